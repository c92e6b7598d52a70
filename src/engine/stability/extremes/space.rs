//! Sizes and places of whole scenes.

use std::f64::consts::PI;

use glam::Vec3;

use super::super::case::{Case, Fit, Run, decades};
use super::super::estimate::{Sampling, frame, mean_of, means};
use super::super::scenes::{diffuse, point_light, room, sphere, square, view};
use super::super::{fits, oracles};
use crate::engine::film::Frame;
use crate::engine::scene::desc::SceneDesc;

/// A room of any size.
pub const SCALE: Case = Case {
    id: "scale",
    label: "Scale",
    summary: "A room with diffuse, glossy, mirror and glass surfaces, scaled as a whole.",
    parameter: "factor",
    oracle: "the room of factor 1: bit for bit under powers of two, else within confidence",
    stiff: false,
    fit: scale_fit,
    run: scale,
};

/// A sphere far from the origin.
pub const TRANSLATE: Case = Case {
    id: "translate",
    label: "Distance from the origin",
    summary: "The sphere around a point light, moved away from the origin. Coordinates keep 24 \
              bits: at a distance of 10⁵ sizes the scene itself is known to a hundredth.",
    parameter: "distance / size",
    oracle: "ρI/(πR²(1−ρ)), within 2 % up to 10³ sizes; beyond it is reported",
    stiff: false,
    fit: translate_fit,
    run: translate,
};

/// A plane through a telescope.
pub const TELEPHOTO: Case = Case {
    id: "telephoto",
    label: "Telephoto",
    summary: "The plane under a point light from farther and farther away through narrower views.",
    parameter: "distance of the eye",
    oracle: "ρ I cosθ/(π r²), averaged over the view",
    stiff: false,
    fit: telephoto_fit,
    run: telephoto,
};

fn scale_fit(id: &str) -> Fit {
    match id {
        "path" => fits::path_modes(id),
        "monte-carlo" => fits::direct_point(id),
        _ => fits::diffuse_in_sky(id),
    }
}

/// Largest difference of two pixels over the mean of the picture.
fn farthest(a: &Frame, b: &Frame) -> f64 {
    let values = |f: &Frame| -> Vec<f64> {
        let pixels = f.layers[0].pixels.iter().flatten();
        pixels.map(|x| f64::from(*x)).collect()
    };
    let (a, b) = (values(a), values(b));
    let mean = a.iter().sum::<f64>() / a.len() as f64;
    let differences = a.iter().zip(&b).map(|(a, b)| (a - b).abs() / mean);
    differences.fold(0.0, |most, d| if d <= most { most } else { d })
}

fn scale(run: &mut Run) {
    let unit = run.job(&room(1.0));
    let passes = run.pick(2, 8);
    let Some(expected) = frame(&unit, 0, passes) else {
        return;
    };
    for exponent in [-20, 20] {
        let size = 2.0_f32.powi(exponent);
        let found = frame(&run.job(&room(size)), 0, passes);
        let off = found.map_or(f64::NAN, |f| farthest(&f, &expected));
        run.value(f64::from(size), "powers of two", off, 0.0, 0.0);
    }
    let passes = run.pick(4, 32);
    let expected = means(&unit, passes);
    for size in decades(-6..=6, 12) {
        let found = means(&run.job(&room(size as f32)), passes);
        // The same random numbers: most of the noise is in both.
        let ratios: Vec<f64> = found.iter().zip(&expected).map(|(a, b)| a / b).collect();
        let (mean, half) = mean_of(&ratios);
        run.mean(
            size,
            "powers of ten",
            (mean, half + 1e-4),
            1.0,
            run.pick(0.3, 0.1),
        );
    }
}

fn translate_fit(id: &str) -> Fit {
    match id {
        "monte-carlo" | "whitted" => Fit::LeftOut("their words are too short for the closed form"),
        "pssmlt" => Fit::LeftOut("it runs over bdpt, which is asked"),
        _ => fits::closed_room_point(id),
    }
}

fn translate(run: &mut Run) {
    let (rho, intensity) = (0.75_f32, 3.0_f32);
    for offset in std::iter::once(1.0).chain(decades(2..=7, 1)) {
        let center = Vec3::splat(offset as f32);
        let desc = SceneDesc {
            camera: view(
                center + Vec3::new(0.25, -0.25, 0.5),
                center + Vec3::new(1.0, 0.5, -1.0),
                90.0,
                4,
            ),
            materials: vec![diffuse("wall", rho)],
            spheres: vec![sphere(0, center, 1.0, true)],
            lights: vec![point_light(center, intensity)],
            ..SceneDesc::default()
        };
        let exact = f64::from(rho) * f64::from(intensity) / (PI * (1.0 - f64::from(rho)));
        // A pass of maps takes as long as many of paths.
        let (first, bounds) = if run.id() == "photon" {
            (1, (0.05, 0.02))
        } else {
            (16, (0.02, 0.01))
        };
        let bound = run.pick(bounds.0, bounds.1);
        let how = Sampling::new(first, run.pick(1024, 8192), bound);
        let job = run.job(&desc);
        if offset > 2e3 {
            run.report(offset, "", &job, exact, &how);
        } else {
            let how = Sampling {
                // The wall is rounded to 2⁻²⁴ of its coordinates.
                rounding: 2e-5 + offset * 4.0 * f64::from(f32::EPSILON),
                ..how
            };
            run.picture(offset, "", &job, exact, &how);
        }
    }
}

fn telephoto_fit(id: &str) -> Fit {
    match id {
        "pssmlt" => Fit::LeftOut("it runs over bdpt, which is asked"),
        _ => fits::direct_point(id),
    }
}

fn telephoto(run: &mut Run) {
    let (rho, intensity) = (0.5_f32, 7.0_f32);
    for far in [1.0_f32, 100.0, 1e4] {
        let tan = 0.4 / far;
        let desc = SceneDesc {
            camera: view(Vec3::Y * far, Vec3::ZERO, 2.0 * tan.atan().to_degrees(), 4),
            materials: vec![diffuse("floor", rho)],
            meshes: vec![square(0, Vec3::ZERO, Vec3::Z * 2.0, Vec3::X * 2.0)],
            lights: vec![point_light(Vec3::Y * 0.5, intensity)],
            ..SceneDesc::default()
        };
        let (far, tan) = (f64::from(far), f64::from(tan));
        let exact = oracles::falloff(f64::from(rho), f64::from(intensity), 0.5, far, tan);
        let how = Sampling {
            // A direction is known to 2⁻²⁴, of which a narrow view has few.
            rounding: 2e-5 + f64::from(f32::EPSILON) / tan,
            ..Sampling::new(16, run.pick(1024, 8192), run.pick(0.02, 0.005))
        };
        let job = run.job(&desc);
        run.picture(far, "", &job, exact, &how);
    }
}
