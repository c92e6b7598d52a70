//! A scene ready for rendering. It never changes: an edit makes another one.

use super::desc::CameraDesc;
use super::features::SceneFeatures;
use super::material::Material;
use crate::engine::bsdf::Bsdf;
use crate::engine::geometry::{Departure, Geometry, Ray, RayFault, SurfaceInteraction};
use crate::engine::light::{LightSample, Lights};
use crate::engine::media::Media;

/// Geometry, materials and lights in the form that is fast to query.
pub struct Scene {
    /// Name, for titles and logs.
    pub name: String,
    /// One line: what the scene shows.
    pub description: String,
    /// Number of frames, if it is one of a sequence.
    pub frames: Option<u32>,
    /// The view to open with.
    pub camera: CameraDesc,
    /// Surfaces.
    pub geometry: Geometry,
    /// Indexed by [`SurfaceInteraction::material`].
    pub materials: Vec<Material>,
    /// Names of the materials, by the same index.
    pub material_names: Vec<String>,
    /// Emitters.
    pub lights: Lights,
    /// What is between the surfaces.
    pub media: Media,
    /// What the scene holds.
    pub features: SceneFeatures,
    /// Sentences about what was assumed or dropped.
    pub warnings: Vec<String>,
}

/// Most surfaces of opacity below 1 that one ray may cross.
const MAX_CROSSINGS: u32 = 10_000;

impl Scene {
    /// What is wrong with how a ray ended that left a surface at `left`: at `si`, or outside the
    /// scene.
    #[inline]
    pub fn ray_fault(&self, left: Departure, si: Option<&SurfaceInteraction>) -> Option<RayFault> {
        match si {
            Some(si) if si.prim != left.prim || si.is_in_volume() => None,
            Some(si) => self.geometry.self_hit(left, si),
            // A ray may leave by a surface that lets it pass.
            None if self.features.opacity => None,
            None => self.geometry.missed_edge(left),
        }
    }

    /// The first surface along `ray` that stops it. Where surfaces have an opacity, it decides by
    /// `number` (called at most once) whether the ray meets them; crossing one is no event.
    #[inline]
    pub fn intersect(&self, ray: &Ray, number: impl FnOnce() -> f32) -> Option<SurfaceInteraction> {
        let hit = self.geometry.intersect(ray)?;
        let si = self.geometry.interaction(ray, &hit);
        if !self.features.opacity {
            return Some(si);
        }
        self.cross(*ray, si, number())
    }

    /// Goes through surfaces while the random number `u` says so; what is left of it after one
    /// decision is uniform again and serves the next.
    fn cross(
        &self,
        ray: Ray,
        mut si: SurfaceInteraction,
        mut u: f32,
    ) -> Option<SurfaceInteraction> {
        for _ in 0..MAX_CROSSINGS {
            let opacity = self.materials[si.material as usize].opacity(&si);
            if u < opacity {
                return Some(si);
            }
            u = (u - opacity) / (1.0 - opacity);
            let next = si.spawn_ray(ray.d);
            let hit = self.geometry.intersect(&next)?;
            si = self.geometry.interaction(&next, &hit);
        }
        None
    }

    /// The share of light that a shadow ray from `si` to `light` lets through: 0 or 1, and
    /// between only where surfaces have an opacity.
    #[inline]
    pub fn transmittance(&self, si: &SurfaceInteraction, light: &LightSample) -> f32 {
        self.transmittance_along(light.ray_from(si))
    }

    /// The share of light that gets through along `ray`, up to its end.
    #[inline]
    pub fn transmittance_along(&self, ray: Ray) -> f32 {
        if !self.features.opacity {
            return f32::from(u8::from(!self.geometry.occluded(&ray)));
        }
        self.transmittance_through(ray)
    }

    fn transmittance_through(&self, mut ray: Ray) -> f32 {
        let mut transmittance = 1.0;
        for _ in 0..MAX_CROSSINGS {
            let Some(hit) = self.geometry.intersect(&ray) else {
                return transmittance;
            };
            let si = self.geometry.interaction(&ray, &hit);
            transmittance *= 1.0 - self.materials[si.material as usize].opacity(&si);
            if transmittance == 0.0 {
                return 0.0;
            }
            let (t_max, [_, end]) = (ray.t_max - si.t, ray.clear_of);
            ray = Ray {
                t_max,
                clear_of: [si.prim, end],
                ..si.spawn_ray(ray.d)
            };
        }
        0.0
    }

    /// Adds the lobes at `si` to `bsdf`.
    #[inline]
    pub fn add_lobes(&self, si: &SurfaceInteraction, bsdf: &mut Bsdf) {
        self.materials[si.material as usize].add_lobes(si, bsdf);
    }

    /// The scattering at `si`.
    #[inline]
    pub fn bsdf(&self, si: &SurfaceInteraction) -> Bsdf {
        self.materials[si.material as usize].bsdf(si)
    }
}
