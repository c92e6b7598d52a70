//! What is written.

use std::fs;

use super::support::{Exr, cornell, folder, json, lightscope, reference, render, stderr, succeeds};

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
fn a_pyramid_holds_every_strategy_and_adds_up() {
    let dir = folder();
    let at = dir.path();
    let bdpt = ["--integrator", "bdpt", "--spp", "4", "--max-depth", "2"];
    render(at, "whole.exr", &bdpt);
    render(
        at,
        "pyramid.exr",
        &[&bdpt[..], &["--pyramid", "4"]].concat(),
    );
    render(
        at,
        "pyramid.png",
        &[&bdpt[..], &["--pyramid", "4"]].concat(),
    );
    let (whole, exr) = (
        Exr::read(at.join("whole.exr")),
        Exr::read(at.join("pyramid.exr")),
    );
    // Paths of 2, 3 and 4 vertices have as many strategies, each two pictures of three channels.
    assert_eq!(exr.names().len(), (2 + 3 + 4) * 2 * 3);
    let of = |name: &str| exr.channel(name).iter().map(|x| f64::from(*x)).sum::<f64>();
    let names = exr.names();
    let weighted = names
        .iter()
        .filter(|n| n.starts_with("weighted.") && n.ends_with(".G"));
    let sum: f64 = weighted.map(|n| of(n)).sum();
    let expected: f64 = whole.channel("G").iter().map(|x| f64::from(*x)).sum();
    assert!((sum / expected - 1.0).abs() < 1e-4, "{sum} {expected}");
    assert!(of("unweighted.s2.t2.G") > of("weighted.s2.t2.G"));
    // Four columns twice by three rows of 16 × 16 pixels.
    let sheet = image::open(at.join("pyramid.png")).unwrap();
    assert_eq!((sheet.width(), sheet.height()), (128, 48));
}
