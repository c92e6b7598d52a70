//! What photons carry.

use std::convert::Infallible;
use std::f64::consts::PI;

use glam::Vec3;

use super::super::case::{Case, Fit, Run};
use super::super::estimate::{RUNS, Sampling, mean_of};
use super::super::scenes::{build, diffuse, glass, point_light, sphere, square, view};
use super::super::{fits, oracles};
use crate::engine::math::Rgb;
use crate::engine::path::{Expression, PathClasses};
use crate::engine::photon::emission::Emission;
use crate::engine::photon::{
    MapKind, MapSettings, Numbers, Packing, PhotonMap, Roulette, SplitRule,
};
use crate::engine::scene::Scene;
use crate::engine::scene::desc::{LightDesc, SceneDesc};

/// All of a map.
pub const POWER: Case = Case {
    id: "photon-power",
    label: "Power of stored photons",
    summary: "All photons that are stored in a closed sphere around a point light.",
    parameter: "1/(1−ρ)",
    oracle: "Φ/(1−ρ)",
    stiff: true,
    fit: fits::engine,
    run: power,
};

/// A caustic as a whole.
pub const LENS: Case = Case {
    id: "caustic-lens",
    label: "Light through a ball lens",
    summary: "A parallel beam that a ball of glass refracts onto a diffuse screen.",
    parameter: "index n",
    oracle: "ρ Φ/(π A) by conservation of flux, rays traced apart in f64 with Fresnel's T²",
    stiff: false,
    fit: lens_fit,
    run: lens,
};

fn stored(scene: &Scene, roulette: Roulette, index: u64, photons: usize) -> f64 {
    let settings = MapSettings {
        photons,
        roulette,
        packing: Packing::Full,
        split: SplitRule::Widest,
        numbers: Numbers::Independent,
        seed: 1,
        index,
    };
    let never = || Ok::<(), Infallible>(());
    let classes = PathClasses::components();
    let emission = Emission::Everywhere;
    match PhotonMap::build(
        scene,
        &classes,
        MapKind::Global,
        &emission,
        &settings,
        &never,
    ) {
        Ok(map) => map.photons().map(|p| f64::from(p.power.mean())).sum(),
        Err(impossible) => match impossible {},
    }
}

fn power(run: &mut Run) {
    let albedos: &[f32] = run.pick(&[0.9], &[0.5, 0.9, 0.99]);
    for (name, roulette) in [
        ("power kept", Roulette::Keep),
        ("power lost", Roulette::Lose),
    ] {
        for &rho in albedos {
            let scene = build(&SceneDesc {
                materials: vec![diffuse("wall", rho)],
                spheres: vec![sphere(0, Vec3::ZERO, 2.0, true)],
                lights: vec![point_light(Vec3::new(0.3, 0.2, -0.1), 1.0)],
                ..SceneDesc::default()
            });
            let exact = 4.0 * PI / (1.0 - f64::from(rho));
            let photons = run.pick(20_000, 100_000) * if rho > 0.95 { 4 } else { 1 };
            let values: Vec<f64> = (0..RUNS)
                .map(|i| stored(&scene, roulette, i, photons))
                .collect();
            let (mean, half) = mean_of(&values);
            let x = 1.0 / (1.0 - f64::from(rho));
            // Sums of as many numbers of f32 precision.
            run.mean(
                x,
                name,
                (mean, half + 2e-5 * exact),
                exact,
                run.pick(0.05, 0.03),
            );
        }
    }
}

fn lens_fit(id: &str) -> Fit {
    match id {
        "pssmlt" => Fit::LeftOut("it runs over bdpt, which is asked"),
        _ => fits::caustic_point(id),
    }
}

fn lens(run: &mut Run) {
    let (distance, side) = (3.0_f32, 4.0_f32);
    let rho = 0.5_f32;
    for n in [1.1_f32, 1.3, 1.5] {
        // The eye is between ball and screen: it sees the screen alone, and casts no shadow.
        let tan = side / 1.5;
        let fov = 2.0 * tan.atan().to_degrees();
        let desc = SceneDesc {
            camera: view(Vec3::X * (distance - 1.5), Vec3::X * distance, fov, 8),
            materials: vec![glass("glass", n), diffuse("screen", rho)],
            meshes: vec![square(1, Vec3::X * distance, Vec3::Y * 9.0, Vec3::Z * -9.0)],
            spheres: vec![sphere(0, Vec3::ZERO, 1.0, false)],
            lights: vec![LightDesc::Directional {
                direction: Vec3::X,
                irradiance: Rgb::WHITE,
            }],
            ..SceneDesc::default()
        };
        // What lands beyond the disc within the view is weak; the corners hold some of it.
        let [least, most] = [1.0, std::f64::consts::SQRT_2].map(|reach| {
            oracles::through_ball(f64::from(n), f64::from(distance), f64::from(side) * reach)
        });
        let area = f64::from(2.0 * side).powi(2);
        let exact = f64::from(rho) / PI * PI * 0.5 * (least + most) / area;
        let mut job = run.job(&desc);
        // Two refractions, no inner reflections, nothing that passed the ball by.
        job.settings.layers.expressions = "LSSDE".parse::<Expression>().into_iter().collect();
        let how = Sampling {
            layer: 5,
            rounding: 2e-5 + 0.5 * (most - least) / least,
            ..Sampling::new(4, run.pick(2048, 1 << 14), run.pick(0.05, 0.025))
        };
        run.picture(f64::from(n), "", &job, exact, &how);
    }
}
