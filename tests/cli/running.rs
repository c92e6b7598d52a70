//! What happens while a render runs.

use std::fs;
#[cfg(unix)]
use std::process::{Command, Stdio};

use serde_json::Value;

#[cfg(unix)]
use super::support::Exr;

use super::support::{command, cornell, folder, json, reference, render, stderr, stdout, succeeds};

#[test]
fn renders_stop_at_the_first_condition_reached() {
    let dir = folder();
    let spp = |more: &[&str]| {
        let scene = cornell();
        let args = ["render", &scene, "-o", "a.exr", "--size", "16x16", "--json"];
        let figures = json(dir.path(), &[&args[..], more].concat());
        for name in ["t_wall", "t_cpu", "mrays_per_second", "samples_per_second"] {
            assert!(figures[name].as_f64().unwrap() > 0.0, "{name} in {figures}");
        }
        assert!(figures["rays"].as_u64().unwrap() >= 256);
        figures["spp"].as_u64().unwrap()
    };
    assert_eq!(spp(&[]), 64);
    assert_eq!(spp(&["--spp", "3"]), 3);
    assert_eq!(
        spp(&["--spp", "3", "--seconds", "1000", "--error", "1e-9"]),
        3
    );
    assert_eq!(spp(&["--seconds", "1e-9"]), 1, "at least one pass");
    assert_eq!(
        spp(&["--error", "1000", "--seconds", "1000"]),
        2,
        "an error needs two halves"
    );
    assert!(spp(&["--seconds", "0.2", "--spp", "100000000"]) > 1);
    // No light reaches the camera at depth 0 here, so there is no relative error to reach.
    fs::write(dir.path().join("dark.json"), DARK).unwrap();
    let args = ["render", "dark.json", "-o", "dark.exr", "--error", "0.1"];
    assert!(stderr(&succeeds(dir.path(), &args)).contains("stays black"));
}

/// A sphere without light.
const DARK: &str = r#"{ "format": 1, "name": "dark", "description": "No light.",
    "camera": { "type": "perspective", "position": [0, 0, 5], "target": [0, 0, 0],
                "up": [0, 1, 0], "vfov_deg": 40, "width": 8, "height": 8 },
    "materials": { "white": { "type": "diffuse", "reflectance": [0.8, 0.8, 0.8] } },
    "meshes": [],
    "spheres": [{ "name": "ball", "center": [0, 0, 0], "radius": 1, "material": "white" }],
    "lights": [], "medium": null }"#;

#[test]
fn the_log_holds_a_line_a_pass_and_errors_against_a_reference() {
    let dir = folder();
    let (scene, reference) = (cornell(), reference("cornell-diffuse/ref.exr"));
    let args = [
        "render", &scene, "-o", "a.exr", "--spp", "8", "--log", "a.jsonl", "--json",
    ];
    let figures = json(
        dir.path(),
        &[&args[..], &["--reference", &reference]].concat(),
    );
    let text = fs::read_to_string(dir.path().join("a.jsonl")).unwrap();
    let lines: Vec<Value> = text
        .lines()
        .map(|l| serde_json::from_str(l).unwrap())
        .collect();
    assert_eq!(lines.len(), 8);
    let number = |line: &Value, name: &str| line[name].as_f64().unwrap_or_else(|| panic!("{line}"));
    for (i, line) in lines.iter().enumerate() {
        assert_eq!(
            (line["pass"].as_u64(), line["spp"].as_u64()),
            (Some(i as u64 + 1), Some(i as u64 + 1))
        );
        assert!(number(line, "t_cpu") > 0.0 && number(line, "relmse") > 0.0);
    }
    for pair in lines.windows(2) {
        assert!(number(&pair[1], "t_wall") > number(&pair[0], "t_wall"));
        assert!(number(&pair[1], "rays") > number(&pair[0], "rays"));
    }
    assert!(
        number(&lines[7], "rmse") < 0.6 * number(&lines[0], "rmse"),
        "noise falls"
    );
    for name in ["rmse", "relmse", "nmse"] {
        assert_eq!(number(&lines[7], name), number(&figures, name));
    }
    // What compare finds in the file is what was logged while rendering.
    let rows = json(dir.path(), &["compare", "a.exr", &reference, "--json"]);
    assert_eq!(rows[0]["layer"], "whole");
    assert_eq!(number(&rows[0], "relmse"), number(&lines[7], "relmse"));
    assert!(number(&rows[0]["reference_noise"], "relmse") < 1e-4);
}

#[test]
fn the_user_is_told_what_is_left_out_and_what_cannot_be_found() {
    let dir = folder();
    let output = render(dir.path(), "a.exr", &["--spp", "1", "--components"]);
    assert!(
        stderr(&output).contains("left out: layer caustic"),
        "{}",
        stderr(&output)
    );
    assert!(stdout(&output).is_empty());
    let scene = reference("point-light/scene.json");
    let args = [
        "render",
        &scene,
        "-o",
        "b.exr",
        "--spp",
        "1",
        "--set",
        "mode=hits",
    ];
    assert!(stderr(&succeeds(dir.path(), &args)).contains("cannot find L.*E"));
}

#[cfg(unix)]
#[test]
fn an_interrupt_writes_the_passes_that_are_complete() {
    use std::time::{Duration, Instant};
    let dir = folder();
    let scene = cornell();
    let args = [
        "render",
        &scene,
        "-o",
        "a.exr",
        "--seconds",
        "1000",
        "--log",
        "a.jsonl",
    ];
    let mut child = command(dir.path(), &args)
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    let log = dir.path().join("a.jsonl");
    let start = Instant::now();
    while fs::read_to_string(&log).map_or(0, |text| text.lines().count()) < 2 {
        assert!(
            start.elapsed() < Duration::from_secs(60),
            "no pass was logged"
        );
        assert!(
            child.try_wait().unwrap().is_none(),
            "the render ended by itself"
        );
        std::thread::sleep(Duration::from_millis(10));
    }
    let pid = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &pid])
            .status()
            .expect("kill")
            .success()
    );
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("interrupted"),
        "{}",
        stderr(&output)
    );
    let exr = Exr::read(dir.path().join("a.exr"));
    let passes = fs::read_to_string(&log).unwrap().lines().count();
    assert_eq!(exr.text("lightscope:spp"), passes.to_string());
}

#[test]
fn a_reader_of_the_notes_who_goes_away_costs_no_picture() {
    let folder = folder();
    let scene = cornell();
    let args = [
        "render", &scene, "-o", "a.exr", "--size", "16x16", "--spp", "4",
    ];
    let mut command = command(folder.path(), &args);
    let mut child = command
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stderr.take());
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
    assert!(folder.path().join("a.exr").exists());
}
