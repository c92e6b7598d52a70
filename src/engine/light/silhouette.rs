//! What lights at infinity see of the scene: all their light enters through it.

use std::f32::consts::PI;

use glam::{Vec2, Vec3A};

use crate::engine::geometry::{Geometry, Ray};
use crate::engine::math::Frame;
use crate::engine::math::float::{MACHINE_EPSILON, ONE_MINUS_EPSILON};
use crate::engine::sampling::warp::sample_unit_disk;

/// How far the box stands off the surfaces, of the scene's radius: a flat scene has a shadow along
/// its plane, too.
const PADDING: f32 = 1e-3;
/// Roundings of a ray's origin, beside which the box still covers the scene.
const ROUNDINGS: f32 = 4.0 * MACHINE_EPSILON;

/// The shape around the scene that rays from infinity are aimed at.
#[derive(Clone, Copy, Debug)]
pub struct Silhouette {
    center: Vec3A,
    /// Of the sphere around the scene, > 0.
    radius: f32,
    /// Half the sides of the box around all surfaces; `None` if the sphere is to be lit in full.
    half: Option<Vec3A>,
}

impl Silhouette {
    /// The sphere around all surfaces; of radius 1 where there are none, or only one of no extent.
    /// A medium may fill it.
    pub fn of_sphere(geometry: &Geometry) -> Self {
        let (center, radius) = geometry.bounding_sphere();
        Self {
            center,
            radius: if radius.is_normal() { radius } else { 1.0 },
            half: None,
        }
    }

    /// The box around all surfaces, whose shadow is smaller: up to a half in a cube, and without
    /// limit in a flat scene.
    pub fn of_box(geometry: &Geometry) -> Self {
        let sphere = Self::of_sphere(geometry);
        let bounds = geometry.bounds();
        let half = (!bounds.is_empty()).then(|| {
            // From the centre as it was rounded: far from the origin that is no small matter.
            let c = sphere.center.as_dvec3();
            let (up, down) = (bounds.max.as_dvec3() - c, c - bounds.min.as_dvec3());
            let rounding = ROUNDINGS * (sphere.center.abs() + Vec3A::splat(sphere.radius));
            up.max(down).as_vec3a() + rounding + Vec3A::splat(PADDING * sphere.radius)
        });
        Self { half, ..sphere }
    }

    /// A point outside in the direction `d` from `p`.
    #[inline]
    pub fn beyond(&self, p: Vec3A, d: Vec3A) -> Vec3A {
        p + d * (2.0 * (p.distance(self.center) + self.radius))
    }

    /// Area in m² of the shadows that the sides of a box throw along `d`, those across x, y and z.
    #[inline]
    fn shadows(half: Vec3A, d: Vec3A) -> Vec3A {
        let areas = Vec3A::new(half.y * half.z, half.z * half.x, half.x * half.y);
        4.0 * areas * d.abs()
    }

    /// Area of the shadow along the unit direction `d`, m².
    #[inline]
    pub fn area(&self, d: Vec3A) -> f32 {
        match self.half {
            Some(half) => Self::shadows(half, d).element_sum(),
            None => PI * self.radius * self.radius,
        }
    }

    /// Its mean over all directions, m²: a quarter of a convex surface (Cauchy 1841).
    pub fn mean_area(&self) -> f32 {
        match self.half {
            Some(half) => 0.5 * Self::shadows(half, Vec3A::ONE).element_sum(),
            None => PI * self.radius * self.radius,
        }
    }

    /// Density of the rays of [`Self::enter`] across `d`, 1/m².
    #[inline]
    pub fn pdf_pos(&self, d: Vec3A) -> f32 {
        1.0 / self.area(d)
    }

    /// A ray along the unit direction `d` that starts outside; rays are spread evenly over the
    /// shadow.
    pub fn enter(&self, d: Vec3A, u: Vec2) -> Ray {
        let Some(half) = self.half else {
            let disk = sample_unit_disk(u);
            let offset = Frame::from_normal(d).to_world(Vec3A::new(disk.x, disk.y, -1.0));
            return Ray::new(self.center + offset * self.radius, d);
        };
        // One of the three sides that the light falls on, in proportion to its shadow.
        let shadows = Self::shadows(half, d).to_array();
        let mut x = u.x * (shadows[0] + shadows[1] + shadows[2]);
        let mut side = 0;
        while side < 2 && x >= shadows[side] {
            x -= shadows[side];
            side += 1;
        }
        // Rounding may lead past the last shadow, or to one of no size: the end, then.
        let x = (x / shadows[side]).min(ONE_MINUS_EPSILON);
        let (a, b) = ((side + 1) % 3, (side + 2) % 3);
        let mut on_box = Vec3A::ZERO;
        on_box[side] = -d[side].signum() * half[side];
        on_box[a] = (2.0 * x - 1.0) * half[a];
        on_box[b] = (2.0 * u.y - 1.0) * half[b];
        Ray::new(self.center + on_box - d * self.radius, d)
    }
}
