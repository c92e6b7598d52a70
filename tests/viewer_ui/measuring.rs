//! The plot of errors, references, error images and the referee.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::Key;
use egui_kittest::kittest::Queryable;
use lightscope::engine::film::Frame;
use lightscope::engine::integrators::{Cancel, Params, REGISTRY, find};
use lightscope::engine::measure::referee::Verdict;
use lightscope::engine::session::{RenderJob, Renderer, Settings};
use lightscope::viewer::measuring::referee::Arrangement;
use lightscope::viewer::measuring::reference::Reference;
use lightscope::viewer::measuring::{Along, Made, Over};
use lightscope::viewer::workspace::Request;

use crate::desk::{Desk, desk_with_section};

/// What the desk shows, rendered by another algorithm.
fn made(desk: &Desk, integrator: &str) -> Made {
    let workspace = desk.state();
    Made {
        scene: workspace.scene.clone().expect("a scene"),
        view: workspace.model.view,
        size: glam::UVec2::new(32, 24),
        settings: Settings::new(find(integrator).expect("an integrator")),
    }
}

/// Renders `passes` passes and shows each.
fn render(desk: &mut Desk, made: &Made, passes: u64) {
    let workspace = desk.state_mut();
    let job = RenderJob {
        scene: Arc::clone(&made.scene),
        camera: workspace.model.camera(made.size).expect("a camera"),
        size: made.size,
        settings: made.settings.clone(),
        navigating: false,
    };
    let mut renderer = Renderer::new(&job).expect("a render");
    for _ in 0..passes {
        renderer.render_pass(&Cancel::never()).expect("a pass");
        let frame: Arc<Frame> = Arc::new(renderer.frame());
        workspace.show_frame(Arc::clone(&frame));
        workspace.measuring.observe(made.clone(), &frame);
        // The next frame waits until this one is compared: every pass has its point.
        wait(|| {
            workspace.measuring.poll();
            !workspace.measuring.is_busy()
        });
    }
    desk.run();
}

fn wait(mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(
            start.elapsed() < Duration::from_secs(120),
            "it takes too long"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Labels and numbers of points of the curves.
fn curves(desk: &Desk) -> Vec<(String, usize)> {
    let chart = desk.state().measuring.chart(0.01);
    let curves = chart.curves.into_iter();
    curves.map(|c| (c.label, c.points.len())).collect()
}

fn click(desk: &mut Desk, label: &str) {
    desk.get_by_label(label).click();
    desk.run();
}

#[test]
fn curves_of_one_view_pile_up_and_another_view_begins_anew() {
    let mut desk = desk_with_section("Error");
    assert!(desk.query_by_label("Error plot").is_some());
    let (path, light) = (made(&desk, "path"), made(&desk, "light"));
    render(&mut desk, &path, 8);
    render(&mut desk, &light, 4);
    // The first pass has no second half to compare with.
    let expected = [("path".to_owned(), 7), ("light".to_owned(), 3)];
    assert_eq!(curves(&desk), expected);
    desk.run();
    assert!(desk.query_by_label_contains("path: slope").is_some());
    assert!(desk.query_by_label_contains("light: slope").is_some());
    assert!(desk.query_by_label_contains("samples), in").is_some());

    let chart = desk.state().measuring.chart(0.01);
    assert!(chart.curves[0].band.len() == 7 && chart.guide().is_some());
    click(&mut desk, "samples");
    assert_eq!(desk.state().measuring.along, Along::Samples);
    assert_eq!(
        desk.state().measuring.chart(0.01).curves[1].points[0].0,
        2.0
    );

    let mut moved = path.clone();
    moved.view.vfov_deg += 1.0;
    render(&mut desk, &moved, 3);
    assert_eq!(curves(&desk), [("path".to_owned(), 2)]);
    click(&mut desk, "Clear curves");
    assert_eq!(curves(&desk), []);
}

#[test]
fn the_plot_is_saved_in_three_formats_and_has_a_window_of_its_own() {
    let mut desk = desk_with_section("Error");
    let path = made(&desk, "path");
    render(&mut desk, &path, 4);
    for (label, extension) in [
        ("Plot PNG", "png"),
        ("Plot SVG", "svg"),
        ("Plot CSV", "csv"),
    ] {
        click(&mut desk, label);
        let requests = std::mem::take(&mut desk.state_mut().requests);
        assert_eq!(requests, [Request::SavePlot(extension)]);
    }
    let bytes = |e: &str| desk.state().measuring.plot_bytes(e, 0.01).expect("a file");
    let image = image::load_from_memory(&bytes("png"))
        .expect("a PNG")
        .to_rgb8();
    assert!(
        image.pixels().any(|p| p.0 == [0, 114, 178]),
        "the curve is drawn"
    );
    let svg = String::from_utf8(bytes("svg")).expect("text");
    assert!(
        svg.contains("slope −1/2") && svg.contains("target 0.01"),
        "{svg}"
    );
    let csv = String::from_utf8(bytes("csv")).expect("text");
    assert_eq!(csv.lines().count(), 4, "{csv}");

    desk.key_press(Key::M);
    desk.run();
    assert!(desk.state().measuring.large);
    assert_eq!(desk.query_all_by_label("Error plot").count(), 2);
    desk.key_press(Key::M);
    desk.run();
    assert!(!desk.state().measuring.large);
}

#[test]
fn a_reference_is_made_in_the_background_and_errors_are_shown_against_it() {
    let mut desk = desk_with_section("Error");
    let path = made(&desk, "path");
    render(&mut desk, &path, 4);
    desk.state_mut().measuring.maker_seconds = 1.0;
    click(&mut desk, "Make reference");
    wait(|| {
        desk.state_mut().measuring.poll();
        desk.state().measuring.reference.is_some()
    });
    let measuring = &desk.state().measuring;
    let reference = measuring
        .usable_reference()
        .expect("of this picture")
        .clone();
    assert!(
        reference.error.is_some_and(|e| e > 0.0 && e < 0.5),
        "{:?}",
        reference.error
    );
    render(&mut desk, &path, 8);
    desk.run();
    assert_eq!(curves(&desk)[0].0, "path");
    assert!(curves(&desk)[0].1 >= 4, "{:?}", curves(&desk));
    assert!(desk.state().measuring.chart(0.01).curves[0].band.is_empty());
    assert!(desk.query_by_label_contains("Reference: path,").is_some());

    click(&mut desk, "Error image");
    for kind in ["absolute", "relative", "signed"] {
        click(&mut desk, kind);
        wait(|| {
            desk.state_mut().measuring.poll();
            let scale = desk.state().measuring.error_image.scale.as_ref();
            scale.is_some_and(|s| s.label.starts_with(kind))
        });
        desk.run();
        assert_eq!(desk.state().measuring.error_image.size.to_array(), [32, 24]);
    }
    let scale = desk
        .state()
        .measuring
        .error_image
        .scale
        .clone()
        .expect("a scale");
    assert!(scale.signed && scale.ends[0] == -scale.ends[1]);
    click(&mut desk, "No reference");
    assert_eq!(desk.state().measuring.over, Over::Nothing);
    assert!(
        desk.query_by_label("No reference: errors are estimated.")
            .is_some()
    );
}

#[test]
fn a_reference_is_opened_and_one_of_another_size_says_so() {
    let mut desk = desk_with_section("Error");
    let path = made(&desk, "path");
    render(&mut desk, &path, 2);
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference");
    let reference = Reference::open(&root.join("cornell-diffuse/ref.exr")).expect("a picture");
    desk.state_mut().measuring.set_reference(reference);
    desk.run();
    assert!(
        desk.query_by_label_contains("of another picture (64 × 64)")
            .is_some()
    );
    assert!(desk.state().measuring.usable_reference().is_none());
    click(&mut desk, "Open reference…");
    assert!(
        desk.query_by_label("Open a reference (.exr, .hdr)")
            .is_some()
    );
    let browser = desk.state_mut().browser.as_mut().expect("a browser");
    browser.go_to(&root.join("furnace"));
    desk.run();
    assert!(desk.query_by_label("scene.json").is_none());
    click(&mut desk, "ref.exr");
    click(&mut desk, "Open file");
    assert!(desk.query_by_label_contains("Reference: ref.exr").is_some());
    assert!(Reference::open(&root.join("nothing.exr")).is_err());
}

#[test]
fn the_referee_finds_agreement_and_difference() {
    let mut desk = desk_with_section("Referee");
    let path = made(&desk, "path");
    render(&mut desk, &path, 2);
    for (opponent, differs) in [("bdpt", false), ("whitted", true)] {
        let index = REGISTRY
            .iter()
            .position(|e| e.id == opponent)
            .expect("an id");
        desk.state_mut().measuring.referee.opponent = index;
        desk.run();
        click(&mut desk, "Start referee");
        assert!(desk.state().paused);
        wait(|| {
            desk.state_mut().measuring.poll();
            !desk.state().measuring.referee.is_running()
        });
        desk.run();
        let state = desk
            .state()
            .measuring
            .referee
            .state
            .clone()
            .expect("a state");
        match &state.verdict {
            Verdict::Agree => assert!(!differs, "{opponent}"),
            Verdict::Differ(layers) => {
                assert!(
                    differs && layers.iter().any(|l| l == "indirect"),
                    "{layers:?}"
                );
            }
            Verdict::Needs(seconds) => panic!("{opponent} needs {seconds}"),
        }
        let words = if differs {
            "differ in"
        } else {
            "agree within 1 %"
        };
        assert!(desk.query_by_label_contains(words).is_some(), "{words}");
    }
    for arrangement in Arrangement::ALL {
        click(&mut desk, arrangement.label());
        assert_eq!(desk.state().measuring.referee.arrangement, arrangement);
        assert_eq!(
            desk.state().measuring.referee.overlay.size.to_array(),
            [32, 24]
        );
    }
    // The first side is nearer to white light than the second, which lacks the indirect part.
    click(&mut desk, "difference");
    let overlay = &desk.state().measuring.referee.overlay;
    let red = overlay.pixels.iter().filter(|p| p[0] > p[2]).count();
    assert!(
        red > overlay.pixels.len() / 2,
        "{red} of {}",
        overlay.pixels.len()
    );
    click(&mut desk, "flip");
    let before = desk.state().measuring.referee.overlay.pixels.clone();
    click(&mut desk, "Other side");
    assert!(desk.state().measuring.referee.overlay.pixels != before);
    click(&mut desk, "Show sides");
    assert_eq!(desk.state().measuring.over, Over::Nothing);
    let defaults = Params::defaults(REGISTRY[0].params);
    assert!(desk.state().model.settings.params == defaults);
}
