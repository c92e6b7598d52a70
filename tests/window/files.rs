//! Files: live reload, errors that go away, screenshots that restore.

use std::fs;
use std::path::Path;

use crate::screen::{
    HEIGHT, Program, Screen, WIDTH, difference, mean, reference, saved, wait_until,
};
use crate::x11::Desktop;

/// A room in one colour: one sphere around the camera that emits and reflects.
pub fn room(radiance: &str) -> String {
    format!(
        r#"{{"name": "room",
"camera": {{"type": "perspective", "position": [0, 0, 0], "target": [0, 0, -1], "up": [0, 1, 0],
"vfov_deg": 60, "width": 64, "height": 64}},
"materials": {{"wall": {{"type": "diffuse", "reflectance": [0, 0, 0]}}}},
"spheres": [{{"center": [0, 0, 0], "radius": 1, "material": "wall", "inward": true,
"emission": [{radiance}]}}]}}"#
    )
}

/// The mean of one channel of what is shown.
fn channel(image: &image::RgbImage, c: usize) -> f64 {
    let sum: u64 = image.pixels().map(|p| u64::from(p.0[c])).sum();
    sum as f64 / f64::from(image.width() * image.height())
}

pub fn red(p: &image::RgbImage) -> bool {
    channel(p, 0) > 200.0 && channel(p, 2) < 40.0
}

pub fn blue(p: &image::RgbImage) -> bool {
    channel(p, 2) > 200.0 && channel(p, 0) < 40.0
}

fn uniform(p: &image::RgbImage) -> bool {
    p.pixels().all(|pixel| pixel == p.get_pixel(0, 0))
}

#[test]
fn files_are_opened_by_name_and_a_bad_one_is_refused_in_the_window() {
    let Some(screen) = Screen::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).expect("a file");
        path.display().to_string()
    };
    let first = write("red.json", &room("0.8, 0, 0"));
    write("blue.json", &room("0, 0, 0.8"));
    write("bad.json", "{");
    let mut program = Program::start(&screen, folder.path(), &first);
    program.wait_for("the room is red", |p| red(p) && uniform(p));
    let open = |name: &str| {
        program.key("ctrl+o");
        program.wait_for("folders are shown", |p| !uniform(p));
        std::thread::sleep(std::time::Duration::from_millis(300));
        program.type_text(name);
        program.key("Return");
    };
    open("blue.json");
    program.wait_for("the opened room is blue", |p| blue(p) && uniform(p));
    open("bad.json");
    program.wait_for("the refusal is told on the old picture", |p| {
        blue(p) && !uniform(p)
    });
    open("red.json");
    program.wait_for("the next is red and the error is gone", |p| {
        red(p) && uniform(p)
    });
    program.quit();
}

#[test]
fn scenes_and_screenshots_are_dropped_on_the_window() {
    let Some(screen) = Screen::start() else {
        return;
    };
    let desktop = Desktop::connect(&screen.display);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("red room.json");
    fs::write(&path, room("0.8, 0, 0")).expect("a scene");
    let mut program = Program::start(&screen, folder.path(), &reference("cornell-diffuse"));
    program.wait_for_picture();
    program.drag("3", [250, 250], [-70, 40]);
    let before = program.settle();
    program.key("ctrl+s");
    let png = saved(folder.path(), "spp.png");

    desktop.drop_file(program.window(), &path);
    program.wait_for("the dropped room is red", red);
    desktop.drop_file(program.window(), &png);
    program.wait_for("the dropped screenshot is back", |p| {
        difference(p, &before) < 2.0
    });
    program.quit();
}

#[test]
fn the_clipboard_holds_what_is_shown() {
    let Some(screen) = Screen::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let mut program = Program::start(&screen, folder.path(), &reference("cornell-diffuse"));
    program.wait_for_picture();
    program.settle();
    program.key("ctrl+c");
    let mut copied = None;
    let seen = wait_until(10.0, || {
        copied = program.clipboard();
        copied.is_some()
    });
    assert!(seen, "no picture is on the clipboard");
    let copied = copied.expect("a picture");
    let corner = image::imageops::crop_imm(&copied, 0, 0, WIDTH, HEIGHT).to_image();
    // The sentence that it was copied goes away.
    program.wait_for("the copy is what the window shows", |p| {
        difference(&corner, p) < 1.0
    });
    program.quit();
}

#[test]
fn a_changed_file_is_read_again_and_a_bad_one_keeps_the_old_picture() {
    let Some(screen) = Screen::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("room.json");
    fs::write(&path, room("0.8, 0, 0")).expect("a scene");
    let mut program = Program::start(&screen, folder.path(), &path.display().to_string());
    program.wait_for("the room is red", red);

    fs::write(&path, room("0, 0, 0.8")).expect("a scene");
    program.wait_for("the changed room is blue", blue);

    let before = program.picture();
    fs::write(&path, room("0, oops, 0")).expect("a scene");
    program.wait_for("the error is shown on the old picture", |p| {
        blue(p) && *p != before
    });
    fs::write(&path, room("0.8, 0, 0")).expect("a scene");
    program.wait_for("the mended room is red and the error is gone", |p| {
        red(p) && uniform(p)
    });
    program.quit();
}

#[test]
fn a_screenshot_restores_what_it_shows() {
    let Some(screen) = Screen::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let mut program = Program::start(&screen, folder.path(), &reference("cornell-diffuse"));
    program.wait_for_picture();
    let home = program.settle();
    program.drag("1", [250, 250], [90, -30]);
    program.key("plus");
    program.key("4");
    let before = program.settle();
    assert!(difference(&home, &before) > 3.0, "nothing changed");
    program.key("ctrl+s");
    let png = saved(folder.path(), "spp.png");
    program.quit();

    let name = png.display().to_string();
    let mut program = Program::start(&screen, folder.path(), &name);
    program.wait_for("the picture is back", |p| difference(p, &before) < 2.0);
    program.key("F12");
    let window = image::open(saved(folder.path(), "window.png"))
        .expect("a PNG")
        .to_rgb8();
    assert!(mean(&window) > 1.0, "the picture of the window is black");
    program.quit();
}

#[test]
fn a_picture_of_another_program_is_refused() {
    let path = Path::new(&reference("cornell-diffuse")).with_file_name("ref.exr");
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_lightscope"))
        .arg(&path)
        .output()
        .expect("it starts");
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("holds no state"), "{message}");
}
