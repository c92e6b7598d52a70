//! References, reports, and what pictures say of their error.

use std::path::Path;

use serde_json::Value;

use super::support::{
    Exr, cornell, folder, json, lightscope, reference, render, stderr, stdout, succeeds,
};

fn read(path: &Path) -> Value {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn a_reference_knows_its_error_and_compare_reads_it() {
    let dir = folder();
    let at = dir.path();
    let scene = cornell();
    let size = ["--size", "24x24", "--spp", "4"];
    let args = ["reference", &scene, "-o", "ref24.exr", "--error", "0.3"];
    let output = succeeds(at, &[&args[..], &size].concat());
    assert!(
        stderr(&output).contains("standard error"),
        "{}",
        stderr(&output)
    );
    let (known, error) = (
        Exr::read(at.join("ref24.exr")),
        Exr::read(at.join("ref24_se.exr")),
    );
    assert_eq!(known.names(), error.names());
    assert!(known.names().contains(&"indirect.R"));
    let stated: f64 = known.text("lightscope:error").parse().expect("a number");
    let (mut squares, mut sum) = (0.0, 0.0);
    for name in ["R", "G", "B"] {
        squares += error
            .channel(name)
            .iter()
            .map(|e| f64::from(*e).powi(2))
            .sum::<f64>();
        sum += known
            .channel(name)
            .iter()
            .map(|x| f64::from(*x))
            .sum::<f64>();
    }
    let n = 3.0 * 24.0 * 24.0;
    let found = (squares / n).sqrt() / (sum / n);
    assert!(
        stated <= 0.3 && (found / stated - 1.0).abs() < 1e-4,
        "{found} {stated}"
    );
    assert!(
        known
            .text("lightscope:runs")
            .parse::<u64>()
            .expect("a number")
            >= 16
    );

    let args = ["render", &scene, "-o", "a.exr", "--components"];
    succeeds(at, &[&args[..], &size].concat());
    let rows = json(at, &["compare", "a.exr", "ref24.exr", "--json"]);
    for row in rows.as_array().expect("rows") {
        assert!(row["reference_noise"]["rmse"].is_number(), "{row}");
    }
}

#[test]
fn a_reference_that_cannot_be_made_in_time_is_a_failure() {
    let dir = folder();
    let at = dir.path();
    let scene = cornell();
    let args = [
        "reference",
        &scene,
        "-o",
        "r.exr",
        "--error",
        "1e-6",
        "--seconds",
        "0.2",
    ];
    let output = lightscope(at, &[&args[..], &["--size", "8x8", "--spp", "2"]].concat());
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(at.join("r.exr").exists() && at.join("r_se.exr").exists());
    let output = lightscope(at, &["reference", &scene, "-o", "r.png", "--error", "0.1"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_render_stops_at_its_error_and_every_format_says_it() {
    let dir = folder();
    let at = dir.path();
    for name in ["a.exr", "a.png", "a.hdr"] {
        render(at, name, &["--error", "0.4", "--max-depth", "3"]);
        let info = json(at, &["info", name, "--json"]);
        let text = |key: &str| {
            let text = info["attributes"][format!("lightscope:{key}")].as_str();
            text.unwrap_or_else(|| panic!("{name} says no {key}: {info}"))
                .to_owned()
        };
        let error: f64 = text("error").parse().expect("a number");
        let interval = text("error-interval");
        let ends: Vec<f64> = interval
            .split(' ')
            .map(|x| x.parse().expect("a number"))
            .collect();
        assert!(
            error <= 0.4 && ends[0] < error && error < ends[1],
            "{name}: {error} {interval}"
        );
        assert_eq!(
            (text("integrator"), text("max-depth")),
            ("path".to_owned(), "3".to_owned())
        );
        assert!(text("parameters").contains("mode=mis"));
        assert!(text("spp").parse::<u64>().expect("a number") >= 2);
        assert!(text("seconds").parse::<f64>().expect("a number") > 0.0);
        let printed = stdout(&succeeds(at, &["info", name]));
        assert!(printed.contains("lightscope:error-interval"), "{printed}");
    }
}

#[test]
fn regions_and_the_worst_pixels_are_told_apart() {
    let dir = folder();
    let at = dir.path();
    render(at, "a.exr", &["--spp", "1"]);
    render(at, "b.exr", &["--spp", "8"]);
    let of = |more: &[&str]| {
        let rows = json(
            at,
            &[&["compare", "a.exr", "b.exr", "--json"], more].concat(),
        );
        let row = &rows[0];
        let rmse = row["rmse"].as_f64().expect("a number");
        let most = row["without_worst"]["rmse"].as_f64().expect("a number");
        assert!(most < rmse, "{row}");
        rmse * rmse
    };
    let halves = of(&["--region", "0,0,16x8"]) + of(&["--region", "0,8,16x8"]);
    assert!((of(&[]) / (0.5 * halves) - 1.0).abs() < 1e-9);
    let beyond = lightscope(at, &["compare", "a.exr", "b.exr", "--region", "8,8,9x8"]);
    assert_eq!(beyond.status.code(), Some(2));
    assert!(
        stderr(&beyond).contains("reaches beyond"),
        "{}",
        stderr(&beyond)
    );
}

/// Arguments of a small report.
fn report(out: &str) -> Vec<String> {
    let (scene, reference) = (cornell(), reference("cornell-diffuse"));
    let args = [
        "report",
        &scene,
        "--integrators",
        "path,photon",
        "--set",
        "photon:indirect=direct",
        "--seconds",
        "0.6",
        "--seeds",
        "2",
        "--reference",
        &reference,
        "-o",
        out,
    ];
    args.map(str::to_owned).into()
}

fn as_str(args: &[String]) -> Vec<&str> {
    args.iter().map(String::as_str).collect()
}

/// (pass, rmse, estimate) of all runs, in their order.
fn errors(report: &Value) -> Vec<Vec<(u64, f64, Option<f64>)>> {
    let integrators = report["scenes"][0]["integrators"]
        .as_array()
        .expect("a list");
    let runs = integrators
        .iter()
        .flat_map(|i| i["runs"].as_array().expect("a list"));
    let point = |p: &Value| {
        let (pass, rmse) = (p["pass"].as_u64(), p["rmse"].as_f64());
        (
            pass.expect("a pass"),
            rmse.expect("an error"),
            p["estimate"].as_f64(),
        )
    };
    runs.map(|r| {
        r["points"]
            .as_array()
            .expect("points")
            .iter()
            .map(point)
            .collect()
    })
    .collect()
}

#[test]
fn two_reports_have_the_same_errors_and_one_that_was_cut_off_goes_on() {
    let dir = folder();
    let at = dir.path();
    for out in ["a", "b"] {
        succeeds(at, &as_str(&report(out)));
    }
    let (a, b) = (
        read(&at.join("a/report.json")),
        read(&at.join("b/report.json")),
    );
    let mut common = 0;
    for (a, b) in errors(&a).iter().zip(&errors(&b)) {
        for point in a {
            if let Some(other) = b.iter().find(|o| o.0 == point.0) {
                assert_eq!(point, other);
                common += 1;
            }
        }
    }
    assert!(common >= 16, "{common} passes in common");

    let html = std::fs::read_to_string(at.join("a/index.html")).expect("a page");
    for text in [
        "<svg",
        "data:image/png;base64,",
        "★",
        "seeds",
        "levels off",
        "photon",
    ] {
        assert!(html.contains(text), "{text} is not on the page");
    }
    // Nothing is fetched from anywhere.
    for text in ["http://", "https://", "<script", "<link", "url("] {
        let outside = html.replace("http://www.w3.org/", "");
        assert!(!outside.contains(text), "{text} is on the page");
    }
    let csv = std::fs::read_to_string(at.join("a/errors.csv")).expect("a table");
    let lines = errors(&a).iter().map(Vec::len).sum::<usize>() + 1;
    assert_eq!(csv.lines().count(), lines);

    // Cut off: one run is missing. It is made again, the others stay as they are.
    std::fs::remove_file(at.join("a/runs/cornell-diffuse--photon--1.json")).expect("a run");
    let kept = std::fs::read(at.join("a/runs/cornell-diffuse--path--0.json")).expect("a run");
    let output = succeeds(at, &as_str(&report("a")));
    assert!(
        stderr(&output).contains("3 of 4 are there already"),
        "{}",
        stderr(&output)
    );
    assert_eq!(
        std::fs::read(at.join("a/runs/cornell-diffuse--path--0.json")).expect("a run"),
        kept
    );
    // Other settings are other runs.
    let mut other = report("a");
    other.extend(["--max-depth".to_owned(), "2".to_owned()]);
    let output = succeeds(at, &as_str(&other));
    assert!(
        stderr(&output).starts_with("4 runs of"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn wrong_reports_are_refused_with_a_sentence() {
    let dir = folder();
    let at = dir.path();
    let scene = cornell();
    std::fs::create_dir(at.join("empty")).expect("a folder");
    let base = ["report", scene.as_str(), "--seconds", "1", "-o", "out"];
    for (more, says) in [
        (&["--integrators", "pth"][..], "did you mean \"path\"?"),
        (&["--integrators", "path,path"], "stands twice"),
        (&["--set", "mode=mis"], "ID:NAME=VALUE"),
        (
            &["--integrators", "path", "--set", "vcm:radius=1"],
            "not measured",
        ),
        (&["--reference", "empty"], "lightscope reference"),
        (&["--reference", "nowhere"], "no file or folder"),
        (&[scene.as_str()], "two scenes are called"),
    ] {
        let output = lightscope(at, &[&base[..], more].concat());
        assert_eq!(
            output.status.code(),
            Some(2),
            "{more:?}: {}",
            stderr(&output)
        );
        assert!(
            stderr(&output).contains(says),
            "{more:?}: {}",
            stderr(&output)
        );
        assert!(!at.join("out").exists());
    }
}
