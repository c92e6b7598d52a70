//! Path tracing against the references of an independent renderer: the whole and the four
//! components, in every scene without a medium, for every mode and sampler.
//!
//! Each test prints the smallest bias it would have caught (`cargo test --test agreement --
//! --nocapture`).

mod support;

use lightscope::engine::film::Frame;
use lightscope::engine::io::image;
use support::agreement::{Blocks, compare, mean};
use support::render::{job, load, reference_dir, render};

const LAYERS: [&str; 5] = ["whole", "direct", "specular", "caustic", "indirect"];
const SCENES: [&str; 8] = [
    "cornell-diffuse",
    "cornell-glass",
    "cornell-glossy",
    "caustic-ring",
    "ajar-door",
    "closed-room",
    "point-light",
    "furnace",
];
/// Independent runs behind each standard error. Thirty-two short ones see smaller biases than
/// sixteen of twice the length: Student's t with 31 degrees of freedom has thinner tails.
const RUNS: u64 = 32;

/// Layers found by rare bright samples: by chance hits of a small light behind a mirror or glass,
/// or by shadow rays into the narrow lobe of a rough metal. Their blocks, and those of the whole,
/// are judged by the variance of the whole layer ([`Blocks::pool_variance`]), their image mean as
/// any other. In mode hits all layers are such.
const RARE: [(&str, &[&str]); 4] = [
    ("cornell-glass", &["specular", "caustic"]),
    ("cornell-glossy", &["specular", "caustic", "indirect"]),
    ("caustic-ring", &["specular", "caustic"]),
    ("furnace", &["indirect"]),
];

fn is_rare(scene: &str, set: &[(&str, &str)], layer: &str) -> bool {
    let listed = RARE.iter().any(|r| r.0 == scene && r.1.contains(&layer));
    listed || layer != "whole" && set.contains(&("mode", "hits"))
}

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

/// All runs of `passes` passes each, and the width of the picture.
fn runs(scene: &str, set: &[(&str, &str)], passes: u64) -> (Vec<Frame>, usize) {
    let scene = load(&reference_dir(scene).join("scene.json"));
    let mut job = job(&scene, "path", set);
    let width = job.size.x as usize;
    let frames = (0..RUNS).map(|seed| {
        job.settings.seed = seed;
        let frame = render(&job, passes);
        assert_eq!(frame.stats.non_finite(), 0);
        frame
    });
    (frames.collect(), width)
}

fn layer_blocks(frames: &[Frame], layer: usize, width: usize) -> Blocks {
    let pixels = |f: &'_ Frame| f.layers[layer].pixels.clone();
    let runs: Vec<_> = frames.iter().map(pixels).collect();
    let runs: Vec<&[[f32; 3]]> = runs.iter().map(Vec::as_slice).collect();
    Blocks::from_runs(&runs, width)
}

/// What is wrong with `scene` rendered with `set`.
fn complaints(scene: &str, set: &[(&str, &str)], passes: u64, sharp: f64) -> Vec<String> {
    let (frames, width) = runs(scene, set, passes);
    let means = frames.iter().map(|f| mean(&f.layers[0].pixels));
    let whole = means.sum::<f64>() / RUNS as f64;
    let references = LAYERS.map(|layer| reference_layer(scene, layer, width));
    let mut ours = [0, 1, 2, 3, 4].map(|layer| layer_blocks(&frames, layer, width));
    for index in 1..LAYERS.len() {
        if is_rare(scene, set, LAYERS[index]) {
            ours[index].pool_variance(&references[index]);
            let (whole, parts) = ours.split_at_mut(1);
            whole[0].include_pooled(&parts[index - 1]);
        }
    }
    let mut all = Vec::new();
    for (index, layer) in LAYERS.iter().enumerate() {
        assert_eq!(frames[0].layers[index].label, *layer);
        let v = compare(layer, &ours[index], &references[index], whole, LAYERS.len());
        println!(
            "{scene} {set:?} {layer}: worst block {:.1} standard errors; would catch a bias of \
             {:.2} % of the image, {:.2} % in a block",
            v.worst,
            100.0 * v.sensitivity,
            100.0 * v.block_sensitivity
        );
        if v.sensitivity > sharp {
            let seen = 100.0 * v.sensitivity;
            all.push(format!(
                "{scene} {layer}: only biases of {seen:.1} % are seen"
            ));
        }
        all.extend(v.complaints.into_iter().map(|c| format!("{scene} {c}")));
    }
    all
}

/// Fails too if the test could not see a bias of `sharp`, a share of the image mean.
fn agrees(scenes: &[&str], set: &[(&str, &str)], passes: u64, sharp: f64) {
    let all: Vec<String> = scenes
        .iter()
        .flat_map(|scene| complaints(scene, set, passes, sharp))
        .collect();
    assert!(all.is_empty(), "{set:?}:\n{}", all.join("\n"));
}

#[test]
fn mode_mis_agrees_with_every_reference() {
    agrees(&SCENES, &[("mode", "mis")], 12, 0.02);
}

#[test]
fn mode_kajiya_agrees_with_every_reference() {
    agrees(&SCENES, &[("mode", "kajiya")], 6, 0.03);
}

#[test]
fn independent_numbers_agree_with_every_reference() {
    agrees(&SCENES, &[("sampler", "independent")], 6, 0.03);
}

/// No walk meets a light of zero size: in `point-light` this mode finds no word at all, so the
/// picture is black there; all other words are found everywhere. Hits of the small lights of
/// `ajar-door` are too rare for a bias below some 6 % to be seen.
#[test]
fn mode_hits_agrees_with_every_reference_it_can_find() {
    let set = [("mode", "hits")];
    let (lit, dark): (Vec<&str>, Vec<&str>) = SCENES.iter().partition(|s| **s != "point-light");
    agrees(&lit, &set, 9, 0.07);
    for scene in dark {
        let (frames, _) = runs(scene, &set, 1);
        assert_eq!(mean(&frames[0].layers[0].pixels), 0.0);
    }
}

/// Roulette changes noise only: with survival 1 for 30 events the picture is the same.
#[test]
fn roulette_agrees_with_the_reference() {
    agrees(&["closed-room"], &[("roulette", "30")], 3, 0.02);
    agrees(&["closed-room"], &[("roulette", "0")], 6, 0.03);
}
