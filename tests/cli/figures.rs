//! Results on standard output.

use super::support::{
    cornell, folder, json, lightscope, reference, render, stderr, stdout, succeeds,
};

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
fn integrators_are_compared_at_equal_time() {
    let dir = folder();
    let reference = reference("cornell-diffuse");
    let args = [
        "bench",
        "integrators",
        &reference,
        "--seconds",
        "0.3",
        "--integrators",
        "path,bdpt,whitted",
        "--json",
    ];
    let rows = json(dir.path(), &args);
    let rows = rows.as_array().unwrap();
    assert_eq!(rows.len(), 3);
    let figure = |row: &serde_json::Value, name: &str| row[name].as_f64().unwrap();
    for row in rows {
        assert!(figure(row, "t_wall") >= 0.3 && figure(row, "relmse") > 0.0);
    }
    let brightness = |i: usize| figure(&rows[i], "brightness");
    assert!((brightness(0) - 1.0).abs() < 0.1 && (brightness(1) - 1.0).abs() < 0.1);
    assert!(brightness(2) < 0.9, "Whitted finds no indirect light");
}

/// One render looked at twice, parameters of one algorithm, the bias that it reports, and a layer
/// of an expression.
#[test]
fn a_layer_is_compared_after_several_times() {
    let dir = folder();
    let at = dir.path();
    let ring = reference("caustic-ring");
    let args = [
        "bench",
        "integrators",
        &ring,
        "--layer",
        "caustic",
        "--seconds",
        "0.6,0.2",
        "--integrators",
        "photon,path",
        "--set",
        "photon.caustic-photons=20000",
        "--set",
        "photon.global-photons=20000",
        "--set",
        "photon.fresh-maps=on",
        "--bias-maps",
        "4",
    ];
    let rows = json(at, &[&args[..], &["--json"]].concat());
    let rows = rows.as_array().unwrap();
    assert_eq!(rows.len(), 4);
    let figure = |i: usize, name: &str| rows[i][name].as_f64().unwrap();
    assert!(figure(0, "seconds") == 0.2 && figure(1, "seconds") == 0.6);
    for i in [0, 2] {
        assert_eq!(rows[i]["integrator"], rows[i + 1]["integrator"]);
        assert!(figure(i, "t_wall") >= 0.2 && figure(i + 1, "t_wall") >= 0.6);
        assert!(figure(i + 1, "spp") >= figure(i, "spp"));
    }
    assert!(figure(3, "spp") > figure(2, "spp"));
    assert!(figure(0, "reported_bias") > 0.0 && rows[2]["reported_bias"].is_null());
    assert!((figure(1, "brightness") - 1.0).abs() < 0.2);
    let k = 1000.0 * figure(3, "relmse") * figure(3, "t_cpu");
    assert!((figure(3, "k") - k).abs() < 1e-9);
    let table = stdout(&succeeds(at, &args));
    for part in [
        "caustic",
        "caustic-ring, 0.2 s",
        "caustic-ring, 0.6 s",
        "its bias",
    ] {
        assert!(table.contains(part), "{part} in {table}");
    }

    let words = ["--size", "16x16", "--expression", "LDDE", "--spp", "4"];
    let scene = reference("cornell-diffuse/scene.json");
    succeeds(
        at,
        &[&["render", &scene, "-o", "words.exr"], &words[..]].concat(),
    );
    let pair = format!("{scene}=words.exr");
    let args = ["bench", "integrators", &pair, "--seconds", "0.2", "--json"];
    let more = ["--expression", "LDDE", "--integrators", "path"];
    let rows = json(at, &[&args[..], &more[..]].concat());
    assert_eq!(rows[0]["layer"], "LDDE");
    assert!((rows[0]["brightness"].as_f64().unwrap() - 1.0).abs() < 0.2);

    for (wrong, sentence) in [
        (["--layer", "caustics"], "there is no layer \"caustics\""),
        (
            ["--expression", "LDE"],
            "the reference has no layer \"LDE\"",
        ),
        (["--set", "sppm.radius=1"], "belongs to none of path"),
        (["--set", "path.radius=1"], "path: "),
        (["--bias-maps", "1"], "0 or a whole number"),
    ] {
        let args = [&args[..5], &["--integrators", "path"], &wrong[..]].concat();
        let output = lightscope(at, &args);
        assert_eq!(output.status.code(), Some(2), "{wrong:?}");
        assert!(stderr(&output).contains(sentence), "{}", stderr(&output));
    }
}
