//! Opening, saving, looking closely.

use std::path::Path;

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use glam::{UVec2, Vec2};
use lightscope::viewer::opening::Opening;
use lightscope::viewer::state::State;
use lightscope::viewer::workspace::Request;

use crate::desk::{Desk, desk};

fn requests(desk: &mut Desk) -> Vec<Request> {
    std::mem::take(&mut desk.state_mut().requests)
}

#[test]
fn a_scene_is_chosen_in_the_browser() {
    let mut desk = desk();
    desk.get_by_label("Open…").click();
    desk.run();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference");
    let typed = folder.display().to_string();
    // The browser begins where the last file was.
    assert!(desk.query_by_label("scene.json").is_some());
    desk.get_by_label("Up").click();
    desk.run();
    desk.get_by_label("Filter").set_text_value_accesskit("furn");
    desk.run();
    assert!(desk.query_by_label("cornell-glass/").is_none());
    desk.get_by_label("furnace/").click();
    desk.run();
    desk.get_by_label("Filter").set_text_value_accesskit("");
    desk.run();
    desk.get_by_label("scene.json").click();
    desk.run();
    desk.get_by_label("Open file").click();
    desk.run();
    let expected = Path::new(&typed).join("furnace/scene.json");
    assert_eq!(requests(&mut desk), [Request::Open(expected)]);
    assert!(desk.state().browser.is_none());
}

#[test]
fn a_file_is_replaced_only_after_a_question() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("old.png");
    std::fs::write(&path, "").expect("a file");
    let mut desk = desk();
    desk.get_by_label("Save as…").click();
    desk.run();
    let browser = desk.state_mut().browser.as_mut().expect("a browser");
    assert_eq!(browser.name, "cornell-diffuse-2spp.png");
    browser.go_to(folder.path());
    "old.png".clone_into(&mut browser.name);
    desk.run();
    desk.get_by_label("Save file").click();
    desk.run();
    assert_eq!(requests(&mut desk), []);
    desk.get_by_label("Replace it").click();
    desk.run();
    assert_eq!(requests(&mut desk), [Request::SaveAs(path)]);
}

#[test]
fn typing_replaces_the_proposed_name_and_keeps_its_kind() {
    let mut desk = desk();
    desk.get_by_label("Save as…").click();
    desk.run();
    desk.event(egui::Event::Text("mine".to_owned()));
    desk.run();
    let browser = desk.state().browser.as_ref().expect("a browser");
    assert_eq!(browser.name, "mine.png");
}

#[test]
fn cancel_and_escape_leave_the_browser() {
    let mut desk = desk();
    desk.key_press_modifiers(Modifiers::COMMAND, Key::O);
    desk.run();
    desk.get_by_label("Cancel").click();
    desk.run();
    assert!(desk.state().browser.is_none());
    desk.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    desk.run();
    desk.key_press(Key::Escape);
    desk.run();
    assert!(desk.state().browser.is_none());
    assert_eq!(requests(&mut desk), []);
}

#[test]
fn a_state_restores_all_that_makes_the_picture() {
    let mut desk = desk();
    let saved = {
        let workspace = desk.state_mut();
        workspace.model.display.exposure = 3.0;
        workspace.model.settings.seed = 5;
        workspace.model.view.position.x += 0.5;
        State::new(
            &workspace.model,
            UVec2::new(40, 30),
            2,
            &workspace.scene_hash,
        )
    };
    let expected = desk.state().model.clone();
    let workspace = desk.state_mut();
    workspace.model.display.exposure = 0.0;
    workspace.model.settings.seed = 0;
    let scene = workspace.scene.clone().expect("a scene");
    let opening = Opening {
        source: saved.source(None),
        frame: saved.frame(),
        state: Some(Box::new(saved)),
    };
    let hash = workspace.scene_hash.clone();
    workspace.show_scene(opening, scene, false, hash);
    let model = &workspace.model;
    assert_eq!(workspace.notices.errors(), []);
    assert_eq!(model.view, expected.view);
    assert!(model.settings == expected.settings);
    assert_eq!(model.display, expected.display);
    assert_eq!(workspace.pixels(), UVec2::new(40, 30));
    desk.run();
    assert!(
        desk.query_by_label("The scene file has changed since this picture was saved.")
            .is_none()
    );
}

#[test]
fn the_inspector_names_the_material_under_the_cursor() {
    let mut desk = desk();
    desk.key_press(Key::I);
    desk.run();
    assert!(desk.query_by_label("Point at the picture.").is_some());
    desk.hover_at(egui::pos2(350.0, 680.0));
    desk.run();
    for name in [
        "whole",
        "direct",
        "indirect",
        "std. error",
        "samples",
        "material",
        "normal",
        "depth",
    ] {
        // Components have a control of the same name.
        assert!(desk.get_all_by_label(name).count() > 0, "{name}");
    }
}

#[test]
fn the_inspector_leaves_the_corner_that_is_pointed_at() {
    let mut desk = desk();
    desk.key_press(Key::I);
    let mut left_of_middle = |x, y| {
        desk.hover_at(egui::pos2(x, y));
        desk.run();
        desk.get_by_label("pixel").rect().max.x < 300.0
    };
    assert!(left_of_middle(650.0, 500.0));
    assert!(!left_of_middle(650.0, 900.0));
    assert!(!left_of_middle(40.0, 500.0));
}

#[test]
fn magnifying_keeps_the_point_under_the_cursor() {
    let mut desk = desk();
    let at = Vec2::new(200.0, 900.0);
    let workspace = desk.state_mut();
    workspace.magnify(8.0, at);
    assert_eq!(workspace.placement.zoom, 8.0);
    let zoomed = workspace.placement;
    workspace.move_pixels(Vec2::new(50.0, 0.0));
    assert!(workspace.placement.center.x < zoomed.center.x);
    desk.run();
    assert!(desk.query_by_label("magnified 8.0 ×").is_some());
    desk.key_press(Key::Z);
    desk.run();
    assert_eq!(desk.state().placement.zoom, 1.0);
}

#[test]
fn sections_and_theme_are_remembered() {
    let mut desk = desk();
    desk.get_by_label("Statistics").click();
    desk.run();
    assert!(desk.query_by_label("Estimated error").is_some());
    assert_eq!(
        desk.state().preferences.sections.get("Statistics"),
        Some(&true)
    );
    desk.key_press(Key::L);
    desk.run();
    assert!(!desk.state().preferences.dark);
    assert_eq!(desk.ctx.theme(), egui::Theme::Light);
}

#[test]
fn the_gallery_opens_and_closes() {
    let mut desk = desk();
    desk.get_by_label("Gallery").click();
    desk.run();
    assert!(desk.state().gallery);
    desk.key_press(Key::Escape);
    desk.run();
    assert!(!desk.state().gallery);
}
