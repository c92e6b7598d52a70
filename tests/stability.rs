//! The command `stability`: some of its cases, its arguments, and what it writes. All cases run by
//! `lightscope stability --quick`, which takes minutes.

use std::process::{Command, Output};

use lightscope::engine::stability::{self, Depth, Fit, Outcome, case::ENGINE};

/// Cases of a few seconds together, some of each kind.
const AFFORDABLE: [&str; 12] = [
    "furnace-object",
    "furnace-ggx",
    "point-falloff",
    "refraction-radiance",
    "beer-lambert",
    "axis-rays",
    "degenerate-mesh",
    "thin-shell",
    "random-ends",
    "photon-estimate",
    "accumulate",
    "layers",
];

#[test]
fn affordable_cases_hold() {
    let cases = stability::cases();
    for id in AFFORDABLE {
        let case = cases.iter().find(|c| c.id == id).expect("a case");
        let mut outcomes: Vec<Outcome> = Vec::new();
        stability::run(case, &[], Depth::Quick, &mut |outcome| {
            outcomes.push(outcome)
        });
        assert!(outcomes.iter().any(|o| !o.points.is_empty()), "{id}");
        for outcome in outcomes {
            let failed = outcome.points.iter().find(|p| p.fails());
            assert!(failed.is_none(), "{id}, {}: {failed:?}", outcome.subject);
        }
    }
}

#[test]
fn every_case_asks_somebody_and_says_why_not() {
    let cases = stability::cases();
    for case in &cases {
        let same = cases.iter().filter(|c| c.id == case.id).count();
        assert_eq!(same, 1, "{} stands twice", case.id);
        let ids = lightscope::engine::integrators::REGISTRY
            .iter()
            .map(|e| e.id);
        let mut asked = usize::from(matches!((case.fit)(ENGINE), Fit::Asked(_)));
        for id in ids {
            match (case.fit)(id) {
                Fit::Asked(variants) => asked += variants.len(),
                Fit::LeftOut(why) => assert!(!why.is_empty(), "{} without {id}", case.id),
            }
        }
        assert!(asked > 0, "{} asks nobody", case.id);
    }
}

fn lightscope(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lightscope"))
        .args(args)
        .output()
        .expect("the program runs")
}

#[test]
fn unknown_ids_are_wrong_input_with_a_suggestion() {
    for (args, meant) in [
        (["stability", "--case", "furnace-obj"], "furnace-object"),
        (["stability", "--integrator", "pth"], "path"),
    ] {
        let output = lightscope(&args);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(
            said.contains(&format!("did you mean \"{meant}\"?")),
            "{said}"
        );
    }
}

#[test]
fn the_result_is_one_json_value_and_one_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("out");
    let shown = path.to_string_lossy();
    let output = lightscope(&[
        "stability",
        "--case",
        "point-falloff,thin-shell",
        "--integrator",
        "path",
        "--json",
        "-o",
        &shown,
    ]);
    assert_eq!(output.status.code(), Some(0));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one JSON value");
    let cases = json["cases"].as_array().expect("cases");
    assert_eq!((cases.len(), json["holds"].as_bool()), (2, Some(true)));
    let first = &cases[0]["outcomes"][0];
    assert_eq!(first["subject"], "path mis");
    assert!(
        first["points"][0]["exact"]
            .as_f64()
            .is_some_and(|x| x > 0.0)
    );
    let page = std::fs::read_to_string(path.join("index.html")).expect("a page");
    assert!(page.contains("<svg") && page.contains("id=\"thin-shell\""));
    assert!(!page.contains("src=") && !page.contains("href=\"http"));
}

#[test]
fn cases_are_listed() {
    let output = lightscope(&["list", "cases", "--json"]);
    let rows: Vec<serde_json::Value> = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(rows.len(), stability::cases().len());
    assert!(
        rows.iter()
            .all(|r| r["oracle"].is_string() && r["asked"].is_array())
    );
}
