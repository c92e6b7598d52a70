//! What must hold for every surface: probabilities, energy, reciprocity, finite numbers.

#[path = "support/surface.rs"]
#[allow(dead_code)]
mod surface;

use glam::{Vec2, Vec3A};
use lightscope::engine::bsdf::{Bsdf, Transport};
use lightscope::engine::event::Event;
use lightscope::engine::math::Rgb;
use lightscope::engine::math::float::ONE_MINUS_EPSILON;
use lightscope::engine::sampling::{IndependentSampler, Sampler, Stream, warp};
use lightscope::engine::scene::desc::{MaterialDesc, NamedMaterial};
use surface::{
    bsdf_of, color, diffuse, direction, ggx, glass, mirror, mixed, named, plastic, rough_glass,
};

/// Surfaces with every lobe, alone and mixed.
fn materials() -> Vec<(&'static str, Vec<NamedMaterial>)> {
    let one = |m: MaterialDesc| vec![named(m)];
    vec![
        ("diffuse", one(diffuse(0.9, 0.5, 0.1))),
        ("mirror", one(mirror())),
        ("ggx 1e-4", one(ggx(1e-4))),
        ("ggx 0.1", one(ggx(0.1))),
        ("ggx 1", one(ggx(1.0))),
        ("glass", one(glass(1.5))),
        ("glass 1", one(glass(1.0))),
        ("glass 1+1e-6", one(glass(1.0 + 1e-6))),
        ("glass 1-1e-6", one(glass(1.0 - 1e-6))),
        ("glass 1e3", one(glass(1e3))),
        ("rough glass 1e-4", one(rough_glass(1.5, 1e-4))),
        ("rough glass 0.3", one(rough_glass(1.5, 0.3))),
        ("rough glass 1.001", one(rough_glass(1.001, 1.0))),
        ("rough glass 1e3", one(rough_glass(1e3, 0.5))),
        ("plastic", one(plastic(0.7, 1.5, false))),
        ("nonlinear plastic", one(plastic(0.7, 1.9, true))),
        ("thin plastic", one(plastic(0.7, 0.8, true))),
        (
            "mixture",
            mixed(vec![
                diffuse(0.2, 0.9, 0.4),
                plastic(0.5, 1.4, true),
                glass(1.3),
                ggx(0.3),
            ]),
        ),
    ]
}

fn events(bsdf: &Bsdf) -> Vec<Event> {
    bsdf.non_delta_events().chain(bsdf.delta_events()).collect()
}

/// Flat and shaded, seen from both sides, from the normal to the surface itself.
fn for_each_view(mut test: impl FnMut(&str, &Bsdf, Vec3A, bool)) {
    let shading = [Vec3A::Z, direction(0.9, 1.0), direction(0.3, -2.0)];
    for (name, material) in materials() {
        for (i, n_s) in shading.into_iter().enumerate() {
            let bsdf = bsdf_of(&material, Vec3A::Z, n_s);
            for cos in [1.0_f32, 0.7, 0.2, 0.01, 1e-4, 1e-20, 0.0] {
                for (j, sign) in [1.0, -1.0].into_iter().enumerate() {
                    let wo = direction(cos, 0.5 + j as f32) * sign;
                    test(name, &bsdf, wo, i == 0);
                }
            }
        }
    }
}

/// Numbers with the corners of the unit cube among them.
fn numbers(n: u64) -> impl Iterator<Item = (f32, Vec2)> {
    let corners = [0.0, f32::MIN_POSITIVE, 0.5, ONE_MINUS_EPSILON];
    let cube = (0..64).map(move |i| {
        let x = |k: usize| corners[(i >> (2 * k)) & 3];
        (x(0), Vec2::new(x(1), x(2)))
    });
    let random = (0..n).map(|i| {
        let mut s = IndependentSampler::new(11, Stream::Test, (0, i));
        (s.next_1d(), s.next_2d())
    });
    cube.chain(random)
}

#[test]
fn probabilities_of_events_sum_to_one() {
    for_each_view(|name, bsdf, wo, _| {
        let sum: f32 = events(bsdf)
            .iter()
            .map(|&e| bsdf.event_probability(e, wo))
            .sum();
        if wo.z == 0.0 {
            assert_eq!(sum, 0.0, "{name}: in the surface nothing is seen");
        } else {
            assert!((sum - 1.0).abs() < 1e-6, "{name} {wo}: {sum}");
        }
        assert_eq!(bsdf.event_probability(Event::Volume, wo), 0.0);
        assert_eq!(bsdf.event_probability(Event::Specular(200), wo), 0.0);
    });
}

#[test]
fn samples_are_finite_and_weigh_f_over_pdf() {
    for_each_view(|name, bsdf, wo, flat| {
        for (u_event, u) in numbers(300) {
            for transport in [Transport::Radiance, Transport::Importance] {
                let Some(s) = bsdf.sample(wo, u_event, u, transport) else {
                    continue;
                };
                let case = format!("{name} wo {wo} u {u_event} {u} -> {s:?}");
                assert!(
                    s.weight.is_finite() && s.pdf_dir.is_finite() && s.pdf_dir > 0.0,
                    "{case}"
                );
                assert!((s.wi.length() - 1.0).abs() < 1e-5 && s.eta > 0.0, "{case}");
                assert!(s.weight.to_array().iter().all(|&w| w >= 0.0), "{case}");
                if flat && transport == Transport::Importance {
                    // Total albedo 1 times the largest over the mean channel of a lobe.
                    assert!(s.weight.max_component() <= 3.0, "{case}");
                }
                let f = bsdf.eval(s.event, wo, s.wi, transport);
                let pdf = bsdf.pdf(s.event, wo, s.wi);
                if s.event.is_delta() {
                    assert!(f.is_black() && pdf == 0.0, "{case}");
                    assert_eq!(s.pdf_dir, bsdf.event_probability(s.event, wo), "{case}");
                } else {
                    assert!((pdf / s.pdf_dir - 1.0).abs() < 1e-5, "{case} {pdf}");
                    for c in 0..3 {
                        let expected = f[c] / pdf;
                        assert!((s.weight[c] - expected).abs() <= 1e-5 * expected, "{case}");
                    }
                }
                // The reverse walk can find the same event wherever it is not dark.
                let reverse = bsdf.event_probability(s.event, s.wi);
                assert!(reverse > 0.0 || s.event.is_delta(), "{case}");
            }
        }
    });
}

#[test]
fn eval_and_pdf_are_finite_for_any_pair() {
    for_each_view(|name, bsdf, wo, _| {
        for i in 0..200 {
            let mut s = IndependentSampler::new(12, Stream::Test, (0, i));
            let mut wi = warp::sample_sphere(s.next_2d());
            if i < 4 {
                wi = [wo, -wo, Vec3A::X, direction(1e-20, 3.0)][i as usize];
            }
            for event in events(bsdf) {
                let f = bsdf.eval(event, wo, wi, Transport::Importance);
                let pdf = bsdf.pdf(event, wo, wi);
                assert!(
                    f.is_finite() && pdf.is_finite() && pdf >= 0.0,
                    "{name} {wo} {wi}"
                );
                assert!(
                    pdf > 0.0 || f.is_black(),
                    "{name} {wo} {wi}: f {f:?} without density"
                );
                let both = bsdf.eval_both_ways(event, wo, wi, Transport::Importance);
                let expected = match f.is_black() {
                    true => (f, 0.0, 0.0),
                    false => (f, pdf, bsdf.pdf(event, wi, wo)),
                };
                assert_eq!(
                    (both.f, both.toward, both.back),
                    expected,
                    "{name} {wo} {wi}"
                );
            }
        }
    });
}

/// Index of refraction on a side of the surface.
fn index(ior: f32, w: Vec3A) -> f32 {
    if w.z > 0.0 { 1.0 } else { ior }
}

#[test]
fn reciprocal_up_to_the_squared_index() {
    let cases = [
        (1.0, named(diffuse(0.9, 0.5, 0.1))),
        (1.0, named(ggx(0.3))),
        (1.0, named(plastic(0.7, 1.5, true))),
        (1.5, named(rough_glass(1.5, 0.4))),
        (0.6, named(rough_glass(0.6, 0.8))),
    ];
    for (ior, material) in cases {
        let bsdf = bsdf_of(&[material], Vec3A::Z, Vec3A::Z);
        let mut found = 0;
        for i in 0..3000 {
            let mut s = IndependentSampler::new(13, Stream::Test, (0, i));
            let a = warp::sample_sphere(s.next_2d());
            let b = warp::sample_sphere(s.next_2d());
            for event in bsdf.non_delta_events() {
                let f = |wo: Vec3A, wi: Vec3A| {
                    let f = bsdf.eval(event, wo, wi, Transport::Radiance) / wi.z.abs();
                    f * index(ior, wi).powi(2)
                };
                let (x, y) = (f(a, b), f(b, a));
                found += u32::from(!x.is_black());
                for c in 0..3 {
                    // Where f reaches 0 one direction may round to it before the other.
                    let close = (x[c] - y[c]).abs() <= 1e-3 * x[c].max(y[c]) + 1e-6;
                    assert!(close, "{x:?} {y:?}");
                }
            }
        }
        assert!(found > 500, "only {found} pairs scatter");
    }
}

#[test]
fn light_walks_are_the_adjoint_of_camera_walks() {
    for (name, material) in materials() {
        for n_s in [Vec3A::Z, direction(0.9, 1.0), direction(0.5, -2.0)] {
            let bsdf = bsdf_of(&material, Vec3A::Z, n_s);
            for i in 0..2000 {
                let mut s = IndependentSampler::new(14, Stream::Test, (0, i));
                let eye = warp::sample_sphere(s.next_2d());
                let light = warp::sample_sphere(s.next_2d());
                for event in bsdf.non_delta_events() {
                    // The same measured contribution: f over the projected angle of n_g.
                    let x = bsdf.eval(event, eye, light, Transport::Radiance) / light.z.abs();
                    let y = bsdf.eval(event, light, eye, Transport::Importance) / eye.z.abs();
                    for c in 0..3 {
                        // Where f reaches 0 one side may round to it before the other.
                        let close = (x[c] - y[c]).abs() <= 1e-3 * x[c].max(y[c]) + 1e-6;
                        assert!(
                            close,
                            "{name} n_s {n_s}: {x:?} {y:?} eye {eye} light {light}"
                        );
                    }
                }
            }
        }
    }
}

/// Monte Carlo estimate of the directional albedo, all events: mean weight, and its error.
fn albedo(bsdf: &Bsdf, wo: Vec3A, n: u64, transport: Transport) -> (Rgb, f32) {
    let (mut sum, mut sum_sq) = ([0.0_f64; 3], 0.0);
    for i in 0..n {
        let mut s = IndependentSampler::new(15, Stream::Test, (0, i));
        let (u_event, u) = (s.next_1d(), s.next_2d());
        if let Some(s) = bsdf.sample(wo, u_event, u, transport) {
            let weight = s.weight.to_array().map(f64::from);
            (0..3).for_each(|c| sum[c] += weight[c]);
            sum_sq += weight[0] * weight[0];
        }
    }
    let n = n as f64;
    let mean = sum.map(|s| s / n);
    let error = ((sum_sq / n - mean[0] * mean[0]).max(0.0) / n).sqrt();
    (Rgb::from(mean.map(|m| m as f32)), error as f32)
}

#[test]
fn white_diffuse_mirror_and_glass_weigh_one_sample_by_sample() {
    let white = [
        diffuse(1.0, 1.0, 1.0),
        mirror(),
        glass(1.5),
        glass(1.0),
        glass(1.0 + 1e-6),
    ];
    for material in white {
        let bsdf = bsdf_of(&[named(material)], Vec3A::Z, Vec3A::Z);
        for cos in [1.0_f32, 0.5, 0.01, -0.01, -0.5, -1.0] {
            let wo = direction(cos.abs(), 1.0) * cos.signum();
            for (u_event, u) in numbers(200) {
                let s = bsdf.sample(wo, u_event, u, Transport::Importance).unwrap();
                assert!(
                    (s.weight - Rgb::WHITE).max_component().abs() < 1e-6,
                    "{s:?}"
                );
                let r = bsdf.sample(wo, u_event, u, Transport::Radiance).unwrap();
                let scaled = r.weight * r.eta * r.eta;
                assert!((scaled - Rgb::WHITE).max_component().abs() < 1e-6, "{r:?}");
            }
        }
    }
}

#[test]
fn nothing_creates_energy() {
    for (name, material) in materials() {
        let bsdf = bsdf_of(&material, Vec3A::Z, Vec3A::Z);
        for cos in [1.0_f32, 0.5, 0.05] {
            for sign in [1.0, -1.0] {
                let wo = direction(cos, 0.3) * sign;
                let (a, error) = albedo(&bsdf, wo, 20_000, Transport::Importance);
                assert!(
                    a.max_component() <= 1.0 + 4.0 * error + 1e-5,
                    "{name} {wo}: {a:?}"
                );
            }
        }
    }
}

#[test]
fn white_plastic_loses_nothing_on_the_average() {
    // Its diffuse lobe's albedo at θo is exactly T(θo), beside the mirror's F(θo).
    for nonlinear in [false, true] {
        for ior in [1.2_f32, 1.5, 1.9, 0.8] {
            let bsdf = bsdf_of(&[named(plastic(1.0, ior, nonlinear))], Vec3A::Z, Vec3A::Z);
            for cos in [1.0_f32, 0.5, 0.1] {
                let (a, error) = albedo(&bsdf, direction(cos, 0.0), 200_000, Transport::Radiance);
                assert!(
                    (a[0] - 1.0).abs() < 4.0 * error + 1e-5,
                    "{ior} {cos}: {a:?} ± {error}"
                );
                assert!(error < 2e-3);
            }
        }
    }
}

#[test]
fn plastic_follows_the_written_formula() {
    const RHO: f32 = 0.6;
    let fresnel = |c: f32| {
        let t = (1.0 - (1.0 - c * c) / 2.25).sqrt();
        let (s, p) = ((c - 1.5 * t) / (c + 1.5 * t), (1.5 * c - t) / (1.5 * c + t));
        0.5 * (s * s + p * p)
    };
    for (nonlinear, k) in [(false, 0.59635), (true, 0.59635 * RHO)] {
        let bsdf = bsdf_of(&[named(plastic(RHO, 1.5, nonlinear))], Vec3A::Z, Vec3A::Z);
        for (o, i) in [(1.0, 1.0), (0.3, 0.8), (0.05, 0.4)] {
            let (wo, wi) = (direction(o, 0.0), direction(i, 2.0));
            let f = bsdf.eval(Event::Diffuse, wo, wi, Transport::Radiance)[0] / i;
            let expected = RHO * (1.0 - fresnel(i)) * (1.0 - fresnel(o))
                / (std::f32::consts::PI * 2.25 * (1.0 - k));
            assert!((f / expected - 1.0).abs() < 1e-4, "{f} {expected}");
            let s = bsdf.sample_event(Event::Specular(1), wo, 0.0, Vec2::ZERO, Transport::Radiance);
            let s = s.unwrap();
            assert!((s.weight[0] * s.pdf_dir - fresnel(o)).abs() < 1e-5);
        }
    }
}

#[test]
fn ggx_tends_to_the_mirror() {
    let smooth = bsdf_of(&[named(ggx(0.0))], Vec3A::Z, Vec3A::Z);
    let wo = direction(0.6, 0.4);
    let mirrored = smooth
        .sample(wo, 0.5, Vec2::splat(0.5), Transport::Radiance)
        .unwrap();
    assert_eq!(mirrored.event, Event::Specular(0));
    for alpha in [1e-2_f32, 1e-3, 1e-4] {
        let bsdf = bsdf_of(&[named(ggx(alpha))], Vec3A::Z, Vec3A::Z);
        let mut far = 0;
        for (u_event, u) in numbers(2000).skip(64) {
            let s = bsdf.sample(wo, u_event, u, Transport::Radiance).unwrap();
            assert_eq!(s.event, Event::Glossy);
            far += u32::from((s.wi - mirrored.wi).length() > 20.0 * alpha);
            let loss = (s.weight - mirrored.weight).to_array().map(f32::abs);
            // Shadowing costs about α² tan²θ.
            assert!(
                loss.iter().all(|&l| l < 0.1 * alpha + 1e-6),
                "{alpha} {:?}",
                s.weight
            );
        }
        assert!(far < 40, "{far} of 2000 directions far from the mirror's");
    }
}

#[test]
fn index_one_passes_straight_under_any_normals() {
    for n_s in [Vec3A::Z, direction(0.4, 1.0)] {
        for material in [glass(1.0), rough_glass(1.0, 0.5)] {
            let bsdf = bsdf_of(&[named(material)], Vec3A::Z, n_s);
            for (u_event, u) in numbers(100) {
                let wo = warp::sample_sphere(u);
                if wo.z == 0.0 {
                    continue;
                }
                for transport in [Transport::Radiance, Transport::Importance] {
                    let s = bsdf.sample(wo, u_event, u, transport).unwrap();
                    assert_eq!((s.wi, s.eta), (-wo, 1.0));
                    assert!((s.weight - Rgb::WHITE).max_component().abs() < 1e-6);
                }
            }
        }
    }
}

#[test]
fn tint_colours_what_is_transmitted_only() {
    let tint = Rgb::new(0.2, 0.5, 1.0);
    let tinted = MaterialDesc::Dielectric {
        ior: 1.5,
        transmittance: tint,
    };
    let bsdf = bsdf_of(&[named(tinted)], Vec3A::Z, Vec3A::Z);
    let wo = direction(0.5, 0.0);
    let lobe = |i| {
        let event = Event::Specular(i);
        let s = bsdf.sample_event(event, wo, 0.0, Vec2::ZERO, Transport::Importance);
        s.map(|s| s.weight * s.pdf_dir).unwrap()
    };
    let (r, t) = (lobe(0), lobe(1));
    assert_eq!(r[0], r[2]);
    assert!((t[0] / t[2] - 0.2).abs() < 1e-6 && (t[2] + r[2] - 1.0).abs() < 1e-6);
}

#[test]
fn black_scatters_nothing() {
    let bsdf = bsdf_of(&[named(diffuse(0.0, 0.0, 0.0))], Vec3A::Z, Vec3A::Z);
    assert!(bsdf.is_empty() && events(&bsdf).is_empty());
    let none = bsdf.sample(Vec3A::Z, 0.5, Vec2::splat(0.5), Transport::Radiance);
    assert!(none.is_none());
    let half = MaterialDesc::Diffuse {
        reflectance: color(0.0, 0.0, 0.5),
    };
    assert!(!bsdf_of(&[named(half)], Vec3A::Z, Vec3A::Z).is_empty());
}
