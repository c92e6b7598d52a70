//! Axis-aligned boxes.

use glam::Vec3A;

/// A box between two corners; `min` > `max` where it is empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds3 {
    /// Lower corner.
    pub min: Vec3A,
    /// Upper corner.
    pub max: Vec3A,
}

impl Bounds3 {
    /// The box that holds nothing, neutral under [`Bounds3::union`].
    pub const EMPTY: Self = Self {
        min: Vec3A::INFINITY,
        max: Vec3A::NEG_INFINITY,
    };

    /// Whether it holds no point.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The smallest box around both.
    #[inline]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The smallest box around this one and a point.
    #[inline]
    pub fn including(&self, p: Vec3A) -> Self {
        Self {
            min: self.min.min(p),
            max: self.max.max(p),
        }
    }

    /// Midpoint; the origin for an empty box.
    pub fn center(&self) -> Vec3A {
        if self.is_empty() {
            Vec3A::ZERO
        } else {
            // Halved first, so that no sum overflows.
            0.5 * self.min + 0.5 * self.max
        }
    }

    /// Radius of the sphere around [`Bounds3::center`] that holds the box, rounded up; 0 for an
    /// empty box.
    pub fn radius(&self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        let c = self.center().as_dvec3();
        let far = (self.max.as_dvec3() - c)
            .abs()
            .max((self.min.as_dvec3() - c).abs());
        (far.length() as f32).next_up()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sphere_around_a_box_holds_its_corners() {
        let b = Bounds3::EMPTY
            .including(Vec3A::new(-1.0, 2.0, 1e6))
            .including(Vec3A::new(3.0, 2.0, 1e6 + 1.0));
        for p in [b.min, b.max] {
            let d = (p.as_dvec3() - b.center().as_dvec3()).length();
            assert!(d <= f64::from(b.radius()));
        }
        assert_eq!(Bounds3::EMPTY.radius(), 0.0);
        assert!(Bounds3::EMPTY.is_empty());
    }
}
