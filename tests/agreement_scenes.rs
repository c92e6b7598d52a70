//! Every scene within the program × every unbiased integrator, by words that both of a pair can
//! find and sample well: `path` and `bdpt` where light leaves for a diffuse or glossy surface,
//! `bdpt` and `light` where the eye sees a diffuse one, Metropolis and `path` by their means.

mod support;

use std::sync::Arc;

use glam::UVec2;
use lightscope::engine::film::Frame;
use lightscope::engine::io::embedded;
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

/// Sixteen seeds of Metropolis: the means of the picture, to 1 % of the whole or 4 standard errors.
fn assert_same_mean(what: &str, a: &[Frame], b: &[Frame], layer: usize) {
    let ((x, dx), (y, dy)) = (moments(a, layer), moments(b, layer));
    let (error, whole) = ((dx * dx + dy * dy).sqrt(), whole_mean(b));
    println!("{what}: {x} against {y} ± {error}");
    let allowed = (0.01 * whole).max(4.0 * error);
    assert!((x - y).abs() < allowed, "{what}: {x} against {y} ± {error}");
}

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
        assert_same_mean(&format!("pssmlt in {id}"), &chains, &path, FROM_LIGHT.0);
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

/// No scene is left out.
#[test]
fn every_embedded_scene_is_compared() {
    let text = include_str!("agreement_scenes.rs");
    for scene in embedded::all() {
        let quoted = format!("\"{}\"", scene.id);
        assert!(text.contains(&quoted), "{} is compared nowhere", scene.id);
    }
}

/// Metropolis over both walks on the scenes with references: the mean of the picture.
#[test]
fn metropolis_has_the_means_of_the_references() {
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
        let set = [("over", "bdpt"), ("chains", "32"), ("bootstrap", "4096")];
        let mut job = job(&scene, "pssmlt", &set);
        job.size /= 4;
        let frames = runs_of(job, 96);
        let ((x, error), exact) = (moments(&frames, 0), {
            use lightscope::engine::io::image;
            let read = image::read(&folder.join("ref.exr"), image::Encoding::Linear);
            mean(&read.unwrap_or_else(|e| panic!("{e}")).pixels)
        });
        println!("pssmlt on {name}: {x} ± {error}, reference {exact}");
        let allowed = (0.01 * exact).max(4.0 * error);
        assert!(
            (x - exact).abs() < allowed && error < 0.03 * exact,
            "pssmlt on {name}: {x} ± {error}, reference {exact}"
        );
    }
}
