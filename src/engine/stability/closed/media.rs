//! Participating media.

use std::f64::consts::PI;

use glam::Vec3;

use super::super::case::{Case, Fit, Run, decades};
use super::super::estimate::Sampling;
use super::super::scenes::{
    block, diffuse, fill, fill_meshes, medium, nothing, sky, sphere, square, view,
};
use super::super::{fits, oracles};
use crate::engine::math::Rgb;
use crate::engine::scene::desc::media::{PhaseDesc, SurfaceDesc};
use crate::engine::scene::desc::{LightDesc, SceneDesc};

/// A slab that absorbs.
pub const BEER: Case = Case {
    id: "beer-lambert",
    label: "Absorbing slab",
    summary: "A sky seen straight through a homogeneous slab that absorbs only.",
    parameter: "optical thickness τ",
    oracle: "e^(−τ); finite and not negative where that is below f32",
    stiff: false,
    fit: beer_fit,
    run: beer,
};

/// A slab that scatters and loses nothing.
pub const SLAB: Case = Case {
    id: "slab-conservative",
    label: "Conservative slab",
    summary: "A wide slab of albedo 1 before a lamp that fills one side, seen from both.",
    parameter: "optical thickness τ",
    oracle: "R + T = 1",
    stiff: true,
    fit: slab_fit,
    run: slab,
};

/// A half space under a beam.
pub const HALF_SPACE: Case = Case {
    id: "semi-infinite",
    label: "Scattering half space",
    summary: "An isotropically scattering half space of albedo ϖ under parallel light.",
    parameter: "1/(1−ϖ)",
    oracle: "E ϖ/(4π) · μ₀/(μ+μ₀) · H(μ) H(μ₀) with Chandrasekhar's H",
    stiff: true,
    fit: half_space_fit,
    run: half_space,
};

/// A cloud in a sky.
pub const FURNACE: Case = Case {
    id: "medium-furnace",
    label: "Cloud in a furnace",
    summary: "A ball of a medium of albedo 1 in a constant sky, of any phase function.",
    parameter: "optical thickness τ",
    oracle: "the sky's radiance",
    stiff: true,
    fit: fits::in_media,
    run: furnace,
};

fn beer_fit(id: &str) -> Fit {
    match id {
        "photon" => fits::specular_only(id),
        _ => fits::in_media(id),
    }
}

fn beer(run: &mut Run) {
    for tau in decades(-9..=4, run.pick(2, 1)).chain([0.5, 10.0, 80.0]) {
        let mut desc = SceneDesc {
            camera: view(Vec3::Z * 5.0, Vec3::ZERO, 0.01, 2),
            materials: vec![nothing("none")],
            meshes: vec![block(
                0,
                Vec3::new(-9.0, -9.0, -0.5),
                Vec3::new(9.0, 9.0, 0.5),
            )],
            lights: vec![sky(1.0)],
            ..SceneDesc::default()
        };
        desc.media.media = vec![medium(tau as f32, 0.0, PhaseDesc::Isotropic)];
        fill_meshes(&mut desc, 1);
        let exact = if tau > 80.0 {
            0.0
        } else {
            (-f64::from(tau as f32)).exp()
        };
        // The slab's faces are known to f32, and so is its thickness; below 1e-37 there is no
        // number of full precision.
        let rounding = if tau > 80.0 { 1e-34 } else { 1e-5 + 3e-7 * tau };
        let job = run.job(&desc);
        run.picture(tau, "", &job, exact, &Sampling::every_pixel(2, rounding));
    }
}

/// A slab between y = 0 and 1, a thousand times as wide, with a lamp over all of one side.
fn slab_scene(tau: f32, lamp_above: bool) -> SceneDesc {
    let (y, side) = if lamp_above { (1.5, -1.0) } else { (-0.5, 1.0) };
    let mut lamp = square(1, Vec3::Y * y, Vec3::Z * 1000.0 * side, Vec3::X * 1000.0);
    lamp.emission = Some(Rgb::WHITE);
    let slab = block(
        0,
        Vec3::new(-900.0, 0.0, -900.0),
        Vec3::new(900.0, 1.0, 900.0),
    );
    let mut desc = SceneDesc {
        camera: view(Vec3::Y * 1.2, Vec3::ZERO, 0.01, 2),
        materials: vec![nothing("none"), diffuse("lamp", 0.0)],
        meshes: vec![lamp, slab],
        ..SceneDesc::default()
    };
    desc.media.media = vec![medium(tau, 1.0, PhaseDesc::Isotropic)];
    fill_meshes(&mut desc, 1);
    desc
}

fn slab_fit(id: &str) -> Fit {
    match id {
        "path" => Fit::Asked(&[super::super::case::Variant {
            name: "hits",
            set: &[("mode", "hits"), ("roulette", "10000000")],
            bias: 0.0,
        }]),
        "bdpt" | "vcm" => Fit::LeftOut("walks of τ² events have τ⁴ connections"),
        _ => fits::in_media(id),
    }
}

fn slab(run: &mut Run) {
    let thick: &[f32] = run.pick(
        &[0.5, 10.0, 100.0],
        &[0.5, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0],
    );
    for &tau in thick {
        // Both sides in one picture: a run is the mean of two halves of the same seed.
        let both = [true, false].map(|above| run.job(&slab_scene(tau, above)));
        let how = Sampling::new(4, run.pick(1024, 4096), run.pick(0.05, 0.02));
        run.pictures(f64::from(tau), "", &both, 1.0, &how);
    }
}

fn half_space_fit(id: &str) -> Fit {
    match id {
        "path" => fits::path_only(id),
        _ => fits::in_media(id),
    }
}

fn half_space(run: &mut Run) {
    let albedos: &[f32] = match run.id() {
        "path" => run.pick(&[0.3, 0.9, 0.99], &[0.3, 0.9, 0.99, 0.999]),
        _ => run.pick(&[0.3, 0.9], &[0.3, 0.9]),
    };
    for &albedo in albedos {
        let (mu0, mu) = (0.6_f64, 0.8_f64);
        let sine = |mu: f64| (1.0 - mu * mu).sqrt();
        let up = |mu: f64, sign: f64| Vec3::new((sign * sine(mu)) as f32, mu as f32, 0.0);
        let sideways = Vec3::new(0.0, -mu0 as f32, sine(mu0) as f32);
        let ground = block(
            0,
            Vec3::new(-2000.0, -300.0, -2000.0),
            Vec3::new(2000.0, 0.0, 2000.0),
        );
        let mut desc = SceneDesc {
            camera: view(5.0 * up(mu, 1.0), Vec3::ZERO, 0.01, 2),
            materials: vec![nothing("none")],
            meshes: vec![ground],
            lights: vec![LightDesc::Directional {
                direction: sideways,
                irradiance: Rgb::WHITE,
            }],
            ..SceneDesc::default()
        };
        desc.media.media = vec![medium(1.0, albedo, PhaseDesc::Isotropic)];
        fill_meshes(&mut desc, 1);
        let h = oracles::chandrasekhar_h(f64::from(albedo));
        let exact = f64::from(albedo) / (4.0 * PI) * mu0 / (mu + mu0) * h(mu) * h(mu0);
        let job = run.job(&desc);
        let how = Sampling {
            // H by 400 points, and the edge of the ground.
            rounding: 1e-3,
            ..Sampling::new(16, run.pick(1024, 8192), run.pick(0.05, 0.02))
        };
        run.picture(1.0 / (1.0 - f64::from(albedo)), "", &job, exact, &how);
    }
}

fn furnace(run: &mut Run) {
    let sure = run.variant.name == "hits";
    let clouds: &[(&str, PhaseDesc, f32)] = &[
        ("isotropic", PhaseDesc::Isotropic, 1.0),
        ("g = 0.9", PhaseDesc::HenyeyGreenstein { g: 0.9 }, 10.0),
        (
            "g = −0.999",
            PhaseDesc::HenyeyGreenstein { g: -0.999 },
            10.0,
        ),
        ("Rayleigh", PhaseDesc::Rayleigh, 100.0),
        ("isotropic", PhaseDesc::Isotropic, 1000.0),
    ];
    for (name, phase, tau) in clouds {
        // Shadow rays see nothing of the sky from within; chance hits see it all.
        if !sure && *tau > 20.0 {
            continue;
        }
        let mut desc = SceneDesc {
            camera: view(Vec3::Z * 3.0, Vec3::ZERO, 30.0, 4),
            materials: vec![nothing("none")],
            spheres: vec![sphere(0, Vec3::ZERO, 1.0, false)],
            lights: vec![sky(1.0)],
            ..SceneDesc::default()
        };
        desc.media.media = vec![medium(0.5 * tau, 1.0, *phase)];
        fill(&mut desc, SurfaceDesc::Sphere(0));
        let how = match sure {
            true => Sampling::every_pixel(if *tau > 500.0 { 1 } else { 4 }, 1e-5),
            false => Sampling::new(2, run.pick(256, 2048), run.pick(0.05, 0.02)),
        };
        let job = run.job(&desc);
        run.picture(f64::from(*tau), name, &job, 1.0, &how);
    }
}
