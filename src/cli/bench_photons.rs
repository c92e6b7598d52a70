//! Photon maps against the clock: what tracing and sorting take, and how many queries a second
//! are answered where eye rays really land.

use std::time::Instant;

use glam::{Vec2, Vec3A};
use serde::Serialize;

use crate::engine::camera::Camera;
use crate::engine::film::tiles::Tiles;
use crate::engine::geometry::SurfaceInteraction;
use crate::engine::path::PathClasses;
use crate::engine::photon::emission::Emission;
use crate::engine::photon::map::trace_photons;
use crate::engine::photon::record::PackedPhoton;
use crate::engine::photon::trace::Walks;
use crate::engine::photon::{
    Disc, KdTree, MapKind, MapSettings, Nearest, Numbers, Packing, Record, Roulette, SplitRule,
};
use crate::engine::scene::Scene;

/// Figures of one map.
#[derive(Clone, Debug, Serialize)]
pub struct MapFigures {
    /// Photons stored.
    pub photons: usize,
    /// Bytes of the tree.
    pub bytes: usize,
    /// Seconds to trace the photons.
    pub trace_seconds: f64,
    /// Seconds to sort them into the tree.
    pub build_seconds: f64,
    /// Plain n-nearest queries a second, one thread.
    pub queries_per_second: f64,
    /// The same filtered by side and disc within 0.15 of the scene's radius, as renders ask.
    pub filtered_per_second: f64,
    /// Sum over the queries of the distance to the farthest photon found: equal work gives an
    /// equal sum.
    pub sum_of_radii: f64,
}

/// A map of `photons` photons of `scene`, and the time it took.
pub struct TimedTree {
    /// The tree.
    pub tree: KdTree<PackedPhoton>,
    /// Seconds to trace.
    pub trace_seconds: f64,
    /// Seconds to sort.
    pub build_seconds: f64,
}

/// Traces about `photons` photons of the global map and sorts them.
pub fn build(scene: &Scene, photons: usize) -> TimedTree {
    let classes = PathClasses::components();
    let emission = Emission::Everywhere;
    let walks = Walks {
        scene,
        classes: &classes,
        kind: MapKind::Global,
        roulette: Roulette::Keep,
        emission: &emission,
    };
    let settings = MapSettings {
        photons,
        roulette: Roulette::Keep,
        packing: Packing::Packed,
        split: SplitRule::Widest,
        numbers: Numbers::Independent,
        seed: 0,
        index: 0,
    };
    let start = Instant::now();
    let never = || Ok::<(), std::convert::Infallible>(());
    let traced = trace_photons(&walks, &settings, &never);
    let photons: Vec<PackedPhoton> = match traced {
        Ok((photons, _)) => photons,
        Err(impossible) => match impossible {},
    };
    let trace_seconds = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let tree = KdTree::build(photons, SplitRule::Widest);
    let build_seconds = start.elapsed().as_secs_f64();
    TimedTree {
        tree,
        trace_seconds,
        build_seconds,
    }
}

/// About `count` points where rays of the camera land, in the order of a render: tile by tile.
pub fn eye_points(scene: &Scene, camera: &Camera, count: usize) -> Vec<SurfaceInteraction> {
    let aspect = f64::from(camera.size().x) / f64::from(camera.size().y);
    let height = (count as f64 / aspect).sqrt().ceil().max(1.0);
    let size = glam::UVec2::new((height * aspect).ceil() as u32, height as u32);
    let camera = camera.with_size(size);
    let tiles = Tiles::new(camera.size());
    let pixels = (0..tiles.len()).flat_map(|t| tiles.pixels(t));
    let lands = pixels.filter_map(|(_, pixel)| {
        let ray = camera.generate_ray(pixel.as_vec2() + 0.5, Vec2::splat(0.5));
        let hit = scene.geometry.intersect(&ray)?;
        Some(scene.geometry.interaction(&ray, &hit))
    });
    lands.take(count).collect()
}

/// Times `n`-nearest queries at `points`.
pub fn queries(
    timed: &TimedTree,
    scene: &Scene,
    points: &[SurfaceInteraction],
    n: usize,
) -> MapFigures {
    let tree = &timed.tree;
    let mut nearest = Nearest::new(n);
    let mut sum_of_radii = 0.0;
    let start = Instant::now();
    for si in points {
        nearest.begin(f32::INFINITY);
        tree.locate_photons(si.p, &mut nearest, |_, _, d2| Some(d2));
        let farthest = nearest.found().map(|(d2, _)| d2).fold(0.0, f32::max);
        sum_of_radii += f64::from(farthest.sqrt());
    }
    let plain = start.elapsed().as_secs_f64();
    let radius = 0.15 * scene.geometry.bounding_sphere().1;
    let mut found = 0;
    let start = Instant::now();
    for si in points {
        let disc = Disc::new(si, radius, true);
        nearest.begin(radius * radius);
        tree.locate_photons(disc.p, &mut nearest, |t, d, d2| disc.metric(t, d, d2));
        found += nearest.found().len();
    }
    let filtered = start.elapsed().as_secs_f64();
    std::hint::black_box(found);
    MapFigures {
        photons: tree.nodes().len(),
        bytes: tree.memory_bytes(),
        trace_seconds: timed.trace_seconds,
        build_seconds: timed.build_seconds,
        queries_per_second: points.len() as f64 / plain,
        filtered_per_second: points.len() as f64 / filtered,
        sum_of_radii,
    }
}

/// Positions of the photons of a tree, for other trees.
pub fn positions(timed: &TimedTree) -> Vec<[f32; 3]> {
    timed.tree.nodes().iter().map(|p| *p.position()).collect()
}

/// The positions of surface points, for other trees.
pub fn query_positions(points: &[SurfaceInteraction]) -> Vec<[f32; 3]> {
    points.iter().map(|si| Vec3A::to_array(&si.p)).collect()
}
