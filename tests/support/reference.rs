//! Comparison with the reference images.

use lightscope::engine::film::Frame;
use lightscope::engine::io::image;
use lightscope::engine::session::RenderJob;

use super::agreement::{Blocks, compare, mean};
use super::render::{job, load, reference_dir, render};

/// The layers of a reference.
pub const LAYERS: [&str; 5] = ["whole", "direct", "specular", "caustic", "indirect"];
/// Independent runs behind each standard error.
pub const RUNS: u64 = 16;

/// A reference layer and its standard error.
pub fn reference_layer(scene: &str, layer: &str, width: usize) -> Blocks {
    let stem = if layer == "whole" { "ref" } else { layer };
    let (pixels, se) = (
        read_layer(scene, stem),
        read_layer(scene, &format!("{stem}_se")),
    );
    Blocks::from_reference(&pixels, &se, width)
}

/// Pixels of a file of a reference.
pub fn read_layer(scene: &str, stem: &str) -> Vec<[f32; 3]> {
    let path = reference_dir(scene).join(format!("{stem}.exr"));
    let image = image::read(&path, image::Encoding::Linear).unwrap_or_else(|e| panic!("{e}"));
    image.pixels
}

/// Sixteen runs of `passes` passes each on a reference scene.
pub fn runs(
    scene: &str,
    integrator: &str,
    set: &[(&str, &str)],
    passes: u64,
) -> (Vec<Frame>, usize) {
    let scene = load(&reference_dir(scene).join("scene.json"));
    let job = job(&scene, integrator, set);
    let width = job.size.x as usize;
    (runs_of(job, passes), width)
}

/// Sixteen runs of `passes` passes each.
pub fn runs_of(mut job: RenderJob, passes: u64) -> Vec<Frame> {
    let frames = (0..RUNS).map(|seed| {
        job.settings.seed = seed;
        let frame = render(&job, passes);
        let bad = frame.stats.bad_samples().next();
        assert_eq!(frame.stats.non_finite(), 0, "seed {seed}, {bad:?}");
        frame
    });
    frames.collect()
}

/// Block means of one layer over `frames`.
pub fn layer_blocks(frames: &[Frame], layer: usize, width: usize) -> Blocks {
    let runs: Vec<&[[f32; 3]]> = frames
        .iter()
        .map(|f| f.layers[layer].pixels.as_slice())
        .collect();
    Blocks::from_runs(&runs, width)
}

/// Mean of the whole over `frames`.
pub fn whole_mean(frames: &[Frame]) -> f64 {
    let sum: f64 = frames.iter().map(|f| mean(&f.layers[0].pixels)).sum();
    sum / frames.len() as f64
}

/// Layers with blocks that hardly any sample meets: slivers of the floor and the ring's own caustic
/// seen in the ring, which both walks find by chance hits of the lamp alone; light from the glossy
/// blocks that reaches far walls; the furnace's few pixels from which a second diffuse surface is
/// seen at a glance. A block in which sixteen runs meet nothing, or one path, has no standard error
/// of its own. They are judged by the variance of the whole layer ([`Blocks::pool_variance`]), their
/// image mean as any other; every unbiased integrator is held to them, so that what path tracing
/// meets seldom is judged by one that meets it often.
const RARE: [(&str, &str); 4] = [
    ("caustic-ring", "specular"),
    ("caustic-ring", "caustic"),
    ("cornell-glossy", "caustic"),
    ("furnace", "indirect"),
];

/// Fails unless the layers `layers` of sixteen runs agree with the reference.
pub fn assert_agrees_with_reference(
    scene: &str,
    integrator: &str,
    set: &[(&str, &str)],
    passes: u64,
    layers: &[&str],
) {
    let (frames, width) = runs(scene, integrator, set, passes);
    let whole = mean(&read_layer(scene, "ref"));
    let mut ours = [0, 1, 2, 3, 4].map(|layer| layer_blocks(&frames, layer, width));
    let references = LAYERS.map(|layer| reference_layer(scene, layer, width));
    for index in 1..LAYERS.len() {
        if RARE.contains(&(scene, LAYERS[index])) {
            ours[index].pool_variance(&references[index]);
            let (whole, parts) = ours.split_at_mut(1);
            whole[0].include_pooled(&parts[index - 1]);
        }
    }
    let mut complaints = Vec::new();
    for (index, layer) in LAYERS.iter().enumerate() {
        assert_eq!(frames[0].layers[index].label, *layer);
        if !layers.contains(layer) {
            continue;
        }
        let verdict = compare(layer, &ours[index], &references[index], whole, LAYERS.len());
        println!(
            "{integrator} {scene} {layer}: worst block {:.1} standard errors; would catch a bias \
             of {:.2} %",
            verdict.worst,
            100.0 * verdict.sensitivity
        );
        complaints.extend(verdict.complaints);
    }
    assert!(
        complaints.is_empty(),
        "{integrator} {scene}:\n{}",
        complaints.join("\n")
    );
}

/// Fails unless the layers of each pair, one of `a` and one of `b`, agree.
pub fn assert_agree(label: &str, a: &[Frame], b: &[Frame], pairs: &[(usize, usize)]) {
    let width = a[0].size.x as usize;
    let whole = whole_mean(b);
    let mut complaints = Vec::new();
    for &(i, j) in pairs {
        let (x, y) = (layer_blocks(a, i, width), layer_blocks(b, j, width));
        let name = format!("{label} {}", a[0].layers[i].label);
        let verdict = compare(&name, &x, &y, whole, pairs.len());
        println!(
            "{name}: worst block {:.1} standard errors; would catch a bias of {:.2} %",
            verdict.worst,
            100.0 * verdict.sensitivity
        );
        complaints.extend(verdict.complaints);
    }
    assert!(complaints.is_empty(), "{label}:\n{}", complaints.join("\n"));
}
