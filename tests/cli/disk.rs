//! Disks that are full, files that must not be read or written, and files that go away: the old
//! file survives, one sentence says what happened, and the exit code is right.

use std::fs;
use std::path::Path;
use std::process::Output;

use crate::support::{cornell, folder, lightscope, stderr, succeeds};

/// The one line that is an error.
fn sentence(output: &Output) -> String {
    let text = stderr(output);
    let errors: Vec<&str> = text.lines().filter(|l| l.starts_with("error: ")).collect();
    assert_eq!(errors.len(), 1, "one error:\n{text}");
    assert!(!text.contains("panicked"), "{text}");
    errors[0].to_owned()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> = entries
        .map(|e| {
            e.expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    names
}

/// Runs the program where no file may grow beyond `blocks` of 512 bytes, as on a full disk.
#[cfg(unix)]
fn on_a_full_disk(folder: &Path, blocks: u32, args: &[&str]) -> Output {
    use std::process::{Command, Stdio};
    // Without its signal the limit is an error of the write, as a full disk is.
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\"");
    let mut command = Command::new("bash");
    command
        .args([
            "--posix",
            "-c",
            &script,
            "bash",
            env!("CARGO_BIN_EXE_lightscope"),
        ])
        .args(args)
        .current_dir(folder)
        .stdin(Stdio::null());
    command.output().expect("bash starts")
}

#[cfg(unix)]
#[test]
fn on_a_full_disk_the_old_picture_survives() {
    let dir = folder();
    let (at, scene) = (dir.path(), cornell());
    for name in ["a.exr", "a.png", "a.hdr"] {
        let path = at.join(name);
        fs::write(&path, "old").expect("an old file");
        let size = ["--size", "64x64", "--spp", "1"];
        let args = [&["render", &scene, "-o", name][..], &size].concat();
        let output = on_a_full_disk(at, 4, &args);
        assert_eq!(output.status.code(), Some(1), "{name}: {}", stderr(&output));
        let said = sentence(&output);
        assert!(
            said.contains(name) && said.contains("cannot be written"),
            "{said}"
        );
        assert_eq!(fs::read(&path).expect("still there"), b"old", "{name}");
        assert_eq!(names(at), [name], "nothing is left over");
        // With room it is replaced.
        succeeds(at, &args);
        assert!(fs::read(&path).expect("there").len() > 2048);
        fs::remove_file(&path).expect("removed");
    }
}

#[cfg(unix)]
#[test]
fn on_a_full_disk_a_reference_and_a_report_fail_with_a_sentence() {
    let dir = folder();
    let (at, scene) = (dir.path(), cornell());
    fs::write(at.join("ref.exr"), "old").expect("an old file");
    let size = ["--size", "32x32", "--spp", "1", "--error", "10"];
    let args = [&["reference", &scene, "-o", "ref.exr"][..], &size].concat();
    let output = on_a_full_disk(at, 4, &args);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(sentence(&output).contains("cannot be written"));
    assert_eq!(fs::read(at.join("ref.exr")).expect("still there"), b"old");
    assert_eq!(names(at), ["ref.exr"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_log_or_standard_output_is_told() {
    let dir = folder();
    let (at, scene) = (dir.path(), cornell());
    let size = ["--size", "16x16", "--spp", "2"];
    let log = ["render", &scene, "-o", "a.exr", "--log", "/dev/full"];
    let output = lightscope(at, &[&log[..], &size].concat());
    assert_eq!(output.status.code(), Some(1));
    assert!(sentence(&output).contains("/dev/full cannot be written"));

    let full = fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .expect("it opens");
    let json = ["render", &scene, "-o", "b.exr", "--json"];
    let output = crate::support::command(at, &[&json[..], &size].concat())
        .stdout(full)
        .output()
        .expect("the program starts");
    assert_eq!(output.status.code(), Some(1));
    assert!(sentence(&output).contains("standard output cannot be written"));
    assert!(at.join("b.exr").exists(), "the picture was written before");
}

#[test]
fn a_read_only_picture_is_found_before_rendering() {
    let dir = folder();
    let (at, scene) = (dir.path(), cornell());
    let path = at.join("a.exr");
    fs::write(&path, "old").expect("an old file");
    let mut rights = fs::metadata(&path).expect("there").permissions();
    rights.set_readonly(true);
    fs::set_permissions(&path, rights).expect("made read-only");
    let args = ["render", &scene, "-o", "a.exr", "--seconds", "1000"];
    let output = lightscope(at, &args);
    assert_eq!(output.status.code(), Some(1));
    let said = sentence(&output);
    assert!(
        said.contains("a.exr") && said.contains("read-only"),
        "{said}"
    );
    assert_eq!(fs::read(&path).expect("still there"), b"old");
}

#[cfg(unix)]
#[test]
fn what_must_not_be_read_is_named() {
    use std::os::unix::fs::PermissionsExt;
    let dir = folder();
    let at = dir.path();
    let scene = "camera = { position = [0, 0, 5], target = [0, 0, 0] }\n\
                 [materials]\nwhite = { type = \"diffuse\", reflectance = 0.5 }\n\
                 [[meshes]]\nfile = \"a.obj\"\nmaterial = \"white\"\n";
    fs::write(at.join("a.toml"), scene).expect("a scene");
    fs::write(at.join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("a mesh");
    succeeds(at, &["info", "a.toml"]);
    let forbid = |name: &str| {
        let path = at.join(name);
        fs::set_permissions(&path, fs::Permissions::from_mode(0o000)).expect("rights");
        // The administrator may read everything.
        fs::read(&path).is_err()
    };
    if forbid("a.obj") {
        let output = lightscope(at, &["info", "a.toml"]);
        assert_eq!(output.status.code(), Some(2));
        let said = sentence(&output);
        assert!(said.contains("a.obj: it must not be read"), "{said}");
    }
    if forbid("a.toml") {
        let output = lightscope(at, &["info", "a.toml"]);
        assert_eq!(output.status.code(), Some(2));
        let said = sentence(&output);
        assert!(said.contains("a.toml: it cannot be read"), "{said}");
    }
    // A folder in a file's place cannot be read by anybody.
    for (name, what) in [("a.obj", "a.toml"), ("a.toml", "a.toml")] {
        fs::remove_file(at.join(name)).expect("removed");
        fs::create_dir(at.join(name)).expect("a folder");
        if name == "a.obj" {
            fs::set_permissions(at.join(what), fs::Permissions::from_mode(0o644)).expect("rights");
        }
        let output = lightscope(at, &["info", what]);
        assert_eq!(output.status.code(), Some(2));
        let said = sentence(&output);
        assert!(
            said.contains(name) && said.contains("it is a folder"),
            "{said}"
        );
    }
}

/// Starts a render of some seconds, takes `away` what it needs, and waits for its end.
#[cfg(unix)]
fn meanwhile(folder: &Path, args: &[&str], log: &Path, away: impl FnOnce()) -> Output {
    use std::process::Stdio;
    use std::time::{Duration, Instant};
    let child = crate::support::command(folder, args)
        .stderr(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let started = Instant::now();
    while fs::read_to_string(log).map_or(0, |text| text.lines().count()) < 2 {
        assert!(
            started.elapsed() < Duration::from_secs(60),
            "no pass was logged"
        );
        std::thread::sleep(Duration::from_millis(10));
    }
    away();
    child.wait_with_output().expect("it ends")
}

#[cfg(unix)]
#[test]
fn files_that_go_away_while_rendering_cost_no_more_than_they_must() {
    let dir = folder();
    let at = dir.path();
    // The scene and its meshes were read; nothing needs them again.
    let scene = at.join("scene");
    fs::create_dir(&scene).expect("a folder");
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/cornell-diffuse");
    for entry in fs::read_dir(from).expect("the reference scene") {
        let path = entry.expect("an entry").path();
        let small = path.extension().is_some_and(|e| e == "json" || e == "obj");
        if small {
            fs::copy(&path, scene.join(path.file_name().expect("a name"))).expect("copied");
        }
    }
    let log = at.join("a.jsonl");
    let render = [
        "render",
        "scene/scene.json",
        "--size",
        "16x16",
        "--seconds",
        "2",
        "--log",
    ];
    let args = [&render[..], &["a.jsonl", "-o", "a.exr"]].concat();
    let output = meanwhile(at, &args, &log, || {
        fs::remove_dir_all(&scene).expect("removed");
    });
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(at.join("a.exr").exists() && !scene.exists());

    // The folder that the picture was to be written into.
    let (out, scene) = (at.join("out"), cornell());
    fs::create_dir(&out).expect("a folder");
    fs::remove_file(&log).expect("removed");
    let args = [
        "render",
        &scene,
        "-o",
        "out/a.exr",
        "--size",
        "16x16",
        "--seconds",
        "2",
    ];
    let output = meanwhile(
        at,
        &[&args[..], &["--log", "a.jsonl"]].concat(),
        &log,
        || {
            fs::remove_dir_all(&out).expect("removed");
        },
    );
    assert_eq!(output.status.code(), Some(1));
    let said = sentence(&output);
    assert!(said.contains("out/a.exr cannot be written"), "{said}");
    assert!(!out.exists());
}

#[test]
fn a_sequence_without_a_frame_keeps_the_frames_before_it() {
    let dir = folder();
    let at = dir.path();
    let scene = "frames = 3\ncamera = { position = [0, 0, 5], target = [0, 0, 0] }\n\
                 [materials]\nwhite = { type = \"diffuse\", reflectance = 0.5 }\n\
                 [[meshes]]\nfile = \"a-{frame}.obj\"\nmaterial = \"white\"\n";
    fs::write(at.join("a.toml"), scene).expect("a scene");
    for frame in 0..2 {
        let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        fs::write(at.join(format!("a-{frame}.obj")), mesh).expect("a mesh");
    }
    let args = [
        "render", "a.toml", "-o", "f#.png", "--frames", "all", "--size", "8x8", "--spp", "1",
    ];
    let output = lightscope(at, &args);
    assert_eq!(output.status.code(), Some(2));
    let said = sentence(&output);
    assert!(said.contains("there is no such file"), "{said}");
    let pictures: Vec<String> = names(at)
        .into_iter()
        .filter(|n| n.ends_with("png"))
        .collect();
    assert_eq!(pictures, ["f0.png", "f1.png"]);
}
