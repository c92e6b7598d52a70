//! What is known about a point where a ray met a surface.

use glam::{Vec2, Vec3A};

use super::closed::Departure;
use super::offset::offset_origin;
use super::ray::{NO_TRIANGLE, Ray};

/// A point of a surface, seen from `wo`.
///
/// Invariant: `wo` points away from the surface; `n_g` is the geometric normal of the front side
/// (counter-clockwise, or outward) whichever side is seen; `n_s` lies in its hemisphere. A place
/// in a medium has no normal: both are 0, as is `p_error`, and rays leave it from where it is.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInteraction {
    /// Position.
    pub p: Vec3A,
    /// Bound on the absolute error of each coordinate of `p`.
    pub p_error: Vec3A,
    /// Unit geometric normal.
    pub n_g: Vec3A,
    /// Unit shading normal.
    pub n_s: Vec3A,
    /// Texture coordinates; v = 0 at the bottom of an image. Of spheres only where a material of the
    /// scene looks them up.
    pub uv: Vec2,
    /// Unit direction the ray came from.
    pub wo: Vec3A,
    /// Distance along the ray.
    pub t: f32,
    /// Index into the scene's materials.
    pub material: u32,
    /// Index into the scene's lights where the surface emits.
    pub light: Option<u32>,
    /// Index of the triangle or sphere in the geometry.
    pub prim: u32,
}

impl SurfaceInteraction {
    /// A place in a medium at the distance `t` of `ray`.
    pub fn in_volume(ray: &Ray, t: f32) -> Self {
        Self {
            p: ray.at(t),
            p_error: Vec3A::ZERO,
            n_g: Vec3A::ZERO,
            n_s: Vec3A::ZERO,
            uv: Vec2::ZERO,
            wo: -ray.d,
            t,
            material: 0,
            light: None,
            prim: u32::MAX,
        }
    }

    /// Whether it is a place in a medium.
    #[inline]
    pub fn is_in_volume(&self) -> bool {
        self.n_g == Vec3A::ZERO
    }

    /// Where a ray leaves in the direction `d`.
    #[inline]
    pub fn departure(&self, d: Vec3A) -> Departure {
        Departure {
            prim: self.prim,
            front: self.n_g.dot(d) > 0.0,
        }
    }

    /// A ray that leaves in the unit direction `d` without meeting this surface again at its
    /// origin.
    #[inline]
    pub fn spawn_ray(&self, d: Vec3A) -> Ray {
        let o = offset_origin(self.p, self.p_error, self.n_g, d);
        Ray {
            clear_of: [self.prim, NO_TRIANGLE],
            ..Ray::new(o, d)
        }
    }

    /// A ray to `target`, a point that is moved off its own surface already; it ends short of it.
    #[inline]
    pub fn spawn_ray_to(&self, target: Vec3A) -> Ray {
        let o = offset_origin(self.p, self.p_error, self.n_g, target - self.p);
        Ray {
            clear_of: [self.prim, NO_TRIANGLE],
            ..Ray::between(o, target)
        }
    }

    /// A ray to the point `other` of another surface, clear of both.
    #[inline]
    pub fn spawn_ray_to_surface(&self, other: &Self) -> Ray {
        let toward = self.p - other.p;
        let target = offset_origin(other.p, other.p_error, other.n_g, toward);
        Ray {
            clear_of: [self.prim, other.prim],
            ..self.spawn_ray_to(target)
        }
    }
}
