//! Flat area lights: a triangle, and two that share an edge.

use std::f32::consts::PI;

use glam::{Vec2, Vec3A};

use super::spherical_triangle::SphericalTriangle;
use super::{EmissionSample, LightSample};
use crate::engine::geometry::{Ray, inset, offset_origin};
use crate::engine::math::float::{ONE_MINUS_EPSILON, gamma};
use crate::engine::math::{Frame, Rgb};
use crate::engine::sampling::warp::{
    pdf_cosine_hemisphere, sample_cosine_hemisphere, sample_triangle,
};

/// A triangle that emits the same radiance from all of its front side.
#[derive(Clone, Copy, Debug)]
pub struct TriangleLight {
    corners: [Vec3A; 3],
    /// (v1 − v0) × (v2 − v0): twice the area long.
    cross: Vec3A,
    /// Unit normal of the front.
    pub n: Vec3A,
    /// Area in m².
    pub area: f32,
    /// Emitted radiance.
    pub radiance: Rgb,
}

impl TriangleLight {
    /// Its centroid.
    pub fn center(&self) -> Vec3A {
        (self.corners[0] + self.corners[1] + self.corners[2]) / 3.0
    }

    /// A light on the side from which `corners` run counter-clockwise. `None` for a triangle
    /// whose area is 0 or beyond the range of `f32`.
    pub fn new(corners: [Vec3A; 3], radiance: Rgb) -> Option<Self> {
        let v = corners.map(|v| v.as_dvec3());
        let cross = (v[1] - v[0]).cross(v[2] - v[0]);
        let area = (0.5 * cross.length()) as f32;
        let light = Self {
            corners,
            cross: cross.as_vec3a(),
            n: cross.try_normalize()?.as_vec3a(),
            area,
            radiance,
        };
        (area.is_normal() && light.cross.is_finite()).then_some(light)
    }

    /// The point of the given barycentric coordinates and a bound on its error.
    fn point(&self, b: [f32; 3]) -> (Vec3A, Vec3A) {
        let terms = [
            self.corners[0] * b[0],
            self.corners[1] * b[1],
            self.corners[2] * b[2],
        ];
        let p = terms[0] + terms[1] + terms[2];
        let magnitude = terms[0].abs() + terms[1].abs() + terms[2].abs();
        (p, gamma(6) * magnitude)
    }

    fn seen_from(&self, p: Vec3A) -> Option<SphericalTriangle> {
        SphericalTriangle::new(&self.corners, self.cross, p)
    }

    /// The point with barycentric coordinates `b`, seen from `p`.
    fn light_sample(&self, p: Vec3A, b: [f32; 3], pdf_dir: f32) -> Option<LightSample> {
        let (q, q_error) = self.point(b);
        let to = q - p;
        let distance = to.length();
        if !(distance > 0.0 && pdf_dir.is_finite()) {
            return None;
        }
        Some(LightSample {
            wi: to / distance,
            target: offset_origin(q, q_error, self.n, self.n),
            distance,
            n: Some(self.n),
            radiance: self.radiance,
            pdf_dir,
            is_delta: false,
        })
    }

    /// See [`super::Light::sample_li`]: uniform over the solid angle.
    #[inline]
    pub fn sample_li(&self, p: Vec3A, u: Vec2) -> Option<LightSample> {
        let seen = self.seen_from(p)?;
        self.light_sample(p, seen.sample(u)?, 1.0 / seen.solid_angle)
    }

    /// See [`super::Light::pdf_li`].
    #[inline]
    pub fn pdf_li(&self, p: Vec3A) -> f32 {
        self.seen_from(p).map_or(0.0, |seen| 1.0 / seen.solid_angle)
    }

    /// See [`super::Light::sample_le`]: uniform by area, directions by the cosine.
    pub fn sample_le(&self, u_pos: Vec2, u_dir: Vec2) -> EmissionSample {
        let b = sample_triangle(u_pos);
        let b = [b.x, b.y, (1.0 - b.x - b.y).max(0.0)];
        let (p, p_error) = self.point(b);
        let [v0, v1, v2] = self.corners.map(|v| v.as_dvec3());
        let edges = [v1 - v0, v2 - v0, self.cross.as_dvec3()];
        let p = inset(p.as_dvec3(), b.map(f64::from), edges, p_error).as_vec3a();
        emit_from_surface(p, p_error, self.n, self.area, self.radiance, u_dir)
    }

    /// π · area · radiance.
    pub fn power(&self) -> Rgb {
        self.radiance * (PI * self.area)
    }
}

/// A ray from the point `p` of a surface of area `area`, sampled uniformly, with the cosine.
pub(super) fn emit_from_surface(
    p: Vec3A,
    p_error: Vec3A,
    n: Vec3A,
    area: f32,
    radiance: Rgb,
    u_dir: Vec2,
) -> EmissionSample {
    let local = sample_cosine_hemisphere(u_dir);
    let d = Frame::from_normal(n).to_world(local);
    EmissionSample {
        ray: Ray::new(offset_origin(p, p_error, n, n), d),
        p,
        p_error,
        n: Some(n),
        radiance,
        pdf_pos: 1.0 / area,
        pdf_dir: pdf_cosine_hemisphere(local.z),
        is_delta_pos: false,
        is_delta_dir: false,
    }
}

/// Two triangles of one plane that share an edge and its radiance, sampled as one: uniformly over
/// the solid angle of both, where two lights would be chosen by their power.
#[derive(Clone, Copy, Debug)]
pub struct QuadLight {
    /// Both begin their corners (v0, v1, v2) so that v1 is the same point, from which the rays of
    /// the sampling fan out.
    halves: [TriangleLight; 2],
}

/// Not by `map` over the halves, which is not inlined.
#[inline]
fn solid_angles([first, second]: &[Option<SphericalTriangle>; 2]) -> [f32; 2] {
    let of = |half: &Option<SphericalTriangle>| half.as_ref().map_or(0.0, |s| s.solid_angle);
    [of(first), of(second)]
}

impl QuadLight {
    /// The middle of its halves' centroids.
    pub fn center(&self) -> Vec3A {
        0.5 * (self.halves[0].center() + self.halves[1].center())
    }

    /// Joins two triangles if they share an edge, run the same way round, lie in one plane, and
    /// emit the same.
    pub fn new(first: &TriangleLight, second: &TriangleLight) -> Option<Self> {
        if first.radiance != second.radiance || first.n.dot(second.n) <= 0.0 {
            return None;
        }
        // The shared edge runs i → i+1 in one and j+1 → j in the other.
        let (i, j) = (0..9).map(|k| (k / 3, k % 3)).find(|&(i, j)| {
            first.corners[i] == second.corners[(j + 1) % 3]
                && first.corners[(i + 1) % 3] == second.corners[j]
        })?;
        let far = second.corners[(j + 2) % 3].as_dvec3() - first.corners[i].as_dvec3();
        let normal = first.cross.as_dvec3();
        // In one plane to within the rounding of the corners themselves.
        let reach = first
            .corners
            .iter()
            .chain(&second.corners)
            .fold(Vec3A::ZERO, |m, v| m.max(v.abs()));
        let height = far.dot(normal).abs();
        if height > f64::from(gamma(3)) * normal.abs().dot(reach.as_dvec3()) {
            return None;
        }
        let turned = |t: &TriangleLight, apex: usize| {
            let at = |k: usize| t.corners[(apex + k) % 3];
            TriangleLight::new([at(2), at(0), at(1)], t.radiance)
        };
        // Around the apex the order is: far corner of one, shared corner, far corner of the other.
        Some(Self {
            halves: [turned(first, i)?, turned(second, (j + 1) % 3)?],
        })
    }

    fn seen_from(&self, p: Vec3A) -> [Option<SphericalTriangle>; 2] {
        [self.halves[0].seen_from(p), self.halves[1].seen_from(p)]
    }

    /// See [`super::Light::sample_li`]: uniform over the solid angle.
    #[inline]
    pub fn sample_li(&self, p: Vec3A, u: Vec2) -> Option<LightSample> {
        let seen = self.seen_from(p);
        let omega = solid_angles(&seen);
        let total = omega[0] + omega[1];
        let x = u.x * total;
        let (half, u_x) = if x < omega[0] {
            (0, x / omega[0])
        } else {
            (1, (x - omega[0]) / omega[1])
        };
        let u = Vec2::new(u_x.min(ONE_MINUS_EPSILON), u.y);
        self.halves[half].light_sample(p, seen[half]?.sample(u)?, 1.0 / total)
    }

    /// See [`super::Light::pdf_li`].
    #[inline]
    pub fn pdf_li(&self, p: Vec3A) -> f32 {
        let omega = solid_angles(&self.seen_from(p));
        let total = omega[0] + omega[1];
        if total > 0.0 { 1.0 / total } else { 0.0 }
    }

    /// See [`super::Light::sample_le`]: uniform by area, directions by the cosine.
    pub fn sample_le(&self, u_pos: Vec2, u_dir: Vec2) -> EmissionSample {
        let x = u_pos.x * self.area();
        let area = self.halves[0].area;
        let (half, u_x) = if x < area {
            (&self.halves[0], x / area)
        } else {
            (&self.halves[1], (x - area) / self.halves[1].area)
        };
        let u_pos = Vec2::new(u_x.min(ONE_MINUS_EPSILON), u_pos.y);
        EmissionSample {
            pdf_pos: 1.0 / self.area(),
            ..half.sample_le(u_pos, u_dir)
        }
    }

    /// Area of both, m².
    #[inline]
    pub fn area(&self) -> f32 {
        self.halves[0].area + self.halves[1].area
    }

    /// Emitted radiance.
    #[inline]
    pub fn radiance(&self) -> Rgb {
        self.halves[0].radiance
    }

    /// π · area · radiance.
    pub fn power(&self) -> Rgb {
        self.radiance() * (PI * self.area())
    }
}
