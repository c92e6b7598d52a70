//! Media that emit: shadow rays that look for them.

#[path = "support/chi_square.rs"]
mod chi_square;
mod support;

use std::sync::Arc;

use chi_square::{SphereGrid, assert_family, test_directions};
use glam::Vec3A;
use lightscope::engine::film::Frame;
use lightscope::engine::media::Draws;
use lightscope::engine::scene::Scene;
use support::reference::{assert_agree, runs_of};
use support::render::{job, load};

/// A dim room with a small flame in it, of uneven density.
const FLAME: &str = r#"
    medium = { type = "grid", file = "flame.txt", sigma_t_scale = [2, 3, 4], albedo = 0.3,
               emission = [90, 40, 10], region = { min = [0.4, -0.9, -0.3], max = [0.7, -0.4, 0.1] } }
"#;
/// A room of thin fog with two embers of their own density in it.
const EMBERS: &str = r#"
    media.ember = { type = "homogeneous", sigma_t = [4, 6, 8], albedo = 0.1, emission = [300, 90, 20] }
    media.fog = { type = "homogeneous", sigma_t = 0.1, albedo = [0.9, 0.8, 0.7] }
    medium = "fog"
"#;
const EMBER_SPHERES: &str = r#"
    { center = [0.8, -0.4, 0.3], radius = 0.1, material = "none", interior = "ember" },
    { center = [-0.6, 0.9, -0.5], radius = 0.05, material = "none", interior = "ember" },
"#;

/// Large ones, which quadrature over directions does not miss.
const COALS: &str = r#"
    { center = [0.8, -0.4, 0.3], radius = 0.7, material = "none", interior = "ember" },
    { center = [-1.2, 0.9, -0.5], radius = 0.5, material = "none", interior = "ember" },
"#;

fn room(media: &str, spheres: &str) -> Arc<Scene> {
    let folder = tempfile::tempdir().expect("a folder");
    let flame = "3 2 2\n0 1 3 0 2 0.5\n0 0.2 4 1 0 0\n";
    std::fs::write(folder.path().join("flame.txt"), flame).expect("written");
    let path = folder.path().join("scene.toml");
    let text = format!(
        r#"
        camera = {{ position = [0, 0.3, 3.5], target = [0, 0, 0], vfov_deg = 50, width = 24, height = 16 }}
        materials.white = {{ type = "diffuse", reflectance = [0.5, 0.4, 0.3] }}
        materials.metal = {{ type = "ggx_conductor", specular_reflectance = 0.9, alpha = 0.2 }}
        materials.plastic = {{ type = "plastic", diffuse_reflectance = [0.1, 0.2, 0.6], ior = 1.5 }}
        spheres = [
            {{ center = [0, 0, 0], radius = 4, material = "white", inward = true }},
            {{ center = [-0.9, -0.3, 0.2], radius = 0.6, material = "metal" }},
            {{ center = [0.9, 0.8, 0.2], radius = 0.5, material = "plastic" }},
            {spheres}
        ]
        {media}
        "#
    );
    std::fs::write(&path, text).expect("written");
    load(&path)
}

/// Two scenes, by name.
fn rooms() -> [(&'static str, Arc<Scene>); 2] {
    [
        ("flame", room(FLAME, "")),
        ("embers", room(EMBERS, EMBER_SPHERES)),
    ]
}

#[test]
fn directions_are_drawn_by_the_density_they_claim() {
    let mut p_values = Vec::new();
    for (name, scene) in [("flame", room(FLAME, "")), ("coals", room(EMBERS, COALS))] {
        let glow = &scene.media.glow;
        for (i, p) in [
            Vec3A::new(0.0, 0.3, 2.0),
            Vec3A::new(0.55, -0.6, -0.1),
            Vec3A::new(0.401, -0.5, 0.0),
            Vec3A::new(0.8, -0.42, 0.33),
        ]
        .into_iter()
        .enumerate()
        {
            let mut draws = Draws::hashed(i as u64);
            let (axis, _) = glow.sample_dir(p, &mut draws).expect("a direction");
            let p_value = test_directions(
                &SphereGrid::new(axis, 0.3),
                200_000,
                |d| f64::from(glow.pdf_dir(p, d)),
                || glow.sample_dir(p, &mut draws).map(|(d, _)| d),
            );
            p_values.push((format!("{name} from {p}"), p_value));
        }
    }
    assert_family(&p_values);
}

/// Variance of the pixels of light that was scattered, up to a factor.
fn spread(frames: &[Frame]) -> f64 {
    const SCATTERED: usize = 5;
    let pixels = frames[0].layers[SCATTERED].pixels.len();
    let n = frames.len() as f64;
    (0..pixels)
        .map(|i| {
            let values = frames
                .iter()
                .map(|f| f64::from(f.layers[SCATTERED].pixels[i][0]));
            let mean = values.clone().sum::<f64>() / n;
            values.map(|x| (x - mean).powi(2)).sum::<f64>() / n
        })
        .sum()
}

/// Walks alone, walks and shadow rays together, and walks from both ends find the same light; and
/// shadow rays are worth their while.
#[test]
fn shadow_rays_find_the_same_light_with_less_noise() {
    for (name, scene) in rooms() {
        let run = |id: &str, set: &[(&str, &str)], passes| {
            let mut job = job(&scene, id, set);
            job.settings.layers.expressions = vec!["L.+E".parse().expect("well-formed")];
            runs_of(job, passes)
        };
        let both = run("path", &[], 128);
        let alone = run("path", &[("mode", "hits")], 512);
        let all = [0, 1, 2, 4].map(|i| (i, i));
        assert_agree(&format!("hits, {name}"), &alone, &both, &all);
        assert_agree(
            &format!("bdpt, {name}"),
            &run("bdpt", &[], 256),
            &both,
            &all,
        );
        let gain = spread(&alone) * 4.0 / spread(&both);
        println!("{name}: {gain:.1} times the samples without shadow rays");
        assert!(gain > 5.0, "{name}: {gain}");
    }
}
