//! Distances along a ray in proportion to the irradiance of a light near it (Kulla and Fajardo
//! 2012, *Importance Sampling Techniques for Path Tracing in Participating Media*).
//!
//! Tracking scatters where the medium is dense, not where it is lit: around a small light 1/r² is
//! left to chance. Sampled by the angle under which the light sees the ray, it cancels.

use crate::engine::geometry::Ray;
use crate::engine::light::Light;

/// Free paths beyond which no distance is drawn: e⁻⁸ of the light comes from there.
const MAX_THICKNESS: f32 = 8.0;

/// The distribution for one light and one part of a ray.
#[derive(Clone, Copy, Debug)]
pub struct Equiangular {
    /// Distance on the ray that is nearest to the light.
    nearest: f32,
    /// Distance of the light from the ray.
    height: f32,
    /// Angles at the light of the ends of the part, from the perpendicular.
    angles: (f32, f32),
    range: (f32, f32),
}

impl Equiangular {
    /// For `range` of `ray` in a medium of extinction `sigma_t`; None if the light is at infinity
    /// or on the ray.
    #[inline]
    pub fn new(light: &Light, ray: &Ray, range: (f32, f32), sigma_t: f32) -> Option<Self> {
        let center = light.center()?;
        let to = center - ray.o;
        let nearest = to.dot(ray.d);
        let height = (to - ray.d * nearest).length();
        let end = range.1.min(range.0 + MAX_THICKNESS / sigma_t);
        let angle = |t: f32| ((t - nearest) / height).atan();
        let angles = (angle(range.0), angle(end));
        // A comparison that refuses NaN, too.
        (height > 0.0 && angles.1 - angles.0 > 0.0).then_some(Self {
            nearest,
            height,
            angles,
            range: (range.0, end),
        })
    }

    /// A distance on the ray.
    #[inline]
    pub fn sample(&self, u: f32) -> f32 {
        let angle = self.angles.0 + (self.angles.1 - self.angles.0) * u;
        let t = self.nearest + self.height * angle.tan();
        t.clamp(self.range.0, self.range.1)
    }

    /// Density of [`Self::sample`], 1/m.
    #[inline]
    pub fn pdf(&self, t: f32) -> f32 {
        if !(self.range.0..=self.range.1).contains(&t) {
            return 0.0;
        }
        let along = (t - self.nearest) / self.height;
        1.0 / ((self.angles.1 - self.angles.0) * self.height * (1.0 + along * along))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_density_is_that_of_the_samples() {
        for (nearest, height, range) in [
            (0.5, 0.1, (0.0, 1.0)),
            (-3.0, 2.0, (0.0, 50.0)),
            (7.0, 1e-2, (0.2, 100.0)),
            (2.0, 30.0, (0.0, f32::INFINITY)),
        ] {
            let angle = |t: f32| ((t - nearest) / height).atan();
            let e = Equiangular {
                nearest,
                height,
                angles: (angle(range.0), angle(range.1)),
                range,
            };
            // Between neighbouring samples lies the same share: pdf · Δt = Δu.
            let n = 4096;
            let t = |i: usize| e.sample(i as f32 / n as f32);
            for i in (256..n - 288).step_by(61) {
                let (a, b) = (t(i), t(i + 32));
                let middle = t(i + 16);
                let share = e.pdf(middle) * (b - a) * n as f32 / 32.0;
                assert!(
                    (share - 1.0).abs() < 0.02,
                    "{nearest} {height} {i}: {share}"
                );
            }
            assert_eq!(e.pdf(range.0 - 0.1), 0.0);
        }
    }
}
