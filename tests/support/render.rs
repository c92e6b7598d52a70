//! Renders for tests.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::UVec2;
use lightscope::engine::camera::Camera;
use lightscope::engine::film::Frame;
use lightscope::engine::integrators::{self, Cancel};
use lightscope::engine::io;
use lightscope::engine::scene::Scene;
use lightscope::engine::session::{RenderJob, Renderer, Settings};

/// Folder of a reference scene.
pub fn reference_dir(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/reference")
        .join(name)
}

/// A scene file, prepared.
pub fn load(path: &Path) -> Arc<Scene> {
    let desc = io::scene_file::load(path).unwrap_or_else(|e| panic!("{e}"));
    Arc::new(Scene::build(&desc).unwrap_or_else(|e| panic!("{e}")))
}

/// A scene given as TOML text.
pub fn scene_from_toml(text: &str) -> Arc<Scene> {
    let desc = io::scene_file::from_toml(text, "test.toml").unwrap_or_else(|e| panic!("{e}"));
    Arc::new(Scene::build(&desc).unwrap_or_else(|e| panic!("{e}")))
}

/// A job at the scene's own view and size.
pub fn job(scene: &Arc<Scene>, integrator: &str, set: &[(&str, &str)]) -> RenderJob {
    let entry = integrators::find(integrator).expect("an integrator of the registry");
    let mut settings = Settings::new(entry);
    for (name, value) in set {
        settings
            .params
            .set(entry.params, name, value)
            .expect("a parameter of the integrator");
    }
    let camera = scene.camera;
    RenderJob {
        scene: Arc::clone(scene),
        camera: Camera::new(&camera).expect("a view"),
        size: UVec2::new(camera.width, camera.height),
        settings,
        navigating: false,
    }
}

/// The picture after `passes` passes.
pub fn render(job: &RenderJob, passes: u64) -> Frame {
    let mut renderer = Renderer::new(job).expect("classes fit their table");
    for _ in 0..passes {
        renderer
            .render_pass(&Cancel::never())
            .expect("nobody cancels");
    }
    renderer.frame()
}

/// The picture after `passes` passes on a pool of `threads` threads.
pub fn render_with_threads(job: &RenderJob, passes: u64, threads: usize) -> Frame {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads");
    pool.install(|| render(job, passes))
}
