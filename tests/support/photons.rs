//! Photon maps, and what they estimate where a ray lands.

use std::convert::Infallible;

use glam::Vec3;
use lightscope::engine::geometry::{Ray, SurfaceInteraction};
use lightscope::engine::math::Rgb;
use lightscope::engine::path::PathClasses;
use lightscope::engine::photon::emission::Emission;
use lightscope::engine::photon::{
    Disc, Kernel, MapKind, MapSettings, Nearest, Numbers, Packing, PhotonMap, ProjectionMap,
    Roulette, SplitRule,
};
use lightscope::engine::scene::Scene;

pub fn settings(photons: usize, index: u64) -> MapSettings {
    MapSettings {
        photons,
        roulette: Roulette::Keep,
        packing: Packing::Full,
        split: SplitRule::Widest,
        numbers: Numbers::Independent,
        seed: 1,
        index,
    }
}

pub fn build(scene: &Scene, kind: MapKind, settings: &MapSettings) -> PhotonMap {
    let emission = match kind {
        MapKind::Caustic => Emission::aimed(scene, ProjectionMap::new(scene)).expect("mirrors"),
        MapKind::Global | MapKind::Volume => Emission::Everywhere,
    };
    let classes = PathClasses::components();
    let never = || Ok::<(), Infallible>(());
    match PhotonMap::build(scene, &classes, kind, &emission, settings, &never) {
        Ok(map) => map,
        Err(impossible) => match impossible {},
    }
}

/// Where a ray lands.
pub fn landing(scene: &Scene, o: Vec3, d: Vec3) -> SurfaceInteraction {
    let ray = Ray::new(o.into(), d.normalize().into());
    let hit = scene.geometry.intersect(&ray).expect("a surface");
    scene.geometry.interaction(&ray, &hit)
}

/// Radiance estimated at a point, mean of the channels.
pub fn estimate(
    map: &PhotonMap,
    scene: &Scene,
    si: &SurfaceInteraction,
    radius: f32,
    n: usize,
) -> f64 {
    let disc = Disc::new(si, radius, false);
    let mut sum = Rgb::BLACK;
    let bsdf = scene.bsdf(si);
    map.estimate(si, &bsdf, &disc, Kernel::Box, &mut Nearest::new(n), |c| {
        sum += c.radiance
    });
    f64::from(sum.mean())
}

pub fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
    (mean, (squares / (n - 1.0) / n).sqrt())
}
