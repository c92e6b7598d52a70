//! Every scene within the program × every unbiased integrator, by words that both of a pair can
//! find and sample well: `path` and `bdpt` where light leaves for a diffuse or glossy surface,
//! `bdpt` and `light` where the eye sees a diffuse one, Metropolis and `path` by their means; and
//! those that merge, by means within a stated bound.

mod support;

use std::sync::Arc;

use glam::UVec2;
use lightscope::engine::film::Frame;
use lightscope::engine::io::{embedded, image};
use lightscope::engine::scene::Scene;
use lightscope::engine::session::RenderJob;
use support::agreement::mean;
use support::reference::{RUNS, assert_agree, runs_of, whole_mean};
use support::render::job;

const WORDS: [&str; 2] = ["L(D|G).*E", "L.*DE"];
/// Their layers.
const FROM_LIGHT: (usize, usize) = (5, 5);
const TO_EYE: (usize, usize) = (6, 6);
/// Few large blocks: rare paths fall into each of them.
const SIZE: UVec2 = UVec2::new(24, 16);

fn scene(id: &str) -> Arc<Scene> {
    let desc = embedded::read(id).unwrap_or_else(|e| panic!("{e}"));
    Arc::new(Scene::build(&desc).unwrap_or_else(|e| panic!("{e}")))
}

fn runs(scene: &Arc<Scene>, id: &str, set: &[(&str, &str)], passes: u64) -> Vec<Frame> {
    let mut job: RenderJob = job(scene, id, set);
    job.size = SIZE;
    job.settings.layers.expressions = WORDS.map(|w| w.parse().expect("well-formed")).to_vec();
    runs_of(job, passes)
}

/// Mean of a layer over the runs, and its standard error.
fn moments(frames: &[Frame], layer: usize) -> (f64, f64) {
    let means = frames.iter().map(|f| mean(&f.layers[layer].pixels));
    let n = RUNS as f64;
    let m = means.clone().sum::<f64>() / n;
    let v = means.map(|x| (x - m).powi(2)).sum::<f64>() / (n - 1.0) / n;
    (m, v.sqrt())
}

/// Sixteen seeds: the means of the picture, to `bound` of the whole and 4 standard errors.
fn assert_same_mean(what: &str, a: &[Frame], b: &[Frame], bound: f64) {
    let layer = FROM_LIGHT.0;
    let ((x, dx), (y, dy)) = (moments(a, layer), moments(b, layer));
    let (error, whole) = ((dx * dx + dy * dy).sqrt(), whole_mean(b));
    println!("{what}: {x} against {y} ± {error}");
    assert!(error < 0.03 * whole, "{what}: {x} ± {error} says nothing");
    let allowed = bound * whole + 4.0 * error;
    assert!((x - y).abs() < allowed, "{what}: {x} against {y} ± {error}");
}

/// An integrator that merges, its parameters, passes, and the bound of its means: what it may blur
/// across edges by then, as a share of the whole. The radius of `vcm` ends at 0.3 % of the scene's,
/// that of `sppm` at 1.8 %: with less, pictures as small as these have too few photons.
type Merging = (
    &'static str,
    &'static [(&'static str, &'static str)],
    u64,
    f64,
);
const MERGING: [Merging; 2] = [
    ("sppm", &[("radius", "0.03")], 48, 0.03),
    ("vcm", &[], 24, 0.01),
];

fn check(ids: &[&str]) {
    for id in ids {
        let scene = scene(id);
        let path = runs(&scene, "path", &[], 96);
        let bdpt = runs(&scene, "bdpt", &[], 32);
        assert_agree(&format!("bdpt in {id}"), &bdpt, &path, &[FROM_LIGHT]);
        let light = runs(&scene, "light", &[], 96);
        assert_agree(&format!("light in {id}"), &light, &bdpt, &[TO_EYE]);
        let chains = [("chains", "32"), ("bootstrap", "4096")];
        let chains = runs(&scene, "pssmlt", &chains, 48);
        assert_same_mean(&format!("pssmlt in {id}"), &chains, &path, 0.0);
        for (merging, set, passes, bound) in MERGING {
            let merged = runs(&scene, merging, set, passes);
            assert_same_mean(&format!("{merging} in {id}"), &merged, &path, bound);
        }
    }
}

#[test]
fn integrators_agree_in_boxes() {
    check(&["jensen-box", "cornell", "glossy", "ajar-door"]);
}

#[test]
fn integrators_agree_under_glass_and_metal() {
    check(&["kajiya-spheres", "metal-ring", "cognac-glass", "pool"]);
}

#[test]
fn integrators_agree_under_many_lights_and_skies() {
    check(&["veach-plates", "many-lights", "sky-sun", "mesh-100k"]);
}

#[test]
fn integrators_agree_in_small_vcms_scenes() {
    check(&["vcm-sun", "vcm-ceiling", "vcm-point", "vcm-environment"]);
}

/// Those that hold media: also what a medium scatters, and photons stored in it. Light that milk
/// scatters more than sixteen times is left out: walks from both ends would be joined at all pairs
/// of hundreds of places.
#[test]
fn integrators_agree_in_media() {
    let words = ["L(D|G|V).*E", "L.*(D|V)E"];
    let photons = [
        ("caustic-photons", "10000"),
        ("global-photons", "10000"),
        ("volume-photons", "20000"),
    ];
    for (id, depth) in [
        ("fog-spot", None),
        ("glass-volume-caustic", None),
        ("smoke", None),
        ("milk", Some(16)),
    ] {
        let scene = scene(id);
        let run = |id: &str, set: &[(&str, &str)], passes| {
            let mut job: RenderJob = job(&scene, id, set);
            job.size = SIZE;
            job.settings.layers.max_depth = depth;
            job.settings.layers.expressions = words.map(|w| w.parse().expect("well-formed")).into();
            let start = std::time::Instant::now();
            let frames = runs_of(job, passes);
            println!("{id}: {:.1} s", start.elapsed().as_secs_f64());
            frames
        };
        let (path, bdpt) = (run("path", &[], 512), run("bdpt", &[], 64));
        assert_agree(&format!("bdpt in {id}"), &bdpt, &path, &[FROM_LIGHT]);
        let light = run("light", &[], 128);
        assert_agree(&format!("light in {id}"), &light, &bdpt, &[TO_EYE]);
        let chains = run("pssmlt", &[("chains", "32"), ("bootstrap", "4096")], 32);
        assert_same_mean(&format!("pssmlt in {id}"), &chains, &path, 0.0);
        let vcm = run("vcm", &[], 12);
        assert_same_mean(&format!("vcm in {id}"), &vcm, &path, 0.01);
        let photon = run("photon", &photons, 4);
        assert_same_mean(&format!("photon in {id}"), &photon, &path, 0.03);
    }
}

/// No scene is left out.
#[test]
fn every_embedded_scene_is_compared() {
    let text = include_str!("agreement_scenes.rs");
    for scene in embedded::all() {
        let quoted = format!("\"{}\"", scene.id);
        assert!(text.contains(&quoted), "{} is compared nowhere", scene.id);
    }
}

/// On the scenes with references: the mean of the picture by Metropolis over both walks, and by
/// those that merge, to `bound` of it and 4 standard errors.
fn check_references(id: &str, set: &[(&str, &str)], passes: u64, bound: f64) {
    for name in [
        "cornell-diffuse",
        "cornell-glass",
        "cornell-glossy",
        "caustic-ring",
        "ajar-door",
        "closed-room",
        "point-light",
        "furnace",
    ] {
        let folder = support::render::reference_dir(name);
        let scene = support::render::load(&folder.join("scene.json"));
        let mut job = job(&scene, id, set);
        job.size /= 4;
        let frames = runs_of(job, passes);
        let read = image::read(&folder.join("ref.exr"), image::Encoding::Linear);
        let exact = mean(&read.unwrap_or_else(|e| panic!("{e}")).pixels);
        let (x, error) = moments(&frames, 0);
        println!("{id} on {name}: {x} ± {error}, reference {exact}");
        assert!(
            (x - exact).abs() < bound * exact + 4.0 * error && error < 0.03 * exact,
            "{id} on {name}: {x} ± {error}, reference {exact}"
        );
    }
}

#[test]
fn metropolis_has_the_means_of_the_references() {
    let set = [("over", "bdpt"), ("chains", "32"), ("bootstrap", "4096")];
    check_references("pssmlt", &set, 96, 0.0);
}

#[test]
fn merging_has_the_means_of_the_references() {
    for (id, set, passes, bound) in MERGING {
        check_references(id, set, passes, bound);
    }
}
