//! Wrong usage and help.

use std::fs;

use super::support::{cornell, folder, lightscope, reference, render, stderr, stdout, succeeds};

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
        (
            &["render", s, "-o", "a.exr", "--pyramid", "4"],
            "--integrator bdpt",
        ),
        (
            &[
                "render",
                s,
                "-o",
                "a.exr",
                "--integrator",
                "bdpt",
                "--pyramid",
                "1",
            ],
            "from 2 to 12",
        ),
        (
            &[
                "render",
                s,
                "-o",
                "a.exr",
                "--integrator",
                "bdpt",
                "--pyramid",
                "4",
                "--seconds",
                "1",
            ],
            "--pyramid goes with",
        ),
        (
            &[
                "bench",
                "integrators",
                &reference_dir,
                "--integrators",
                "pth",
            ],
            "did you mean \"path\"?",
        ),
        (
            &["bench", "integrators", &reference_dir, "--layer", "shade"],
            "no layer \"shade\"",
        ),
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
        (&["bench", "photons", "--photons", "10,0"], "at least 1"),
        (&["bench", "photons", "--scene", "none.toml"], "none.toml"),
        (&["bench", "noise-bias", "--set", "nearst=9"], "nearest"),
        (&["bench", "noise-bias", "--set", "nearest=1"], "from 2 to"),
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
fn ids_win_over_files_and_a_dot_forces_the_file() {
    let dir = folder();
    fs::write(dir.path().join("jensen-box"), "no scene").unwrap();
    succeeds(dir.path(), &["info", "jensen-box"]);
    let output = lightscope(dir.path(), &["info", "./jensen-box"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
}

#[test]
fn a_log_does_not_replace_what_the_render_reads() {
    let folder = folder();
    let scene = folder.path().join("cornell.json");
    std::fs::copy(cornell(), &scene).expect("copied");
    let before = std::fs::read(&scene).expect("readable");
    let args = [
        "render",
        "cornell.json",
        "-o",
        "a.exr",
        "--log",
        "cornell.json",
    ];
    let output = lightscope(folder.path(), &args);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("the log would overwrite the scene, cornell.json"));
    assert_eq!(std::fs::read(&scene).expect("still there"), before);
    let args = ["render", "cornell.json", "-o", "a.exr", "--log", "a.exr"];
    let output = lightscope(folder.path(), &args);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("the log would overwrite the picture, a.exr"));
}

#[test]
fn a_mistyped_command_is_named_whatever_follows_it() {
    let folder = folder();
    for args in [
        &["rendr"][..],
        &["rendr", "cornell"],
        &["rendr", "-o", "a.png"],
    ] {
        let output = lightscope(folder.path(), args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        let said = stderr(&output);
        assert!(
            said.contains("did you mean \"render\"?"),
            "{args:?}: {said}"
        );
    }
}
