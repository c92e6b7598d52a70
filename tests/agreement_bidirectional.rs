//! Light tracing and bidirectional path tracing against independent references, and against `path`
//! by the words that both can find.

mod support;

use glam::UVec2;
use support::reference::{LAYERS, assert_agree, assert_agrees_with_reference, runs_of};
use support::render::{job, load, reference_dir};

#[test]
fn bdpt_agrees_on_cornell_diffuse() {
    assert_agrees_with_reference("cornell-diffuse", "bdpt", &[], 8, &LAYERS);
}

#[test]
fn bdpt_agrees_on_cornell_glass() {
    assert_agrees_with_reference("cornell-glass", "bdpt", &[], 48, &LAYERS);
}

#[test]
fn bdpt_agrees_on_cornell_glossy() {
    assert_agrees_with_reference("cornell-glossy", "bdpt", &[], 8, &LAYERS);
}

#[test]
fn bdpt_agrees_on_caustic_ring() {
    assert_agrees_with_reference("caustic-ring", "bdpt", &[], 32, &LAYERS);
}

#[test]
fn bdpt_agrees_on_ajar_door() {
    assert_agrees_with_reference("ajar-door", "bdpt", &[], 16, &LAYERS);
}

#[test]
fn bdpt_agrees_on_closed_room() {
    assert_agrees_with_reference("closed-room", "bdpt", &[], 3, &LAYERS);
}

#[test]
fn bdpt_agrees_on_point_light() {
    assert_agrees_with_reference("point-light", "bdpt", &[], 8, &LAYERS);
}

#[test]
fn bdpt_agrees_on_furnace() {
    assert_agrees_with_reference("furnace", "bdpt", &[], 8, &LAYERS);
}

#[test]
fn light_agrees_on_cornell_diffuse() {
    assert_agrees_with_reference("cornell-diffuse", "light", &[], 24, &LAYERS);
}

#[test]
fn light_agrees_on_the_caustics_of_cornell_glass() {
    let layers = ["direct", "caustic", "indirect"];
    assert_agrees_with_reference("cornell-glass", "light", &[], 32, &layers);
}

#[test]
fn light_agrees_on_cornell_glossy() {
    assert_agrees_with_reference("cornell-glossy", "light", &[], 24, &LAYERS);
}

/// Against bdpt, in few large pixels: some blocks of the reference hold slivers of the floor that
/// hardly any light path meets.
#[test]
fn light_agrees_on_the_caustics_of_caustic_ring() {
    let scene = load(&reference_dir("caustic-ring").join("scene.json"));
    let runs = |integrator: &str, passes| {
        let mut job = job(&scene, integrator, &[]);
        job.size = UVec2::splat(16);
        runs_of(job, passes)
    };
    let (light, bdpt) = (runs("light", 512), runs("bdpt", 256));
    let found = [(1, 1), (3, 3), (4, 4)];
    assert_agree("light on caustic-ring", &light, &bdpt, &found);
}
