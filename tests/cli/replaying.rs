//! `lightscope replay`, and the commands that renders print for bad samples.

use std::process::Command;

use crate::support::{Exr, cornell, folder, json, lightscope, render, stderr, stdout, succeeds};

#[test]
fn a_replayed_sample_is_the_pixel_of_the_render() {
    let dir = folder();
    let (at, scene) = (dir.path(), cornell());
    for integrator in ["path", "whitted", "photon"] {
        let photons = ["--set", "global-photons=3000"];
        let set = if integrator == "photon" {
            &photons[..]
        } else {
            &[]
        };
        let more = ["--spp", "1", "--seed", "9", "--integrator", integrator];
        render(at, "a.exr", &[&more[..], set].concat());
        let exr = Exr::read(at.join("a.exr"));
        let channels = ["R", "G", "B"].map(|name| exr.channel(name));
        for (x, y) in [(0, 0), (7, 9), (8, 3), (15, 15)] {
            let index = format!("{x},{y},0");
            let args = ["replay", &scene, "--size", "16x16", "--seed", "9", "--json"];
            let more = ["--integrator", integrator, "--index", &index];
            let replay = json(at, &[&args[..], &more, set].concat());
            for (c, channel) in channels.iter().enumerate() {
                let told = replay["radiance"][c].as_f64().expect("a number") as f32;
                assert_eq!(
                    told.to_bits(),
                    channel[y * 16 + x].to_bits(),
                    "{integrator} {x} {y}"
                );
            }
            assert_eq!(replay["faults"], serde_json::json!([]));
            assert_eq!(replay["steps"][0]["step"], "lens");
        }
    }
}

#[test]
fn a_replay_is_read_vertex_by_vertex() {
    let dir = folder();
    let scene = cornell();
    let args = ["replay", &scene, "--size", "16x16", "--index", "8,12,0"];
    let text = stdout(&succeeds(dir.path(), &args));
    for expected in [
        "16x16, path (",
        "seed 0, camera 8,12,0",
        "lens: film (8.",
        "vertex: point (",
        "throughput (1 1 1)",
        "shadow ray: light 0, probability",
        "event: event D, direction (",
        "radiance of its pixel: (",
    ] {
        assert!(text.contains(expected), "{expected} is not in\n{text}");
    }
}

#[test]
fn wrong_samples_are_refused_with_what_would_be_right() {
    let dir = folder();
    let scene = cornell();
    for (more, said) in [
        (&["--index", "1,2"][..], "X,Y,PASS"),
        (&["--index", "16,0,0", "--size", "16x16"], "no pixel 16,0"),
        (
            &["--index", "1,2", "--stream", "lights"],
            "there are camera, light",
        ),
        (
            &[
                "--index",
                "1,2",
                "--stream",
                "chain",
                "--integrator",
                "pssmlt",
            ],
            "pssmlt cannot replay this",
        ),
        (
            &[
                "--index",
                "caustic,2,0",
                "--stream",
                "light",
                "--integrator",
                "photon",
            ],
            "was not built",
        ),
    ] {
        let args = [&["replay", &scene][..], more].concat();
        let output = lightscope(dir.path(), &args);
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        let text = stderr(&output);
        assert!(
            text.contains(said) && text.lines().count() == 1,
            "{more:?}: {text}"
        );
    }
}

/// Light beyond what f32 can hold.
const TOO_BRIGHT: &str = r#"
camera = { position = [0, 1, 5], target = [0, 1, 0], vfov_deg = 40, width = 8, height = 8 }
[materials]
white = { type = "diffuse", reflectance = 0.8 }
[[spheres]]
center = [0, 0, 0]
radius = 1
material = "white"
[[lights]]
type = "point"
position = [0, 1.4, 0]
intensity = [3e38, 3e38, 3e38]
"#;

#[test]
fn a_bad_sample_prints_the_command_that_shows_it_again() {
    let dir = folder();
    let at = dir.path();
    std::fs::write(at.join("too bright.toml"), TOO_BRIGHT).expect("a scene");
    let size = ["--size", "32x32", "--spp", "4", "--seed", "5"];
    for integrator in ["path", "bdpt", "light", "photon"] {
        let set = match integrator {
            "photon" => &["--set", "global-photons=2000"][..],
            _ => &["--set", "sampler=independent"],
        };
        let args = ["render", "too bright.toml", "-o", "a.exr", "--json"];
        let more = ["--integrator", integrator];
        let output = succeeds(at, &[&args[..], &size, &more, set].concat());
        let figures: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("JSON");
        assert!(
            figures["infinite"].as_u64() > Some(0),
            "{integrator}: {figures}"
        );
        assert_eq!(figures["non_finite"], figures["infinite"]);
        assert_eq!(figures["negative"], 0);
        let notes = stderr(&output);
        assert!(
            notes.contains("samples were infinite and were left out"),
            "{notes}"
        );
        let commands = figures["replay"].as_array().expect("commands");
        assert!(!commands.is_empty() && commands.len() <= 4);
        for command in commands {
            let command = command.as_str().expect("a command");
            assert!(notes.contains(command), "{command}\n{notes}");
            // Through a shell, as a person would.
            let program = env!("CARGO_BIN_EXE_lightscope").replace('\'', r"'\''");
            let typed = command.replacen("lightscope", &format!("'{program}'"), 1);
            let replayed = Command::new("sh")
                .current_dir(at)
                .args(["-c", &typed])
                .output()
                .expect("a shell");
            let text = String::from_utf8_lossy(&replayed.stdout);
            assert!(replayed.status.success(), "{typed}: {replayed:?}");
            assert!(
                text.contains("fault: infinite") || text.contains("inf"),
                "{typed}: {text}"
            );
        }
    }
}

#[test]
fn a_sound_render_counts_no_errors() {
    let dir = folder();
    let scene = cornell();
    let args = [
        "render", &scene, "-o", "a.exr", "--size", "16x16", "--spp", "2",
    ];
    let figures = json(dir.path(), &[&args[..], &["--json"]].concat());
    for name in [
        "nan",
        "infinite",
        "negative",
        "self_hits",
        "missed_edges",
        "cut_paths",
    ] {
        assert_eq!(figures[name], 0, "{name}");
    }
    assert_eq!(figures["replay"], serde_json::json!([]));
}
