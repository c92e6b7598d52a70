//! The real program in a real window: an X server without a screen, a software graphics driver,
//! and a hand that is a program.
#![cfg(all(feature = "viewer", target_os = "linux"))]

mod files;
mod robust;
mod screen;
mod walk;
mod x11;

use std::process::{Command, Stdio};

use screen::{CLOSING, Program, Screen, reference, wait_until};

#[test]
fn without_a_display_it_says_what_works_without() {
    let output = Command::new(env!("CARGO_BIN_EXE_lightscope"))
        .arg(reference("cornell-glass"))
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .stdin(Stdio::null())
        .output()
        .expect("the program starts");
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("no display"), "{message}");
    assert!(message.contains("lightscope render"), "{message}");
    assert_eq!(message.trim().lines().count(), 1, "{message}");
}

#[test]
fn without_a_graphics_driver_it_names_the_package() {
    let Some(screen) = Screen::start() else {
        return;
    };
    let output = screen
        .command(&std::env::temp_dir())
        .arg(reference("cornell-glass"))
        // No driver is found there.
        .env("VK_DRIVER_FILES", "/nonexistent.json")
        .env("VK_ICD_FILENAMES", "/nonexistent.json")
        .env("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent.json")
        .stderr(Stdio::piped())
        .output()
        .expect("the program starts");
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("mesa-vulkan-drivers"), "{message}");
    assert!(message.contains("lightscope render"), "{message}");
}

#[test]
fn a_wrong_scene_is_refused_before_a_window_opens() {
    let output = Command::new(env!("CARGO_BIN_EXE_lightscope"))
        .arg("no-such-scene")
        .stdin(Stdio::null())
        .output()
        .expect("the program starts");
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn closing_is_immediate_while_it_renders() {
    let Some(screen) = Screen::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let mut program = Program::start(&screen, folder.path(), &reference("cornell-glass"));
    program.wait_for_picture();
    program.key("ctrl+q");
    // Threads are joined on the way out; a job has no end of its own.
    assert!(
        wait_until(CLOSING, || program.has_ended()),
        "it does not end"
    );
    assert_eq!(program.exit_code(), Some(0));
}
