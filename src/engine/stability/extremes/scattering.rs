//! Scattering at surfaces.

use std::f64::consts::PI;

use glam::{Vec2, Vec3, Vec3A};

use super::super::case::{Case, Fit, Run};
use super::super::estimate::Sampling;
use super::super::fits;
use super::super::scenes::{diffuse, ggx, glass, grey, mirror, named, sky, sphere, view};
use crate::engine::bsdf::{Bsdf, Transport};
use crate::engine::event::Event;
use crate::engine::geometry::SurfaceInteraction;
use crate::engine::math::float::ONE_MINUS_EPSILON;
use crate::engine::sampling::{Sampler, SobolSampler, Stream, warp};
use crate::engine::scene::desc::{MaterialDesc, NamedMaterial, SceneDesc};
use crate::engine::scene::material::Material;

/// Microfacets.
pub const GGX: Case = Case {
    id: "ggx",
    label: "GGX from mirror to chalk",
    summary: "Density and reflectance of GGX reflection over all directions, to grazing.",
    parameter: "roughness α",
    oracle: "∫ pdf and the share of rejected samples sum to 1; ∫ f cosθ ≤ 1; α = 0 is a mirror",
    stiff: false,
    fit: fits::engine,
    run: microfacets,
};

/// Glass within glass.
pub const IOR: Case = Case {
    id: "ior",
    label: "Indices of refraction",
    summary: "A diffuse ball within two balls of glass, overlapping or nested, under a constant sky.",
    parameter: "index n",
    oracle: "ρ L for n = 1; L for ρ = 1 and any n",
    stiff: false,
    fit: ior_fit,
    run: ior,
};

/// The ends of the unit interval.
pub const ENDS: Case = Case {
    id: "random-ends",
    label: "Random numbers 0 and 1 − 2⁻²⁴",
    summary: "Every lobe and every warp at the ends of its random numbers.",
    parameter: "",
    oracle: "densities > 0, everything finite, weights not negative",
    stiff: false,
    fit: fits::engine,
    run: ends,
};

/// The scattering of a material at a surface with normal +z.
fn bsdf(material: NamedMaterial) -> Option<Bsdf> {
    let si = SurfaceInteraction {
        p: Vec3A::ZERO,
        p_error: Vec3A::ZERO,
        n_g: Vec3A::Z,
        n_s: Vec3A::Z,
        uv: Vec2::ZERO,
        wo: Vec3A::Z,
        t: 1.0,
        material: 0,
        light: None,
        prim: 0,
    };
    let material = Material::build(0, &[material]).ok()?;
    Some(material.bsdf(&si))
}

/// ∫ pdf and ∫ f cosθ over the half vectors, on a grid that follows the roughness.
fn integrals(bsdf: &Bsdf, alpha: f64, wo: Vec3A) -> (f64, f64) {
    let (rings, sectors) = (600, 300);
    let (mut pdf, mut f) = (0.0, 0.0);
    for i in 0..rings {
        let s = (f64::from(i) + 0.5) / f64::from(rings);
        let (u, du) = (1.0 - (1.0 - s).powi(4), 4.0 * (1.0 - s).powi(3));
        let tan2 = alpha * alpha * u / (1.0 - u);
        let cos = 1.0 / (1.0 + tan2).sqrt();
        let sin = tan2.sqrt() * cos;
        // D cosθ dω is du dφ/2π (Walter et al. 2007, equation 33).
        let k = cos * cos * (alpha * alpha + tan2);
        let d = alpha * alpha / (PI * k * k);
        for j in 0..sectors {
            let phi = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(sectors);
            let h = Vec3A::new(
                (sin * phi.cos()) as f32,
                (sin * phi.sin()) as f32,
                cos as f32,
            );
            let oh = wo.dot(h);
            let wi = (2.0 * oh * h - wo).normalize();
            if oh <= 0.0 {
                continue;
            }
            let dw = 4.0 * f64::from(oh) * du / (d * cos);
            pdf += f64::from(bsdf.pdf(Event::Glossy, wo, wi)) * dw;
            f += f64::from(bsdf.eval(Event::Glossy, wo, wi, Transport::Radiance)[0]) * dw;
        }
    }
    let n = f64::from(rings * sectors);
    (pdf / n, f / n)
}

fn microfacets(run: &mut Run) {
    for cos in [1.0_f32, 0.5, 0.1, 0.01] {
        let wo = Vec3A::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        for alpha in [1.0_f32, 0.3, 0.1, 0.01, 1e-3, 1e-4] {
            let Some(bsdf) = bsdf(ggx("metal", alpha)) else {
                return run.count(f64::from(alpha), "", 1, 1, "no such material");
            };
            let (pdf, f) = integrals(&bsdf, f64::from(alpha), wo);
            let n = 1 << 16;
            let rejected = (0..n).filter(|i| {
                let mut s = SobolSampler::new(1, Stream::Test, (0, *i));
                let (u, v) = (s.next_1d(), s.next_2d());
                bsdf.sample(wo, u, v, Transport::Radiance).is_none()
            });
            let rejected = rejected.count() as f64 / n as f64;
            let curve = format!("cosθ = {cos}");
            run.value(
                f64::from(alpha),
                &format!("∫ pdf, {curve}"),
                pdf + rejected,
                1.0,
                0.01,
            );
            let gain = (f - 1.0).max(0.0);
            run.value(f64::from(alpha), &format!("∫ f, {curve}"), gain, 0.0, 0.002);
        }
    }
}

fn ior_fit(id: &str) -> Fit {
    match id {
        "path" => Fit::Asked(&[super::super::case::Variant {
            name: "hits",
            set: &[("mode", "hits"), ("roulette", "10000000")],
            bias: 0.0,
        }]),
        "bdpt" | "vcm" => fits::specular_only(id),
        "pssmlt" => Fit::LeftOut("it runs over bdpt, which is asked"),
        "light" => Fit::LeftOut("it is blind to all that is seen in a mirror or through glass"),
        _ => {
            Fit::LeftOut("light that comes through glass and is scattered arrives by no shadow ray")
        }
    }
}

fn ior(run: &mut Run) {
    let sure = run.id() == "path";
    for (name, shift, rho) in [
        ("nested, ρ = 1", 0.0, 1.0_f32),
        ("overlapping, ρ = 1", 0.5, 1.0),
        ("nested, ρ = ½", 0.0, 0.5),
    ] {
        for n in [1.0_f32 - 1e-6, 1.0, 1.0 + 1e-6, 1.5, 2.4, 1e3] {
            if rho < 1.0 && n != 1.0 {
                continue;
            }
            // Light is lost nowhere, but a path may stay within for a thousand reflections.
            if n > 100.0 && !sure {
                continue;
            }
            let desc = SceneDesc {
                camera: view(Vec3::Z * 6.0, Vec3::ZERO, 10.0, 4),
                materials: vec![diffuse("white", rho), glass("inner", n), glass("outer", n)],
                spheres: vec![
                    sphere(0, Vec3::ZERO, 1.0, false),
                    sphere(1, Vec3::ZERO, 1.5, false),
                    sphere(2, Vec3::X * shift, 2.25, false),
                ],
                lights: vec![sky(1.0)],
                ..SceneDesc::default()
            };
            let how = match (sure, rho == 1.0) {
                (true, true) => Sampling::every_pixel(4, 2e-5),
                (true, false) => Sampling::new(64, run.pick(1024, 8192), 0.02),
                _ => Sampling::new(16, run.pick(512, 4096), run.pick(0.05, 0.02)),
            };
            // Seen along the axis the whole view is within the diffuse ball where nothing bends.
            let exact = if n == 1.0 { f64::from(rho) } else { 1.0 };
            let job = run.job(&desc);
            run.picture(f64::from(n), name, &job, exact, &how);
        }
    }
}

const ALL_ENDS: [f32; 4] = [0.0, f32::MIN_POSITIVE, 0.5, ONE_MINUS_EPSILON];

fn ends(run: &mut Run) {
    let materials = [
        diffuse("diffuse", 0.8),
        mirror("mirror", 1.0),
        glass("glass", 1.5),
        ggx("metal", 0.3),
        ggx("polished", 1e-4),
        named(
            "rough glass",
            MaterialDesc::RoughDielectric {
                ior: 1.5,
                alpha: 0.1,
            },
        ),
        named(
            "plastic",
            MaterialDesc::Plastic {
                diffuse_reflectance: grey(0.9),
                ior: 1.5,
                nonlinear: true,
            },
        ),
    ];
    for (i, material) in materials.into_iter().enumerate() {
        let name = material.name.clone();
        let Some(bsdf) = bsdf(material) else {
            return run.count(i as f64, &name, 1, 1, "no such material");
        };
        let (mut wrong, mut trials) = (0, 0);
        for cos in [1.0_f32, 0.5, 1e-3, 1e-7] {
            let wo = Vec3A::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            for k in 0..64 {
                let u = ALL_ENDS[k % 4];
                let v = Vec2::new(ALL_ENDS[k / 4 % 4], ALL_ENDS[k / 16]);
                trials += 1;
                // Nothing at all is an answer; a wrong one is not.
                if let Some(s) = bsdf.sample(wo, u, v, Transport::Radiance) {
                    let sound = s.pdf_dir > 0.0
                        && s.pdf_dir.is_finite()
                        && s.weight.is_finite()
                        && s.weight.to_array().iter().all(|w| *w >= 0.0)
                        && (s.wi.length() - 1.0).abs() < 1e-5;
                    wrong += u64::from(!sound);
                }
            }
        }
        run.count((i + 1) as f64, &name, wrong, trials, "");
    }
    warps(run);
}

fn warps(run: &mut Run) {
    let (mut wrong, mut trials) = (0, 0);
    for (x, y) in ALL_ENDS.iter().flat_map(|x| ALL_ENDS.map(|y| (*x, y))) {
        let u = Vec2::new(x, y);
        let cosine = warp::sample_cosine_hemisphere(u);
        let cone = warp::sample_cone(u, 1e-12);
        let b = warp::sample_triangle(u);
        let sound = [
            warp::pdf_cosine_hemisphere(cosine.z) > 0.0 && cosine.is_finite(),
            cone.is_finite() && cone.z > 0.0 && warp::pdf_cone(1e-12).is_finite(),
            warp::sample_sphere(u).is_finite(),
            b.x >= 0.0 && b.y >= 0.0 && b.x + b.y <= 1.0,
            warp::sample_unit_disk(u).length() <= 1.0 + 1e-6,
        ];
        wrong += sound.iter().filter(|s| !**s).count() as u64;
        trials += sound.len() as u64;
    }
    run.count(10.0, "warps", wrong, trials, "");
}
