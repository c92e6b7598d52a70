//! Scenes whose light is known in closed form.

mod support;

use std::f64::consts::PI;
use std::sync::Arc;

use glam::Vec3;
use lightscope::engine::io;
use lightscope::engine::math::Rgb;
use lightscope::engine::scene::Scene;
use lightscope::engine::scene::desc::{CameraDesc, MeshDesc, SceneDesc};
use support::agreement::mean;
use support::render::{job, render, scene_from_toml};

/// Independent runs behind each standard error.
const RUNS: u64 = 16;

/// Mean of layer `layer` over the picture, and its standard error.
fn estimate(scene: &Arc<Scene>, set: &[(&str, &str)], passes: u64, layer: usize) -> (f64, f64) {
    let mut job = job(scene, "path", set);
    let runs: Vec<f64> = (0..RUNS)
        .map(|seed| {
            job.settings.seed = seed;
            mean(&render(&job, passes).layers[layer].pixels)
        })
        .collect();
    let n = RUNS as f64;
    let mean = runs.iter().sum::<f64>() / n;
    let squares: f64 = runs.iter().map(|r| (r - mean).powi(2)).sum();
    (mean, (squares / (n - 1.0) / n).sqrt())
}

/// `found` lies within 4.5 standard errors of `exact`, and those are below the share `sharp`.
fn assert_near(what: &str, (found, error): (f64, f64), exact: f64, sharp: f64) {
    assert!(error <= sharp * exact, "{what}: error {error} of {exact}");
    assert!(
        (found - exact).abs() <= 4.5 * error + 2e-5 * exact,
        "{what}: {found}, not {exact}, error {error}"
    );
}

/// Every pixel of the whole is `exact` but for rounding.
fn assert_every_pixel(what: &str, scene: &Arc<Scene>, exact: f64, tolerance: f64) {
    let job = job(scene, "path", &[("mode", "hits"), ("roulette", "100000")]);
    for (i, pixel) in render(&job, 8).layers[0].pixels.iter().enumerate() {
        let off = (f64::from(pixel[0]) - exact).abs();
        assert!(
            off <= tolerance * exact,
            "{what}: pixel {i} is {pixel:?}, not {exact}"
        );
    }
}

fn inside_a_sphere(rho: f64, radius: f64, emission: f64, light: &str) -> Arc<Scene> {
    scene_from_toml(&format!(
        r#"
        camera = {{ position = [0.3, -0.2, 0.4], target = [1, 0.5, -1], vfov_deg = 90, width = 4, height = 4 }}
        materials.m = {{ type = "diffuse", reflectance = [{rho}, {rho}, {rho}] }}
        spheres = [{{ center = [0, 0, 0], radius = {radius}, material = "m", inward = true,
                      emission = [{emission}, {emission}, {emission}] }}]
        lights = [{light}]
        "#
    ))
}

/// E/(1−ρ): only some 1/(1−ρ) bounces bring all of the light, so that a limit of depth or a
/// roulette that ends paths too soon, or without paying for it, shows.
#[test]
fn integrating_sphere() {
    for (rho, passes, sharp) in [
        (0.5, 256, 0.003),
        (0.9, 256, 0.005),
        (0.99, 128, 0.02),
        (0.999, 16, 0.05),
        (0.9999, 4, 0.08),
    ] {
        let scene = inside_a_sphere(rho, 1.0, 1.0, "");
        let exact = 1.0 / (1.0 - f64::from(rho as f32));
        // Ten thousand bounces a path: one mode is enough, as the others walk the same way.
        let modes = [("hits", "4"), ("mis", "0")];
        for (mode, roulette) in modes.into_iter().take(if rho < 0.9995 { 2 } else { 1 }) {
            let found = estimate(&scene, &[("mode", mode), ("roulette", roulette)], passes, 0);
            assert_near(&format!("ρ = {rho}, {mode}"), found, exact, sharp);
        }
    }
}

/// Direct ρI/(πR²), in total 1/(1−ρ) of that.
#[test]
fn sphere_around_a_point_light() {
    let (rho, radius, intensity) = (0.75, 2.0, 3.0);
    let light = r#"{ type = "point", position = [0, 0, 0], intensity = [3, 3, 3] }"#;
    let scene = inside_a_sphere(rho, radius, 0.0, light);
    let direct = rho * intensity / (PI * radius * radius);
    for mode in ["mis", "kajiya"] {
        let set = [("mode", mode)];
        assert_near("direct", estimate(&scene, &set, 1, 1), direct, 1e-5);
        let total = direct / (1.0 - rho);
        assert_near("total", estimate(&scene, &set, 256, 0), total, 0.005);
        let indirect = total - direct;
        assert_near("indirect", estimate(&scene, &set, 256, 4), indirect, 0.005);
    }
}

/// A square of side 2·`half` around `center`, its front toward `normal` = u × v.
fn square(center: Vec3, u: Vec3, v: Vec3, material: usize) -> MeshDesc {
    MeshDesc {
        name: "square".to_owned(),
        positions: vec![
            center - u - v,
            center + u - v,
            center + u + v,
            center - u + v,
        ],
        normals: Vec::new(),
        uvs: Vec::new(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material,
        emission: None,
        transform: None,
    }
}

/// A scene of that material, seen from `position` toward `target` in a narrow cone.
fn seen(material: &str, position: Vec3, target: Vec3, rest: &str) -> SceneDesc {
    let text = format!("materials.m = {material}\n{rest}");
    let mut desc = io::scene_file::from_toml(
        &format!("camera = {{ position = [0, 0, 1], target = [0, 0, 0], vfov_deg = 1 }}\n{text}"),
        "test.toml",
    )
    .unwrap_or_else(|e| panic!("{e}"));
    desc.camera = CameraDesc {
        position,
        target,
        up: Vec3::Z,
        vfov_deg: 0.01,
        width: 4,
        height: 4,
        lens: None,
    };
    desc
}

fn built(desc: &SceneDesc) -> Arc<Scene> {
    Arc::new(Scene::build(desc).unwrap_or_else(|e| panic!("{e}")))
}

/// ρ I cosθ/(π d²).
#[test]
fn plane_under_a_point_light() {
    let material = r#"{ type = "diffuse", reflectance = [0.5, 0.5, 0.5] }"#;
    let light = r#"lights = [{ type = "point", position = [3, 4, 0], intensity = [7, 7, 7] }]"#;
    let mut desc = seen(material, Vec3::Y * 9.0, Vec3::ZERO, light);
    desc.meshes
        .push(square(Vec3::ZERO, Vec3::Z * 9.0, Vec3::X * 9.0, 0));
    let exact = 0.5 * 7.0 * (4.0 / 5.0) / (PI * 25.0);
    let found = estimate(&built(&desc), &[], 4, 0);
    assert_near("falloff", (found.0, 1e-4 * exact), exact, 1e-3);
}

/// n mirrors of reflectance r leave rⁿ of the sky.
#[test]
fn chain_of_parallel_mirrors() {
    for n in [1_u32, 10, 1000, 10_000] {
        let r = 0.5_f64.powf(1.0 / f64::from(n)) as f32;
        let material = format!(r#"{{ type = "mirror", reflectance = [{r}, {r}, {r}] }}"#);
        let sky = r#"lights = [{ type = "constant", radiance = [1, 1, 1] }]"#;
        // Between planes at y = 0 and 1 a ray of slope 1 hits one at x = ½, 1½, 2½ …; the mirrors
        // end half a step after the last hit.
        let mut desc = seen(
            &material,
            Vec3::new(0.0, 0.5, 0.0),
            Vec3::new(0.5, 0.0, 0.0),
            sky,
        );
        desc.camera.vfov_deg = 1e-4;
        let half = 0.5 * n as f32;
        for (y, side) in [(0.0, 1.0), (1.0, -1.0)] {
            let center = Vec3::new(half, y, 0.0);
            desc.meshes
                .push(square(center, Vec3::Z * side, Vec3::X * half, 0));
        }
        let exact = f64::from(r).powi(n as i32);
        // Each of n products is rounded.
        let tolerance = 1e-5 + f64::from(n) * 6e-8;
        assert_every_pixel(&format!("{n} mirrors"), &built(&desc), exact, tolerance);
    }
}

/// Straight through a plate, all inner reflections summed: T = (1 − R)²/(1 − R²) with
/// R = ((n − 1)/(n + 1))².
#[test]
fn plate_of_glass() {
    for n in [1.0_f32, 1.0 - 1e-6, 1.0 + 1e-6, 1.5, 2.4, 1e3] {
        let material = format!(r#"{{ type = "dielectric", ior = {n:?} }}"#);
        let black = r#"materials.black = { type = "diffuse", reflectance = [0, 0, 0] }"#;
        let mut desc = seen(&material, Vec3::Y * 9.0, Vec3::ZERO, black);
        let find = |name: &str| desc.materials.iter().position(|m| m.name == name);
        let (glass, black) = (find("m").expect("m"), find("black").expect("black"));
        for (y, side) in [(1.0, 1.0), (0.0, -1.0)] {
            let (u, v) = (Vec3::Z * side * 50.0, Vec3::X * 50.0);
            desc.meshes.push(square(Vec3::Y * y, u, v, glass));
        }
        let mut lamp = square(Vec3::Y * -2.0, Vec3::Z * 50.0, Vec3::X * 50.0, black);
        lamp.emission = Some(Rgb::splat(2.0));
        desc.meshes.push(lamp);
        let r = ((f64::from(n) - 1.0) / (f64::from(n) + 1.0)).powi(2);
        let exact = 2.0 * (1.0 - r).powi(2) / (1.0 - r * r);
        let found = estimate(&built(&desc), &[], 1024, 0);
        assert_near(&format!("n = {n}"), found, exact, 0.05);
    }
}

fn within_glass(light: &str) -> SceneDesc {
    let text = format!(
        r#"
        camera = {{ position = [0.3, 0, 0], target = [1, 0.4, 0.2], vfov_deg = 60, width = 8, height = 8 }}
        materials.glass = {{ type = "dielectric", ior = 1.5 }}
        spheres = [{{ center = [0, 0, 0], radius = 1, material = "glass" }}]
        {light}
        "#
    );
    io::scene_file::from_toml(&text, "test.toml").unwrap_or_else(|e| panic!("{e}"))
}

/// Seen from within glass the sky is n² L where all inner reflections leave in the end, and
/// (1 − F) n² L where only the direct way counts.
#[test]
fn sky_seen_from_within_glass() {
    let sky = r#"lights = [{ type = "constant", radiance = [1, 1, 1] }]"#;
    let scene = built(&within_glass(sky));
    assert_every_pixel("closed glass", &scene, 2.25, 1e-5);

    let mut desc = within_glass(sky);
    // From the centre every ray leaves perpendicularly: F = (0.5/2.5)².
    desc.camera.position = Vec3::ZERO;
    let scene = built(&desc);
    let mut job = job(&scene, "path", &[]);
    job.settings.layers.max_depth = Some(1);
    let found = mean(&render(&job, 4096).layers[0].pixels);
    assert!((found - 0.96 * 2.25).abs() < 2e-3, "{found}");
}
