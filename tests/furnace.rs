//! White objects in a constant sky are invisible: closed forms that need no second renderer.

mod support;

use support::agreement::{Blocks, compare, mean};
use support::render::{job, render, scene_from_toml};

fn furnace(material: &str) -> std::sync::Arc<lightscope::engine::scene::Scene> {
    scene_from_toml(&format!(
        r#"
        name = "furnace"
        camera = {{ position = [0, 0, 4], target = [0, 0, 0], vfov_deg = 40, width = 32, height = 32 }}
        materials.m = {material}
        spheres = [{{ center = [0, 0, 0], radius = 1, material = "m" }}]
        lights = [{{ type = "constant", radiance = [1, 1, 1] }}]
        "#
    ))
}

const DIFFUSE: &str = r#"{ type = "diffuse", reflectance = [1, 1, 1] }"#;
const MIRROR: &str = r#"{ type = "mirror", reflectance = [1, 1, 1] }"#;
const GLASS: &str = r#"{ type = "dielectric", ior = 1.5 }"#;
const PLASTIC: &str =
    r#"{ type = "plastic", diffuse_reflectance = [1, 1, 1], ior = 1.5, nonlinear = true }"#;

#[test]
fn white_objects_vanish_in_every_pixel() {
    for material in [DIFFUSE, MIRROR, GLASS] {
        let scene = furnace(material);
        // Roulette would turn certainty into noise: survival is 1 until it begins.
        let job = job(&scene, "path", &[("mode", "hits"), ("roulette", "1000")]);
        let frame = render(&job, 16);
        for (i, pixel) in frame.layers[0].pixels.iter().enumerate() {
            for value in pixel {
                assert!(
                    (value - 1.0).abs() <= 1e-5,
                    "{material}: pixel {i} is {value}"
                );
            }
        }
    }
}

#[test]
fn plastic_and_weighted_strategies_vanish_on_the_mean() {
    for (material, set) in [
        (PLASTIC, [("mode", "hits"), ("roulette", "30")]),
        (PLASTIC, [("mode", "mis"), ("roulette", "30")]),
        (DIFFUSE, [("mode", "mis"), ("roulette", "30")]),
        (DIFFUSE, [("mode", "kajiya"), ("roulette", "30")]),
    ] {
        let scene = furnace(material);
        let mut job = job(&scene, "path", &set);
        let frames: Vec<_> = (0..16)
            .map(|seed| {
                job.settings.seed = seed;
                render(&job, 512)
            })
            .collect();
        let runs: Vec<&[[f32; 3]]> = frames
            .iter()
            .map(|f| f.layers[0].pixels.as_slice())
            .collect();
        let found = runs.iter().map(|r| mean(r)).sum::<f64>() / 16.0;
        assert!(
            (found - 1.0).abs() < 1e-4,
            "{material} {set:?}: mean {found}"
        );
        let exact = Blocks::exact(1.0, 32, 32);
        let verdict = compare("whole", &Blocks::from_runs(&runs, 32), &exact, 1.0, 1);
        assert!(
            verdict.complaints.is_empty(),
            "{material} {set:?}: {:?}",
            verdict.complaints
        );
    }
}

#[test]
fn ggx_shows_its_directional_albedo() {
    use lightscope::engine::bsdf::Transport;
    use lightscope::engine::event::Event;
    use lightscope::engine::sampling::{Sampler, SobolSampler, Stream, warp};
    for alpha in ["0.05", "0.3", "1.0"] {
        let material = format!(
            r#"{{ type = "ggx_conductor", specular_reflectance = [1, 1, 1], alpha = {alpha} }}"#
        );
        let scene = furnace(&material);
        // A pencil of rays at one point of the sphere: the pixel in the middle of a telephoto.
        let job = job(&scene, "path", &[("mode", "hits"), ("roulette", "30")]);
        let frame = render(&job, 1024);
        // Where eye rays meet the sphere and reflect, the picture is the albedo at that angle.
        let width = job.size.x as usize;
        let centre: f64 = [(15, 15), (15, 16), (16, 15), (16, 16)]
            .iter()
            .map(|&(x, y)| f64::from(frame.layers[0].pixels[y * width + x][0]))
            .sum::<f64>()
            / 4.0;
        // The same integral, by uniform directions and the evaluated f alone.
        let ray = job
            .camera
            .with_size(job.size)
            .generate_ray(glam::Vec2::splat(16.0), glam::Vec2::ZERO);
        let si = scene
            .intersect(&ray, || 0.5)
            .expect("the sphere is in the middle");
        let bsdf = scene.bsdf(&si);
        let n = 1 << 16;
        let albedo = (0..n)
            .map(|i| {
                let u = SobolSampler::new(1, Stream::Test, (0, i)).next_2d();
                let half = warp::sample_sphere(u);
                let wi = 2.0 * si.wo.dot(half) * half - si.wo;
                // Uniform half vectors: dω_i = 4 |wo·h| dω_h.
                let jacobian = 4.0 * si.wo.dot(half).abs() / warp::pdf_sphere();
                let f = bsdf.eval(Event::Glossy, si.wo, wi, Transport::Radiance);
                // h and −h are the same half vector.
                f64::from(f[0] * jacobian) / 2.0
            })
            .sum::<f64>()
            / n as f64;
        assert!(
            (centre - albedo).abs() < 0.01,
            "α = {alpha}: {centre} against {albedo}"
        );
    }
}
