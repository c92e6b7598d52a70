//! Pictures of participating media against closed forms and the references of an independent
//! renderer.

mod support;

use std::f64::consts::PI;
use std::sync::Arc;

use lightscope::engine::film::Frame;
use lightscope::engine::scene::Scene;
use lightscope::engine::session::RenderJob;
use lightscope::engine::stability::oracles::chandrasekhar_h;
use support::agreement::mean;
use support::reference::{assert_agree, runs_of};
use support::render::{job, render, scene_from_toml};
use support::volumes::{HOMOGENEOUS, agrees_with_reference, smoky_room};

const RUNS: u64 = 16;
/// No roulette: where nothing is absorbed, nothing needs to end early.
const NO_ROULETTE: (&str, &str) = ("roulette", "10000000");

/// Mean of the whole over the picture, and its standard error.
fn estimate(scene: &Arc<Scene>, set: &[(&str, &str)], passes: u64) -> (f64, f64) {
    let mut job = job(scene, "path", set);
    let runs: Vec<f64> = (0..RUNS)
        .map(|seed| {
            job.settings.seed = seed;
            mean(&sound(&job, passes).layers[0].pixels)
        })
        .collect();
    let n = RUNS as f64;
    let mean = runs.iter().sum::<f64>() / n;
    let squares: f64 = runs.iter().map(|r| (r - mean).powi(2)).sum();
    (mean, (squares / (n - 1.0) / n).sqrt())
}

/// A render in which nothing went wrong.
fn sound(job: &RenderJob, passes: u64) -> Frame {
    let frame = render(job, passes);
    assert_eq!(frame.stats.non_finite(), 0);
    assert_eq!(frame.stats.exceeded_majorants, 0);
    assert_eq!(frame.stats.cut_paths, 0);
    frame
}

/// `found` lies within 4.5 standard errors of `exact`, and those are below the share `sharp`.
fn assert_near(what: &str, (found, error): (f64, f64), exact: f64, sharp: f64) {
    assert!(error <= sharp * exact, "{what}: error {error} of {exact}");
    assert!(
        (found - exact).abs() <= 4.5 * error + 2e-5 * exact,
        "{what}: {found}, not {exact}, error {error}"
    );
}

fn assert_every_pixel(what: &str, frame: &Frame, exact: f64, tolerance: f64) {
    for pixel in &frame.layers[0].pixels {
        let off = (f64::from(pixel[0]) - exact).abs();
        assert!(off <= tolerance * exact, "{what}: {pixel:?}, not {exact}");
    }
}

const SKY: &str = r#"{ type = "constant", radiance = [1, 1, 1] }"#;

/// A view along −z from z = 5, and what else there is.
fn along_z(rest: &str) -> Arc<Scene> {
    scene_from_toml(&format!(
        r#"
        camera = {{ position = [0, 0, 5], target = [0, 0, 0], vfov_deg = 0.01, width = 4, height = 4 }}
        {rest}
        "#
    ))
}

/// An absorbing slab of thickness 1 before the sky.
#[test]
fn beer_lambert() {
    for exponent in -9..=4 {
        let tau = 10_f64.powi(exponent);
        let scene = along_z(&format!(
            r#"
            lights = [{SKY}]
            medium = {{ type = "homogeneous", sigma_t = {tau}, albedo = 0,
                        region = {{ min = [-9, -9, -0.5], max = [9, 9, 0.5] }} }}
            "#
        ));
        let frame = sound(&job(&scene, "path", &[]), 2);
        if tau > 80.0 {
            // Below the smallest f32 of full precision.
            let dark = |x: f32| (0.0..1e-37).contains(&x);
            assert!(frame.layers[0].pixels.iter().flatten().all(|x| dark(*x)));
            continue;
        }
        // The slab's faces are known to f32, and so is its thickness.
        assert_every_pixel(
            &format!("τ = {tau}"),
            &frame,
            (-tau).exp(),
            1e-5 + 3e-7 * tau,
        );
    }
}

/// Overlapping interiors: the higher priority is there, of equal ones the later, and vacuum is one
/// as well. What is seen and what shadow rays bring passes the same.
#[test]
fn interiors_overlap_by_priority() {
    let balls = |a: i32, b: i32| {
        format!(
            r#"
            materials.white = {{ type = "diffuse", reflectance = 0.5 }}
            media.thin = {{ type = "homogeneous", sigma_t = 0.3, albedo = 0 }}
            media.thick = {{ type = "homogeneous", sigma_t = 0.7, albedo = 0 }}
            spheres = [
                {{ center = [0, 0, 0], radius = 2, material = "none", interior = "thin", priority = {a} }},
                {{ center = [0, 0, 1], radius = 2, material = "none", interior = "thick", priority = {b} }},
                {{ center = [0, 0, 1], radius = 0.5, material = "none", interior = "vacuum", priority = 9 }},
            ]
            "#
        )
    };
    // Along z: thin in [−2, 2], thick in [−1, 3], nothing in [½, 1½].
    for (a, b, tau) in [
        (0, 1, 0.3 + 0.7 * 3.0_f64),
        (0, 0, 0.3 + 0.7 * 3.0),
        (1, 0, 0.3 * 3.0 + 0.7),
    ] {
        let scene = along_z(&format!("lights = [{SKY}]\n{}", balls(a, b)));
        let frame = sound(&job(&scene, "path", &[]), 2);
        assert_every_pixel("overlap", &frame, (-tau).exp(), 1e-5);
        // From within, at z = 2.5, where the thick one is.
        let within = format!(
            r#"
            camera = {{ position = [0, 0, 2.5], target = [0, 0, 0], vfov_deg = 0.01, width = 4, height = 4 }}
            lights = [{SKY}]
            {}
            "#,
            balls(a, b)
        );
        let tau = tau - 0.7 * 0.5;
        let frame = sound(&job(&scene_from_toml(&within), "path", &[]), 2);
        assert_every_pixel("from within", &frame, (-tau).exp(), 1e-5);
    }

    // A lamp at z = 4 seen by a wall at z = −4 through all of them: the wall is ½/π · I/64.
    let scene = along_z(&format!(
        r#"
        lights = [{{ type = "point", position = [0, 0, 4], intensity = [1, 1, 1] }}]
        {}
        "#,
        balls(0, 1).replace(
            "spheres = [",
            r#"spheres = [ { center = [0, 0, -104], radius = 100, material = "white" },"#
        )
    ));
    let tau = 0.3 + 0.7 * 3.0_f64;
    let exact = 0.5 / PI / 64.0 * (-2.0 * tau).exp();
    let frame = sound(&job(&scene, "path", &[]), 1);
    assert_every_pixel("shadow rays", &frame, exact, 1e-4);
}

/// A medium everywhere under a sky ends at the ball around the scene; without one it does not.
#[test]
fn a_medium_everywhere_ends_where_the_scene_does() {
    let scene = along_z(&format!(
        r#"
        lights = [{SKY}]
        materials.none = {{ type = "diffuse", reflectance = 0, opacity = 0 }}
        spheres = [{{ center = [0, 0, 0], radius = 1, material = "none" }}]
        medium = {{ type = "homogeneous", region = "everywhere", sigma_t = 0.25, albedo = 0 }}
        "#
    ));
    let (_, radius) = scene.geometry.bounding_sphere();
    let frame = sound(&job(&scene, "path", &[]), 1);
    let exact = (-0.25 * 2.0 * f64::from(radius)).exp();
    assert_every_pixel("ball", &frame, exact, 1e-5);

    let scene = along_z(
        r#"
        medium = { type = "homogeneous", region = "everywhere", sigma_t = 0.25, albedo = 0,
                   emission = 3 }
        "#,
    );
    assert_every_pixel(
        "endless glow",
        &sound(&job(&scene, "path", &[]), 1),
        12.0,
        1e-5,
    );
}

/// ε/σ (1 − exp(−σ d)), and ε d without extinction.
#[test]
fn a_shining_slab() {
    for (sigma, exact) in [
        (0.0, 2.0),
        (1e-6, 2.0),
        (0.5, 4.0 * (1.0 - (-0.5_f64).exp())),
    ] {
        let scene = along_z(&format!(
            r#"
            medium = {{ type = "homogeneous", sigma_t = {sigma}, albedo = 0, emission = 2,
                        region = {{ min = [-9, -9, -0.5], max = [9, 9, 0.5] }} }}
            "#
        ));
        let frame = sound(&job(&scene, "path", &[]), 1);
        assert_every_pixel("shining", &frame, exact, 1e-5);
    }
}

/// Where nothing is absorbed under a sky of radiance 1, all is 1: a path that is not cut meets the
/// sky in the end.
#[test]
fn medium_furnace() {
    for (phase, tau) in [
        (r#"{ type = "isotropic" }"#, 1.0),
        (r#"{ type = "hg", g = 0.9 }"#, 10.0),
        (r#"{ type = "hg", g = -0.999 }"#, 10.0),
        (r#"{ type = "rayleigh" }"#, 100.0),
        (r#"{ type = "isotropic" }"#, 1000.0),
    ] {
        let scene = scene_from_toml(&format!(
            r#"
            camera = {{ position = [0, 0, 3], target = [0, 0, 0], vfov_deg = 30, width = 8, height = 8 }}
            lights = [{SKY}]
            media.milk = {{ type = "homogeneous", sigma_t = {}, albedo = 1, phase = {phase} }}
            spheres = [{{ center = [0, 0, 0], radius = 1, material = "none", interior = "milk" }}]
            "#,
            0.5 * tau
        ));
        let hits = sound(&job(&scene, "path", &[("mode", "hits"), NO_ROULETTE]), 1);
        assert_every_pixel(&format!("τ = {tau}, hits"), &hits, 1.0, 1e-5);
        if tau < 500.0 {
            let found = estimate(&scene, &[NO_ROULETTE], 4);
            assert_near(&format!("τ = {tau}, mis"), found, 1.0, 0.01);
        }
    }
}

/// A slab between y = 0 and 1, a thousand times as wide, with a lamp over all of one side.
fn slab(tau: f64, lamp_above: bool) -> Arc<Scene> {
    let folder = tempfile::tempdir().expect("a folder");
    let (y, order) = if lamp_above {
        (1.5, "f 1 2 3 4")
    } else {
        (-0.5, "f 4 3 2 1")
    };
    let square = format!(
        "v -1000 {y} -1000\nv 1000 {y} -1000\nv 1000 {y} 1000\nv -1000 {y} 1000\n{order}\n"
    );
    std::fs::write(folder.path().join("lamp.obj"), square).expect("written");
    let path = folder.path().join("scene.toml");
    let text = format!(
        r#"
        camera = {{ position = [0, 1.2, 0], target = [0, 0, 0], up = [0, 0, 1], vfov_deg = 0.01, width = 8, height = 8 }}
        materials.black = {{ type = "diffuse", reflectance = 0 }}
        meshes = [{{ file = "lamp.obj", material = "black", emission = [1, 1, 1] }}]
        medium = {{ type = "homogeneous", sigma_t = {tau}, albedo = 1,
                    region = {{ min = [-900, 0, -900], max = [900, 1, 900] }} }}
        "#
    );
    std::fs::write(&path, text).expect("written");
    support::render::load(&path)
}

/// What is not reflected is transmitted; each is estimated by itself.
#[test]
fn slab_conservative() {
    let mut last = 1.0;
    for (tau, passes) in [(0.5, 16), (10.0, 16), (100.0, 8), (1000.0, 8)] {
        let set = [("mode", "hits"), NO_ROULETTE];
        let (r, r_error) = estimate(&slab(tau, true), &set, passes);
        let (t, t_error) = estimate(&slab(tau, false), &set, passes);
        let error = r_error.hypot(t_error);
        assert_near(&format!("τ = {tau}"), (r + t, error), 1.0, 0.02);
        assert!(t < last && t > 0.0, "τ = {tau}: transmits {t}");
        last = t;
    }
}

#[test]
fn semi_infinite() {
    for (albedo, passes) in [(0.3, 128), (0.9, 128), (0.99, 128)] {
        let (mu0, mu) = (0.6_f64, 0.8_f64);
        let sine = |mu: f64| (1.0 - mu * mu).sqrt();
        let scene = scene_from_toml(&format!(
            r#"
            camera = {{ position = [{}, {}, 0], target = [0, 0, 0], vfov_deg = 0.01, width = 8, height = 8 }}
            lights = [{{ type = "directional", direction = [0, {}, {}], irradiance = [1, 1, 1] }}]
            medium = {{ type = "homogeneous", sigma_t = 1, albedo = {albedo},
                        region = {{ min = [-2000, -300, -2000], max = [2000, 0, 2000] }} }}
            "#,
            5.0 * sine(mu),
            5.0 * mu,
            -mu0,
            sine(mu0),
        ));
        let h = chandrasekhar_h(f64::from(albedo as f32));
        let exact = albedo / (4.0 * PI) * mu0 / (mu + mu0) * h(mu) * h(mu0);
        let found = estimate(&scene, &[], passes);
        assert_near(&format!("ϖ = {albedo}"), found, exact, 0.02);
    }
}

/// Nothing breaks, and every render ends.
#[test]
fn extremes_are_finite_and_end() {
    for (sigma, albedo) in [
        ("0", "0.5"),
        ("1e-9", "1"),
        ("1e9", "0.5"),
        ("[0, 1, 5]", "[1, 1, 0.9]"),
        ("[5, 0, 0]", "[0, 1, 1]"),
        ("[1e9, 1, 1e-9]", "[0.9, 0.9, 0.9]"),
    ] {
        for g in ["-0.999", "0", "0.999"] {
            for region in [
                r#""everywhere""#,
                "{ min = [-2, -2, -2], max = [2, 2, 3] }",
                "{ min = [-2, -2, -2], max = [2, 2, 1.5] }",
            ] {
                let scene = scene_from_toml(&format!(
                    r#"
                    camera = {{ position = [0, 0.3, 2.5], target = [0, 0, 0], vfov_deg = 40, width = 8, height = 8 }}
                    materials.white = {{ type = "diffuse", reflectance = 0.5 }}
                    materials.glass = {{ type = "dielectric", ior = 1.5 }}
                    lights = [{SKY}, {{ type = "point", position = [0, 1, 0], intensity = [1, 2, 3] }}]
                    spheres = [
                        {{ center = [0, -101, 0], radius = 100, material = "white" }},
                        {{ center = [0, 0, 0], radius = 0.5, material = "glass", interior = "vacuum", priority = 1 }},
                        {{ center = [0, 1, 0], radius = 0.1, material = "white", emission = [1, 1, 1] }},
                    ]
                    medium = {{ type = "homogeneous", region = {region}, sigma_t = {sigma}, albedo = {albedo}, phase = {{ type = "hg", g = {g} }} }}
                    "#
                ));
                for mode in ["mis", "hits", "kajiya"] {
                    let frame = sound(&job(&scene, "path", &[("mode", mode)]), 2);
                    let least = frame.layers[0].pixels.iter().flatten().copied();
                    assert!(least.fold(0.0_f32, f32::min) >= 0.0, "{sigma} {g} {region}");
                }
            }
        }
    }
}

#[test]
fn path_agrees_with_the_fog_references() {
    for scene in ["fog-isotropic", "fog-hg"] {
        agrees_with_reference(scene, "path", &[], 8);
        agrees_with_reference(scene, "path", &[("equiangular", "off")], 8);
        agrees_with_reference(scene, "path", &[("mode", "kajiya")], 8);
        agrees_with_reference(scene, "path", &[("mode", "hits")], 24);
    }
}

const COMPONENTS: [(usize, usize); 5] = [(0, 0), (1, 1), (2, 2), (3, 3), (4, 4)];

#[test]
fn a_constant_grid_renders_as_homogeneous() {
    let grid = r#"type = "grid", file = "constant.txt", sigma_t_scale = [0.2, 0.6, 1.0]"#;
    let homogeneous = runs_of(job(&smoky_room(HOMOGENEOUS), "path", &[]), 96);
    let constant = runs_of(job(&smoky_room(grid), "path", &[]), 96);
    assert_agree("constant grid", &constant, &homogeneous, &COMPONENTS);
    let loose = format!("{grid}, majorant_scale = 10000");
    let mut short = job(&smoky_room(&loose), "path", &[]);
    short.settings.layers.max_depth = Some(2);
    let mut same = job(&smoky_room(grid), "path", &[]);
    same.settings.layers.max_depth = Some(2);
    let (loose, tight) = (runs_of(short, 1), runs_of(same, 16));
    let (a, b) = (estimate_of(&loose), estimate_of(&tight));
    let error = a.1.hypot(b.1);
    assert!(
        (a.0 - b.0).abs() < 4.5 * error && error < 0.03 * b.0,
        "{a:?} {b:?}"
    );
    let low = format!("{grid}, majorant_scale = 0.5");
    let frame = render(&job(&smoky_room(&low), "path", &[]), 1);
    assert!(frame.stats.exceeded_majorants > 0);
}

fn estimate_of(frames: &[Frame]) -> (f64, f64) {
    let means: Vec<f64> = frames.iter().map(|f| mean(&f.layers[0].pixels)).collect();
    let n = means.len() as f64;
    let m = means.iter().sum::<f64>() / n;
    let v: f64 = means.iter().map(|x| (x - m).powi(2)).sum();
    (m, (v / (n - 1.0) / n).sqrt())
}

#[test]
fn modes_and_equiangular_places_agree_and_layers_add_up() {
    let scene = smoky_room(HOMOGENEOUS);
    let mut all = job(&scene, "path", &[]);
    let texts = ["L.*VE", "L.*DE", "LV.*E", "LE|L.*(S|G)E"];
    all.settings.layers.expressions = texts.iter().map(|t| t.parse().expect("good")).collect();
    let run = |set: &[(&str, &str)], passes| {
        let mut job = job(&scene, "path", set);
        job.settings.layers.expressions = all.settings.layers.expressions.clone();
        runs_of(job, passes)
    };
    let mis = run(&[], 96);
    let pairs: Vec<(usize, usize)> = (0..9).map(|i| (i, i)).collect();
    assert_agree(
        "equiangular off",
        &run(&[("equiangular", "off")], 96),
        &mis,
        &pairs,
    );
    assert_agree("kajiya", &run(&[("mode", "kajiya")], 96), &mis, &pairs);
    assert_agree(
        "independent",
        &run(&[("sampler", "independent")], 96),
        &mis,
        &pairs,
    );
    for frame in &mis {
        for (i, whole) in frame.layers[0].pixels.iter().enumerate() {
            for (c, whole) in whole.iter().enumerate() {
                let of = |l: usize| frame.layers[l].pixels[i][c];
                let (parts, last) = (of(1) + of(2) + of(3) + of(4), of(5) + of(6) + of(8));
                let scale = whole.max(0.1);
                assert!((parts - whole).abs() < 1e-4 * scale);
                assert!((last - whole).abs() < 1e-4 * scale);
            }
        }
    }
    let volume = mean(&mis[0].layers[5].pixels);
    assert!(volume > 0.05 * mean(&mis[0].layers[0].pixels), "{volume}");
}
