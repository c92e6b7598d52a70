//! Spherical lights.

use std::f32::consts::PI;

use glam::{Vec2, Vec3A};

use super::triangle::emit_from_surface;
use super::{EmissionSample, LightSample};
use crate::engine::geometry::{NO_TRIANGLE, offset_origin};
use crate::engine::math::float::{gamma, safe_sqrt};
use crate::engine::math::{Frame, Rgb};
use crate::engine::sampling::warp::{pdf_cone, sample_sphere};

/// A sphere that emits the same radiance from all of its front side.
///
/// From outside, a sphere that emits outward is sampled uniformly over the cone of directions that
/// meet it; one that emits inward is sampled by area from anywhere, which for two points of the
/// sphere itself is the exact form factor.
#[derive(Clone, Copy, Debug)]
pub struct SphereLight {
    center: Vec3A,
    radius: f32,
    inward: bool,
    /// Emitted radiance.
    pub radiance: Rgb,
}

/// The cone in which a sphere is seen.
struct Cone {
    /// Unit direction to the centre.
    axis: Vec3A,
    /// Distance of the centre.
    distance: f32,
    /// Its square less that of the radius.
    tangent2: f32,
    /// 1 − cosθmax, in (0, 1].
    drop: f32,
}

impl SphereLight {
    /// Its centre.
    pub fn center(&self) -> Vec3A {
        self.center
    }

    /// A light on the outer side, or the inner one. `None` unless radius and area are in the
    /// range of `f32`.
    pub fn new(center: Vec3A, radius: f32, inward: bool, radiance: Rgb) -> Option<Self> {
        let light = Self {
            center,
            radius,
            inward,
            radiance,
        };
        (radius > 0.0 && light.area().is_normal() && center.is_finite()).then_some(light)
    }

    /// Surface area, m².
    #[inline]
    pub fn area(&self) -> f32 {
        4.0 * PI * self.radius * self.radius
    }

    /// `None` for points inside.
    fn cone(&self, p: Vec3A) -> Option<Cone> {
        let to = self.center - p;
        let distance = to.length();
        let tangent2 = (distance - self.radius) * (distance + self.radius);
        if tangent2 <= 0.0 {
            return None;
        }
        // 1 − cosθ = sin²θ / (1 + cosθ) keeps its digits where the cone is narrow.
        let sin = self.radius / distance;
        let cos = tangent2.sqrt() / distance;
        let drop = sin * sin / (1.0 + cos);
        (drop.is_normal() && distance.is_finite()).then_some(Cone {
            axis: to / distance,
            distance,
            tangent2,
            drop,
        })
    }

    /// The point whose outward normal is `outward`, a bound on its error, the emitting side's
    /// normal.
    fn point(&self, outward: Vec3A) -> (Vec3A, Vec3A, Vec3A) {
        let p = self.center + self.radius * outward;
        let p_error = gamma(5) * (self.center.abs() + Vec3A::splat(self.radius));
        (p, p_error, if self.inward { -outward } else { outward })
    }

    /// See [`super::Light::sample_li`].
    pub fn sample_li(&self, p: Vec3A, u: Vec2) -> Option<LightSample> {
        if self.inward {
            self.sample_by_area(p, u)
        } else {
            self.sample_by_cone(p, u)
        }
    }

    fn sample_by_cone(&self, p: Vec3A, u: Vec2) -> Option<LightSample> {
        let cone = self.cone(p)?;
        let max = cone.drop;
        let h = u.x * max; // 1 − cosθ
        let (sin, cos) = (safe_sqrt(h * (2.0 - h)), 1.0 - h);
        // The ray passes the centre at r·ρ; ρ = sinθ / sinθmax and √(1 − ρ²) as products.
        let rho = (u.x * (2.0 - h) / (2.0 - max)).sqrt();
        let depth = safe_sqrt((1.0 - u.x) * (2.0 - max * (1.0 + u.x)) / (2.0 - max));
        let (sin_phi, cos_phi) = (2.0 * PI * u.y).sin_cos();
        let frame = Frame::from_normal(cone.axis);
        let wi = frame.to_world(Vec3A::new(sin * cos_phi, sin * sin_phi, cos));

        // Angle at the centre between the point and p: asin ρ − θ.
        let (sin_a, cos_a) = (rho * cos - depth * sin, depth * cos + rho * sin);
        let outward = frame.to_world(Vec3A::new(sin_a * cos_phi, sin_a * sin_phi, -cos_a));
        let (q, q_error, n) = self.point(outward);
        Some(LightSample {
            wi,
            target: offset_origin(q, q_error, n, n),
            // The near one of two crossings whose product is the tangent's square.
            distance: cone.tangent2 / (cone.distance * cos + self.radius * depth),
            n: Some(n),
            radiance: self.radiance,
            pdf_dir: pdf_cone(max),
            is_delta: false,
            prim: NO_TRIANGLE,
        })
    }

    fn sample_by_area(&self, p: Vec3A, u: Vec2) -> Option<LightSample> {
        let (q, q_error, n) = self.point(sample_sphere(u));
        let to = q - p;
        let distance = to.length();
        let pdf_dir = self.pdf_by_area(p, q, n);
        (pdf_dir > 0.0 && pdf_dir.is_finite()).then(|| LightSample {
            wi: to / distance,
            target: offset_origin(q, q_error, n, n),
            distance,
            n: Some(n),
            radiance: self.radiance,
            pdf_dir,
            is_delta: false,
            prim: NO_TRIANGLE,
        })
    }

    /// distance² / (cosθ · area), 0 where `q` turns its back.
    fn pdf_by_area(&self, p: Vec3A, q: Vec3A, n: Vec3A) -> f32 {
        let to = p - q;
        let distance = to.length();
        let cos = n.dot(to) / distance;
        if cos > 0.0 {
            distance / cos * distance / self.area()
        } else {
            0.0
        }
    }

    /// See [`super::Light::pdf_li`]; `q` is the point of the light, `n` its front's normal.
    pub fn pdf_li(&self, p: Vec3A, q: Vec3A, n: Vec3A) -> f32 {
        if self.inward {
            self.pdf_by_area(p, q, n)
        } else {
            self.cone(p).map_or(0.0, |cone| pdf_cone(cone.drop))
        }
    }

    /// See [`super::Light::sample_le`]: uniform by area, directions by the cosine.
    pub fn sample_le(&self, u_pos: Vec2, u_dir: Vec2) -> EmissionSample {
        let (p, p_error, n) = self.point(sample_sphere(u_pos));
        emit_from_surface(p, p_error, n, self.area(), self.radiance, u_dir)
    }

    /// π · area · radiance.
    pub fn power(&self) -> Rgb {
        self.radiance * (PI * self.area())
    }
}
