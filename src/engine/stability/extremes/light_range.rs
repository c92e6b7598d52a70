//! Lights of any power, number and texels.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{Quat, Vec3};

use super::super::case::{Case, ENGINE, Fit, Run, decades};
use super::super::estimate::Sampling;
use super::super::scenes::{diffuse, point_light, sphere, square, view};
use super::super::{fits, oracles};
use crate::engine::math::Rgb;
use crate::engine::scene::Scene;
use crate::engine::scene::desc::{ImageData, LightDesc, SceneDesc};

/// One light outshines another that is seen; very many lights; one texel that outshines a sky.
pub const RANGE: Case = Case {
    id: "light-dynamic-range",
    label: "Dynamic range of lights",
    summary: "A plane under a point light, and a lamp of R times the power that no wall lets \
              through; under a hundred thousand point lights; under a sky of which one texel is R \
              times as bright.",
    parameter: "ratio R, or number of lights",
    oracle: "ρ I cosθ/(π r²): the hidden lamp adds nothing, and many lights add up. Who draws one \
             light in proportion to its power has a variance that grows with R: judged up to 10², \
             then reported. ρ/π Σ L ∫cosθ dω over the texels; probabilities sum to 1; texels that \
             are no radiance are refused in a sentence",
    stiff: true,
    fit: range_fit,
    run: range,
};

const RHO: f32 = 0.5;
const INTENSITY: f32 = 7.0;
/// Number of point lights.
const MANY: usize = 100_000;

fn range_fit(id: &str) -> Fit {
    match id {
        ENGINE => fits::engine(id),
        "sppm" | "vcm" | "pssmlt" => Fit::LeftOut("they draw lights as bdpt does, which is asked"),
        _ => fits::direct_point(id),
    }
}

fn range(run: &mut Run) {
    if run.id() == ENGINE {
        probabilities(run);
        bad_texels(run);
        return;
    }
    hidden(run);
    many(run);
    bright_texel(run);
}

/// A floor that is seen from 2 above, in pictures of `pixels`².
fn floor(pixels: u32, vfov: f32, lights: Vec<LightDesc>) -> SceneDesc {
    SceneDesc {
        camera: view(Vec3::Y * 2.0, Vec3::ZERO, vfov, pixels),
        materials: vec![diffuse("floor", RHO), diffuse("wall", 0.0)],
        meshes: vec![square(0, Vec3::ZERO, Vec3::Z * 4.0, Vec3::X * 4.0)],
        lights,
        ..SceneDesc::default()
    }
}

/// Whether it asks all lights at every point, and draws none.
fn asks_all(run: &Run) -> bool {
    run.variant.name == "kajiya" || run.id() == "whitted"
}

fn hidden(run: &mut Run) {
    for ratio in decades(0..=run.pick(8, 12), 2) {
        let below = Vec3::new(0.0, -9.0, 0.0);
        let lights = vec![
            point_light(Vec3::Y, INTENSITY),
            point_light(below, INTENSITY * ratio as f32),
        ];
        let desc = SceneDesc {
            // Closed all around the hidden lamp.
            spheres: vec![sphere(1, below, 1.0, true)],
            ..floor(4, 40.0, lights)
        };
        let tan = 20_f64.to_radians().tan();
        let exact = oracles::falloff(f64::from(RHO), f64::from(INTENSITY), 1.0, 2.0, tan);
        let job = run.job(&desc);
        let how = Sampling::new(16, run.pick(1 << 14, 1 << 17), run.pick(0.05, 0.02));
        if asks_all(run) || ratio < 1e3 {
            run.picture(ratio, "hidden lamp", &job, exact, &how);
        } else {
            run.report(ratio, "hidden lamp", &job, exact, &how);
        }
    }
}

/// Lights in one place, the i-th of i parts of the whole intensity.
fn many(run: &mut Run) {
    let parts = (MANY * (MANY + 1) / 2) as f32;
    let light = |i: usize| point_light(Vec3::Y, INTENSITY * (i as f32 / parts));
    let desc = floor(1, 0.01, (1..=MANY).map(light).collect());
    let exact = f64::from(RHO) * f64::from(INTENSITY) / PI;
    let how = Sampling {
        // A sum of so many `f32` numbers, where all lights are asked.
        rounding: 1e-4,
        ..Sampling::new(1, 1 << 12, 0.05)
    };
    if run.id() == "light" {
        let note = "not asked: no light path lands in so narrow a view by chance";
        return run.fact(MANY as f64, "many lights", 0.0, note);
    }
    run.picture(MANY as f64, "many lights", &run.job(&desc), exact, &how);
}

/// A sky of 64 × 32 texels.
fn sky(texel: [f32; 3]) -> ImageData {
    let (width, height) = (64, 32);
    let mut pixels = vec![[1.0; 3]; width * height];
    pixels[BRIGHT.0 * width + BRIGHT.1] = texel;
    ImageData {
        name: "sky".into(),
        width,
        height,
        pixels,
    }
}

/// Row and column of the texel that is not as the others, 34 degrees from above.
const BRIGHT: (usize, usize) = (6, 20);

fn under(image: ImageData) -> LightDesc {
    LightDesc::Environment {
        image: Arc::new(image),
        scale: Rgb::WHITE,
        rotation: Quat::IDENTITY,
    }
}

fn bright_texel(run: &mut Run) {
    for ratio in decades(0..=6, 2) {
        let lights = vec![under(sky([ratio as f32; 3]))];
        // The whole upper half weighs π; ∫ cosθ dω over a texel is Δφ (sin²θ₂ − sin²θ₁)/2.
        let theta = |row: usize| PI * row as f64 / 32.0;
        let (a, b) = (theta(BRIGHT.0).sin(), theta(BRIGHT.0 + 1).sin());
        let texel = 2.0 * PI / 64.0 * (b * b - a * a) / 2.0;
        let exact = f64::from(RHO) / PI * (PI + (ratio - 1.0) * texel);
        let how = Sampling::new(16, run.pick(1 << 13, 1 << 16), run.pick(0.05, 0.02));
        let job = run.job(&floor(4, 80.0, lights));
        run.picture(ratio, "bright texel", &job, exact, &how);
    }
}

fn probabilities(run: &mut Run) {
    // 1e-12 … 1e12 W in turn, then all of one power.
    let powers: [fn(usize) -> f32; 2] = [|i| 10_f32.powi(i as i32 % 25 - 12), |_| 1.0];
    for (x, powers) in powers.into_iter().enumerate() {
        let lights = (0..MANY).map(|i| point_light(Vec3::Y, powers(i))).collect();
        let Ok(scene) = Scene::build(&floor(1, 1.0, lights)) else {
            return run.count(MANY as f64, "refused", 1, 1, "a scene of so many lights");
        };
        let lights = &scene.lights;
        let each = (0..lights.len() as u32).map(|id| f64::from(lights.pmf(id)));
        run.value((x + 1) as f64, "sum of probabilities", each.sum(), 1.0, 0.0);
        let never = (0..lights.len() as u32).filter(|id| lights.pmf(*id) <= 0.0);
        let never = never.count() + MANY - lights.len();
        let note = "lights that are never drawn";
        run.count((x + 1) as f64, "drawn", never as u64, MANY as u64, note);
        // In cells of 2⁻²⁴: one for each light, the others in proportion to the powers.
        let cells = 2_f64.powi(24);
        let whole: f64 = (0..MANY).map(|i| f64::from(powers(i))).sum();
        let off = (0..MANY).map(|i| {
            let share = 1.0 + (cells - MANY as f64) * f64::from(powers(i)) / whole;
            (f64::from(lights.pmf(i as u32)) * cells - share).abs()
        });
        let off = off.fold(0.0, f64::max);
        // Two of them for rounding.
        let curve = "probability against power";
        run.value((x + 1) as f64, curve, off / cells, 0.0, 2.0 / cells);
    }
}

fn bad_texels(run: &mut Run) {
    let texels = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, -1e-30];
    let mut wrong = 0;
    for value in texels {
        let scene = Scene::build(&floor(1, 1.0, vec![under(sky([1.0, value, 1.0]))]));
        let place = format!("column {}, row {}", BRIGHT.1, BRIGHT.0);
        wrong += u64::from(!scene.is_err_and(|error| error.contains(&place)));
    }
    let note = "texels that no sentence refuses";
    run.count(1.0, "bad texels", wrong, texels.len() as u64, note);
    let mut black = sky([0.0; 3]);
    black.pixels.fill([0.0; 3]);
    let scene = Scene::build(&floor(1, 1.0, vec![under(black)]));
    let lit = scene.map_or(1, |scene| scene.lights.len());
    run.count(
        2.0,
        "black sky",
        lit as u64,
        1,
        "black skies that are drawn",
    );
}
