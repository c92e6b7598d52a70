//! Photons as they leave the lights.

use glam::Vec3A;

use super::projection::ProjectionMap;
use crate::engine::geometry::Ray;
use crate::engine::light::{EmissionSample, Light};
use crate::engine::math::Rgb;
use crate::engine::math::distribution::Discrete;
use crate::engine::sampling::Sampler;
use crate::engine::scene::Scene;

/// A photon that leaves a light.
#[derive(Clone, Copy, Debug)]
pub struct Emitted {
    /// Its first ray.
    pub ray: Ray,
    /// Flux in W, to be divided by the number of photons emitted.
    pub flux: Rgb,
}

/// Dimensions that an emission takes.
pub const EMISSION_DIMENSIONS: u32 = 8;

/// How photons of one map are emitted.
pub enum Emission {
    /// In all directions, lights by their power.
    Everywhere,
    /// Toward specular and glossy surfaces only, lights by the power that may go there.
    Aimed(ProjectionMap, Discrete),
}

impl Emission {
    /// Emission toward the surfaces of `map`; `None` if no light can reach any.
    pub fn aimed(scene: &Scene, map: ProjectionMap) -> Option<Self> {
        let lights = scene.lights.as_slice();
        let weights: Vec<f64> = lights.iter().map(|l| importance(l, &map)).collect();
        let selection = Discrete::new(&weights)?;
        (!map.is_empty()).then_some(Self::Aimed(map, selection))
    }

    /// Emits one photon; `None` where the sample carries no light.
    pub fn sample<S: Sampler>(&self, scene: &Scene, sampler: &mut S) -> Option<Emitted> {
        sampler.seek(0);
        let (u_pos, u_dir) = (sampler.next_2d(), sampler.next_2d());
        let (u_light, u_group) = (sampler.next_1d(), sampler.next_1d());
        match self {
            Self::Everywhere => {
                let (id, pmf) = scene.lights.sample(u_light)?;
                let sample = scene.lights.get(id).sample_le(u_pos, u_dir)?;
                emitted(sample.ray, sample.flux() / pmf)
            }
            Self::Aimed(map, selection) => {
                let choice = selection.sample(u_light);
                let light = &scene.lights.as_slice()[choice.index];
                let sample = light.sample_le(u_pos, u_dir)?;
                let aimed = if light.is_infinite() {
                    enter(&sample, scene, map, u_group, u_pos)
                } else {
                    leave(light, &sample, map, u_group, u_dir)
                };
                aimed.and_then(|e| emitted(e.ray, e.flux / choice.pmf))
            }
        }
    }
}

fn emitted(ray: Ray, flux: Rgb) -> Option<Emitted> {
    // What is no number is let through, and counted where it lands.
    (!flux.is_black()).then_some(Emitted { ray, flux })
}

/// From the point of `sample` on a light, in a direction of the projection map.
fn leave(
    light: &Light,
    sample: &EmissionSample,
    map: &ProjectionMap,
    u_group: f32,
    u_dir: glam::Vec2,
) -> Option<Emitted> {
    let (d, pdf) = map.sample_from(sample.ray.o, u_group, u_dir)?;
    let cos = sample.n.map_or(1.0, |n| n.dot(d).max(0.0));
    let radiance = match light {
        Light::Spot(spot) => spot.intensity(d),
        _ => sample.radiance,
    };
    let flux = radiance * (cos / pdf) / sample.pdf_pos;
    Some(Emitted {
        ray: Ray { d, ..sample.ray },
        flux,
    })
}

/// From infinity, in the direction of `sample`, through a disk of the projection map.
fn enter(
    sample: &EmissionSample,
    scene: &Scene,
    map: &ProjectionMap,
    u_group: f32,
    u_pos: glam::Vec2,
) -> Option<Emitted> {
    let d = sample.ray.d;
    let (through, pdf) = map.sample_along(d, u_group, u_pos)?;
    // Back to the plane that touches the sphere around the scene from behind.
    let (center, radius) = scene.geometry.bounding_sphere();
    let start = (center - through).dot(d) - radius;
    let flux = sample.radiance / pdf / sample.pdf_dir;
    Some(Emitted {
        ray: Ray::new(through + d * start, d),
        flux,
    })
}

/// What the choice of a light for the caustic map is proportional to. Any positive number keeps
/// the result unbiased.
fn importance(light: &Light, map: &ProjectionMap) -> f64 {
    let middle = glam::Vec2::splat(0.5);
    let power = f64::from(light.power().mean()).min(f64::from(f32::MAX));
    let share = match light.sample_le(middle, middle) {
        Some(sample) if light.is_infinite() => map.area() * sample.pdf_pos,
        Some(sample) => map.share_from(center(light, &sample)),
        None => 1.0,
    };
    // A light whose middle sees little may see more from its rim.
    power * f64::from(share.clamp(0.01, 1.0))
}

fn center(light: &Light, sample: &EmissionSample) -> Vec3A {
    match (light, sample.n) {
        // One more point opposite: the middle of the sphere.
        (Light::Sphere(_), Some(_)) => {
            let other = light.sample_le(glam::Vec2::new(0.5, 0.0), glam::Vec2::splat(0.5));
            other.map_or(sample.p, |o| 0.5 * (o.p + sample.p))
        }
        _ => sample.p,
    }
}
