//! Media: what they scatter alone, and sequences.

use std::sync::Arc;

use egui::Key;
use egui_kittest::kittest::Queryable;
use lightscope::engine::integrators::{Cancel, REGISTRY};
use lightscope::engine::io::{FileSource, scene_file};
use lightscope::engine::scene::Scene;
use lightscope::engine::session::{RenderJob, Renderer, Settings};
use lightscope::viewer::display::Shown;
use lightscope::viewer::opening::Opening;
use lightscope::viewer::source::SceneSource;
use lightscope::viewer::workspace::{Request, VOLUME, Workspace};

use crate::desk::{Desk, desk, desk_of};

const FOG: &str = r#"
    frames = 3
    camera = { position = [0, 0, 5], target = [0, 0, 0], vfov_deg = 40, width = 8, height = 6 }
    materials.grey = { type = "diffuse", reflectance = [0.5, 0.5, 0.5] }
    spheres = [{ center = [0, 0, 0], radius = 1, material = "grey" }]
    lights = [{ type = "point", position = [2, 4, 3], intensity = [40, 40, 40] }]
    media.fog = { type = "homogeneous", sigma_t = [0.1, 0.1, 0.1], albedo = [0.9, 0.9, 0.9] }
    medium = "fog"
"#;

struct Text;

impl FileSource for Text {
    fn read(&self, _: &str) -> std::io::Result<std::borrow::Cow<'_, [u8]>> {
        Ok(FOG.as_bytes().into())
    }
}

fn rendered(workspace: &mut Workspace, frame: u32, again: bool) {
    let source = SceneSource::File("fog.toml".into());
    let desc = scene_file::load_frame_from(&Text, "fog.toml", frame).expect("a scene");
    let scene = Arc::new(Scene::build(&desc).expect("a scene"));
    let opening = Opening::of_frame(source, frame);
    workspace.show_scene(opening, Arc::clone(&scene), again, String::new());
}

fn picture(workspace: &mut Workspace) {
    let scene = workspace.scene.clone().expect("a scene");
    let size = glam::UVec2::new(8, 6);
    let job = RenderJob {
        camera: workspace.model.camera(size).expect("a camera"),
        scene,
        size,
        settings: Settings::new(&REGISTRY[0]),
        navigating: false,
    };
    let mut renderer = Renderer::new(&job).expect("a render");
    renderer.render_pass(&Cancel::never()).expect("a pass");
    workspace.show_frame(Arc::new(renderer.frame()));
}

fn foggy() -> Desk {
    let mut workspace = Workspace::new(SceneSource::File("fog.toml".into()));
    rendered(&mut workspace, 0, false);
    picture(&mut workspace);
    desk_of(workspace)
}

#[test]
fn what_a_medium_scatters_is_shown_alone() {
    let mut desk = foggy();
    desk.get_by_label("only volume").click();
    desk.run_steps(2);
    let model = &desk.state().model;
    assert_eq!(model.settings.layers.expressions[0].text(), VOLUME);
    assert_eq!(model.display.shown, Shown::Expression(0));
    desk.key_press(Key::Num6);
    desk.run_steps(2);
    assert_eq!(desk.state().model.display.shown, Shown::Whole);
    desk.key_press(Key::Num6);
    desk.run_steps(2);
    let model = &desk.state().model;
    assert_eq!(model.display.shown, Shown::Expression(0));
    assert_eq!(model.settings.layers.expressions.len(), 1, "once only");
}

#[test]
fn without_a_medium_there_is_nothing_to_be_shown_alone() {
    let mut desk = desk();
    for label in ["only volume", "Play", "Equiangular"] {
        assert!(desk.query_by_label(label).is_none(), "{label}");
    }
    assert!(foggy().query_by_label("Equiangular").is_some());
    desk.key_press(Key::Num6);
    desk.run_steps(2);
    assert_eq!(desk.state().model.display.shown, Shown::Whole);
    let sentence = "Nothing in this scene scatters light in a volume.";
    assert!(desk.query_by_label(sentence).is_some());
}

#[test]
fn a_sequence_plays_one_frame_after_another_and_begins_again() {
    let mut desk = foggy();
    desk.run_steps(5);
    assert_eq!(desk.state().requests, [], "nobody asked for it");
    desk.get_by_label("Play").click();
    for next in [1, 2, 0, 1] {
        desk.run_steps(10);
        assert_eq!(desk.state().requests, [Request::Frame(next)]);
        let workspace = desk.state_mut();
        workspace.requests.clear();
        rendered(workspace, next, true);
        desk.run_steps(10);
        assert_eq!(desk.state().requests, [], "its picture is not there yet");
        picture(desk.state_mut());
    }
    desk.get_by_label("Stop").click();
    desk.run_steps(2);
    desk.state_mut().requests.clear();
    desk.run_steps(10);
    assert_eq!(desk.state().requests, []);
    assert_eq!(desk.state().sequence.at, 1);
}
