//! White objects in a constant sky.

use glam::Vec3;

use super::super::case::{Case, Fit, Run};
use super::super::estimate::Sampling;
use super::super::scenes::{diffuse, ggx, glass, grey, mirror, named, sky, sphere, square, view};
use super::super::{fits, oracles};
use crate::engine::scene::desc::{MaterialDesc, NamedMaterial, SceneDesc};

/// They vanish.
pub const OBJECT: Case = Case {
    id: "furnace-object",
    label: "White furnace",
    summary: "White diffuse, mirror, glass and plastic balls in a constant sky, all of the view \
              within the ball.",
    parameter: "material",
    oracle: "the sky's radiance",
    stiff: false,
    fit: object_fit,
    run: object,
};

/// They show their directional albedo.
pub const GGX: Case = Case {
    id: "furnace-ggx",
    label: "GGX furnace",
    summary: "A GGX reflector in a constant sky, seen from straight above to grazing.",
    parameter: "roughness α",
    oracle: "the directional albedo, integrated apart in f64 (1 at α = 0); of those who \
             find light by shadow rays alone, α < ½ is reported",
    stiff: true,
    fit: ggx_fit,
    run: directional_albedo,
};

fn object_fit(id: &str) -> Fit {
    match id {
        "photon" => Fit::LeftOut(
            "sky photons that glass and plastic bring are estimated over discs that leave the ball",
        ),
        "pssmlt" => Fit::LeftOut("the mean is known from its bootstrap alone, which runs bdpt"),
        _ => fits::diffuse_in_sky(id),
    }
}

fn ball(material: NamedMaterial) -> SceneDesc {
    SceneDesc {
        camera: view(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, 20.0, 8),
        materials: vec![material],
        spheres: vec![sphere(0, Vec3::ZERO, 1.0, false)],
        lights: vec![sky(1.0)],
        ..SceneDesc::default()
    }
}

fn object(run: &mut Run) {
    let plastic = MaterialDesc::Plastic {
        diffuse_reflectance: grey(1.0),
        ior: 1.5,
        nonlinear: true,
    };
    let materials = [
        diffuse("diffuse", 1.0),
        mirror("mirror", 1.0),
        glass("glass", 1.5),
        named("plastic", plastic),
    ];
    for (i, material) in materials.into_iter().enumerate() {
        let name = material.name.clone();
        let deep = matches!(name.as_str(), "glass");
        let lost = match run.id() {
            // Blind to what a mirror shows, of which plastic has some.
            "light" => name != "diffuse",
            // Beyond its number of branches it follows one of two ways.
            _ => false,
        };
        if lost {
            continue;
        }
        let mut job = run.job(&ball(material));
        let hits = run.variant.name == "hits";
        if hits {
            // Roulette would turn certainty into noise.
            let params = job.settings.integrator.params;
            let set = job.settings.params.set(params, "roulette", "1000");
            debug_assert!(set.is_ok());
        }
        let how = match (hits, deep || name == "mirror" || name == "diffuse") {
            (true, true) => Sampling::every_pixel(16, 1e-5),
            _ => Sampling::new(4, run.pick(2048, 1 << 15), run.pick(0.01, 0.002)),
        };
        run.picture((i + 1) as f64, &name, &job, 1.0, &how);
    }
}

fn ggx_fit(id: &str) -> Fit {
    match id {
        "pssmlt" => Fit::LeftOut("the mean is known from its bootstrap alone, which runs bdpt"),
        "light" => Fit::LeftOut("no light path lands in so narrow a view by chance"),
        _ => fits::diffuse_in_sky(id),
    }
}

fn directional_albedo(run: &mut Run) {
    let alphas: &[f32] = run.pick(
        &[1.0, 0.1, 1e-2, 1e-4],
        &[1.0, 0.5, 0.2, 0.1, 0.03, 1e-2, 1e-3, 1e-4],
    );
    let angles: &[f32] = run.pick(&[0.95, 0.1], &[1.0, 0.7, 0.3, 0.1, 0.02]);
    for &cos in angles {
        for &alpha in alphas {
            let from = Vec3::new(0.0, (1.0 - cos * cos).sqrt(), cos);
            let desc = SceneDesc {
                camera: view(4.0 * from, Vec3::ZERO, 0.01, 2),
                materials: vec![ggx("metal", alpha)],
                meshes: vec![square(0, Vec3::ZERO, Vec3::X, Vec3::Y)],
                lights: vec![sky(1.0)],
                ..SceneDesc::default()
            };
            let exact = oracles::ggx_albedo(f64::from(alpha), f64::from(cos));
            let how = Sampling::new(4, run.pick(1024, 1 << 14), run.pick(0.02, 0.005));
            let job = run.job(&desc);
            let curve = format!("cosθ = {cos}");
            // Shadow rays alone do not find a lobe that is narrower than their density of the sky.
            let blind = run.id() == "whitted" || run.variant.name == "kajiya";
            if blind && alpha < 0.5 {
                run.report(f64::from(alpha), &curve, &job, exact, &how);
            } else {
                run.picture(f64::from(alpha), &curve, &job, exact, &how);
            }
        }
    }
}
