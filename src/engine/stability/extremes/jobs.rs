//! Jobs of any size, empty ones, and layers.

use std::f64::consts::PI;

use glam::{UVec2, Vec3};

use super::super::case::{Case, Fit, Run};
use super::super::estimate::{Sampling, frame, mean_of_layer};
use super::super::fits;
use super::super::scenes::{diffuse, point_light, room, sky, sphere, square, view};
use crate::engine::scene::desc::SceneDesc;

/// Pictures of odd shapes.
pub const SIZES: Case = Case {
    id: "sizes",
    label: "Sizes of pictures",
    summary: "A plane under a point light in pictures of 1 × 1, 1 × 64 and 16384 × 1 pixels.",
    parameter: "pixels",
    oracle: "ρ I cosθ/(π r²) straight below the light",
    stiff: false,
    fit: sizes_fit,
    run: sizes,
};

/// Nothing to see.
pub const EMPTY: Case = Case {
    id: "empty",
    label: "Empty scenes",
    summary: "No light, no surface, the eye within a solid, and depths of 0 and 1.",
    parameter: "",
    oracle: "black, or the sky; every render ends",
    stiff: false,
    fit: all,
    run: empty,
};

/// The sum of the layers.
pub const LAYERS: Case = Case {
    id: "layers",
    label: "Layers add up",
    summary: "The four components of the room, and three expressions that share all paths out.",
    parameter: "",
    oracle: "in every pixel their sum is the whole, which has sums of its own",
    stiff: false,
    fit: all,
    run: layers,
};

pub(super) fn all(id: &str) -> Fit {
    match id {
        "path" => fits::path_modes(id),
        "monte-carlo" => fits::direct_point(id),
        _ => fits::diffuse_in_sky(id),
    }
}

fn sizes_fit(id: &str) -> Fit {
    match id {
        "light" => Fit::LeftOut("no light path lands in so narrow a view by chance"),
        "pssmlt" => {
            Fit::LeftOut("chains of one pixel: its bootstrap alone is seen, which runs bdpt")
        }
        _ => fits::direct_point(id),
    }
}

fn sizes(run: &mut Run) {
    let (rho, intensity) = (0.5_f32, 7.0_f32);
    for size in [UVec2::new(1, 1), UVec2::new(1, 64), UVec2::new(16_384, 1)] {
        let desc = SceneDesc {
            camera: view(Vec3::Y * 2.0, Vec3::ZERO, 2.5e-5, 1),
            materials: vec![diffuse("floor", rho)],
            meshes: vec![square(0, Vec3::ZERO, Vec3::Z * 4.0, Vec3::X * 4.0)],
            lights: vec![point_light(Vec3::Y, intensity)],
            ..SceneDesc::default()
        };
        let exact = f64::from(rho) * f64::from(intensity) / PI;
        let mut job = run.job(&desc);
        job.size = size;
        let pixels = f64::from(size.x * size.y);
        // The widest view has an angle of 16384 · 2.5e-5 degrees.
        let how = Sampling {
            rounding: 1e-4,
            // All pixels see one place: what merges there is the same for all of a pass.
            ..Sampling::new(if pixels > 1e3 { 4 } else { 256 }, 1024, 0.05)
        };
        run.picture(pixels, "", &job, exact, &how);
    }
}

fn empty(run: &mut Run) {
    let base = SceneDesc {
        camera: view(Vec3::Z * 4.0, Vec3::ZERO, 20.0, 4),
        materials: vec![diffuse("white", 0.5)],
        ..SceneDesc::default()
    };
    let ball = sphere(0, Vec3::ZERO, 1.0, false);
    let sky_alone = SceneDesc {
        lights: vec![sky(1.0)],
        ..base.clone()
    };
    let within = SceneDesc {
        camera: view(Vec3::ZERO, Vec3::X, 20.0, 4),
        spheres: vec![ball.clone()],
        ..sky_alone.clone()
    };
    let unlit = SceneDesc {
        spheres: vec![ball.clone()],
        ..base.clone()
    };
    let lit = SceneDesc {
        spheres: vec![ball],
        lights: vec![point_light(Vec3::Z * 3.0, 1.0)],
        ..base.clone()
    };
    let sky_seen = match run.id() {
        // It meets the lens with no ray from infinity.
        "light" => 0.0,
        _ => 1.0,
    };
    for (i, (name, desc, depth, exact)) in [
        ("nothing", &base, None, 0.0),
        ("sky alone", &sky_alone, None, sky_seen),
        ("no light", &unlit, None, 0.0),
        ("eye within a solid", &within, None, 0.0),
        ("depth 0", &lit, Some(0), 0.0),
    ]
    .into_iter()
    .enumerate()
    {
        let mut job = run.job(desc);
        job.settings.layers.max_depth = depth;
        let found = frame(&job, 0, 2);
        // Chains share their states out over the pixels: their mean is known.
        let values: Vec<f64> = match (&found, run.id()) {
            (Some(f), "pssmlt") => vec![mean_of_layer(f, 0)],
            (Some(f), _) => {
                let pixels = f.layers[0].pixels.iter().flatten();
                pixels.map(|x| f64::from(*x)).collect()
            }
            (None, _) => Vec::new(),
        };
        let off = values.into_iter().map(|x| (x - exact).abs());
        let off = off.fold(0.0, |most: f64, d| if d <= most { most } else { d });
        let off = if found.is_none() { f64::NAN } else { off };
        run.value((i + 1) as f64, name, off, 0.0, 1e-6);
    }
}

fn layers(run: &mut Run) {
    let mut job = run.job(&room(1.0));
    job.settings.layers.components = true;
    let words = ["LE|L.*SE", "L.*GE", "L.*DE"];
    let parsed = words.iter().filter_map(|w| w.parse().ok());
    job.settings.layers.expressions = parsed.collect();
    let Some(found) = frame(&job, 0, run.pick(8, 64)) else {
        return;
    };
    let mean = found.layers[0]
        .pixels
        .iter()
        .flatten()
        .map(|x| f64::from(*x))
        .sum::<f64>()
        / (3 * found.layers[0].pixels.len()) as f64;
    for (i, (name, parts)) in [("components", 1..5), ("expressions", 5..8)]
        .into_iter()
        .enumerate()
    {
        let mut most = 0.0_f64;
        for (p, whole) in found.layers[0].pixels.iter().enumerate() {
            for (c, whole) in whole.iter().enumerate() {
                let sum: f64 = parts
                    .clone()
                    .map(|l| f64::from(found.layers[l].pixels[p][c]))
                    .sum();
                let whole = f64::from(*whole);
                let off = (sum - whole).abs() / whole.abs().max(mean);
                most = if off <= most { most } else { off };
            }
        }
        run.value((i + 1) as f64, name, most, 0.0, 1e-5);
    }
}
