//! Integrators against independent references, and against each other.

mod support;

use support::agreement::compare;
use support::reference::{LAYERS, assert_agrees_with_reference, layer_blocks, runs, whole_mean};

fn agrees_with_reference(scene: &str, set: &[(&str, &str)], passes: u64) {
    assert_agrees_with_reference(scene, "path", set, passes, &LAYERS);
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
    let whole = whole_mean(&base);
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
