//! Lights at a point: in all directions, and into a cone.

use std::f32::consts::PI;

use glam::{Vec2, Vec3A};

use super::{EmissionSample, LightSample};
use crate::engine::geometry::{NO_TRIANGLE, Ray};
use crate::engine::math::{Frame, Rgb};
use crate::engine::sampling::warp::{pdf_cone, pdf_sphere, sample_cone, sample_sphere};

/// The same intensity in all directions.
#[derive(Clone, Copy, Debug)]
pub struct PointLight {
    /// Where.
    pub position: Vec3A,
    /// W/sr.
    pub intensity: Rgb,
}

impl PointLight {
    /// See [`super::Light::sample_li`].
    #[inline]
    pub fn sample_li(&self, p: Vec3A) -> Option<LightSample> {
        sample_at(self.position, p, |_| self.intensity)
    }

    /// See [`super::Light::sample_le`].
    #[inline]
    pub fn sample_le(&self, u_dir: Vec2) -> EmissionSample {
        emit_at(
            self.position,
            sample_sphere(u_dir),
            self.intensity,
            pdf_sphere(),
        )
    }

    /// 4π · intensity.
    pub fn power(&self) -> Rgb {
        self.intensity * (4.0 * PI)
    }
}

/// A cone with a smooth edge.
#[derive(Clone, Copy, Debug)]
pub struct SpotLight {
    position: Vec3A,
    axis: Frame,
    intensity: Rgb,
    /// 1 − cos of the angle up to which the intensity is full.
    inner: f32,
    /// 1 − cos of the angle from which it is 0.
    outer: f32,
}

impl SpotLight {
    /// Where it is.
    pub fn position(&self) -> Vec3A {
        self.position
    }

    /// A light along `direction` (any length but 0) within the half angle `angle_deg` in
    /// (0, 180], fading over the last `falloff_deg` of it. `None` for a direction of no length.
    pub fn new(
        position: Vec3A,
        direction: Vec3A,
        intensity: Rgb,
        angle_deg: f32,
        falloff_deg: f32,
    ) -> Option<Self> {
        let axis = direction.as_dvec3().try_normalize()?.as_vec3a();
        // 1 − cosα = 2 sin²(α/2) keeps its digits in narrow cones.
        let drop = |degrees: f32| {
            let s = (0.5 * degrees.clamp(0.0, 180.0).to_radians()).sin();
            2.0 * s * s
        };
        Some(Self {
            position,
            axis: Frame::from_normal(axis),
            intensity,
            inner: drop(angle_deg - falloff_deg),
            outer: drop(angle_deg),
        })
    }

    /// Intensity in the unit direction `d`: a cubic step in the cosine, as in *Physically Based
    /// Rendering*, 4th ed., section 12.2.1.
    #[inline]
    pub fn intensity(&self, d: Vec3A) -> Rgb {
        self.intensity * self.step(0.5 * (d - self.axis.n).length_squared())
    }

    fn step(&self, drop: f32) -> f32 {
        if drop <= self.inner {
            1.0
        } else if drop < self.outer {
            let x = (self.outer - drop) / (self.outer - self.inner);
            x * x * (3.0 - 2.0 * x)
        } else {
            0.0
        }
    }

    /// See [`super::Light::sample_li`].
    #[inline]
    pub fn sample_li(&self, p: Vec3A) -> Option<LightSample> {
        sample_at(self.position, p, |d| self.intensity(d))
            .filter(|sample| !sample.radiance.is_black())
    }

    /// See [`super::Light::sample_le`]: uniform over the cone. Of a narrow cone, the turn to world
    /// coordinates rounds some directions over the edge: there the intensity is 0, as it is for
    /// shadow rays, and so is the density. The intensity belonging to the direction before it was
    /// rounded would be light that no other strategy can find.
    #[inline]
    pub fn sample_le(&self, u_dir: Vec2) -> EmissionSample {
        let d = self.axis.to_world(sample_cone(u_dir, self.outer));
        emit_at(self.position, d, self.intensity(d), pdf_cone(self.outer))
    }

    /// Density of the directions of [`SpotLight::sample_le`], 1/sr.
    #[inline]
    pub fn pdf_dir(&self, d: Vec3A) -> f32 {
        if 0.5 * (d - self.axis.n).length_squared() < self.outer {
            pdf_cone(self.outer)
        } else {
            0.0
        }
    }

    /// Intensity times the solid angle of the inner cone and half that of the edge, since the
    /// cubic step has the mean ½.
    pub fn power(&self) -> Rgb {
        self.intensity * (PI * (self.inner + self.outer))
    }
}

/// A light at `position` seen from `p`, with the intensity towards a direction.
#[inline]
fn sample_at(position: Vec3A, p: Vec3A, intensity: impl Fn(Vec3A) -> Rgb) -> Option<LightSample> {
    let to = position - p;
    let distance = to.length();
    let wi = to / distance;
    let radiance = intensity(-wi) / distance / distance;
    // A light in the surface itself, or beyond all numbers, lies in no direction. Radiance that is
    // infinite is let through: it is counted, not dropped in silence.
    (distance > 0.0 && distance.is_finite()).then_some(LightSample {
        wi,
        target: position,
        distance,
        n: None,
        radiance,
        pdf_dir: 1.0,
        is_delta: true,
        prim: NO_TRIANGLE,
    })
}

fn emit_at(p: Vec3A, d: Vec3A, radiance: Rgb, pdf_dir: f32) -> EmissionSample {
    EmissionSample {
        ray: Ray::new(p, d),
        p,
        p_error: Vec3A::ZERO,
        n: None,
        radiance,
        pdf_pos: 1.0,
        pdf_dir,
        is_delta_pos: true,
        is_delta_dir: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::sampling::{IndependentSampler, Sampler, Stream};

    /// Emission lies where the density says so, however narrow the cone.
    #[test]
    fn no_light_leaves_where_the_density_is_0() {
        for (angle, some_rounded_out) in [(0.02, true), (0.5, false), (60.0, false)] {
            let direction = Vec3A::new(0.1, -1.0, 0.3);
            let spot =
                SpotLight::new(Vec3A::ZERO, direction, Rgb::WHITE, angle, 0.0).expect("an axis");
            let mut dark = 0;
            let n = 200_000;
            for i in 0..n {
                let mut sampler = IndependentSampler::new(1, Stream::Test, (0, i));
                let e = spot.sample_le(sampler.next_2d());
                assert_eq!(e.radiance.is_black(), spot.pdf_dir(e.ray.d) == 0.0);
                dark += u64::from(e.radiance.is_black());
            }
            assert!(dark < n / 1000, "{angle}: {dark}");
            assert!(dark > 0 || !some_rounded_out, "{angle}: nothing was tested");
        }
    }
}
