//! Every sampling routine against the density it claims, rejected samples included.

#[path = "support/chi_square.rs"]
mod chi_square;
#[path = "support/surface.rs"]
#[allow(dead_code)]
mod surface;

use chi_square::{SphereGrid, assert_family, p_value, test_directions};
use glam::{Vec2, Vec3A};
use lightscope::engine::bsdf::{Bsdf, Transport};
use lightscope::engine::event::Event;
use lightscope::engine::sampling::{IndependentSampler, Sampler, Stream, warp};
use surface::{bsdf_of, diffuse, direction, ggx, glass, mixed, named, plastic, rough_glass};

const SAMPLES: u64 = 100_000;

/// Draws `event` of `bsdf` on one half of the sphere around `axis` or on all of it.
fn test_event(
    bsdf: &Bsdf,
    event: Event,
    wo: Vec3A,
    (axis, spread): (Vec3A, f64),
    counts: impl Fn(Vec3A) -> bool,
    stream: u64,
) -> f64 {
    let probability = f64::from(bsdf.event_probability(event, wo));
    assert!(probability > 0.0);
    let grid = SphereGrid::new(axis, spread);
    let pdf = |wi: Vec3A| {
        if counts(wi) {
            f64::from(bsdf.pdf(event, wo, wi)) / probability
        } else {
            0.0
        }
    };
    let mut index = 0;
    let sample = || {
        let mut s = IndependentSampler::new(1, Stream::Test, (stream, index));
        index += 1;
        let (u, u_lobe) = (s.next_2d(), s.next_1d());
        // Light walks keep the whole support of diffuse lobes under shading normals.
        let sample = bsdf.sample_event(event, wo, u_lobe, u, Transport::Importance)?;
        Some(sample.wi).filter(|&wi| counts(wi))
    };
    test_directions(&grid, SAMPLES, pdf, sample)
}

/// Normal to grazing incidence, from outside and from inside.
fn views() -> Vec<Vec3A> {
    views_to(0.01)
}

fn views_to(grazing: f32) -> Vec<Vec3A> {
    let cosines = [1.0, 0.8, 0.3, grazing];
    cosines
        .iter()
        .enumerate()
        .flat_map(|(i, &c)| [direction(c, 0.7 * i as f32), direction(-c, 2.0 + i as f32)])
        .collect()
}

/// The geometric normal +z with itself and with a shading normal that leans away.
fn normals() -> [(Vec3A, Vec3A); 2] {
    [(Vec3A::Z, Vec3A::Z), (Vec3A::Z, direction(0.9, 1.0))]
}

fn mirror_direction(wo: Vec3A, n: Vec3A) -> Vec3A {
    2.0 * wo.dot(n) * n - wo
}

#[test]
fn diffuse_events() {
    let materials = [
        ("lambert", mixed(vec![diffuse(0.5, 0.2, 0.9)])),
        ("plastic", mixed(vec![plastic(0.5, 1.5, true)])),
        (
            "mixture",
            mixed(vec![
                diffuse(0.5, 0.2, 0.9),
                plastic(0.7, 1.9, false),
                ggx(0.2),
            ]),
        ),
    ];
    let mut p_values = Vec::new();
    for (name, material) in &materials {
        for (n_g, n_s) in normals() {
            let bsdf = bsdf_of(material, n_g, n_s);
            for wo in views() {
                // Where the light is below the shading horizon, diffuse lobes are dark.
                if (wo.dot(n_s) > 0.0) != (wo.dot(n_g) > 0.0) {
                    continue;
                }
                let stream = p_values.len() as u64;
                let p = test_event(&bsdf, Event::Diffuse, wo, (n_s, 1.0), |_| true, stream);
                p_values.push((format!("{name} n_s {n_s} wo {wo}"), p));
            }
        }
    }
    assert_family(&p_values);
}

#[test]
fn ggx_reflection() {
    let mut p_values = Vec::new();
    for alpha in [1e-4_f32, 1e-3, 0.01, 0.1, 0.4, 1.0] {
        // Across the plane of incidence a lobe is about 2 α cosθ wide: at 1e-4 and 0.01 that is
        // 2e-6, which the 1e-7 of `f32` directions blur by more than this test resolves.
        let grazing = if alpha < 1e-3 { 0.1 } else { 0.01 };
        for (n_g, n_s) in normals() {
            let bsdf = bsdf_of(&[named(ggx(alpha))], n_g, n_s);
            for wo in views_to(grazing) {
                let grid = (mirror_direction(wo, n_s), f64::from(alpha));
                let stream = 1000 + p_values.len() as u64;
                let p = test_event(&bsdf, Event::Glossy, wo, grid, |_| true, stream);
                p_values.push((format!("alpha {alpha} n_s {n_s} wo {wo}"), p));
            }
        }
    }
    assert_family(&p_values);
}

#[test]
fn rough_dielectric() {
    let mut p_values = Vec::new();
    for (ior, alpha) in [
        (1.5_f32, 1.0_f32),
        (1.5, 0.3),
        (1.5, 0.003),
        (1.05, 0.4),
        (0.6, 0.2),
    ] {
        for (n_g, n_s) in normals() {
            let bsdf = bsdf_of(&[named(rough_glass(ior, alpha))], n_g, n_s);
            let smooth = bsdf_of(&[named(glass(ior))], n_s, n_s);
            for wo in views() {
                // At grazing angles lobes lean on the horizon, with details as fine as the cosine.
                let spread = f64::from(alpha.min(wo.dot(n_s).abs()));
                let horizon = (n_s * wo.dot(n_s) - wo).normalize_or(n_s);
                let reflected = (mirror_direction(wo, n_s), spread);
                // Smooth refraction shows where the narrow lobe lies.
                let refracted = smooth
                    .sample_event(
                        Event::Specular(1),
                        wo,
                        0.5,
                        Vec2::splat(0.5),
                        Transport::Radiance,
                    )
                    .map_or((horizon, spread), |s| (s.wi, spread));
                for (grid, above) in [(reflected, true), (refracted, false)] {
                    let half = |wi: Vec3A| (wi.dot(n_g) * wo.dot(n_g) > 0.0) == above;
                    let stream = 2000 + p_values.len() as u64;
                    let p = test_event(&bsdf, Event::Glossy, wo, grid, half, stream);
                    let name = format!("ior {ior} alpha {alpha} n_s {n_s} wo {wo} above {above}");
                    p_values.push((name, p));
                }
            }
        }
    }
    assert_family(&p_values);
}

#[test]
fn glossy_mixture() {
    let material = mixed(vec![
        ggx(0.5),
        diffuse(0.3, 0.3, 0.3),
        ggx(0.1),
        rough_glass(1.5, 0.3),
    ]);
    let bsdf = bsdf_of(&material, Vec3A::Z, Vec3A::Z);
    let mut p_values = Vec::new();
    for wo in views() {
        let grid = (mirror_direction(wo, Vec3A::Z), 0.3);
        let stream = 5000 + p_values.len() as u64;
        let p = test_event(&bsdf, Event::Glossy, wo, grid, |_| true, stream);
        p_values.push((format!("wo {wo}"), p));
    }
    assert_family(&p_values);
}

#[test]
fn events_are_drawn_by_their_probabilities() {
    let material = mixed(vec![plastic(0.6, 1.5, false), glass(1.3), ggx(0.2)]);
    let bsdf = bsdf_of(&material, Vec3A::Z, Vec3A::Z);
    let mut p_values = Vec::new();
    for wo in views() {
        let events: Vec<Event> = bsdf.non_delta_events().chain(bsdf.delta_events()).collect();
        assert_eq!(events.len(), 5);
        let mut counts = vec![0; events.len() + 1];
        for i in 0..SAMPLES {
            let mut s = IndependentSampler::new(2, Stream::Test, (p_values.len() as u64, i));
            let (u_event, u) = (s.next_1d(), s.next_2d());
            let sample = bsdf.sample(wo, u_event, u, Transport::Radiance);
            let event = sample
                .map(|s| s.event)
                .and_then(|e| events.iter().position(|&x| x == e));
            counts[event.unwrap_or(events.len())] += 1;
        }
        // Rejected samples are those of the glossy event: put them there.
        let glossy = events.iter().position(|&e| e == Event::Glossy).unwrap();
        counts[glossy] += counts.pop().unwrap();
        let probabilities: Vec<f64> = events
            .iter()
            .map(|&e| f64::from(bsdf.event_probability(e, wo)))
            .collect();
        p_values.push((format!("wo {wo}"), p_value(&probabilities, &counts)));
    }
    assert_family(&p_values);
}

#[test]
fn warps_of_directions() {
    type Warp = (&'static str, fn(Vec2) -> Vec3A, fn(Vec3A) -> f32, f64);
    const NARROW: f32 = 1e-6;
    let warps: [Warp; 4] = [
        (
            "cosine hemisphere",
            warp::sample_cosine_hemisphere,
            |d| warp::pdf_cosine_hemisphere(d.z),
            1.0,
        ),
        ("sphere", warp::sample_sphere, |_| warp::pdf_sphere(), 1.0),
        (
            "cone",
            |u| warp::sample_cone(u, 0.3),
            |d| if d.z >= 0.7 { warp::pdf_cone(0.3) } else { 0.0 },
            1.0,
        ),
        (
            "narrow cone",
            |u| warp::sample_cone(u, NARROW),
            |d| {
                let inside = 0.5 * (d - Vec3A::Z).length_squared() <= NARROW;
                if inside { warp::pdf_cone(NARROW) } else { 0.0 }
            },
            1e-4,
        ),
    ];
    let mut p_values = Vec::new();
    for (k, (name, sample, pdf, spread)) in warps.into_iter().enumerate() {
        let grid = SphereGrid::new(Vec3A::Z, spread);
        let mut index = 0;
        let draw = || {
            index += 1;
            let mut s = IndependentSampler::new(3, Stream::Test, (k as u64, index));
            Some(sample(s.next_2d()))
        };
        let p = test_directions(&grid, SAMPLES, |d| f64::from(pdf(d)), draw);
        p_values.push((name.to_owned(), p));
    }
    assert_family(&p_values);
}

#[test]
fn warps_of_points() {
    const K: usize = 16;
    let mut p_values = Vec::new();
    let (mut disk, mut triangle) = (vec![0; K * K], vec![0; K * K]);
    let cell = |x: f32, y: f32| {
        let index = |v: f32| ((v * K as f32) as usize).min(K - 1);
        index(x) * K + index(y)
    };
    for i in 0..SAMPLES {
        let mut s = IndependentSampler::new(4, Stream::Test, (0, i));
        let p = warp::sample_unit_disk(s.next_2d());
        let angle = (p.y.atan2(p.x) / std::f32::consts::TAU).rem_euclid(1.0);
        disk[cell(p.length_squared(), angle)] += 1;
        let b = warp::sample_triangle(s.next_2d());
        assert!(b.x >= 0.0 && b.y >= 0.0 && b.x + b.y <= 1.0);
        triangle[cell(b.x, b.y)] += 1;
    }
    // Rings of equal area, sectors of equal angle.
    let uniform = vec![1.0 / (K * K) as f64; K * K];
    let pdf_disk = f64::from(warp::pdf_unit_disk()) * std::f64::consts::PI;
    assert!((pdf_disk - 1.0).abs() < 1e-6);
    p_values.push(("disk".to_owned(), p_value(&uniform, &disk)));

    // Squares of barycentric coordinates: whole, halved by the long edge, outside. Their share of
    // a triangle of area ½ is their area times the density 2.
    let density = f64::from(warp::pdf_triangle(0.5)) / (K * K) as f64;
    let expected: Vec<f64> = (0..K * K)
        .map(|i| match (i / K + i % K).cmp(&(K - 1)) {
            std::cmp::Ordering::Less => density,
            std::cmp::Ordering::Equal => 0.5 * density,
            std::cmp::Ordering::Greater => 0.0,
        })
        .collect();
    p_values.push(("triangle".to_owned(), p_value(&expected, &triangle)));
    assert_family(&p_values);
}

#[test]
fn a_wrong_density_is_caught() {
    // 3 % too much on one half of the hemisphere: what the tests above would not let pass.
    let grid = SphereGrid::new(Vec3A::Z, 1.0);
    let mut index = 0;
    let p = test_directions(
        &grid,
        SAMPLES,
        |d| f64::from(warp::pdf_cosine_hemisphere(d.z)) * if d.x > 0.0 { 1.03 } else { 0.97 },
        || {
            index += 1;
            let mut s = IndependentSampler::new(5, Stream::Test, (0, index));
            Some(warp::sample_cosine_hemisphere(s.next_2d()))
        },
    );
    assert!(p < 1e-6, "p = {p}");
}
