//! Warps from the unit square to the distributions of light transport. Each `sample_*` stands
//! beside its `pdf_*`.

use std::f32::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, PI};

use glam::{Vec2, Vec3A};

use crate::engine::math::float::{one_minus_sqr, safe_sqrt};

/// A point of the unit disk, uniform by area (Shirley and Chiu 1997, the concentric map).
#[inline]
pub fn sample_unit_disk(u: Vec2) -> Vec2 {
    let p = 2.0 * u - Vec2::ONE;
    if p == Vec2::ZERO {
        return Vec2::ZERO;
    }
    let (r, phi) = if p.x.abs() > p.y.abs() {
        (p.x, FRAC_PI_4 * (p.y / p.x))
    } else {
        (p.y, FRAC_PI_2 - FRAC_PI_4 * (p.x / p.y))
    };
    let (sin, cos) = phi.sin_cos();
    Vec2::new(r * cos, r * sin)
}

/// Density of [`sample_unit_disk`], 1/m² on the disk of radius 1 m.
#[inline]
pub const fn pdf_unit_disk() -> f32 {
    FRAC_1_PI
}

/// A direction around +z with density cosθ/π (Malley's method). cosθ is greater than 0.
#[inline]
pub fn sample_cosine_hemisphere(u: Vec2) -> Vec3A {
    let d = sample_unit_disk(u);
    // The rim of the disk rounds to radius 1; a direction in the surface would have density 0.
    let z = safe_sqrt(1.0 - d.length_squared()).max(f32::EPSILON * 0.5);
    Vec3A::new(d.x, d.y, z)
}

/// Density of [`sample_cosine_hemisphere`], 1/sr.
#[inline]
pub fn pdf_cosine_hemisphere(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// A direction, uniform over the sphere.
#[inline]
pub fn sample_sphere(u: Vec2) -> Vec3A {
    let z = 1.0 - 2.0 * u.x;
    let r = safe_sqrt(one_minus_sqr(z));
    let (sin, cos) = (2.0 * PI * u.y).sin_cos();
    Vec3A::new(r * cos, r * sin, z)
}

/// Density of [`sample_sphere`], 1/sr.
#[inline]
pub const fn pdf_sphere() -> f32 {
    0.25 * FRAC_1_PI
}

/// A direction around +z, uniform over the cone of opening `one_minus_cos_max` = 1 − cos θmax.
/// The argument is that difference, since a narrow cone's cosine rounds to 1.
#[inline]
pub fn sample_cone(u: Vec2, one_minus_cos_max: f32) -> Vec3A {
    let h = u.x * one_minus_cos_max; // 1 − cosθ
    let r = safe_sqrt(h * (2.0 - h)); // sinθ without cancellation
    let (sin, cos) = (2.0 * PI * u.y).sin_cos();
    Vec3A::new(r * cos, r * sin, 1.0 - h)
}

/// Density of [`sample_cone`], 1/sr.
#[inline]
pub fn pdf_cone(one_minus_cos_max: f32) -> f32 {
    1.0 / (2.0 * PI * one_minus_cos_max)
}

/// Barycentric coordinates (b0, b1) of a point of a triangle, uniform by area and of low
/// distortion (Heitz 2019, *A Low-Distortion Map Between Triangle and Square*).
#[inline]
pub fn sample_triangle(u: Vec2) -> Vec2 {
    if u.x < u.y {
        let b0 = u.x * 0.5;
        Vec2::new(b0, u.y - b0)
    } else {
        let b1 = u.y * 0.5;
        Vec2::new(u.x - b1, b1)
    }
}

/// Density of [`sample_triangle`] on a triangle of area `area` m², 1/m².
#[inline]
pub fn pdf_triangle(area: f32) -> f32 {
    1.0 / area
}
