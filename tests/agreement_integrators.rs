//! Integrators against `path` where no reference image exists: lenses, skies, lights of zero size,
//! shading normals, and the words that each of them can find.

mod support;

use std::sync::Arc;

use glam::Vec3;
use lightscope::engine::film::Frame;
use lightscope::engine::integrators::REGISTRY;
use lightscope::engine::io;
use lightscope::engine::scene::Scene;
use lightscope::engine::scene::desc::MeshDesc;
use lightscope::engine::session::RenderJob;
use support::reference::{assert_agree, runs_of};
use support::render::{job, load, reference_dir, render, scene_from_toml};

const WHOLE_AND_COMPONENTS: [(usize, usize); 5] = [(0, 0), (1, 1), (2, 2), (3, 3), (4, 4)];
/// The first typed expression.
const EXPR1: usize = 5;

/// A job with typed expressions.
fn with_expressions(mut job: RenderJob, texts: &[&str]) -> RenderJob {
    job.settings.layers.expressions = texts
        .iter()
        .map(|t| t.parse().expect("well-formed"))
        .collect();
    job
}

fn reference_scene(name: &str) -> Arc<Scene> {
    load(&reference_dir(name).join("scene.json"))
}

/// Every kind of material in a room of radius 4 or in the open, under `lights` and, if `lamp`, a
/// small sphere that shines.
fn things(camera: &str, room: bool, lamp: bool, lights: &str) -> String {
    let room = if room {
        r#"{ center = [0, 0, 0], radius = 4, material = "white", inward = true },"#
    } else {
        ""
    };
    let lamp = if lamp {
        r#"{ center = [0.5, 1.9, 0.5], radius = 0.5, material = "black", emission = [9, 8, 7] },"#
    } else {
        ""
    };
    format!(
        r#"
        camera = {{ position = [0, 0.3, 3.5], target = [0, 0, 0], vfov_deg = 50, width = 24, height = 16 {camera} }}
        spheres = [
            {room} {lamp}
            {{ center = [0, -4, 0], radius = 3, material = "white" }},
            {{ center = [-1.1, 0, 0], radius = 0.9, material = "glass" }},
            {{ center = [0.9, -0.3, 0.4], radius = 0.7, material = "coat" }},
            {{ center = [0.2, 0.7, -1.2], radius = 0.6, material = "satin" }},
            {{ center = [1.3, 1, -0.6], radius = 0.5, material = "frost" }},
        ]
        lights = [{lights}]
        [materials]
        black = {{ type = "diffuse", reflectance = [0, 0, 0] }}
        white = {{ type = "diffuse", reflectance = [0.7, 0.6, 0.5] }}
        glass = {{ type = "dielectric", ior = 1.5 }}
        coat = {{ type = "plastic", diffuse_reflectance = [0.7, 0.2, 0.2], ior = 1.5 }}
        metal = {{ type = "ggx_conductor", specular_reflectance = [0.9, 0.9, 0.9], alpha = 0.3 }}
        frost = {{ type = "rough_dielectric", ior = 1.5, alpha = 0.4 }}
        satin = {{ type = "mix", materials = ["white", "metal"], weight = 0.5 }}
        "#
    )
}

const LENS: &str = ", lens = { radius = 0.1, focus_distance = 3 }";
const POINT: &str = r#"{ type = "point", position = [0.5, 1.9, 0.5], intensity = [5, 5, 5] }"#;
const SUN: &str = r#"{ type = "directional", direction = [1, -2, -1], irradiance = [2, 2, 2] }"#;
const SKY: &str = r#"{ type = "constant", radiance = [0.3, 0.4, 0.5] }"#;

#[test]
fn bdpt_sees_through_a_lens_as_path_does() {
    let scene = scene_from_toml(&things(LENS, true, true, ""));
    let path = runs_of(job(&scene, "path", &[]), 128);
    let bdpt = runs_of(job(&scene, "bdpt", &[]), 24);
    assert_agree("bdpt with a lens", &bdpt, &path, &WHOLE_AND_COMPONENTS);
    // All but LE is found by light paths where no mirror is next to the lens.
    let light = runs_of(job(&scene, "light", &[]), 96);
    let found = [(1, 1), (3, 3), (4, 4)];
    assert_agree("light with a lens", &light, &bdpt, &found);
}

#[test]
fn lights_of_zero_size_agree_by_the_words_both_can_find() {
    for (name, lights, room) in [
        ("point", POINT, true),
        ("sun and sky", &*format!("{SUN}, {SKY}"), false),
    ] {
        let scene = scene_from_toml(&things("", room, false, lights));
        let both = ["L(D|G).*E", "L(D|G)E", "L(D|G).*(D|G)E", "L.*(D|G)E"];
        let runs =
            |id: &str, passes: u64| runs_of(with_expressions(job(&scene, id, &[]), &both), passes);
        let (path, bdpt, light) = (runs("path", 96), runs("bdpt", 24), runs("light", 96));
        // Path tracing misses LS.*E of point and sun, light tracing what ends on S.
        let by_path = [
            (EXPR1, EXPR1),
            (EXPR1 + 1, EXPR1 + 1),
            (EXPR1 + 2, EXPR1 + 2),
        ];
        assert_agree(&format!("bdpt under {name}"), &bdpt, &path, &by_path);
        let by_light = [
            (EXPR1 + 1, EXPR1 + 1),
            (EXPR1 + 2, EXPR1 + 2),
            (EXPR1 + 3, EXPR1 + 3),
        ];
        assert_agree(&format!("light under {name}"), &light, &bdpt, &by_light);
    }
}

/// A ball of few triangles with the normals of a sphere, under a lamp.
fn smooth_ball() -> Arc<Scene> {
    let text =
        things("", true, true, "").replace("center = [0.9, -0.3, 0.4]", "center = [9, 9, 9]");
    let mut desc = io::scene_file::from_toml(&text, "test.toml").unwrap_or_else(|e| panic!("{e}"));
    let (rows, columns) = (4, 6);
    let (mut positions, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..=rows {
        for column in 0..columns {
            let theta = std::f32::consts::PI * row as f32 / rows as f32;
            let phi = std::f32::consts::TAU * column as f32 / columns as f32;
            let n = Vec3::new(
                theta.sin() * phi.cos(),
                theta.cos(),
                theta.sin() * phi.sin(),
            );
            positions.push(Vec3::new(0.7, -0.2, 0.6) + 0.8 * n);
            normals.push(n);
            if row < rows {
                let (a, b) = (
                    row * columns + column,
                    row * columns + (column + 1) % columns,
                );
                let (c, d) = (a + columns, b + columns);
                triangles.push([a, b, c]);
                triangles.push([b, d, c]);
            }
        }
    }
    desc.meshes.push(MeshDesc {
        name: "ball".to_owned(),
        positions,
        normals,
        triangles,
        material: desc
            .materials
            .iter()
            .position(|m| m.name == "satin")
            .expect("a material"),
        ..MeshDesc::default()
    });
    Arc::new(Scene::build(&desc).unwrap_or_else(|e| panic!("{e}")))
}

#[test]
fn shading_normals_are_the_same_from_either_end() {
    let scene = smooth_ball();
    let path = runs_of(job(&scene, "path", &[]), 128);
    let bdpt = runs_of(job(&scene, "bdpt", &[]), 24);
    assert_agree("bdpt of a smooth ball", &bdpt, &path, &WHOLE_AND_COMPONENTS);
    let light = runs_of(job(&scene, "light", &[]), 96);
    let found = [(1, 1), (3, 3), (4, 4)];
    assert_agree("light of a smooth ball", &light, &bdpt, &found);
}

#[test]
fn single_strategies_agree_where_each_finds_all() {
    // Indirect light between diffuse surfaces is found by every strategy of its length.
    let scene = scene_from_toml(&things("", true, true, ""));
    let run = |strategies: &str, passes| {
        let job = job(&scene, "bdpt", &[("strategies", strategies)]);
        runs_of(with_expressions(job, &["LDDE"]), passes)
    };
    let all = run("all", 24);
    for one in ["0,4", "1,3", "2,2", "3,1"] {
        let alone = run(one, if one == "0,4" { 384 } else { 96 });
        assert_agree(&format!("bdpt {one}"), &alone, &all, &[(EXPR1, EXPR1)]);
    }
    let power = runs_of(job(&scene, "bdpt", &[("heuristic", "power")]), 16);
    let balance = runs_of(job(&scene, "bdpt", &[]), 16);
    assert_agree("power", &power, &balance, &WHOLE_AND_COMPONENTS);
}

const WHITTED: &str = "LDS*E|LGS*E|LS*E";

#[test]
fn whitted_finds_its_words_and_no_others() {
    for (name, passes) in [
        ("cornell-glass", 16),
        ("cornell-glossy", 32),
        ("furnace", 8),
        ("point-light", 8),
    ] {
        let scene = reference_scene(name);
        let path = runs_of(with_expressions(job(&scene, "path", &[]), &[WHITTED]), 32);
        let whitted = runs_of(
            with_expressions(job(&scene, "whitted", &[]), &[WHITTED]),
            passes,
        );
        let pairs = [(0, EXPR1), (EXPR1, EXPR1)];
        assert_agree(&format!("whitted {name}"), &whitted, &path, &pairs);
        // One draw of a lobe instead of all: the same mean.
        let set = [("branching", "0")];
        let drawn = runs_of(
            with_expressions(job(&scene, "whitted", &set), &[WHITTED]),
            passes,
        );
        assert_agree(
            &format!("whitted {name}, lobes drawn"),
            &drawn,
            &path,
            &pairs,
        );
    }
}

#[test]
fn monte_carlo_is_path_tracing_to_its_depth() {
    let scene = scene_from_toml(&things("", true, true, ""));
    let mut path = job(&scene, "path", &[]);
    path.settings.layers.max_depth = Some(2);
    let path = runs_of(path, 128);
    for mode in ["mis", "hits", "kajiya"] {
        let set = [("mode", mode), ("depth", "2"), ("rays", "4")];
        let passes = if mode == "hits" { 96 } else { 16 };
        let frames = runs_of(job(&scene, "monte-carlo", &set), passes);
        assert_agree(
            &format!("monte-carlo {mode}"),
            &frames,
            &path,
            &WHOLE_AND_COMPONENTS,
        );
        let levels = frames[0].stats.levels();
        assert!(levels.len() == 3 && levels[1] > 2 * levels[0] && levels[2] > 4 * levels[0]);
        assert_eq!(frames[0].stats.cut_trees, 0);
    }
    let cut = render(&job(&scene, "monte-carlo", &[("max-rays", "3")]), 1);
    assert!(cut.stats.cut_trees > 0 && cut.stats.levels().iter().sum::<u64>() <= 3 * 24 * 16);
}

#[test]
fn metropolis_has_the_mean_of_what_it_runs_over() {
    let scene = scene_from_toml(&things(LENS, true, true, ""));
    let path = runs_of(job(&scene, "path", &[]), 128);
    for over in ["path", "bdpt"] {
        let set = [("over", over), ("chains", "64"), ("bootstrap", "4096")];
        let passes = if over == "path" { 96 } else { 24 };
        let frames = runs_of(job(&scene, "pssmlt", &set), passes);
        assert_agree(
            &format!("pssmlt over {over}"),
            &frames,
            &path,
            &WHOLE_AND_COMPONENTS,
        );
        let acceptance = frames[0].stats.acceptance().expect("mutations");
        assert!((0.2..1.0).contains(&acceptance), "{acceptance}");
    }
}

#[test]
fn metropolis_without_light_is_black_and_says_so() {
    // The lamp is closed in: no path reaches the eye.
    let text = things("", true, true, "").replace(
        "spheres = [",
        r#"spheres = [ { center = [0.5, 1.9, 0.5], radius = 0.6, material = "white" },"#,
    );
    let scene = scene_from_toml(&text);
    let frame = render(&job(&scene, "pssmlt", &[("bootstrap", "256")]), 2);
    assert!(frame.layers[0].pixels.iter().flatten().all(|v| *v == 0.0));
    assert_eq!(frame.stats.dark_starts, 2);
}

/// Merging blurs: after 32 passes the radius is 0.4 % of the scene's, and what is compared are the
/// means of the picture, to within 2 % of the whole's mean and 4 standard errors.
#[test]
fn merging_tends_to_the_mean() {
    let scene = scene_from_toml(&things(LENS, true, true, ""));
    let path = runs_of(job(&scene, "path", &[]), 128);
    for (id, passes) in [("vcm", 16), ("sppm", 32)] {
        let frames = runs_of(job(&scene, id, &[("radius", "0.01")]), passes);
        for layer in 0..5 {
            let of = |f: &Frame| support::agreement::mean(&f.layers[layer].pixels);
            let n = frames.len() as f64;
            let moments = |frames: &[Frame]| {
                let m = frames.iter().map(of).sum::<f64>() / n;
                let v = frames.iter().map(|f| (of(f) - m).powi(2)).sum::<f64>() / (n - 1.0) / n;
                (m, v)
            };
            let ((a, va), (b, vb)) = (moments(&frames), moments(&path));
            let whole = support::reference::whole_mean(&path);
            println!("{id} layer {layer}: {a} against {b} ± {}", (va + vb).sqrt());
            assert!(
                (a - b).abs() < 0.02 * whole + 4.0 * (va + vb).sqrt(),
                "{id} layer {layer}: {a} against {b}"
            );
        }
    }
}

/// Sum over a partition minus the whole, relative to the whole's mean, at the worst pixel.
fn gap(frame: &Frame, layers: std::ops::Range<usize>) -> f64 {
    let mean = support::agreement::mean(&frame.layers[0].pixels);
    let mut worst: f64 = 0.0;
    for (i, whole) in frame.layers[0].pixels.iter().enumerate() {
        for (c, whole) in whole.map(f64::from).into_iter().enumerate() {
            let values = layers
                .clone()
                .map(|l| f64::from(frame.layers[l].pixels[i][c]));
            worst = worst.max((values.sum::<f64>() - whole).abs() / mean.max(whole));
        }
    }
    worst
}

const PARTITIONS: [&[&str]; 5] = [
    &["LE", "L.E", "L.{2,}E"],
    &["L.*DE", "L.*GE", "L.*SE", "LE"],
    &["LD.*E", "LG.*E", "LS.*E", "LE"],
    &["L(D|G)*E", "L(D|G)*S.*E"],
    &["L(D|S)*E", "L(D|S)*G(D|S)*E", "L(D|S)*G.*G.*E"],
];

#[test]
fn layers_add_up_to_the_whole_in_every_integrator() {
    let scene = scene_from_toml(&things("", true, true, ""));
    // Gathers, and records interpolated between, carry classes of their own.
    let gathers = ["gather", "cache"].map(|way| ("photon", vec![("indirect", way)]));
    let defaults = REGISTRY.iter().map(|entry| (entry.id, vec![]));
    for (id, set) in defaults.chain(gathers) {
        let base = job(&scene, id, &set);
        let frame = render(&base, 2);
        assert!(gap(&frame, 1..5) < 1e-5, "{id} {set:?}: components");
        for partition in PARTITIONS {
            let frame = render(&with_expressions(base.clone(), partition), 2);
            let off = gap(&frame, EXPR1..EXPR1 + partition.len());
            assert!(off < 1e-5, "{id} {set:?} {partition:?}: {off}");
        }
    }
}

#[test]
fn without_the_whole_the_layers_asked_for_stay_the_same() {
    let scene = scene_from_toml(&things("", true, true, ""));
    for entry in REGISTRY {
        let mut with = with_expressions(job(&scene, entry.id, &[]), &["LS+DE", "LD{1,2}E"]);
        with.settings.layers.components = false;
        let mut without = with.clone();
        without.settings.layers.no_whole = true;
        let (with, without) = (render(&with, 16), render(&without, 16));
        for layer in [EXPR1, EXPR1 + 1] {
            let mean = support::agreement::mean(&with.layers[layer].pixels);
            let lost = entry.id == "whitted" && layer == EXPR1;
            assert!(mean > 0.0 || lost, "{} {layer}", entry.id);
            // Chains are distributed by what they compute, so that they take other ways.
            if entry.id != "pssmlt" {
                assert!(
                    with.layers[layer].pixels == without.layers[layer].pixels,
                    "{}",
                    entry.id
                );
            }
        }
        assert!(without.stats.rays <= with.stats.rays, "{}", entry.id);
    }
}
