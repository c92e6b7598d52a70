//! The photon tree beside kiddo's immutable tree: the same points, the same queries, one run.
//!
//! `cargo bench --bench photons [-- SCENE.json [PHOTONS…]]`

use std::num::NonZero;
use std::path::Path;
use std::time::Instant;

use glam::UVec2;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use lightscope::cli::bench_photons::{build, eye_points, positions, queries, query_positions};
use lightscope::engine::camera::Camera;
use lightscope::engine::io::scene_file;
use lightscope::engine::scene::Scene;

const NEAREST: usize = 50;
const QUERIES: usize = 100_000;
/// Rounds, taking turns, of which the best counts.
const ROUNDS: usize = 3;

fn main() {
    // `cargo bench` passes --bench.
    let mut args = std::env::args().skip(1).filter(|a| !a.starts_with("--"));
    let own = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/reference/cornell-glass/scene.json"
    );
    let path = args.next().unwrap_or_else(|| own.to_owned());
    let counts: Vec<usize> = args.filter_map(|a| a.parse().ok()).collect();
    let counts = if counts.is_empty() {
        vec![100_000, 1_000_000, 10_000_000]
    } else {
        counts
    };

    let desc = scene_file::load(Path::new(&path)).unwrap_or_else(|e| panic!("{e}"));
    let scene = Scene::build(&desc).unwrap_or_else(|e| panic!("{e}"));
    let camera = Camera::new(&scene.camera).unwrap_or_else(|e| panic!("{e}"));
    let camera = camera.with_size(UVec2::new(scene.camera.width, scene.camera.height));
    let points = eye_points(&scene, &camera, QUERIES);
    println!(
        "{}: {NEAREST} nearest at {} points where eye rays land",
        scene.name,
        points.len()
    );
    for count in counts {
        compare(&scene, &points, count);
    }
}

fn compare(
    scene: &Scene,
    points: &[lightscope::engine::geometry::SurfaceInteraction],
    count: usize,
) {
    let timed = build(scene, count);
    let photons = positions(&timed);
    let start = Instant::now();
    let theirs: ImmutableKdTree<f32, 3> =
        ImmutableKdTree::new_from_slice(&photons).expect("a tree of kiddo's");
    let their_build = start.elapsed().as_secs_f64();
    let places = query_positions(points);
    let n = NonZero::new(NEAREST).expect("not zero");

    let (mut ours, mut their_rate, mut their_sum) = (None, 0.0_f64, 0.0);
    for _ in 0..ROUNDS {
        let figures = queries(&timed, scene, points, NEAREST);
        let best = |f: &lightscope::cli::bench_photons::MapFigures| f.queries_per_second;
        if ours.as_ref().is_none_or(|o| best(o) < best(&figures)) {
            ours = Some(figures);
        }
        let start = Instant::now();
        let mut sum = 0.0;
        for place in &places {
            let found = theirs
                .query(place)
                .nearest_n::<SquaredEuclidean<f32>>(n)
                .execute();
            sum += f64::from(found.last().map_or(0.0, |f| f.distance.sqrt()));
        }
        their_rate = their_rate.max(places.len() as f64 / start.elapsed().as_secs_f64());
        their_sum = sum;
    }
    let ours = ours.expect("a round");
    let difference = (ours.sum_of_radii / their_sum - 1.0).abs();
    assert!(
        difference < 1e-6,
        "the trees found different photons: {difference}"
    );
    println!(
        "{} photons: sorted in {:.2} s ({:.0} MB), kiddo {:.2} s; {:.0} queries/s, kiddo {:.0}: \
         ratio {:.2}; filtered by side and disc {:.0} queries/s",
        ours.photons,
        ours.build_seconds,
        ours.bytes as f64 * 1e-6,
        their_build,
        ours.queries_per_second,
        their_rate,
        ours.queries_per_second / their_rate,
        ours.filtered_per_second,
    );
}
