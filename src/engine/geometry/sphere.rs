//! Ray against sphere at any size and distance.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::{DVec3, Vec2, Vec3, Vec3A};

use super::bounds::Bounds3;
use super::ray::Ray;
use crate::engine::math::float::MACHINE_EPSILON;

/// A sphere as a scene gives it, in world space.
#[derive(Clone, Copy, Debug)]
pub struct SphereInput {
    /// Centre.
    pub center: Vec3,
    /// Radius, greater than 0.
    pub radius: f32,
    /// Whether the front side, with the normal, is the inner one.
    pub inward: bool,
    /// Index into the scene's materials.
    pub material: u32,
}

/// An exact sphere.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    /// Centre.
    pub center: Vec3A,
    /// Radius, greater than 0.
    pub radius: f32,
    /// Whether the normal points to the centre.
    pub inward: bool,
}

/// A point of a sphere.
#[derive(Clone, Copy, Debug)]
pub struct SpherePoint {
    /// Position.
    pub p: Vec3A,
    /// Bound on the absolute error of `p`.
    pub p_error: Vec3A,
    /// Unit normal of the front side.
    pub n: Vec3A,
}

impl Sphere {
    /// The smallest distance greater than 0 at which the ray crosses the surface: the far crossing
    /// where it starts inside.
    ///
    /// In f64, with the discriminant from the vector between the centre and the ray's nearest
    /// point (Hearn and Baker; *Physically Based Rendering*, 4th ed., 6.2.2), which o × d is |d|
    /// times as long as: r² − |perpendicular|² loses nothing to cancellation when the origin is far
    /// away. What is missed costs no division.
    #[inline]
    pub fn intersect(&self, o: DVec3, d: DVec3) -> Option<f32> {
        let o = o - self.center.as_dvec3();
        let r = f64::from(self.radius);
        let a = d.length_squared();
        let discriminant = r * r * a - o.cross(d).length_squared();
        if discriminant.is_nan() || discriminant < 0.0 {
            return None;
        }
        // One root by the sum that does not cancel, the other by Vieta.
        let b = o.dot(d);
        let q = -b - discriminant.sqrt().copysign(b);
        let (t0, t1) = (q / a, (o.length_squared() - r * r) / q);
        let (near, far) = if t0 < t1 { (t0, t1) } else { (t1, t0) };
        let t = if near > 0.0 { near } else { far } as f32;
        (t > 0.0).then_some(t)
    }

    /// The point at distance `t` of the ray, refined to lie on the sphere.
    pub fn point(&self, ray: &Ray, t: f32) -> SpherePoint {
        let c = self.center.as_dvec3();
        let r = f64::from(self.radius);
        let to = ray.o.as_dvec3() + f64::from(t) * ray.d.as_dvec3() - c;
        let outward = to.try_normalize().unwrap_or(DVec3::Y);
        let p = (c + r * outward).as_vec3a();
        // The result rounds once to f32; the f64 operations before it compound to less than
        // 2⁻⁵⁰ of the terms.
        let p_error = p.abs() * MACHINE_EPSILON
            + (self.center.abs() + Vec3A::splat(self.radius)) * MACHINE_EPSILON.powi(2) * 4.0;
        let n = outward.as_vec3a();
        SpherePoint {
            p,
            p_error,
            n: if self.inward { -n } else { n },
        }
    }

    /// Texture coordinates where the normal is `n`: longitude and latitude in [0, 1]². v is 0 at
    /// the south pole (−y); u is ½ towards +z and grows towards +x, so that a texture reads the
    /// right way round from outside.
    pub fn uv(&self, n: Vec3A) -> Vec2 {
        let n = if self.inward { -n } else { n };
        Vec2::new(
            0.5 + n.x.atan2(n.z) * (0.5 * FRAC_1_PI),
            (-n.y).clamp(-1.0, 1.0).acos() * FRAC_1_PI,
        )
    }

    /// The box around it, rounded outward.
    pub fn bounds(&self) -> Bounds3 {
        let c = self.center.as_dvec3();
        let r = DVec3::splat(f64::from(self.radius));
        let outward = |v: DVec3, next: fn(f32) -> f32| {
            let v = v.as_vec3a();
            Vec3A::new(next(v.x), next(v.y), next(v.z))
        };
        Bounds3 {
            min: outward(c - r, f32::next_down),
            max: outward(c + r, f32::next_up),
        }
    }

    /// Surface area.
    pub fn area(&self) -> f32 {
        4.0 * PI * self.radius * self.radius
    }
}
