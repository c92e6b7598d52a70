//! Flat area lights: a triangle, and two that share an edge.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3A};

use super::spherical_triangle::{HalfAngle, Sight, SphericalTriangle};
use super::{EmissionSample, LightSample};
use crate::engine::geometry::{NO_TRIANGLE, Ray, inset, offset_origin};
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
    /// Which triangle of the geometry it is.
    prim: u32,
}

impl TriangleLight {
    /// Its centroid.
    pub fn center(&self) -> Vec3A {
        (self.corners[0] + self.corners[1] + self.corners[2]) / 3.0
    }

    /// Triangle `prim`, a light on the side from which `corners` run counter-clockwise. `None` where
    /// the area is 0 or beyond the range of `f32`.
    pub fn new(prim: u32, corners: [Vec3A; 3], radiance: Rgb) -> Option<Self> {
        let v = corners.map(|v| v.as_dvec3());
        let cross = (v[1] - v[0]).cross(v[2] - v[0]);
        let area = (0.5 * cross.length()) as f32;
        let light = Self {
            corners,
            cross: cross.as_vec3a(),
            n: cross.try_normalize()?.as_vec3a(),
            area,
            radiance,
            prim,
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

    #[inline]
    fn seen_from(&self, p: Vec3A) -> Option<SphericalTriangle> {
        let [a, b, c] = self.corners;
        let [v0, v1, v2] = &[Sight::new(a, p), Sight::new(b, p), Sight::new(c, p)];
        let arcs = [v0.arc(v1), v0.arc(v2), v1.arc(v2)];
        SphericalTriangle::new([v0, v1, v2], arcs, self.cross)
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
            prim: self.prim,
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
        let mut emission = emit_from_surface(p, p_error, self.n, self.area, self.radiance, u_dir);
        emission.ray.clear_of = [self.prim, NO_TRIANGLE];
        emission
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
    /// the sampling fan out; v2 of the first is v0 of the second.
    halves: [TriangleLight; 2],
}

/// The corners of both halves of a quadrangle seen from a point, and 1 + cos of the arcs 01, 02
/// and 12 of each.
struct QuadSights {
    /// v0, v1 and v2 of the first, v2 of the second.
    corners: [Sight; 4],
    arcs: [[f32; 3]; 2],
}

impl QuadSights {
    /// The corners of half 0 or 1.
    #[inline]
    fn half(&self, half: usize) -> [&Sight; 3] {
        let [v0, apex, shared, last] = &self.corners;
        if half == 0 {
            [v0, apex, shared]
        } else {
            [shared, apex, last]
        }
    }
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
            TriangleLight::new(t.prim, [at(2), at(0), at(1)], t.radiance)
        };
        // Around the apex the order is: far corner of one, shared corner, far corner of the other.
        Some(Self {
            halves: [turned(first, i)?, turned(second, (j + 1) % 3)?],
        })
    }

    #[inline]
    fn seen_from(&self, p: Vec3A) -> QuadSights {
        let [[v0, apex, shared], [_, _, last]] = [self.halves[0].corners, self.halves[1].corners];
        let (v0, apex) = (Sight::new(v0, p), Sight::new(apex, p));
        let (shared, last) = (Sight::new(shared, p), Sight::new(last, p));
        let spoke = apex.arc(&shared);
        QuadSights {
            arcs: [
                [v0.arc(&apex), v0.arc(&shared), spoke],
                [spoke, shared.arc(&last), apex.arc(&last)],
            ],
            corners: [v0, apex, shared, last],
        }
    }

    /// See [`super::Light::sample_li`]: uniform over the solid angle.
    #[inline]
    pub fn sample_li(&self, p: Vec3A, u: Vec2) -> Option<LightSample> {
        let sights = self.seen_from(p);
        let of =
            |i: usize| SphericalTriangle::new(sights.half(i), sights.arcs[i], self.halves[i].cross);
        let (first, second) = (of(0), of(1));
        // Not by `map` over the halves, which is not inlined.
        let omega = |half: &Option<SphericalTriangle>| half.as_ref().map_or(0.0, |s| s.solid_angle);
        let (omega0, omega1) = (omega(&first), omega(&second));
        let total = omega0 + omega1;
        let x = u.x * total;
        let (half, seen, u_x) = if x < omega0 {
            (&self.halves[0], first?, x / omega0)
        } else {
            (&self.halves[1], second?, (x - omega0) / omega1)
        };
        let u = Vec2::new(u_x.min(ONE_MINUS_EPSILON), u.y);
        // No more than half of all directions, whatever rounding makes of both at the lamp itself.
        half.light_sample(p, seen.sample(u)?, 1.0 / total.min(TAU))
    }

    /// See [`super::Light::pdf_li`].
    #[inline]
    pub fn pdf_li(&self, p: Vec3A) -> f32 {
        let sights = self.seen_from(p);
        let of = |i: usize| HalfAngle::new(sights.half(i), sights.arcs[i], self.halves[i].cross);
        let both = match (of(0), of(1)) {
            (Some(first), Some(second)) => first.plus(second),
            (first, second) => match first.or(second) {
                Some(one) => one,
                None => return 0.0,
            },
        };
        both.solid_angle().map_or(0.0, |omega| 1.0 / omega)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::math::hash::{mix64, unit_f32};
    use crate::engine::sampling::warp::sample_sphere;

    /// A lamp of the half width `size` around `center`, whose front looks along the normal of
    /// `frame`.
    fn lamp(frame: &Frame, center: Vec3A, size: f32) -> Option<QuadLight> {
        let at = |x: f32, y: f32| center + (frame.s * x + frame.t * y) * size;
        let [a, b, c, d] = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
        let half = |prim, corners| TriangleLight::new(prim, corners, Rgb::WHITE);
        QuadLight::new(&half(0, [a, b, c])?, &half(1, [a, c, d])?)
    }

    /// At the lamp both halves see about π, and the half angles sum to π but for rounding.
    #[test]
    fn a_quadrangle_is_sampled_with_the_density_that_it_says() {
        let mut key = 0;
        let mut number = || {
            key += 1;
            unit_f32(mix64(key))
        };
        let (mut seen, mut wide) = (0, 0);
        for (offset, size) in [(0.0, 1.0), (10.0, 1.0), (1000.0, 0.05), (0.0, 1e-4)] {
            for _ in 0..40_000 {
                let frame = Frame::from_normal(sample_sphere(Vec2::new(number(), number())));
                let Some(lamp) = lamp(&frame, Vec3A::splat(offset), size) else {
                    continue; // rounding has bent it
                };
                let height = size * 10.0_f32.powf(2.0 - 8.0 * number());
                let aside = Vec2::new(number(), number()) * 2.0 - 1.0;
                let p = Vec3A::splat(offset)
                    + (frame.s * aside.x + frame.t * aside.y) * size
                    + frame.n * height;
                let Some(sample) = lamp.sample_li(p, Vec2::new(number(), number())) else {
                    continue;
                };
                let ratio = lamp.pdf_li(p) / sample.pdf_dir;
                assert!(
                    (ratio - 1.0).abs() < 3e-6,
                    "{ratio} at {height} over {size}"
                );
                seen += 1;
                wide += usize::from(sample.pdf_dir * PI < 0.51);
            }
        }
        assert!(seen > 100_000 && wide > 10_000, "{seen} {wide}");
    }
}
