//! Photons over the picture, and what a click finds.

use std::path::Path;
use std::sync::Arc;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::UVec2;
use lightscope::engine::film::Frame;
use lightscope::engine::integrators::{Cancel, find};
use lightscope::engine::io::scene_file;
use lightscope::engine::photon::MapKind;
use lightscope::engine::scene::Scene;
use lightscope::engine::session::{RenderJob, Renderer, Settings};
use lightscope::viewer::opening::Opening;
use lightscope::viewer::panels;
use lightscope::viewer::photons::{ColorBy, Drawn};
use lightscope::viewer::source::SceneSource;
use lightscope::viewer::workspace::Workspace;

use crate::desk::{Desk, desk};

/// A scene with glass, photon mapped with gathers from a cache.
fn photon_desk() -> Desk {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/cornell-glass/scene.json");
    let scene = Arc::new(Scene::build(&scene_file::load(&path).expect("a scene")).expect("built"));
    let source = SceneSource::File(path);
    let mut workspace = Workspace::new(source.clone());
    workspace.show_scene(
        Opening::scene(source),
        Arc::clone(&scene),
        false,
        String::new(),
    );
    let mut settings = Settings::new(find("photon").expect("registered"));
    let specs = settings.integrator.params;
    for (name, value) in [
        ("caustic-photons", "3000"),
        ("global-photons", "40000"),
        ("gather-rays", "40"),
        ("indirect", "cache"),
    ] {
        settings
            .params
            .set(specs, name, value)
            .expect("a parameter");
    }
    workspace.model.settings = settings.clone();
    let size = UVec2::new(48, 48);
    let job = RenderJob {
        camera: workspace.model.camera(size).expect("a camera"),
        scene,
        size,
        settings,
        navigating: false,
    };
    let mut renderer = Renderer::new(&job).expect("a render");
    renderer.render_pass(&Cancel::never()).expect("a pass");
    workspace.show_frame(Arc::new(renderer.frame()));
    workspace
        .preferences
        .sections
        .insert("Photons".to_owned(), true);
    Harness::builder()
        .with_size(egui::Vec2::new(1000.0, 2200.0))
        .with_context_setup(panels::apply_style)
        .with_accessibility_check(true)
        .with_step_dt(1.0 / 60.0)
        .build_ui_state(panels::show, workspace)
}

fn frame(desk: &Desk) -> Arc<Frame> {
    desk.state().frame.clone().expect("a frame")
}

fn stored(desk: &Desk, kind: MapKind) -> u64 {
    let view = frame(desk).photons.clone().expect("photons");
    view.map(kind).expect("a map").counts.stored
}

#[test]
fn the_maps_are_drawn_alone_and_together() {
    let mut desk = photon_desk();
    let (caustic, global) = (
        stored(&desk, MapKind::Caustic),
        stored(&desk, MapKind::Global),
    );
    assert!(caustic > 1000 && global > 1000);
    for (label, drawn, count) in [
        ("Of the caustic map", Drawn::Caustic, caustic),
        ("Of the global map", Drawn::Global, global),
        ("Of all maps", Drawn::All, caustic + global),
    ] {
        desk.get_by_label(label).click();
        desk.run();
        let photons = &desk.state().photons;
        assert_eq!((photons.choice.drawn, photons.count()), (drawn, count));
    }
    // Every photon of both maps is on the list once.
    let view = frame(&desk).photons.clone().expect("photons");
    let mut expected: Vec<_> = [MapKind::Caustic, MapKind::Global]
        .into_iter()
        .flat_map(|kind| view.map(kind).expect("a map").photons())
        .map(|photon| photon.p.to_array().map(f32::to_bits))
        .collect();
    let list = desk.state().photons.points.list.clone();
    let mut drawn: Vec<_> = list.iter().map(|p| p.p.map(f32::to_bits)).collect();
    expected.sort_unstable();
    drawn.sort_unstable();
    assert!(expected == drawn);
}

#[test]
fn colours_tell_direction_and_class() {
    let mut desk = photon_desk();
    desk.get_by_label("Of all maps").click();
    desk.run();
    for (label, by) in [("direction", ColorBy::Direction), ("class", ColorBy::Class)] {
        desk.get_by_label("Photon colour").click();
        desk.run();
        desk.get_by_label(label).click();
        desk.run();
        assert_eq!(desk.state().photons.choice.color, by);
    }
    // Straight from the lamp, by glass, by a wall …
    let legend = &desk.state().photons.legend;
    for name in ["L…", "LS…", "LD…"] {
        assert!(legend.iter().any(|(n, _)| n == name), "{legend:?}");
        assert!(desk.query_by_label(name).is_some(), "{name}");
    }
    let colors: Vec<_> = legend.iter().map(|(_, c)| *c).collect();
    let known = |p: &lightscope::viewer::photons::Point| {
        colors.contains(&[p.color[0], p.color[1], p.color[2]])
    };
    assert!(desk.state().photons.points.list.iter().all(known));
}

#[test]
fn photons_land_one_by_one() {
    let mut desk = photon_desk();
    desk.get_by_label("Of the global map").click();
    desk.run();
    desk.get_by_label("Let them land").click();
    desk.run_steps(4);
    let early = desk.state().photons.landed();
    assert!((1..=6).contains(&early), "{early}");
    desk.run_steps(60);
    let later = desk.state().photons.landed();
    assert!(later > early && later < desk.state().photons.count());
    desk.get_by_label("Stop").click();
    desk.run_steps(2);
    let stopped = desk.state().photons.landed();
    desk.run_steps(5);
    assert_eq!(desk.state().photons.landed(), stopped);
}

#[test]
fn a_click_finds_what_the_estimate_is_made_of() {
    let mut desk = photon_desk();
    desk.get_by_label("Ask by a click").click();
    desk.run();
    // Upon the floor, before the spheres.
    let picture = desk.get_by_label("Picture").rect();
    let at = picture.center() + egui::vec2(0.0, 0.42 * picture.height());
    desk.drag_at(at);
    desk.drop_at(at);
    desk.run();
    let found = desk.state().photons.found.clone().expect("a surface");
    assert!(found.si.n_g.y.abs() > 0.9, "{:?}", found.si.n_g);
    assert_eq!((found.rays.len(), found.queries.len()), (40, 2));
    let (kind, query, photons) = &found.queries[1];
    assert_eq!(*kind, MapKind::Global);
    assert_eq!(photons.len(), 50);
    let view = frame(&desk).photons.clone().expect("photons");
    for (p, weight) in photons {
        assert!(p.distance(found.si.p) <= query.radius * 1.0001);
        assert!((0.0..=1.0).contains(weight));
    }
    // The panel says the same figures.
    let scene = desk.state().scene.clone().expect("a scene");
    let again = view
        .query(&scene, &found.si, MapKind::Global)
        .expect("an estimate");
    assert_eq!(again.radiance, query.radiance);
    let line = format!("49 of 50 photons within {:.4}", query.radius);
    assert!(desk.query_by_label(&line).is_some(), "{line}");
    // Other maps, other answers: what was asked is asked again.
    desk.get_by_role_and_label(egui::Role::Slider, "Splitting planes")
        .set_value_accesskit(4.0);
    desk.get_by_label("Ways").set_value_accesskit(12.0);
    desk.run();
    assert_eq!(desk.state().photons.choice.planes, 4);
    let ways = &desk.state().photons.ways;
    assert_eq!(ways.len(), 12);
    assert!(ways.iter().all(|way| way.points.len() >= 2));
}

#[test]
fn cache_records_are_offered_where_there_are_some() {
    let mut desk = photon_desk();
    let view = frame(&desk).photons.clone().expect("photons");
    let count = view.cache().expect("a cache").records().len();
    assert!(count > 10);
    desk.get_by_label(&format!("Cache records ({count})"))
        .click();
    desk.run();
    assert!(desk.state().photons.choice.records);
}

#[test]
fn without_photons_the_section_offers_them() {
    let mut desk = desk();
    desk.get_by_label("Photons").click();
    desk.run();
    desk.get_by_label("Use photon mapping").click();
    desk.run();
    assert_eq!(desk.state().model.settings.integrator.id, "photon");
    assert!(
        desk.query_by_label("The photons are on their way.")
            .is_some()
    );
}
