//! Controls of the panel.

use std::sync::Arc;

use egui_kittest::kittest::Queryable;
use lightscope::engine::film::ToneMap;
use lightscope::engine::integrators::{ParamKind, REGISTRY, find};
use lightscope::engine::io::embedded;
use lightscope::engine::scene::Scene;
use lightscope::engine::session::Settings;
use lightscope::viewer::commands::TABLE;
use lightscope::viewer::display::Shown;
use lightscope::viewer::model::PictureSize;
use lightscope::viewer::workspace::{Format, Request};

use crate::desk::desk;

#[test]
fn components_are_switched_and_shown_alone() {
    let mut desk = desk();
    desk.get_by_label("direct").click();
    desk.run();
    let shown = |desk: &crate::desk::Desk| desk.state().model.display.shown;
    assert_eq!(shown(&desk), Shown::Parts([false, true, true, true]));
    desk.get_by_label("only indirect").click();
    desk.run();
    assert_eq!(shown(&desk).solo(), Some(3));
    desk.get_by_label("Side by side").click();
    desk.run();
    assert_eq!(shown(&desk), Shown::Grid);
    desk.get_by_label("Whole").click();
    desk.run();
    assert_eq!(shown(&desk), Shown::Whole);
    // The plan proves them black, and the panel says so.
    assert_eq!(desk.get_all_by_label("empty").count(), 2);
}

#[test]
fn every_parameter_of_every_integrator_has_a_control_where_it_matters() {
    let desc = embedded::read("glass-volume-caustic").expect("a scene");
    let rich = Arc::new(Scene::build(&desc).expect("a scene"));
    for entry in REGISTRY {
        for scene in [None, Some(&rich)] {
            let mut desk = desk();
            let workspace = desk.state_mut();
            workspace.model.settings.integrator = entry;
            workspace.scene = scene.cloned().or(workspace.scene.take());
            let features = workspace.scene.as_ref().expect("a scene").features;
            desk.run();
            for spec in entry.params {
                let name = spec.name.replace('-', " ");
                let mut found = desk.query_all_by(|node| {
                    node.label()
                        .is_some_and(|label| label.eq_ignore_ascii_case(&name))
                });
                let matters = (spec.matters)(&features);
                assert_eq!(found.next().is_some(), matters, "{}: {name}", entry.id);
                assert!(matters || scene.is_none(), "{name} matters nowhere");
            }
        }
    }
}

#[test]
fn a_choice_of_a_parameter_arrives_in_the_settings() {
    let mut desk = desk();
    let spec = &REGISTRY[0].params[0];
    let ParamKind::Choice(words) = spec.kind else {
        panic!("path has a mode")
    };
    desk.get_by_label("Mode").click();
    desk.run();
    desk.get_by_label(words[2]).click();
    desk.run();
    assert_eq!(
        desk.state().model.settings.params.choice(spec.name),
        words[2]
    );
}

#[test]
fn exposure_and_tone_map_change_the_display_only() {
    let mut desk = desk();
    let settings = desk.state().model.settings.clone();
    desk.get_by_role_and_label(egui::Role::Slider, "Exposure")
        .set_value_accesskit(2.5);
    desk.run();
    assert_eq!(desk.state().model.display.exposure, 2.5);
    desk.get_by_label("Tone map").click();
    desk.run();
    desk.get_by_label("AgX").click();
    desk.run();
    assert_eq!(desk.state().model.display.tonemap, ToneMap::Agx);
    desk.get_by_label("False colour").click();
    desk.run();
    assert!(desk.state().model.display.false_color);
    assert!(desk.state().model.settings == settings);
}

#[test]
fn depth_seed_and_size_are_numbers() {
    let mut desk = desk();
    desk.get_by_label("Limit depth").click();
    desk.run();
    assert_eq!(desk.state().model.settings.layers.max_depth, Some(8));
    desk.get_by_label("Fixed size").click();
    desk.run();
    assert!(matches!(desk.state().model.size, PictureSize::Fixed(_)));
    desk.get_by_label("width").set_value_accesskit(640.0);
    desk.get_by_label("height").set_value_accesskit(360.0);
    desk.get_by_label("Seed").set_value_accesskit(7.0);
    desk.run();
    assert_eq!(desk.state().model.settings.seed, 7);
    let PictureSize::Fixed(size) = desk.state().model.size else {
        panic!("a size")
    };
    assert_eq!(size.to_array(), [640, 360]);
}

#[test]
fn buttons_ask_for_files() {
    let mut desk = desk();
    for (label, request) in [
        ("Save PNG", Request::Save(Format::Png)),
        ("Save EXR", Request::Save(Format::Exr)),
        ("Save window", Request::SaveWindow),
        ("Copy picture", Request::Copy),
        ("Reload", Request::Reload),
    ] {
        desk.get_by_label(label).click();
        desk.run();
        assert_eq!(
            std::mem::take(&mut desk.state_mut().requests),
            [request],
            "{label}"
        );
    }
}

#[test]
fn what_is_left_out_is_told_on_demand() {
    let mut desk = desk();
    let reason = "texture lookups: every colour is constant";
    assert!(desk.query_by_label(reason).is_none());
    let count = desk
        .state()
        .frame
        .as_ref()
        .expect("a frame")
        .plan
        .left_out
        .len();
    desk.get_by_label(&format!("Left out for this scene ({count})"))
        .click();
    desk.run();
    assert!(desk.query_by_label(reason).is_some());
}

#[test]
fn help_names_every_command() {
    let mut desk = desk();
    desk.get_by_label("?").click();
    desk.run();
    for binding in TABLE {
        let found = desk.get_all_by_label(binding.doc).count();
        assert!(found > 0, "{} is not in the help", binding.label);
    }
    desk.key_press(egui::Key::Escape);
    desk.run();
    assert!(!desk.state().help);
}

#[test]
fn camera_fields_move_the_camera() {
    let mut desk = desk();
    desk.get_by_label("Camera").click();
    desk.run();
    desk.get_by_label("Opening angle").set_value_accesskit(60.0);
    desk.run();
    assert_eq!(desk.state().model.view.vfov_deg, 60.0);
    let before = desk.state().model.view;
    desk.get_by_label("Top").click();
    desk.run();
    assert!(desk.state().model.view.position.y > before.position.y);
    desk.get_by_label("Lens").click();
    desk.run();
    assert!(desk.state().model.view.lens.is_some());
    desk.get_by_label("Reset view").click();
    desk.run();
    assert_eq!(desk.state().model.view, desk.state().model.home);
}

#[test]
fn the_status_line_tells_samples_and_errors_stay_until_read() {
    let mut desk = desk();
    assert!(desk.query_by_label("2 samples").is_some());
    desk.state_mut()
        .notices
        .set_error("scene", "line 3 is wrong".to_owned());
    desk.run();
    assert!(desk.query_by_label("line 3 is wrong").is_some());
    desk.get_by_label("Dismiss").click();
    desk.run();
    assert!(desk.query_by_label("line 3 is wrong").is_none());
}

#[test]
fn strategies_are_switched_one_by_one_and_shown_alone() {
    let mut desk = desk();
    desk.state_mut().model.settings = lightscope::engine::session::Settings::new(
        lightscope::engine::integrators::find("bdpt").expect("registered"),
    );
    desk.run();
    let words =
        |desk: &crate::desk::Desk, name: &str| desk.state().model.settings.params.text(name);
    desk.get_by_label("Table of strategies").click();
    desk.run();
    desk.get_by_label("1,2").click();
    desk.run();
    desk.get_by_label("3,1").click();
    desk.run();
    assert_eq!(words(&desk, "strategies"), "all-1,2-3,1");
    desk.get_by_label("3,1").click();
    desk.run();
    assert_eq!(words(&desk, "strategies"), "all-1,2");
    desk.get_by_label("Table of strategies").click();
    desk.run();
    desk.get_by_label("Table of picture").click();
    desk.run_steps(30);
    desk.get_by_label("2,2")
        .click_modifiers(egui::Modifiers::SHIFT);
    desk.run();
    assert_eq!(words(&desk, "picture"), "2,2");
}

#[test]
fn statistics_tell_what_the_walks_did() {
    let mut desk = desk();
    desk.get_by_label("Statistics").click();
    desk.run();
    let frame = desk.state().frame.clone().expect("a frame");
    let lengths = frame.stats.lengths()[0].clone().expect("walks");
    assert_eq!(lengths.iter().sum::<u64>(), frame.stats.samples);
    let survival = frame.stats.survival().expect("roulette");
    let text = format!("{:.1} %", survival * 100.0);
    assert!(desk.query_by_label(&text).is_some(), "{text}");
    assert!(desk.query_by_label("Walks from the eye").is_some());
    assert!(desk.query_by_label("Walks from lights").is_none());
}

/// What is not found is said, also of what is switched off.
#[test]
fn what_cannot_be_found_is_said() {
    let mut desk = desk();
    let said = |desk: &crate::desk::Desk, what: &str| {
        let mut found = desk.query_all_by(|node| {
            let label = node.label().or_else(|| node.value());
            label.is_some_and(|label| label.starts_with("Cannot find") && label.contains(what))
        });
        found.next().is_some()
    };
    assert!(!said(&desk, ""));
    for (id, set, words) in [
        ("whitted", None, "L.+(D|G|V).*E"),
        ("monte-carlo", Some(("depth", "2")), "L.{3,}E"),
        ("photon", Some(("global-map", "off")), "L.*D.*DE"),
    ] {
        let settings = &mut desk.state_mut().model.settings;
        *settings = Settings::new(find(id).expect("an integrator"));
        if let Some((name, value)) = set {
            let specs = settings.integrator.params;
            settings.params.set(specs, name, value).expect("a value");
        }
        desk.run();
        assert!(said(&desk, words), "{id} does not say {words}");
    }
}
