//! Mirrors and glass.

use glam::Vec3;

use super::super::case::{Case, Fit, Run};
use super::super::estimate::Sampling;
use super::super::fits;
use super::super::scenes::{diffuse, glass, mirror, sky, sphere, square, view};
use crate::engine::math::Rgb;
use crate::engine::scene::desc::SceneDesc;

/// A sky behind many mirrors.
pub const CHAIN: Case = Case {
    id: "mirror-chain",
    label: "Chain of mirrors",
    summary: "A sky seen over n mirrors, which together leave half of it.",
    parameter: "mirrors n",
    oracle: "rⁿ L",
    stiff: false,
    fit: chain_fit,
    run: chain,
};

/// A plate of glass.
pub const SLAB: Case = Case {
    id: "fresnel-slab",
    label: "Plate of glass",
    summary: "A lamp seen straight through a plate of index n with all inner reflections.",
    parameter: "index n",
    oracle: "T = (1−R)²/(1−R²) with R = ((n−1)/(n+1))²",
    stiff: false,
    fit: slab_fit,
    run: slab,
};

/// A sky seen from within glass.
pub const REFRACTION: Case = Case {
    id: "refraction-radiance",
    label: "Radiance within glass",
    summary: "A constant sky seen from within a closed ball of glass.",
    parameter: "index n",
    oracle: "n² L in all; (1−F) n² L on the direct way from the middle",
    stiff: false,
    fit: fits::specular_only,
    run: refraction,
};

fn chain_fit(id: &str) -> Fit {
    match id {
        "pssmlt" => {
            Fit::LeftOut("its chains would mutate ten thousand numbers of which none matters")
        }
        _ => fits::specular_only(id),
    }
}

fn chain(run: &mut Run) {
    let sure = run.variant.name == "hits";
    for n in [1_u32, 10, 100, 1000, 10_000] {
        // Roulette makes noise of the loss: each sample of a long chain is worth little.
        if !sure && n > run.pick(100, 1000) {
            continue;
        }
        let r = 0.5_f64.powf(1.0 / f64::from(n)) as f32;
        // Between planes at y = 0 and 1 a ray of slope 1 meets one at x = ½, 1½, 2½ …; the mirrors
        // end half a step after the last.
        let half = 0.5 * n as f32;
        let mut desc = SceneDesc {
            camera: view(Vec3::new(0.0, 0.5, 0.0), Vec3::new(0.5, 0.0, 0.0), 1e-4, 2),
            materials: vec![mirror("mirror", r)],
            lights: vec![sky(1.0)],
            ..SceneDesc::default()
        };
        for (y, side) in [(0.0, 1.0), (1.0, -1.0)] {
            let center = Vec3::new(half, y, 0.0);
            desc.meshes
                .push(square(0, center, Vec3::Z * side, Vec3::X * half));
        }
        let exact = f64::from(r).powi(n as i32);
        // Each of n products is rounded.
        let rounding = 1e-5 + f64::from(n) * 6e-8;
        let how = match sure {
            true => Sampling::every_pixel(8, rounding),
            false => Sampling {
                rounding: 2e-5 + rounding,
                ..Sampling::new(64, 4096, 0.05)
            },
        };
        let job = run.job(&desc);
        run.picture(f64::from(n), "", &job, exact, &how);
    }
}

fn slab_fit(id: &str) -> Fit {
    match id {
        "pssmlt" => Fit::LeftOut("the mean is known from its bootstrap alone, which runs bdpt"),
        "path" => fits::path_only(id),
        _ => fits::specular_only(id),
    }
}

fn slab(run: &mut Run) {
    for n in [1.0_f32 - 1e-6, 1.0, 1.0 + 1e-6, 1.5, 2.4, 1e3] {
        let mut desc = SceneDesc {
            camera: view(Vec3::Y * 9.0, Vec3::ZERO, 0.01, 2),
            materials: vec![glass("glass", n), diffuse("lamp", 0.0)],
            ..SceneDesc::default()
        };
        for (y, side) in [(1.0, 1.0), (0.0, -1.0)] {
            let (u, v) = (Vec3::Z * side * 50.0, Vec3::X * 50.0);
            desc.meshes.push(square(0, Vec3::Y * y, u, v));
        }
        let mut lamp = square(1, Vec3::Y * -2.0, Vec3::Z * 50.0, Vec3::X * 50.0);
        lamp.emission = Some(Rgb::splat(2.0));
        desc.meshes.push(lamp);
        let r = ((f64::from(n) - 1.0) / (f64::from(n) + 1.0)).powi(2);
        let exact = 2.0 * (1.0 - r).powi(2) / (1.0 - r * r);
        // At index 1000 one path in 250 gets through.
        let bound = if n > 100.0 {
            run.pick(0.5, 0.1)
        } else {
            run.pick(0.03, 0.01)
        };
        let how = Sampling::new(64, run.pick(1 << 13, 1 << 16), bound);
        let job = run.job(&desc);
        run.picture(f64::from(n), "", &job, exact, &how);
    }
}

fn refraction(run: &mut Run) {
    let sure = run.variant.name == "hits";
    for n in [1.0_f32, 1.0 + 1e-6, 1.5, 2.4] {
        let mut desc = SceneDesc {
            camera: view(Vec3::X * 0.3, Vec3::new(1.0, 0.4, 0.2), 60.0, 4),
            materials: vec![glass("glass", n)],
            spheres: vec![sphere(0, Vec3::ZERO, 1.0, false)],
            lights: vec![sky(1.0)],
            ..SceneDesc::default()
        };
        let n2 = f64::from(n).powi(2);
        let how = match sure {
            true => Sampling::every_pixel(8, 1e-5),
            false => Sampling::new(16, run.pick(2048, 16384), run.pick(0.03, 0.01)),
        };
        let job = run.job(&desc);
        run.picture(f64::from(n), "all ways", &job, n2, &how);

        // From the middle every ray leaves perpendicularly.
        desc.camera.position = Vec3::ZERO;
        let mut job = run.job(&desc);
        job.settings.layers.max_depth = Some(1);
        let f = ((f64::from(n) - 1.0) / (f64::from(n) + 1.0)).powi(2);
        let how = Sampling::new(16, run.pick(2048, 16384), run.pick(0.03, 0.01));
        run.picture(f64::from(n), "direct way", &job, (1.0 - f) * n2, &how);
    }
}
