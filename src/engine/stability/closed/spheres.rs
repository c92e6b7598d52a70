//! The inside of a diffuse sphere: the geometric series of its albedo.

use std::f64::consts::PI;

use glam::Vec3;

use super::super::case::{Case, Depth, Fit, Run, decades};
use super::super::estimate::Sampling;
use super::super::fits;
use super::super::scenes::{diffuse, point_light, sphere, view};
use crate::engine::math::Rgb;
use crate::engine::scene::desc::SceneDesc;

/// Emission everywhere.
pub const INTEGRATING: Case = Case {
    id: "integrating-sphere",
    label: "Integrating sphere",
    summary: "The inside of a closed diffuse sphere of albedo ρ that emits E everywhere.",
    parameter: "1/(1−ρ)",
    oracle: "E/(1−ρ); E Σ ρᵏ up to the depth of those that end there",
    stiff: true,
    fit: integrating_fit,
    run: integrating,
};

/// A point light in the middle.
pub const POINT: Case = Case {
    id: "sphere-point",
    label: "Sphere around a point light",
    summary: "A closed diffuse sphere of radius R around a point light of intensity I.",
    parameter: "radius R",
    oracle: "ρI/(πR²(1−ρ)); direct alone ρI/(πR²)",
    stiff: false,
    fit: point_fit,
    run: point,
};

/// The view within the sphere: not from its middle.
fn inside(rho: f32, radius: f32, emission: f32) -> SceneDesc {
    let [eye, target] = [Vec3::new(0.3, -0.2, 0.4), Vec3::new(1.0, 0.5, -1.0)].map(|p| p * radius);
    let mut wall = sphere(0, Vec3::ZERO, radius, true);
    if emission > 0.0 {
        wall.emission = Some(Rgb::splat(emission));
    }
    SceneDesc {
        camera: view(eye, target, 90.0, 4),
        materials: vec![diffuse("wall", rho)],
        spheres: vec![wall],
        ..SceneDesc::default()
    }
}

/// Σ ρᵏ of as many events as the integrator follows.
fn series(id: &str, rho: f64) -> f64 {
    match id {
        "whitted" => 1.0 + rho,
        // The depth of its fit.
        "monte-carlo" => (1.0 - rho.powi(17)) / (1.0 - rho),
        _ => 1.0 / (1.0 - rho),
    }
}

fn integrating_fit(id: &str) -> Fit {
    match id {
        "photon" => Fit::LeftOut(
            "its map holds each photon's thousand landings in place of a thousand photons; \
             sphere-point and photon-power ask it",
        ),
        _ => fits::closed_room(id),
    }
}

/// The brightest room that an integrator is asked to render, as 1/(1−ρ), in powers of ten.
fn brightest(id: &str, depth: Depth) -> usize {
    let full = depth == Depth::Full;
    match id {
        // One walk a sample.
        "path" => 3 + usize::from(full),
        // Its noise falls on few pixels.
        "light" => 3,
        "whitted" | "monte-carlo" => 4,
        // A walk merges with the vertices of all others: as many as the room is bright.
        "sppm" => 2,
        // Connections grow with the square of the length of walks.
        "bdpt" | "vcm" => 1,
        // Chains of as many numbers as their longest walk takes.
        _ => 1,
    }
}

fn integrating(run: &mut Run) {
    let rooms = [0.5_f32, 0.9, 0.99, 0.999, 0.9999];
    let last = brightest(run.id(), run.depth);
    for (i, rho) in rooms.into_iter().take(last + 1).enumerate() {
        let exact = series(run.id(), f64::from(rho));
        let job = run.job(&inside(rho, 1.0, 1.0));
        // A walk of a thousand events costs a thousand times as much.
        let bound = run.pick(
            [0.02, 0.02, 0.05, 0.1, 0.2],
            [0.005, 0.005, 0.01, 0.03, 0.1],
        )[i];
        let first = if i < 3 { 4 } else { 1 };
        let how = Sampling::new(first, 4096, bound);
        run.picture(1.0 / (1.0 - f64::from(rho)), "", &job, exact, &how);
    }
}

fn point_fit(id: &str) -> Fit {
    fits::closed_room_point(id)
}

fn point(run: &mut Run) {
    let rho = 0.75_f32;
    let slow = matches!(run.id(), "photon" | "pssmlt");
    let exponents = if slow && run.depth == Depth::Quick {
        0..=0
    } else {
        -6..=6
    };
    for radius in decades(exponents, run.pick(6, 3)) {
        let mut desc = inside(rho, radius as f32, 0.0);
        let r = f64::from(radius as f32);
        // As much light on the wall whatever its size.
        let intensity = (3.0 * r * r) as f32;
        desc.lights.push(point_light(Vec3::ZERO, intensity));
        let direct = f64::from(rho) * f64::from(intensity) / (PI * r * r);
        let job = run.job(&desc);
        // A map is built for each pass of photon mapping.
        let how = match run.id() {
            "photon" => Sampling::new(1, run.pick(1, 64), run.pick(0.08, 0.03)),
            _ => Sampling::new(4, run.pick(2048, 1 << 14), run.pick(0.02, 0.005)),
        };
        // What is emitted here is direct light: k events bring ρ^(k−1) of it.
        let total = match run.id() {
            "whitted" => direct,
            "monte-carlo" => direct * (1.0 - f64::from(rho).powi(16)) / (1.0 - f64::from(rho)),
            _ => direct / (1.0 - f64::from(rho)),
        };
        run.picture(radius, "total", &job, total, &how);
    }
}
