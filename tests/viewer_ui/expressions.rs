//! Path expressions in the panel.

use std::sync::Arc;

use egui_kittest::kittest::Queryable;
use glam::UVec2;
use lightscope::engine::integrators::Cancel;
use lightscope::engine::session::{RenderJob, Renderer};
use lightscope::viewer::display::Shown;

use crate::desk::{Desk, desk};

fn open() -> Desk {
    let mut desk = desk();
    desk.get_by_label("Expressions").click();
    desk.run();
    desk
}

fn enter(desk: &mut Desk, text: &str) {
    desk.get_by_role_and_label(egui::Role::TextInput, "Paths")
        .focus();
    desk.run();
    desk.get_by_role_and_label(egui::Role::TextInput, "Paths")
        .type_text(text);
    desk.run();
}

/// What the window would do: two passes of the model.
fn render(desk: &mut Desk) {
    let state = desk.state_mut();
    let size = UVec2::new(32, 24);
    let job = RenderJob {
        camera: state.model.camera(size).expect("a camera"),
        scene: state.scene.clone().expect("a scene"),
        size,
        settings: state.model.settings.clone(),
        navigating: false,
    };
    let mut renderer = Renderer::new(&job).expect("a render");
    for _ in 0..2 {
        renderer.render_pass(&Cancel::never()).expect("a pass");
    }
    state.show_frame(Arc::new(renderer.frame()));
    desk.run();
}

fn texts(desk: &Desk) -> Vec<String> {
    let list = &desk.state().model.settings.layers.expressions;
    list.iter().map(|e| e.text().to_owned()).collect()
}

#[test]
fn what_is_typed_is_checked_while_one_types_and_added_by_enter() {
    let mut desk = open();
    enter(&mut desk, "LD(S");
    let message = "LD(S".parse::<lightscope::engine::path::Expression>();
    let error = message.expect_err("a mistake");
    let (place, message) = (error.position.expect("a place"), error.message);
    assert!(desk.query_by_label(&message).is_some(), "{message}");
    let (before, rest) = "LD(S".split_at(place);
    let marked = format!("{before}»{rest}");
    assert!(desk.query_by_label(&marked).is_some(), "{marked}");
    desk.key_press(egui::Key::Enter);
    desk.run();
    assert!(texts(&desk).is_empty());
    enter(&mut desk, "|D)E");
    assert!(desk.query_by_label(&message).is_none());
    desk.key_press(egui::Key::Enter);
    desk.run();
    assert_eq!(texts(&desk), ["LD(S|D)E"]);
    assert_eq!(desk.state().model.display.shown, Shown::Expression(0));
    // Letters that are typed are no commands.
    assert!(!desk.state().gallery && desk.state().preferences.panel);
}

#[test]
fn expressions_are_shown_removed_and_taken_back() {
    let mut desk = open();
    for text in ["LDE", "LDDE"] {
        enter(&mut desk, text);
        desk.get_by_label("Add").click();
        desk.run();
    }
    let shown = |desk: &Desk| desk.state().model.display.shown;
    assert_eq!(shown(&desk), Shown::Expression(1));
    desk.get_by_label("LDE").click();
    desk.run();
    assert_eq!(shown(&desk), Shown::Expression(0));
    desk.get_by_label("Remove LDE").click();
    desk.run();
    assert_eq!(
        (texts(&desk), shown(&desk)),
        (vec!["LDDE".to_owned()], Shown::Whole)
    );
    desk.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    desk.run();
    assert_eq!(texts(&desk), ["LDE", "LDDE"]);
}

#[test]
fn examples_fill_the_field() {
    let mut desk = open();
    desk.get_by_label("Examples").click();
    desk.run();
    desk.get_by_label_contains("LS+DE   ").click();
    desk.run();
    assert_eq!(desk.state().expression_text, "LS+DE");
    desk.get_by_label("Add").click();
    desk.run();
    assert_eq!(texts(&desk), ["LS+DE"]);
}

#[test]
fn the_badge_tells_a_partition_from_what_is_none() {
    let mut desk = open();
    for text in ["LE", "L.E"] {
        desk.state_mut()
            .add_expression(text.parse().expect("well-formed"));
    }
    render(&mut desk);
    let mean = desk.state().typed_balance.mean.expect("a balance");
    assert!(mean < -0.05, "longer paths are missing: {mean}");
    desk.state_mut()
        .add_expression("L.{2,}E".parse().expect("well-formed"));
    render(&mut desk);
    let balance = desk.state().typed_balance;
    assert!(balance.rms.expect("a balance") < 1e-5, "{balance:?}");
    assert!(
        desk.query_by_label_contains("Sum of these − whole")
            .is_some()
    );
}

#[test]
fn only_expressions_are_computed_until_something_else_is_shown() {
    let mut desk = open();
    desk.state_mut()
        .add_expression("LDE".parse().expect("well-formed"));
    desk.run();
    desk.get_by_label("Compute only these").click();
    desk.run();
    let layers = desk.state().model.settings.layers.clone();
    assert!(layers.no_whole && !layers.components);
    render(&mut desk);
    let frame = desk.state().frame.clone().expect("a frame");
    let lit = |layer: usize| {
        frame.layers[layer]
            .pixels
            .iter()
            .flatten()
            .any(|x| *x > 0.0)
    };
    assert!(lit(5) && !(1..5).any(lit));
    let all = desk.state().frame.clone().expect("a frame").stats.rays;
    desk.get_by_label("Whole").click();
    desk.run();
    let layers = desk.state().model.settings.layers.clone();
    assert!(!layers.no_whole && layers.components);
    render(&mut desk);
    assert!(desk.state().frame.clone().expect("a frame").stats.rays > all);
}
