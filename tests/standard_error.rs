//! The error that a picture says of its own pixels, against the spread of many pictures.

use std::path::Path;
use std::sync::Arc;

use glam::UVec2;
use lightscope::engine::film::Frame;
use lightscope::engine::integrators::{Cancel, find};
use lightscope::engine::io::scene_file;
use lightscope::engine::scene::Scene;
use lightscope::engine::session::{RenderJob, Renderer, Settings};

const SIZE: UVec2 = UVec2::new(24, 18);
/// Pictures with seeds of their own: the spread of each pixel is then known to 11 %.
const PICTURES: u64 = 40;
const PASSES: u64 = 6;

fn pictures(integrator: &str) -> Vec<Frame> {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/cornell-diffuse/scene.json");
    let desc = scene_file::load(&path).expect("a scene");
    let scene = Arc::new(Scene::build(&desc).expect("a scene"));
    let picture = |seed| {
        let mut settings = Settings::new(find(integrator).expect("an integrator"));
        settings.seed = seed;
        let camera = lightscope::engine::camera::Camera::new(&scene.camera).expect("a camera");
        let job = RenderJob {
            camera,
            scene: Arc::clone(&scene),
            size: SIZE,
            settings,
            navigating: false,
        };
        let mut renderer = Renderer::new(&job).expect("a render");
        for _ in 0..PASSES {
            renderer.render_pass(&Cancel::never()).expect("a pass");
        }
        renderer.frame()
    };
    (0..PICTURES).map(picture).collect()
}

/// Mean over the pixels of the variance among pictures, and of the variance they state.
fn variances(frames: &[Frame]) -> [f64; 2] {
    let n = frames.len() as f64;
    let (mut seen, mut stated) = (0.0, 0.0);
    for i in 0..(SIZE.x * SIZE.y) as usize {
        let values = frames.iter().map(|f| f64::from(f.layers[0].pixels[i][1]));
        let mean = values.clone().sum::<f64>() / n;
        seen += values.map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let squares = frames
            .iter()
            .map(|f| f64::from(f.differences[i][1]).powi(2));
        stated += squares.sum::<f64>() / n;
    }
    [seen, stated]
}

#[test]
fn pixels_state_the_error_that_they_have() {
    for integrator in ["path", "light"] {
        let [seen, stated] = variances(&pictures(integrator));
        // Both are means of 432 pixels over 40 pictures: known to a few percent.
        let ratio = stated / seen;
        assert!((0.8..1.25).contains(&ratio), "{integrator}: {ratio}");
    }
}

#[test]
fn what_pixels_state_adds_up_to_what_the_picture_states() {
    let frame = &pictures("path")[0];
    let all = SIZE.max_element();
    let error = frame.standard_error(UVec2::ZERO, all).expect("an error");
    let square = error.map(|e| f64::from(e).powi(2)).iter().sum::<f64>() / 3.0;
    let pixels = &frame.layers[0].pixels;
    let sum: f64 = pixels.iter().flatten().map(|v| f64::from(*v)).sum();
    let mean = sum / (3 * pixels.len()) as f64;
    let whole = frame.relative_error.expect("an error");
    let relative = square.sqrt() / mean;
    assert!((relative / whole - 1.0).abs() < 1e-3, "{relative} {whole}");
    assert_eq!(frame.standard_error(SIZE + 5, 2), None);
}
