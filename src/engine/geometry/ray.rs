//! A half line.

use glam::Vec3A;

/// A ray from `o` along the unit vector `d`, valid for distances in (0, `t_max`).
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Origin. Secondary rays start outside the error box of their surface, so 0 is no hit.
    pub o: Vec3A,
    /// Unit direction.
    pub d: Vec3A,
    /// Largest distance of interest, exclusive; infinite for closest-hit queries.
    pub t_max: f32,
    /// Triangles that it is known not to meet: one that it leaves, one that it ends on. They are
    /// flat. [`NO_TRIANGLE`] stands for none; numbers of spheres change nothing.
    pub clear_of: [u32; 2],
}

/// No triangle, in [`Ray::clear_of`].
pub const NO_TRIANGLE: u32 = u32::MAX;

impl Ray {
    /// A ray without end.
    #[inline]
    pub fn new(o: Vec3A, d: Vec3A) -> Self {
        Self {
            o,
            d,
            t_max: f32::INFINITY,
            clear_of: [NO_TRIANGLE; 2],
        }
    }

    /// A ray from `o` that ends short of `target`; both are moved off their surfaces already.
    #[inline]
    pub fn between(o: Vec3A, target: Vec3A) -> Self {
        let to = target - o;
        let t = to.length();
        Self {
            o,
            // Between two points that `f32` does not tell apart there is nothing: the ray ends
            // where it begins, whatever its direction.
            d: if t > 0.0 { to / t } else { Vec3A::X },
            t_max: t * (1.0 - SHADOW_SHORTENING),
            clear_of: [NO_TRIANGLE; 2],
        }
    }

    /// The same ray, tested against every triangle: whether origins do by themselves.
    #[must_use]
    pub fn against_all(self) -> Self {
        Self {
            clear_of: [NO_TRIANGLE; 2],
            ..self
        }
    }

    /// The point at distance `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3A {
        self.o + self.d * t
    }
}

/// Relative shortening of a ray between two points: covers the rounding of its direction and
/// length, a few operations of γ₃ each.
const SHADOW_SHORTENING: f32 = 8.0 * f32::EPSILON;

/// Where a ray met the geometry; [`super::Geometry::interaction`] tells the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, greater than 0.
    pub t: f32,
    /// The triangle or sphere.
    pub prim: u32,
    /// Barycentric weight of the triangle's second vertex; 0 for a sphere.
    pub u: f32,
    /// Barycentric weight of the triangle's third vertex; 0 for a sphere.
    pub v: f32,
}
