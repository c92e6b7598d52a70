//! The photon tree and its estimates.

use std::convert::Infallible;

use glam::{Vec3, Vec3A};

use super::super::case::{Case, Run, decades};
use super::super::estimate::frame;
use super::super::fits;
use super::super::scenes::{block, build, diffuse, job_of, point_light, quad, view};
use crate::engine::geometry::{Ray, SurfaceInteraction};
use crate::engine::integrators::photon;
use crate::engine::math::Rgb;
use crate::engine::path::{ClassId, PathClasses};
use crate::engine::photon::emission::Emission;
use crate::engine::photon::record::FullPhoton;
use crate::engine::photon::{
    Disc, KdTree, Kernel, MapKind, MapSettings, Nearest, Numbers, Packing, Photon, PhotonMap,
    Record, Roulette, SplitRule,
};
use crate::engine::sampling::{IndependentSampler, Sampler, Stream};
use crate::engine::scene::Scene;
use crate::engine::scene::desc::SceneDesc;

/// The search.
pub const TREE: Case = Case {
    id: "kd-tree",
    label: "Photon tree",
    summary: "The k nearest of 0 to 10⁵ photons: scattered, collinear, clustered, all in one place.",
    parameter: "photons",
    oracle: "the same distances as a plain loop finds",
    stiff: false,
    fit: fits::engine,
    run: tree,
};

/// Walls.
pub const ESTIMATE: Case = Case {
    id: "photon-estimate",
    label: "Photons and thin walls",
    summary: "A wall of one or two sides, lit from above, asked from below.",
    parameter: "gap",
    oracle: "no light comes through",
    stiff: false,
    fit: fits::engine,
    run: estimate,
};

/// Records of irradiance.
pub const CACHE: Case = Case {
    id: "irradiance-cache",
    label: "Interpolated gathers in a corner",
    summary: "The corner of a closed diffuse box, seen nearer and nearer, where the mean distance of \
              what gathers see, and with it the radius of records, goes to 0.",
    parameter: "size / distance from the corner",
    oracle: "a few records cover the view, not one a pixel",
    stiff: false,
    fit: fits::engine,
    run: cache,
};

/// Records that a corner may take: the smallest radius covers the whole view many times over.
const CORNER_RECORDS: u64 = 64;

fn cache(run: &mut Run) {
    let mut walls = block(0, Vec3::NEG_ONE, Vec3::ONE);
    // Fronts inward.
    walls.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    for near in decades(2..=run.pick(6, 7), 1) {
        let gap = (1.0 / near) as f32;
        let corner = Vec3::new(1.0, 1.0 - gap, 1.0 - 2.0 * gap);
        let desc = SceneDesc {
            camera: view(Vec3::ZERO, corner, (100.0 * gap).min(10.0), 32),
            materials: vec![diffuse("wall", 0.5)],
            meshes: vec![walls.clone()],
            lights: vec![point_light(Vec3::Y * 0.5, 1.0)],
            ..SceneDesc::default()
        };
        let set = [
            ("indirect", "cache"),
            ("gather-rays", "16"),
            ("global-photons", "2000"),
        ];
        let frame = frame(&job_of(&photon::ENTRY, &set, &desc), 0, 1);
        let photons = frame.and_then(|frame| frame.photons);
        let records = photons.and_then(|p| Some(p.cache()?.records().len() as u64));
        let beyond = records.map_or(1, |n| n.saturating_sub(CORNER_RECORDS));
        let note = format!("{} records of 1024 pixels", records.unwrap_or(0));
        run.count(
            near,
            "",
            beyond + u64::from(records == Some(0)),
            1024,
            &note,
        );
    }
}

fn cloud(count: usize, item: u64) -> Vec<Vec3A> {
    let mut s = IndependentSampler::new(5, Stream::Test, (item, 0));
    let mut point = || Vec3A::new(s.next_1d(), s.next_1d(), s.next_1d());
    (0..count).map(|_| point()).collect()
}

/// Queries whose k nearest are not those of a plain loop.
fn differences(points: &[Vec3A], queries: &[Vec3A], k: usize, r2: f32) -> u64 {
    let pack = |p: &Vec3A| {
        let photon = Photon {
            p: *p,
            power: Rgb::WHITE,
            wi: Vec3A::Z,
            class: ClassId::EMPTY,
            events: 1,
        };
        FullPhoton::pack(&photon, Vec3A::Z, 1.0, 0.5)
    };
    let tree = KdTree::build(points.iter().map(pack).collect(), SplitRule::Widest);
    let mut nearest = Nearest::new(k);
    let differs = |q: &&Vec3A| {
        nearest.begin(r2);
        tree.locate_photons(**q, &mut nearest, |_, _, d2| Some(d2));
        let mut found: Vec<f32> = nearest.found().map(|(d2, _)| d2).collect();
        found.sort_by(f32::total_cmp);
        let squares = points.iter().map(|p| (*p - **q).length_squared());
        let mut all: Vec<f32> = squares.filter(|d2| *d2 < r2).collect();
        all.sort_by(f32::total_cmp);
        all.truncate(k);
        found != all
    };
    queries.iter().filter(differs).count() as u64
}

fn tree(run: &mut Run) {
    let most = run.pick(20_000, 1_000_000);
    for count in [0, 1, 2, 3, 7, 8, 1000, most] {
        let even = cloud(count, 1);
        let line: Vec<Vec3A> = even.iter().map(|p| Vec3A::new(0.3, p.y, 0.7)).collect();
        let crowd = |(i, p): (usize, &Vec3A)| (*p - 0.5) * 10_f32.powi(-((i % 7) as i32)) + 0.5;
        let cluster: Vec<Vec3A> = even.iter().enumerate().map(crowd).collect();
        let one = vec![Vec3A::new(1.0, 2.0, 3.0); count];
        let mut queries = cloud(run.pick(20, 50), 2);
        queries.extend(even.first());
        for (name, points) in [
            ("scattered", &even),
            ("collinear", &line),
            ("clustered", &cluster),
            ("one place", &one),
        ] {
            let mut wrong = 0;
            for (k, r2) in [
                (1, f32::INFINITY),
                (50, f32::INFINITY),
                (50, 0.01),
                (count + 5, 4.0),
            ] {
                wrong += differences(points, &queries, k.min(2000), r2);
            }
            run.count(count as f64, name, wrong, 4 * queries.len() as u64, "");
        }
    }
}

fn landing(scene: &Scene, o: Vec3, d: Vec3) -> Option<SurfaceInteraction> {
    let ray = Ray::new(o.into(), d.into());
    let hit = scene.geometry.intersect(&ray)?;
    Some(scene.geometry.interaction(&ray, &hit))
}

fn estimate(run: &mut Run) {
    for gap in [0.0_f32, 1e-6, 1e-4, 1e-2] {
        let (a, b) = (Vec3::Z * 4.0, Vec3::X * 4.0);
        let mut meshes = vec![quad(0, Vec3::new(-2.0, 0.0, -2.0), a, b)];
        if gap > 0.0 {
            meshes.push(quad(0, Vec3::new(-2.0, -gap, -2.0), b, a));
        }
        let scene = build(&SceneDesc {
            materials: vec![diffuse("wall", 0.7)],
            meshes,
            lights: vec![point_light(Vec3::new(0.0, 1.5, 0.0), 3.0)],
            ..SceneDesc::default()
        });
        let settings = MapSettings {
            photons: 50_000,
            roulette: Roulette::Keep,
            packing: Packing::Packed,
            split: SplitRule::Widest,
            numbers: Numbers::Independent,
            seed: 1,
            index: 0,
        };
        let never = || Ok::<(), Infallible>(());
        let (classes, all) = (PathClasses::components(), Emission::Everywhere);
        let map = match PhotonMap::build(&scene, &classes, MapKind::Global, &all, &settings, &never)
        {
            Ok(map) => map,
            Err(impossible) => match impossible {},
        };
        let radiance = |si: &SurfaceInteraction| {
            let disc = Disc::new(si, 0.3, false);
            let (bsdf, mut sum) = (scene.bsdf(si), Rgb::BLACK);
            let mut nearest = Nearest::new(50);
            map.estimate(si, &bsdf, &disc, Kernel::Box, &mut nearest, |c| {
                sum += c.radiance
            });
            sum.mean()
        };
        let (mut through, mut dark) = (0, 0);
        for i in 0..200_u8 {
            let (x, z) = (
                f32::from(i % 20) * 0.15 - 1.4,
                f32::from(i / 20) * 0.15 - 1.4,
            );
            let above = landing(&scene, Vec3::new(x, 1.0, z), Vec3::NEG_Y);
            let below = landing(&scene, Vec3::new(x, -1.0, z), Vec3::Y);
            dark += u64::from(above.is_none_or(|si| radiance(&si) <= 0.0));
            through += u64::from(below.is_none_or(|si| radiance(&si) != 0.0));
        }
        run.count(
            f64::from(gap),
            "below",
            through,
            200,
            "estimates that see the other side",
        );
        run.count(
            f64::from(gap),
            "above",
            dark,
            200,
            "estimates that see nothing",
        );
    }
}
