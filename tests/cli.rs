//! The program itself: exit codes, sentences, files.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use exr::prelude::{ReadChannels, ReadLayers};
use serde_json::Value;
use tempfile::TempDir;

/// A scene of the reference suite: diffuse only, so that specular and caustic are zero.
fn cornell() -> String {
    reference("cornell-diffuse/scene.json")
}

fn reference(path: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/reference")
        .join(path)
        .display()
        .to_string()
}

/// A folder to work in.
fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn lightscope(folder: &Path, args: &[&str]) -> Output {
    command(folder, args).output().expect("the program starts")
}

fn command(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lightscope"));
    command.current_dir(folder).args(args).stdin(Stdio::null());
    command
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("UTF-8")
}

fn succeeds(folder: &Path, args: &[&str]) -> Output {
    let output = lightscope(folder, args);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{args:?}: {}",
        stderr(&output)
    );
    output
}

/// Standard output as the one JSON value it must be.
fn json(folder: &Path, args: &[&str]) -> Value {
    let text = stdout(&succeeds(folder, args));
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{args:?}: {e} in {text}"))
}

/// Renders the Cornell box at 16×16.
fn render(folder: &Path, out: &str, more: &[&str]) -> Output {
    let scene = cornell();
    let mut args = vec!["render", &scene, "-o", out, "--size", "16x16"];
    args.extend(more);
    succeeds(folder, &args)
}

/// Channels by name, as bits, and text attributes by name.
struct Exr {
    size: (usize, usize),
    channels: Vec<(String, Vec<u32>)>,
    texts: Vec<(String, String)>,
}

impl Exr {
    fn read(path: PathBuf) -> Self {
        let image = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .from_file(&path)
            .unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        assert_eq!(image.layer_data.len(), 1, "one part");
        let part = &image.layer_data[0];
        let channels = part.channel_data.list.iter().map(|channel| {
            let bits = channel
                .sample_data
                .values_as_f32()
                .map(f32::to_bits)
                .collect();
            assert!(matches!(
                channel.sample_data,
                exr::prelude::FlatSamples::F32(_)
            ));
            (channel.name.to_string(), bits)
        });
        let texts = part
            .attributes
            .other
            .iter()
            .filter_map(|(name, value)| match value {
                exr::prelude::AttributeValue::Text(text) => {
                    Some((name.to_string(), text.to_string()))
                }
                _ => None,
            });
        let size = (part.size.x(), part.size.y());
        Self {
            size,
            channels: channels.collect(),
            texts: texts.collect(),
        }
    }

    fn names(&self) -> Vec<&str> {
        self.channels
            .iter()
            .map(|(name, _)| name.as_str())
            .collect()
    }

    fn channel(&self, name: &str) -> Vec<f32> {
        let channel = self.channels.iter().find(|(n, _)| n == name);
        let (_, bits) = channel.unwrap_or_else(|| panic!("no channel {name}"));
        bits.iter().map(|b| f32::from_bits(*b)).collect()
    }

    fn text(&self, name: &str) -> &str {
        let text = self.texts.iter().find(|(n, _)| n == name);
        text.map(|(_, t)| t.as_str())
            .unwrap_or_else(|| panic!("no attribute {name}"))
    }
}

#[test]
fn wrong_usage_exits_with_2_and_says_what_would_be_right() {
    let dir = folder();
    let at = dir.path();
    fs::write(at.join("empty.toml"), "").unwrap();
    fs::write(at.join("broken.json"), "{ \"name\": ").unwrap();
    fs::write(at.join("notes.txt"), "hello").unwrap();
    fs::write(at.join("false.exr"), "no picture").unwrap();
    fs::create_dir(at.join("folder.exr")).unwrap();
    render(at, "small.exr", &["--spp", "1"]);
    let scene = cornell();
    let reference_dir = reference("cornell-diffuse");
    let shell = reference("cornell-diffuse/shell.obj");
    let s = scene.as_str();
    let cases: &[(&[&str], &str)] = &[
        (&["rendr"], "did you mean \"render\"?"),
        (
            &["no-such-scene"],
            "there is no scene and no file \"no-such-scene\"",
        ),
        (&["--nonsense"], "--nonsense"),
        (&["render"], "required"),
        (&["render", s], "--output"),
        (
            &["render", "jensen-bx", "-o", "a.exr"],
            "did you mean \"jensen-box\"?",
        ),
        (
            &["render", "./jensen-box", "-o", "a.exr"],
            "there is no scene and no file",
        ),
        (&["render", "empty.toml", "-o", "a.exr"], "empty.toml"),
        (&["render", "broken.json", "-o", "a.exr"], "broken.json"),
        (&["render", "notes.txt", "-o", "a.exr"], "notes.txt"),
        (
            &["render", s, "-o", "a.jpg"],
            "must end in .exr, .png or .hdr",
        ),
        (&["render", s, "-o", "a.pngg"], "did you mean \"png\"?"),
        (&["render", s, "-o", "a"], "must end in .exr, .png or .hdr"),
        (&["render", s, "-o", "folder.exr"], "is a folder"),
        (
            &["render", s, "-o", "nowhere/a.exr"],
            "there is no folder nowhere",
        ),
        (
            &["render", s, "-o", "notes.txt/a.exr"],
            "there is no folder notes.txt",
        ),
        (
            &["render", s, "-o", "a.exr", "--integrator", "pat"],
            "did you mean \"path\"?",
        ),
        (&["render", s, "-o", "a.exr", "--set", "mode"], "NAME=VALUE"),
        (
            &["render", s, "-o", "a.exr", "--set", "mood=mis"],
            "did you mean \"mode\"?",
        ),
        (
            &["render", s, "-o", "a.exr", "--set", "mode=all"],
            "one of mis, kajiya, hits",
        ),
        (
            &["render", s, "-o", "a.exr", "--set", "roulette=-1"],
            "an integer from 0",
        ),
        (
            &["render", s, "-o", "a.exr", "--expression", "L(D"],
            "expression `L(D`",
        ),
        (
            &["render", s, "-o", "a.exr", "--expression", "LXE"],
            "character 2",
        ),
        (
            &["render", s, "-o", "a.exr", "--expression", ""],
            "expression",
        ),
        (
            &["render", s, "-o", "a.png", "--components"],
            "write an .exr file",
        ),
        (
            &["render", s, "-o", "a.hdr", "--components"],
            "write an .exr file",
        ),
        (
            &["render", s, "-o", "a.png", "--expression", "LDE"],
            "write an .exr file",
        ),
        (
            &["render", s, "-o", "a.exr", "--no-whole"],
            "leaves nothing to render",
        ),
        (&["render", s, "-o", "a.exr", "--spp", "0"], "at least 1"),
        (&["render", s, "-o", "a.exr", "--spp", "many"], "at least 1"),
        (&["render", s, "-o", "a.exr", "--seconds", "-1"], "above 0"),
        (&["render", s, "-o", "a.exr", "--seconds", "nan"], "above 0"),
        (&["render", s, "-o", "a.exr", "--error", "0"], "above 0"),
        (
            &["render", s, "-o", "a.exr", "--size", "640"],
            "such as 640x480",
        ),
        (
            &["render", s, "-o", "a.exr", "--size", "0x5"],
            "between 1 and",
        ),
        (
            &["render", s, "-o", "a.exr", "--size", "65536x65536"],
            "at most",
        ),
        (
            &["render", s, "-o", "a.exr", "--threads", "-2"],
            "from 0 (one a core)",
        ),
        (&["render", s, "-o", "a.exr", "--seed", "x"], "--seed"),
        (
            &["render", s, "-o", "a.exr", "--max-depth", "-1"],
            "--max-depth",
        ),
        (
            &["render", s, "-o", "a.png", "--exposure", "bright"],
            "stops",
        ),
        (
            &["render", s, "-o", "a.png", "--tonemap", "filmc"],
            "did you mean \"filmic\"?",
        ),
        (
            &["render", s, "-o", "a.exr", "--reference", "none.exr"],
            "there is no file none.exr",
        ),
        (
            &["render", s, "-o", "a.exr", "--reference", "small.exr"],
            "--size 16x16",
        ),
        (
            &["render", s, "-o", "a.exr", "--reference", "false.exr"],
            "false.exr",
        ),
        (&["compare", "small.exr"], "required"),
        (
            &["compare", "small.exr", "none.exr"],
            "there is no file none.exr",
        ),
        (
            &["compare", "small.exr", &reference_dir],
            "only pictures of one size",
        ),
        (
            &["compare", "notes.txt", "small.exr"],
            "must end in .exr, .png or .hdr",
        ),
        (&["list"], "scenes"),
        (&["list", "scene"], "scenes"),
        (&["info", "none.png"], "there is no file none.png"),
        (&["info", "furnance"], "there is no scene and no file"),
        (&["bench"], "first-frame"),
        (&["bench", "scenes"], "DIR"),
        (&["bench", "scenes", "."], "ref.exr"),
        (&["bench", "first-frame", "--changes", "0"], "at least 1"),
        (&["bench", "rays", "none.obj"], "none.obj"),
        (
            &["bench", "rays", &shell, "--rays", "notes.txt"],
            "notes.txt",
        ),
    ];
    for (args, sentence) in cases {
        let output = lightscope(at, args);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
        assert!(message.contains(sentence), "{args:?}: {message}");
        assert!(
            output.stdout.is_empty(),
            "{args:?} wrote {}",
            stdout(&output)
        );
        assert!(!message.contains("panicked"), "{args:?}: {message}");
    }
    let left: Vec<_> = fs::read_dir(at)
        .unwrap()
        .map(|e| e.unwrap().file_name())
        .collect();
    assert_eq!(left.len(), 6, "nothing else was written: {left:?}");
}

#[test]
fn help_and_version_are_results() {
    let dir = folder();
    let help = stdout(&succeeds(dir.path(), &["--help"]));
    for command in ["render", "compare", "list", "info", "bench"] {
        assert!(help.contains(command), "{help}");
    }
    assert!(stdout(&succeeds(dir.path(), &["--version"])).contains(env!("CARGO_PKG_VERSION")));
    assert!(stdout(&succeeds(dir.path(), &["render", "--help"])).contains("--expression"));
}

#[cfg(not(feature = "viewer"))]
#[test]
fn without_a_window_the_user_is_told_what_works() {
    let dir = folder();
    for args in [&[][..], &[cornell().as_str()]] {
        let output = lightscope(dir.path(), args);
        assert_eq!(output.status.code(), Some(1));
        assert!(
            stderr(&output).contains("`lightscope render"),
            "{}",
            stderr(&output)
        );
        assert_eq!(stderr(&output).lines().count(), 1);
    }
}

#[test]
fn layers_asked_for_are_in_the_file_even_if_they_are_zero() {
    let dir = folder();
    let more = [
        "--components",
        "--expression",
        "LDE",
        "--expression",
        "LS+E",
        "--spp",
        "2",
    ];
    render(
        dir.path(),
        "a.exr",
        &[&more[..], &["--seed", "7", "--set", "mode=kajiya"]].concat(),
    );
    let exr = Exr::read(dir.path().join("a.exr"));
    assert_eq!(exr.size, (16, 16));
    let mut expected = vec!["R".to_owned(), "G".to_owned(), "B".to_owned()];
    for layer in [
        "direct", "specular", "caustic", "indirect", "expr1", "expr2",
    ] {
        expected.extend(["R", "G", "B"].map(|c| format!("{layer}.{c}")));
    }
    expected.sort();
    assert_eq!(exr.names(), expected);
    let sum = |name: &str| exr.channel(name).iter().map(|x| f64::from(*x)).sum::<f64>();
    assert!(sum("R") > 0.0 && sum("direct.R") > 0.0 && sum("indirect.R") > 0.0);
    assert!(
        sum("expr1.R") > 0.0 && sum("expr1.R") < sum("direct.R"),
        "LE is no part of LDE"
    );
    for zero in ["specular.R", "caustic.G", "expr2.B"] {
        assert!(exr.channel(zero).iter().all(|x| *x == 0.0), "{zero}");
    }
    let parts = sum("direct.G") + sum("specular.G") + sum("caustic.G") + sum("indirect.G");
    assert!(
        (parts - sum("G")).abs() < 1e-4 * sum("G"),
        "{parts} against {}",
        sum("G")
    );

    assert_eq!(exr.text("expr1"), "LDE");
    assert_eq!(exr.text("expr2"), "LS+E");
    assert_eq!(exr.text("lightscope:scene"), "cornell-diffuse");
    assert_eq!(exr.text("lightscope:integrator"), "path");
    assert!(exr.text("lightscope:parameters").contains("mode=kajiya"));
    assert_eq!(exr.text("lightscope:spp"), "2");
    assert_eq!(exr.text("lightscope:seed"), "7");
    assert_eq!(exr.text("lightscope:version"), env!("CARGO_PKG_VERSION"));
    assert!(exr.text("lightscope:seconds").parse::<f64>().unwrap() > 0.0);
    assert!(exr.text("lightscope:error").parse::<f64>().unwrap() > 0.0);

    render(
        dir.path(),
        "b.exr",
        &[
            "--no-whole",
            "--expression",
            "LDE",
            "--spp",
            "2",
            "--seed",
            "7",
        ],
    );
    assert_eq!(
        Exr::read(dir.path().join("b.exr")).names(),
        ["expr1.B", "expr1.G", "expr1.R"]
    );
    render(dir.path(), "c.exr", &["--spp", "1"]);
    assert_eq!(Exr::read(dir.path().join("c.exr")).names(), ["B", "G", "R"]);
}

#[test]
fn one_thread_and_eight_write_the_same_bits() {
    let dir = folder();
    let scene = reference("cornell-glass/scene.json");
    let render = |out: &str, threads: &str| {
        let args = [
            "render",
            &scene,
            "-o",
            out,
            "--size",
            "40x24",
            "--spp",
            "4",
            "--components",
        ];
        let more = [
            "--expression",
            "L.*S.E",
            "--seed",
            "3",
            "--threads",
            threads,
        ];
        succeeds(dir.path(), &[&args[..], &more].concat());
        Exr::read(dir.path().join(out))
    };
    let (one, eight) = (render("one.exr", "1"), render("eight.exr", "8"));
    assert_eq!(one.names().len(), 18);
    assert!(one.channels == eight.channels);
    assert!(
        one.channel("caustic.R").iter().any(|x| *x > 0.0),
        "a layer that says something"
    );
}

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
fn layers_are_compared_one_by_one() {
    let dir = folder();
    let at = dir.path();
    let more = ["--spp", "2", "--components", "--expression", "LDE"];
    render(at, "a.exr", &more);
    render(
        at,
        "b.exr",
        &[
            "--spp",
            "2",
            "--components",
            "--expression",
            "LS+E",
            "--expression",
            "LDE",
        ],
    );
    let rows = json(at, &["compare", "a.exr", "b.exr", "--json"]);
    let layers: Vec<&str> = rows
        .as_array()
        .unwrap()
        .iter()
        .map(|r| r["layer"].as_str().unwrap())
        .collect();
    assert_eq!(
        layers,
        ["whole", "direct", "specular", "caustic", "indirect", "LDE"]
    );
    for row in rows.as_array().unwrap() {
        for name in ["rmse", "mae", "bias", "relmse", "smape"] {
            assert_eq!(row[name].as_f64(), Some(0.0), "{name} of {row}");
        }
    }
    let scene = cornell();
    succeeds(
        at,
        &[
            "render",
            &scene,
            "-o",
            "c.exr",
            "--spp",
            "4",
            "--components",
        ],
    );
    let folder = reference("cornell-diffuse");
    let rows = json(at, &["compare", "c.exr", &folder, "--json"]);
    assert_eq!(rows.as_array().unwrap().len(), 5);
    for row in rows.as_array().unwrap() {
        assert!(row["reference_noise"]["rmse"].is_number(), "{row}");
        assert!(row["rmse"].as_f64().unwrap() < 1.0, "{row}");
    }
    let table = stdout(&succeeds(at, &["compare", "c.exr", &folder]));
    assert!(
        table.contains("relmse") && table.contains("the reference's own noise"),
        "{table}"
    );
}

#[test]
fn a_file_is_replaced_whole_or_not_at_all() {
    let dir = folder();
    let at = dir.path();
    fs::write(at.join("a.exr"), "old").unwrap();
    let scene = cornell();
    let output = lightscope(
        at,
        &["render", &scene, "-o", "a.exr", "--reference", "none.exr"],
    );
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(fs::read(at.join("a.exr")).unwrap(), b"old");
    render(at, "a.exr", &["--spp", "1"]);
    assert_eq!(Exr::read(at.join("a.exr")).size, (16, 16));
    let left: Vec<_> = fs::read_dir(at)
        .unwrap()
        .map(|e| e.unwrap().file_name())
        .collect();
    assert_eq!(left, ["a.exr"], "no part of a file is left over");
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_cannot_be_written_is_found_before_rendering() {
    let dir = folder();
    let scene = cornell();
    let output = lightscope(
        dir.path(),
        &["render", &scene, "-o", "/proc/a.exr", "--seconds", "1000"],
    );
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("nothing can be written into /proc"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn png_and_hdr_hold_the_picture() {
    let dir = folder();
    render(dir.path(), "a.exr", &["--spp", "2"]);
    render(dir.path(), "a.hdr", &["--spp", "2"]);
    render(dir.path(), "a.png", &["--spp", "2"]);
    render(
        dir.path(),
        "b.png",
        &["--spp", "2", "--exposure", "-2", "--tonemap", "agx"],
    );
    let mean = |name: &str| {
        let info = json(dir.path(), &["info", name, "--json"]);
        assert_eq!(info["size"], serde_json::json!([16, 16]));
        info["layers"][0]["mean"][0].as_f64().unwrap()
    };
    let exact = mean("a.exr");
    assert!(
        (mean("a.hdr") - exact).abs() < 0.02 * exact,
        "a shared exponent keeps 8 bits"
    );
    assert!(mean("a.png") < exact, "the lamp is cut at white");
    assert!(mean("a.png") > 0.2 * exact && mean("b.png") < mean("a.png"));
}

#[test]
fn json_output_is_one_value_and_nothing_else() {
    let dir = folder();
    let at = dir.path();
    for list in ["scenes", "integrators"] {
        let rows = json(at, &["list", list, "--json"]);
        assert!(!rows.as_array().unwrap().is_empty());
        for row in rows.as_array().unwrap() {
            for name in ["id", "label", "summary"] {
                assert!(!row[name].as_str().unwrap().is_empty(), "{name} of {row}");
            }
        }
        let ids = rows
            .as_array()
            .unwrap()
            .iter()
            .map(|r| r["id"].as_str().unwrap());
        let text = stdout(&succeeds(at, &["list", list]));
        ids.for_each(|id| assert!(text.contains(id), "{id} in {text}"));
    }
    let integrators = json(at, &["list", "integrators", "--json"]);
    let path = integrators
        .as_array()
        .unwrap()
        .iter()
        .find(|r| r["id"] == "path")
        .unwrap();
    assert!(
        path["params"]
            .as_array()
            .unwrap()
            .iter()
            .any(|p| p["name"] == "mode" && p["default"] == "mis")
    );
    assert!(
        path["missing"]
            .as_array()
            .unwrap()
            .iter()
            .any(|m| m["words"] == "LS.*E"),
        "{path}"
    );

    let scene = cornell();
    let info = json(at, &["info", &scene, "--json"]);
    assert_eq!(info["name"], "cornell-diffuse");
    assert_eq!(
        (info["size"][0].as_u64(), info["spheres"].as_u64()),
        (Some(64), Some(0))
    );
    assert!(info["triangles"].as_u64().unwrap() > 10 && info["lights"].as_u64().unwrap() >= 1);
    assert!(info["features"].to_string().contains("diffuse"));

    let frames = [
        "bench",
        "first-frame",
        "--changes",
        "3",
        "--size",
        "64x36",
        "--json",
    ];
    let bench = json(at, &[&frames[..], &["--scene", &scene]].concat());
    let ms = |name: &str| bench[name].as_f64().unwrap();
    assert!(0.0 < ms("p50_ms") && ms("p50_ms") <= ms("p99_ms") && ms("p99_ms") <= ms("max_ms"));

    let folder = reference("point-light");
    let rows = json(
        at,
        &["bench", "scenes", &folder, "--seconds", "0.2", "--json"],
    );
    let row = &rows[0];
    let (relmse, t_cpu) = (
        row["relmse"].as_f64().unwrap(),
        row["t_cpu"].as_f64().unwrap(),
    );
    assert_eq!(row["scene"], "point-light");
    assert!((row["k"].as_f64().unwrap() - 1000.0 * relmse * t_cpu).abs() < 1e-9);
}

#[test]
fn ids_win_over_files_and_a_dot_forces_the_file() {
    let dir = folder();
    fs::write(dir.path().join("jensen-box"), "no scene").unwrap();
    succeeds(dir.path(), &["info", "jensen-box"]);
    let output = lightscope(dir.path(), &["info", "./jensen-box"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
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
