//! Parallel light, and what all lights at infinity share.

use std::f32::consts::PI;

use glam::{Vec2, Vec3A};

use super::{EmissionSample, LightSample};
use crate::engine::geometry::{Geometry, Ray};
use crate::engine::math::{Frame, Rgb};
use crate::engine::sampling::warp::{pdf_unit_disk, sample_unit_disk};

/// A sphere around the scene, through which all light from infinity enters.
#[derive(Clone, Copy, Debug)]
pub struct SceneSphere {
    /// Centre.
    pub center: Vec3A,
    /// Radius, > 0.
    pub radius: f32,
}

impl SceneSphere {
    /// Around all surfaces; of radius 1 where there are none, or only one of no extent.
    pub fn of(geometry: &Geometry) -> Self {
        let (center, radius) = geometry.bounding_sphere();
        Self {
            center,
            radius: if radius.is_normal() { radius } else { 1.0 },
        }
    }

    /// A point outside the sphere in the direction `d` from `p`.
    #[inline]
    pub(super) fn beyond(&self, p: Vec3A, d: Vec3A) -> Vec3A {
        p + d * (2.0 * (p.distance(self.center) + self.radius))
    }

    /// Density of the start points of rays in one direction, 1/m².
    #[inline]
    pub(super) fn pdf_pos(&self) -> f32 {
        pdf_unit_disk() / self.radius / self.radius
    }

    /// Area of the sphere's shadow, m².
    #[inline]
    pub(super) fn cross_section(&self) -> f32 {
        PI * self.radius * self.radius
    }

    /// A ray in the direction of `frame.n` that starts on the disk that touches the sphere from
    /// behind.
    #[inline]
    pub(super) fn enter(&self, frame: &Frame, u: Vec2) -> Ray {
        let disk = sample_unit_disk(u);
        let offset = frame.to_world(Vec3A::new(disk.x, disk.y, -1.0));
        Ray::new(self.center + offset * self.radius, frame.n)
    }
}

/// Parallel light.
#[derive(Clone, Copy, Debug)]
pub struct DirectionalLight {
    travel: Frame,
    irradiance: Rgb,
    scene: SceneSphere,
}

impl DirectionalLight {
    /// Light that travels along `direction` (any length but 0) with `irradiance` in W/m² on a
    /// surface across it. `None` for a direction of no length.
    pub fn new(direction: Vec3A, irradiance: Rgb, scene: SceneSphere) -> Option<Self> {
        let d = direction.as_dvec3().try_normalize()?.as_vec3a();
        Some(Self {
            travel: Frame::from_normal(d),
            irradiance,
            scene,
        })
    }

    /// See [`super::Light::sample_li`].
    #[inline]
    pub fn sample_li(&self, p: Vec3A) -> LightSample {
        let wi = -self.travel.n;
        LightSample {
            wi,
            target: self.scene.beyond(p, wi),
            distance: f32::INFINITY,
            n: None,
            radiance: self.irradiance,
            pdf_dir: 1.0,
            is_delta: true,
        }
    }

    /// See [`super::Light::sample_le`].
    pub fn sample_le(&self, u_pos: Vec2) -> EmissionSample {
        let ray = self.scene.enter(&self.travel, u_pos);
        EmissionSample {
            ray,
            p: ray.o,
            p_error: Vec3A::ZERO,
            n: None,
            radiance: self.irradiance,
            pdf_pos: self.scene.pdf_pos(),
            pdf_dir: 1.0,
            is_delta_pos: false,
            is_delta_dir: true,
        }
    }

    /// Density of the start points of [`DirectionalLight::sample_le`], 1/m².
    #[inline]
    pub fn pdf_pos(&self) -> f32 {
        self.scene.pdf_pos()
    }

    /// Irradiance times the cross section of the scene's bounding sphere.
    pub fn power(&self) -> Rgb {
        self.irradiance * self.scene.cross_section()
    }
}
