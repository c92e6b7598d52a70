//! The invariants of the code map, checked by reading the source.

use std::fs;
use std::path::{Path, PathBuf};

struct Source {
    /// Path below `src`, with `/`.
    path: String,
    text: String,
}

fn sources() -> Vec<Source> {
    fn collect(dir: &Path, files: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(dir).expect("a source folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                collect(&path, files);
            } else if path.extension().is_some_and(|e| e == "rs" || e == "wgsl") {
                files.push(path);
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    collect(&root, &mut files);
    files.sort();
    let read = |f: PathBuf| Source {
        path: f
            .strip_prefix(&root)
            .expect("below src")
            .to_string_lossy()
            .replace('\\', "/"),
        text: fs::read_to_string(&f).expect("readable"),
    };
    files.into_iter().map(read).collect()
}

/// Lines of code, comments and the tests at a file's end left out.
fn code_lines(source: &Source) -> impl Iterator<Item = (usize, &str)> {
    let code = source
        .text
        .lines()
        .take_while(|l| !l.starts_with("#[cfg(test)]"));
    code.enumerate()
        .map(|(i, l)| (i + 1, l))
        .filter(|(_, l)| !l.trim_start().starts_with("//"))
}

/// Every place in files that `within` accepts where a line contains one of `words`.
fn places(within: impl Fn(&str) -> bool, words: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    for source in sources().iter().filter(|s| within(&s.path)) {
        for (number, line) in code_lines(source) {
            if words.iter().any(|w| line.contains(w)) {
                found.push(format!("src/{}:{number}: {}", source.path, line.trim()));
            }
        }
    }
    found
}

fn assert_none(rule: &str, found: &[String]) {
    assert!(found.is_empty(), "{rule}:\n{}", found.join("\n"));
}

fn in_engine(path: &str) -> bool {
    path.starts_with("engine/")
}

#[test]
fn the_engine_knows_nothing_of_windows() {
    let words = ["wgpu", "egui", "winit", "crate::viewer", "crate::cli"];
    assert_none(
        "the engine names no window crate",
        &places(in_engine, &words),
    );
}

#[test]
fn obvhs_and_tobj_stay_where_they_are_wrapped() {
    let homes: [(&str, &[&str]); 2] = [
        ("obvhs", &["engine/geometry/accel.rs"]),
        ("tobj", &["engine/io/obj.rs", "engine/io/mtl_files.rs"]),
    ];
    for (word, homes) in homes {
        let words = [&*format!("{word}::"), &*format!("use {word}")];
        let others = places(|p| !homes.contains(&p), &words);
        assert_none(&format!("{word} is named in {homes:?} alone"), &others);
        for home in homes {
            let at_home = places(|p| p == *home, &words);
            assert!(
                !at_home.is_empty(),
                "{home} does not name {word}: this test looks at nothing"
            );
        }
    }
}

#[test]
fn the_engine_prints_nothing() {
    let words = ["println!", "eprintln!", "print!(", "eprint!(", "dbg!"];
    assert_none("no printing in the engine", &places(in_engine, &words));
}

#[test]
fn the_command_line_prints_where_a_closed_pipe_is_no_panic() {
    let within = |p: &str| p.starts_with("cli/") && p != "cli/print.rs";
    let words = ["println!", "print!(", "eprint!(", "dbg!"];
    assert_none(
        "the command line prints by `print` alone",
        &places(within, &words),
    );
}

#[test]
fn files_are_touched_in_io_alone() {
    let within = |p: &str| in_engine(p) && !p.starts_with("engine/io/");
    let words = [
        "std::fs",
        "File::open",
        "File::create",
        "fs::read",
        "fs::write",
    ];
    assert_none("no file access outside engine/io", &places(within, &words));
}

#[test]
fn clocks_are_read_in_session_and_measure_alone() {
    let within = |p: &str| {
        in_engine(p) && !p.starts_with("engine/session/") && !p.starts_with("engine/measure/")
    };
    let words = ["Instant::now", "SystemTime", "ProcessTime"];
    assert_none(
        "no clock outside session and measure",
        &places(within, &words),
    );
}

#[test]
fn the_viewer_sees_frames_and_never_films() {
    let within = |p: &str| p.starts_with("viewer/");
    let words = [
        "Film::",
        "film::Film,",
        "film::Film;",
        "PassBuffer",
        "engine::film::accumulator",
    ];
    assert_none("the viewer names no Film", &places(within, &words));
}

#[test]
fn random_numbers_come_from_the_samplers() {
    let words = [
        "rand::",
        "thread_rng",
        "from_entropy",
        "fastrand",
        "getrandom",
    ];
    assert_none("no other random numbers", &places(in_engine, &words));
}

#[test]
fn modules_use_only_what_stands_left_of_them() {
    const ORDER: &[&[&str]] = &[
        &["math"],
        &["sampling", "event"],
        &["geometry"],
        &["bsdf"],
        &["scene/desc", "scene/texture"],
        &["light", "media", "camera"],
        &["scene"],
        &["path"],
        &["photon"],
        &["plan"],
        &["film", "integrators"],
        &["session"],
        &["measure"],
        &["stability"],
    ];
    let rank = |path: &str| {
        ORDER.iter().enumerate().rev().find_map(|(rank, modules)| {
            let is = |m: &&&str| path == **m || path.starts_with(&format!("{m}/"));
            let found = modules.iter().find(is);
            // `scene/desc` stands apart from the rest of its folder.
            found
                .filter(|m| m.contains('/') || !special(path))
                .map(|_| rank)
        })
    };
    fn special(path: &str) -> bool {
        ["scene/desc", "scene/texture"].contains(&path)
    }
    let mut wrong = Vec::new();
    for source in sources().iter().filter(|s| in_engine(&s.path)) {
        let own = source.path["engine/".len()..].trim_end_matches(".rs");
        let own = own.trim_end_matches("/mod");
        let Some(own_rank) = rank(own) else { continue };
        for (number, line) in code_lines(source) {
            let Some((_, rest)) = line.split_once("crate::engine::") else {
                continue;
            };
            let used = rest.replace("::", "/");
            let used: String = used
                .chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_' || *c == '/')
                .collect();
            let used_rank = ["scene/desc", "scene/texture"]
                .iter()
                .find(|s| used.starts_with(**s))
                .map_or_else(|| rank(used.split('/').next().unwrap_or("")), |s| rank(s));
            if used_rank.is_some_and(|r| r > own_rank) {
                wrong.push(format!("src/{}:{number}: {}", source.path, line.trim()));
            }
        }
    }
    assert_none("a module uses only what stands left of it", &wrong);
}

#[test]
fn files_stay_short() {
    let long: Vec<String> = sources()
        .iter()
        .filter(|s| s.text.lines().count() > 500)
        .map(|s| format!("src/{}: {} lines", s.path, s.text.lines().count()))
        .collect();
    assert_none("a file has at most 500 lines", &long);
}
