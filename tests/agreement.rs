//! Integrators against independent references, and against each other.

mod support;

use lightscope::engine::film::Frame;
use lightscope::engine::io::image;
use support::agreement::{Blocks, compare, mean};
use support::render::{job, load, reference_dir, render};

const LAYERS: [&str; 5] = ["whole", "direct", "specular", "caustic", "indirect"];
/// Independent runs behind each standard error.
const RUNS: u64 = 16;

/// A reference layer and its standard error.
fn reference_layer(scene: &str, layer: &str, width: usize) -> Blocks {
    let stem = if layer == "whole" { "ref" } else { layer };
    let read = |name: String| {
        let path = reference_dir(scene).join(name);
        image::read(&path, image::Encoding::Linear).unwrap_or_else(|e| panic!("{e}"))
    };
    let (pixels, se) = (read(format!("{stem}.exr")), read(format!("{stem}_se.exr")));
    Blocks::from_reference(&pixels.pixels, &se.pixels, width)
}

/// Sixteen runs of `passes` passes each.
fn runs(scene: &str, integrator: &str, set: &[(&str, &str)], passes: u64) -> (Vec<Frame>, usize) {
    let scene = load(&reference_dir(scene).join("scene.json"));
    let mut job = job(&scene, integrator, set);
    let width = job.size.x as usize;
    let frames = (0..RUNS).map(|seed| {
        job.settings.seed = seed;
        let frame = render(&job, passes);
        assert_eq!(frame.stats.non_finite, 0);
        frame
    });
    (frames.collect(), width)
}

fn layer_blocks(frames: &[Frame], layer: usize, width: usize) -> Blocks {
    let runs: Vec<&[[f32; 3]]> = frames
        .iter()
        .map(|f| f.layers[layer].pixels.as_slice())
        .collect();
    Blocks::from_runs(&runs, width)
}

fn agrees_with_reference(scene: &str, set: &[(&str, &str)], passes: u64) {
    let (frames, width) = runs(scene, "path", set, passes);
    let whole = frames
        .iter()
        .map(|f| mean(&f.layers[0].pixels))
        .sum::<f64>()
        / RUNS as f64;
    let mut complaints = Vec::new();
    for (index, layer) in LAYERS.iter().enumerate() {
        assert_eq!(frames[0].layers[index].label, *layer);
        let ours = layer_blocks(&frames, index, width);
        let reference = reference_layer(scene, layer, width);
        let verdict = compare(layer, &ours, &reference, whole, LAYERS.len());
        println!(
            "{scene} {layer}: worst block {:.1} standard errors; would catch a bias of {:.2} %",
            verdict.worst,
            100.0 * verdict.sensitivity
        );
        complaints.extend(verdict.complaints);
    }
    assert!(complaints.is_empty(), "{scene}:\n{}", complaints.join("\n"));
}

#[test]
fn path_agrees_on_cornell_diffuse() {
    agrees_with_reference("cornell-diffuse", &[], 64);
}

#[test]
fn path_agrees_on_cornell_glass() {
    agrees_with_reference("cornell-glass", &[], 128);
}

#[test]
fn path_agrees_on_cornell_glossy() {
    agrees_with_reference("cornell-glossy", &[], 64);
}

#[test]
fn path_agrees_on_caustic_ring() {
    agrees_with_reference("caustic-ring", &[], 128);
}

#[test]
fn path_agrees_on_ajar_door() {
    agrees_with_reference("ajar-door", &[], 128);
}

#[test]
fn path_agrees_on_closed_room() {
    agrees_with_reference("closed-room", &[], 64);
}

#[test]
fn path_agrees_on_point_light() {
    agrees_with_reference("point-light", &[], 64);
}

#[test]
fn path_agrees_on_furnace() {
    agrees_with_reference("furnace", &[], 32);
}

/// The other modes and samplers against the default, on the scene with every kind of lobe but G.
#[test]
fn modes_and_samplers_agree_with_each_other() {
    let (base, width) = runs("cornell-glass", "path", &[], 64);
    let whole = base.iter().map(|f| mean(&f.layers[0].pixels)).sum::<f64>() / RUNS as f64;
    let variants: [(&[(&str, &str)], u64); 4] = [
        (&[("mode", "hits")], 256),
        (&[("mode", "kajiya")], 64),
        (&[("sampler", "independent")], 64),
        (&[("roulette", "30")], 32),
    ];
    for (set, passes) in variants {
        let (frames, _) = runs("cornell-glass", "path", set, passes);
        for (index, layer) in LAYERS.iter().enumerate() {
            let a = layer_blocks(&frames, index, width);
            let b = layer_blocks(&base, index, width);
            let verdict = compare(layer, &a, &b, whole, LAYERS.len());
            assert!(
                verdict.complaints.is_empty(),
                "{set:?}: {}",
                verdict.complaints.join("\n")
            );
        }
    }
}
