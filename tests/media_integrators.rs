//! Every integrator that renders participating media against path tracing, and the references.

mod support;

use std::sync::Arc;

use lightscope::engine::integrators::{self, REGISTRY};
use lightscope::engine::scene::Scene;
use lightscope::engine::session::RenderJob;
use support::reference::{assert_agree, runs_of};
use support::render::{job, scene_from_toml};
use support::volumes::{HOMOGENEOUS, agrees_with_reference, smoky_room};

/// The first typed expression.
const EXPR1: usize = 5;

fn with_expressions(mut job: RenderJob, texts: &[&str]) -> RenderJob {
    let parsed = texts.iter().map(|t| t.parse().expect("well-formed"));
    job.settings.layers.expressions = parsed.collect();
    job
}

/// Light tracing alone is left out: with the eye within the fog the places next to it bring 1/r²,
/// whose variance is infinite.
#[test]
fn both_walks_agree_with_the_fog_references() {
    for scene in ["fog-isotropic", "fog-hg"] {
        agrees_with_reference(scene, "bdpt", &[], 4);
        agrees_with_reference(scene, "vcm", &[("radius", "1e-6")], 4);
    }
}

/// Words of a room with glass, metal and smoke of uneven colour, of one density and of a grid.
#[test]
fn both_walks_agree_with_path_tracing_in_a_smoky_room() {
    let words = ["L.*VE", "LVE", "LS+VE", "LV.*DE", "L(D|V|G)+E"];
    let grid = r#"type = "grid", file = "constant.txt", sigma_t_scale = [0.2, 0.6, 1.0]"#;
    for (name, medium) in [("smoke", HOMOGENEOUS), ("grid", grid)] {
        let scene = smoky_room(medium);
        let run = |id: &str, set: &[(&str, &str)], passes| {
            runs_of(with_expressions(job(&scene, id, set), &words), passes)
        };
        let (path, bdpt) = (run("path", &[], 160), run("bdpt", &[], 32));
        let all = [0, 1, 2, 4, 5, 6, 8, 9].map(|i| (i, i));
        assert_agree(&format!("bdpt, {name}"), &bdpt, &path, &all);
        // Caustics through glass are found by chance from the eye, by light paths easily.
        let light = run("light", &[], 128);
        let diffuse = [3, 4, 5, 6, 7, 8, 9].map(|i| (i, i));
        assert_agree(&format!("light, {name}"), &light, &bdpt, &diffuse);
        let set = [("chains", "64"), ("bootstrap", "4096")];
        let chains = run("pssmlt", &set, 64);
        assert_agree(
            &format!("pssmlt, {name}"),
            &chains,
            &bdpt,
            &[(0, 0), (4, 4), (5, 5)],
        );
    }
}

fn open_air(light: &str, region: &str) -> Arc<Scene> {
    scene_from_toml(&format!(
        r#"
        camera = {{ position = [0, 0.6, 3.5], target = [0, 0, 0], vfov_deg = 50, width = 24, height = 16 }}
        materials.white = {{ type = "diffuse", reflectance = [0.7, 0.6, 0.5] }}
        materials.glass = {{ type = "dielectric", ior = 1.5 }}
        spheres = [
            {{ center = [0, -4, 0], radius = 3, material = "white" }},
            {{ center = [-0.8, 0, 0], radius = 0.7, material = "glass", interior = "vacuum", priority = 1 }},
            {{ center = [0.9, -0.3, 0.4], radius = 0.5, material = "white" }},
        ]
        lights = [{light}]
        medium = {{ type = "homogeneous", sigma_t = [0.1, 0.2, 0.3], albedo = 0.9, {region} }}
        "#
    ))
}

/// Lights of zero size and at infinity, media that end with a box and with the scene, by the words
/// that both can find.
#[test]
fn lights_of_every_kind_agree() {
    let point = r#"{ type = "point", position = [0.3, 1.6, 0.5], intensity = [5, 4, 3] }"#;
    let spot = r#"{ type = "spot", position = [0.3, 1.9, 0.5], direction = [0, -1, 0], intensity = [9, 9, 9], angle_deg = 30, falloff_deg = 5 }"#;
    let sun = r#"{ type = "directional", direction = [1, -2, -1], irradiance = [2, 2, 2] }"#;
    let sky = r#"{ type = "constant", radiance = [0.3, 0.4, 0.5] }"#;
    let everywhere = r#"region = "everywhere""#;
    let boxed = "region = { min = [-1.7, -1.2, -1.2], max = [1.6, 1.5, 1.3] }";
    let words = ["L(D|V).*E", "L(D|V).*VE", "L.*(D|V)E", "LVE"];
    for (name, light, region) in [
        ("point", point.to_owned(), everywhere),
        ("spot", spot.to_owned(), boxed),
        ("sun and sky", format!("{sun}, {sky}"), everywhere),
        ("sun and sky", format!("{sun}, {sky}"), boxed),
    ] {
        let scene = open_air(&light, region);
        let run = |id: &str, passes| {
            println!("{id}, {name}, {region}");
            runs_of(with_expressions(job(&scene, id, &[]), &words), passes)
        };
        let (path, bdpt, light) = (run("path", 128), run("bdpt", 32), run("light", 160));
        let of = |layers: &[usize]| -> Vec<(usize, usize)> {
            layers.iter().map(|i| (EXPR1 + i, EXPR1 + i)).collect()
        };
        assert_agree(
            &format!("bdpt, {name}, {region}"),
            &bdpt,
            &path,
            &of(&[0, 1, 3]),
        );
        assert_agree(
            &format!("light, {name}, {region}"),
            &light,
            &bdpt,
            &of(&[1, 2, 3]),
        );
    }
}

/// Light that smoke itself gives, in smoke that scatters.
#[test]
fn light_of_media_agrees() {
    let glow = r#"type = "grid", file = "constant.txt", sigma_t_scale = [0.2, 0.6, 1.0], emission = [0.3, 0.2, 0.1]"#;
    let even = r#"type = "homogeneous", sigma_t = [0.3, 0.9, 1.5], emission = [0.45, 0.3, 0.15]"#;
    let run = |medium: &str, id: &str, passes| runs_of(job(&smoky_room(medium), id, &[]), passes);
    let even_path = run(even, "path", 96);
    let all = [(0, 0), (1, 1), (4, 4)];
    assert_agree("glowing grid", &run(glow, "path", 96), &even_path, &all);
    assert_agree("bdpt, glow", &run(even, "bdpt", 32), &even_path, &all);
    let dark = run(HOMOGENEOUS, "path", 4);
    let mean = support::reference::whole_mean;
    assert!(mean(&even_path) > 1.1 * mean(&dark));
}

#[test]
fn integrators_without_media_say_so() {
    let scene = smoky_room(HOMOGENEOUS);
    for entry in REGISTRY {
        let refusal = entry.refusal(&scene.features);
        assert_eq!(refusal.is_none(), entry.media, "{}", entry.id);
        if let Some(why) = refusal {
            assert!(why.contains("path, ") && why.starts_with(entry.id), "{why}");
        }
    }
    assert!(integrators::find("path").is_some_and(|e| e.media));
}
