//! Small pictures of the embedded scenes, rendered when the gallery is opened first.

use std::sync::Arc;

use glam::UVec2;

use super::display::Display;
use super::export;
use super::exposure::auto_exposure;
use super::model::Model;
use super::source::SceneSource;
use crate::engine::integrators::Cancel;
use crate::engine::io::embedded;
use crate::engine::scene::Scene;
use crate::engine::session::{RenderJob, Renderer};

/// Pixels of a thumbnail.
pub const SIZE: UVec2 = UVec2::new(160, 120);
/// Samples a pixel.
const PASSES: u32 = 8;

/// A thumbnail.
#[derive(Debug)]
pub struct Thumbnail {
    /// The scene.
    pub id: &'static str,
    /// `SIZE` pixels.
    pub pixels: Vec<[u8; 3]>,
}

/// Renders one after the other on a thread of its own, so that most cores stay with the picture.
/// It ends when `send` says that nobody wants them any more.
pub fn start(send: impl Fn(Thumbnail) -> bool + Send + 'static) {
    let work = move || {
        let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(1).build() else {
            return;
        };
        for scene in embedded::all() {
            // A scene that cannot be rendered has no thumbnail; opening it tells why.
            let Some(pixels) = pool.install(|| render(scene.id)) else {
                continue;
            };
            let id = scene.id;
            if !send(Thumbnail { id, pixels }) {
                return;
            }
        }
    };
    // Without a thread there are no thumbnails, and names remain.
    let _ = std::thread::Builder::new()
        .name("thumbnails".to_owned())
        .spawn(work);
}

fn render(id: &str) -> Option<Vec<[u8; 3]>> {
    let source = SceneSource::Embedded(id.to_owned());
    let scene = Scene::build(&source.read().desc.ok()?).ok()?;
    let mut model = Model::new(source);
    model.view = scene.camera;
    let job = RenderJob {
        camera: model.camera(SIZE).ok()?,
        scene: Arc::new(scene),
        size: SIZE,
        settings: model.settings,
        navigating: false,
    };
    let mut renderer = Renderer::new(&job).ok()?;
    for _ in 0..PASSES {
        renderer.render_pass(&Cancel::never()).ok()?;
    }
    let frame = renderer.frame();
    let display = Display {
        exposure: auto_exposure(&frame, &[0]).unwrap_or(0.0).clamp(-8.0, 8.0),
        tonemap: crate::engine::film::ToneMap::Filmic,
        ..Display::default()
    };
    Some(export::shown(&frame, &display).1)
}
