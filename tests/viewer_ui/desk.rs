//! A workspace with a scene and a rendered frame, and the hand on it.

use std::path::Path;
use std::sync::Arc;

use egui_kittest::Harness;
use glam::UVec2;
use lightscope::engine::integrators::{Cancel, REGISTRY};
use lightscope::engine::scene::Scene;
use lightscope::engine::session::{RenderJob, Renderer, Settings};
use lightscope::viewer::opening::Opening;
use lightscope::viewer::panels;
use lightscope::viewer::source::SceneSource;
use lightscope::viewer::workspace::Workspace;

/// The window's contents in the state of the tests.
pub type Desk = Harness<'static, Workspace>;

/// A small diffuse scene: its specular and caustic components are black.
pub fn workspace() -> Workspace {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/cornell-diffuse/scene.json");
    workspace_of(SceneSource::File(path), 2)
}

/// The scene of `source` after some passes.
pub fn workspace_of(source: SceneSource, passes: u64) -> Workspace {
    let desc = source.read().desc.expect("a scene");
    let scene = Arc::new(Scene::build(&desc).expect("a scene"));
    let mut workspace = Workspace::new(source.clone());
    let opening = Opening::scene(source);
    workspace.show_scene(opening, Arc::clone(&scene), false, String::new());
    let size = UVec2::new(32, 24);
    let job = RenderJob {
        camera: workspace.model.camera(size).expect("a camera"),
        scene,
        size,
        settings: Settings::new(&REGISTRY[0]),
        navigating: false,
    };
    let mut renderer = Renderer::new(&job).expect("a render");
    for _ in 0..passes {
        renderer.render_pass(&Cancel::never()).expect("a pass");
    }
    workspace.show_frame(Arc::new(renderer.frame()));
    workspace
}

/// That of [`workspace`].
pub fn desk() -> Desk {
    desk_of(workspace())
}

/// With one section open and all others folded.
pub fn desk_with_section(section: &str) -> Desk {
    desk_of_section(workspace(), section)
}

/// That of a workspace.
pub fn desk_of_section(mut workspace: Workspace, section: &str) -> Desk {
    let sections = &mut workspace.preferences.sections;
    for title in ["Algorithm", "Components", "Display", "Save"] {
        sections.insert(title.to_owned(), false);
    }
    sections.insert(section.to_owned(), true);
    desk_of(workspace)
}

/// The window's contents, tall enough that nothing need be scrolled.
pub fn desk_of(workspace: Workspace) -> Desk {
    Harness::builder()
        .with_size(egui::Vec2::new(1000.0, 1400.0))
        .with_context_setup(panels::apply_style)
        .with_accessibility_check(true)
        .with_step_dt(1.0 / 60.0)
        .build_ui_state(panels::show, workspace)
}
