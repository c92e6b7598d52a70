//! Light tracing and bidirectional path tracing against independent references, and against `path`
//! by the words that both can find.

mod support;

use support::reference::{LAYERS, assert_agrees_with_reference};

#[test]
fn bdpt_agrees_on_cornell_diffuse() {
    assert_agrees_with_reference("cornell-diffuse", "bdpt", &[], 16, &LAYERS);
}

#[test]
fn bdpt_agrees_on_cornell_glass() {
    assert_agrees_with_reference("cornell-glass", "bdpt", &[], 16, &LAYERS);
}

#[test]
fn bdpt_agrees_on_cornell_glossy() {
    assert_agrees_with_reference("cornell-glossy", "bdpt", &[], 16, &LAYERS);
}

#[test]
fn bdpt_agrees_on_caustic_ring() {
    assert_agrees_with_reference("caustic-ring", "bdpt", &[], 64, &LAYERS);
}

#[test]
fn bdpt_agrees_on_ajar_door() {
    assert_agrees_with_reference("ajar-door", "bdpt", &[], 16, &LAYERS);
}

#[test]
fn bdpt_agrees_on_closed_room() {
    assert_agrees_with_reference("closed-room", "bdpt", &[], 4, &LAYERS);
}

#[test]
fn bdpt_agrees_on_point_light() {
    assert_agrees_with_reference("point-light", "bdpt", &[], 16, &LAYERS);
}

#[test]
fn bdpt_agrees_on_furnace() {
    assert_agrees_with_reference("furnace", "bdpt", &[], 16, &LAYERS);
}

#[test]
fn light_agrees_on_cornell_diffuse() {
    assert_agrees_with_reference("cornell-diffuse", "light", &[], 32, &LAYERS);
}

#[test]
fn light_agrees_on_the_caustics_of_cornell_glass() {
    let layers = ["direct", "caustic", "indirect"];
    assert_agrees_with_reference("cornell-glass", "light", &[], 32, &layers);
}

#[test]
fn light_agrees_on_cornell_glossy() {
    assert_agrees_with_reference("cornell-glossy", "light", &[], 32, &LAYERS);
}

#[test]
fn light_agrees_on_the_caustics_of_caustic_ring() {
    let layers = ["direct", "caustic", "indirect"];
    assert_agrees_with_reference("caustic-ring", "light", &[], 128, &layers);
}
