//! What systems do to windows: sizes, scales, a device that goes away, a minute of a random hand.

use std::fs;

use crate::files::{blue, red, room};
use crate::screen::{Program, Screen, difference, mean, reference, saved};
use crate::x11::Desktop;

#[test]
fn another_scale_is_the_same_window_with_more_pixels() {
    let Some(screen) = Screen::start() else {
        return;
    };
    let desktop = Desktop::connect(&screen.display);
    desktop.set_dpi(96);
    let folder = tempfile::tempdir().expect("a folder");
    let mut program = Program::start(&screen, folder.path(), &reference("cornell-diffuse"));
    program.wait_for_picture();
    let still = program.settle();
    // Width of the panel in pixels: what the window has beside the picture.
    let panel = || {
        let width = |key: &str, name: &str| {
            program.key(key);
            let file = saved(folder.path(), name);
            let picture = image::open(&file).expect("a PNG");
            fs::remove_file(file).expect("the file");
            picture.width()
        };
        width("F12", "window.png") - width("ctrl+s", "spp.png")
    };
    let before = panel();

    desktop.set_dpi(144);
    desktop.tell_place(program.window());
    program.wait_for("it is half as large again", |p| difference(p, &still) > 3.0);
    program.settle();
    let after = panel();
    assert!(
        after.abs_diff(before * 3 / 2) <= 3,
        "{before} pixels of the panel became {after}"
    );

    desktop.set_dpi(96);
    desktop.tell_place(program.window());
    program.resize(900, 640);
    program.wait_for("the old scale is the old picture", |p| {
        difference(p, &still) < 3.0
    });
    program.quit();
}

#[test]
fn hidden_and_tiny_windows_come_back() {
    let Some(screen) = Screen::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let mut program = Program::start(&screen, folder.path(), &reference("cornell-diffuse"));
    program.wait_for_picture();
    let still = program.settle();

    program.hide();
    std::thread::sleep(std::time::Duration::from_millis(500));
    assert!(mean(&program.picture()) < 1.0, "it is still to be seen");
    program.unhide();
    program.wait_for("it is back", |p| difference(p, &still) < 3.0);

    for [width, height] in [[1, 1], [900, 1], [1, 640], [350, 30]] {
        program.resize(width, height);
        std::thread::sleep(std::time::Duration::from_millis(300));
        assert!(!program.has_ended(), "{width}×{height} ended it");
    }
    program.resize(900, 640);
    program.wait_for("the old size is the old picture", |p| {
        difference(p, &still) < 3.0
    });
    program.quit();
}

#[test]
fn a_lost_device_is_replaced() {
    let Some(screen) = Screen::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("room.json");
    fs::write(&path, room("0.8, 0, 0")).expect("a scene");
    let mut command = screen.command(folder.path());
    command.arg(&path).env("LIGHTSCOPE_TEST_LOSE_DEVICE", "40");
    let mut program = Program::spawn(&screen, command);
    let uniform = |p: &image::RgbImage| p.pixels().all(|pixel| pixel == p.get_pixel(0, 0));
    program.wait_for("the room is red", |p| red(p) && uniform(p));
    for step in 0..60 {
        program.drag("1", [250, 250], [step % 7, 20]);
        if red(&program.picture()) && !uniform(&program.picture()) {
            break;
        }
    }
    program.wait_for("the loss is told", |p| red(p) && !uniform(p));
    fs::write(&path, room("0, 0, 0.8")).expect("a scene");
    program.wait_for("it goes on with what is new", blue);
    program.quit();
}

#[test]
fn a_minute_of_a_random_hand_leaves_no_error() {
    let Some(screen) = Screen::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let output = screen
        .command(folder.path())
        .args(["bench", "soak", "--seconds", "60"])
        .output()
        .expect("it starts");
    let report = String::from_utf8_lossy(&output.stdout);
    println!("{report}");
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{report}{message}");
    assert!(report.contains("errors: 0"), "{report}");
    // A minute is too short to tell a slow leak, but not one of a picture a frame.
    let (_, memory) = report.split_once("MiB after each round:").expect("memory");
    let last = memory
        .lines()
        .next()
        .and_then(|l| l.split_whitespace().last());
    let last: f64 = last.expect("a round").parse().expect("a number");
    assert!(last < 1024.0, "{report}");
}
