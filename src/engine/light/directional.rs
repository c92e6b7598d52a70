//! Parallel light.

use glam::{Vec2, Vec3A};

use super::silhouette::Silhouette;
use super::{EmissionSample, LightSample};
use crate::engine::geometry::NO_TRIANGLE;
use crate::engine::math::Rgb;

/// Parallel light.
#[derive(Clone, Copy, Debug)]
pub struct DirectionalLight {
    travel: Vec3A,
    irradiance: Rgb,
    scene: Silhouette,
}

impl DirectionalLight {
    /// Light that travels along `direction` (any length but 0) with `irradiance` in W/m² on a
    /// surface across it. `None` for a direction of no length.
    pub fn new(direction: Vec3A, irradiance: Rgb, scene: Silhouette) -> Option<Self> {
        let d = direction.as_dvec3().try_normalize()?.as_vec3a();
        Some(Self {
            travel: d,
            irradiance,
            scene,
        })
    }

    /// See [`super::Light::sample_li`].
    #[inline]
    pub fn sample_li(&self, p: Vec3A) -> LightSample {
        let wi = -self.travel;
        LightSample {
            wi,
            target: self.scene.beyond(p, wi),
            distance: f32::INFINITY,
            n: None,
            radiance: self.irradiance,
            pdf_dir: 1.0,
            is_delta: true,
            prim: NO_TRIANGLE,
        }
    }

    /// See [`super::Light::sample_le`].
    pub fn sample_le(&self, u_pos: Vec2) -> EmissionSample {
        let ray = self.scene.enter(self.travel, u_pos);
        EmissionSample {
            ray,
            p: ray.o,
            p_error: Vec3A::ZERO,
            n: None,
            radiance: self.irradiance,
            pdf_pos: self.scene.pdf_pos(self.travel),
            pdf_dir: 1.0,
            is_delta_pos: false,
            is_delta_dir: true,
        }
    }

    /// Density of the start points of [`DirectionalLight::sample_le`], 1/m².
    #[inline]
    pub fn pdf_pos(&self) -> f32 {
        self.scene.pdf_pos(self.travel)
    }

    /// Irradiance times the area of the scene's shadow.
    pub fn power(&self) -> Rgb {
        self.irradiance * self.scene.area(self.travel)
    }
}
