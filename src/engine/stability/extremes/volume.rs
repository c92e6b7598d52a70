//! Media at the ends of their coefficients.

use glam::Vec3;

use super::super::case::{Case, Fit, Run};
use super::super::estimate::{complaints, frame};
use super::super::fits;
use super::super::scenes::{
    block, diffuse, fill_meshes, glass, medium, nothing, point_light, sky, sphere, view,
};
use crate::engine::math::Rgb;
use crate::engine::scene::desc::SceneDesc;
use crate::engine::scene::desc::media::PhaseDesc;

/// Extinctions from 0 to 10⁹.
pub const MEDIUM: Case = Case {
    id: "medium",
    label: "Media of any density",
    summary: "Extinctions 0, 10⁻⁹, 10⁹ and single channels, g = ±0.999, the eye within and \
              without, glass within.",
    parameter: "",
    oracle: "every render ends, finite and not negative",
    stiff: false,
    fit: medium_fit,
    run: extremes,
};

fn medium_fit(id: &str) -> Fit {
    match id {
        "photon" | "light" => fits::diffuse_in_sky(id),
        "pssmlt" => Fit::LeftOut("it runs over bdpt, which is asked"),
        _ => fits::in_media(id),
    }
}

fn extremes(run: &mut Run) {
    let media = [
        ([0.0, 0.0, 0.0], [0.5, 0.5, 0.5]),
        ([1e-9, 1e-9, 1e-9], [1.0, 1.0, 1.0]),
        ([1e9, 1e9, 1e9], [0.5, 0.5, 0.5]),
        ([0.0, 1.0, 5.0], [1.0, 1.0, 0.9]),
        ([5.0, 0.0, 0.0], [0.0, 1.0, 1.0]),
        ([1e9, 1.0, 1e-9], [0.9, 0.9, 0.9]),
    ];
    for (i, (sigma, albedo)) in media.into_iter().enumerate() {
        let (mut wrong, mut trials, mut notes) = (0, 0, Vec::new());
        for g in [-0.999, 0.0, 0.999] {
            for far in [3.0, 1.5] {
                let mut lamp = sphere(1, Vec3::Y, 0.1, false);
                lamp.emission = Some(Rgb::WHITE);
                let mut desc = SceneDesc {
                    camera: view(Vec3::new(0.0, 0.3, 2.5), Vec3::ZERO, 40.0, 8),
                    materials: vec![nothing("none"), diffuse("white", 0.5), glass("glass", 1.5)],
                    meshes: vec![block(0, Vec3::splat(-2.0), Vec3::new(2.0, 2.0, far))],
                    spheres: vec![
                        sphere(1, Vec3::new(0.0, -101.0, 0.0), 100.0, false),
                        sphere(2, Vec3::ZERO, 0.5, false),
                        lamp,
                    ],
                    lights: vec![sky(1.0), point_light(Vec3::new(0.0, 1.3, 0.0), 2.0)],
                    ..SceneDesc::default()
                };
                let mut medium = medium(0.0, 0.0, PhaseDesc::HenyeyGreenstein { g });
                medium.medium.sigma_t = Rgb::new(sigma[0], sigma[1], sigma[2]);
                medium.medium.albedo = Rgb::new(albedo[0], albedo[1], albedo[2]);
                desc.media.media = vec![medium];
                fill_meshes(&mut desc, 1);
                let found = frame(&run.job(&desc), 0, run.pick(1, 4));
                let faults = found.map_or(vec!["not rendered".to_owned()], |found| {
                    let pixels = found.layers[0].pixels.iter().flatten();
                    let negative = pixels.filter(|x| x.is_nan() || **x < 0.0).count();
                    let mut faults = complaints(&found.stats);
                    if negative > 0 {
                        faults.push(format!("{negative} values below 0"));
                    }
                    faults
                });
                wrong += u64::from(!faults.is_empty());
                trials += 1;
                notes.extend(faults);
            }
        }
        let curve = format!("σ = {sigma:?}");
        run.count((i + 1) as f64, &curve, wrong, trials, &notes.join("; "));
    }
}
