//! Lights against closed forms, and the two ways of sampling them against each other.

#[path = "support/lights.rs"]
mod support;

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{Quat, Vec2, Vec3, Vec3A};
use lightscope::engine::geometry::{Geometry, Ray};
use lightscope::engine::light::{Light, Lights, Silhouette};
use lightscope::engine::math::Rgb;
use lightscope::engine::math::float::ONE_MINUS_EPSILON;
use lightscope::engine::sampling::{IndependentSampler, Sampler, Stream};
use lightscope::engine::scene::desc::{ImageData, LightDesc};
use support::{RADIANCE, VIEW, every_kind, mesh, sphere};

/// Mean and standard error of the first channel over `n` draws.
fn estimate(n: u64, stream: u64, mut draw: impl FnMut(Vec2, Vec2) -> f64) -> (f64, f64) {
    let (mut sum, mut squares) = (0.0, 0.0);
    for i in 0..n {
        let mut s = IndependentSampler::new(11, Stream::Test, (stream, i));
        let x = draw(s.next_2d(), s.next_2d());
        sum += x;
        squares += x * x;
    }
    let mean = sum / n as f64;
    let variance = (squares / n as f64 - mean * mean).max(0.0);
    (mean, (variance / n as f64).sqrt())
}

/// Irradiance in the first channel at `p` from one draw of `light`.
fn irradiance(light: &Light, p: Vec3A, n: Vec3A, u: Vec2) -> f64 {
    light.sample_li(p, u).map_or(0.0, |s| {
        f64::from(s.radiance[0]) * f64::from(n.dot(s.wi).max(0.0)) / f64::from(s.pdf_dir)
    })
}

/// Fails if `mean` is off `exact` by more than 5 standard errors and 1e-4 of it.
fn assert_near(what: &str, (mean, error): (f64, f64), exact: f64) {
    let allowed = 5.0 * error + 1e-4 * exact.abs();
    assert!(
        (mean - exact).abs() <= allowed,
        "{what}: {mean} ± {error} instead of {exact}"
    );
    assert!(
        error <= 0.02 * exact.abs(),
        "{what}: ± {error} shows nothing"
    );
}

#[test]
fn spheres_light_as_the_cosine_law_says() {
    for ratio in [1.0001_f32, 1.01, 2.0, 100.0, 1e6] {
        for radius in [1e-6_f32, 1.0, 1e5] {
            let lit = sphere(Vec3::ZERO, radius, false);
            let light = lit.lights.get(0);
            let p = Vec3A::new(0.0, 0.6, 0.8) * (ratio * radius);
            let d = p.as_dvec3().length() / f64::from(radius);
            let n = -p.normalize();
            let e = estimate(20_000, 1, |u, _| irradiance(light, p, n, u));
            let exact = 3.0 * PI / (d * d);
            assert_near(&format!("{ratio} radii of {radius}"), e, exact);
        }
    }
}

#[test]
fn disk_light_from_above_a_pinhead_to_a_sky() {
    // 2048 triangles stand in for the disk; their inscribed area is short by 1.6e-6.
    let sides = 2048_u32;
    for ratio in [1e-6_f64, 1e-3, 0.1, 1.0, 10.0, 1e3, 1e6] {
        let mut positions = vec![Vec3::Y];
        for i in 0..sides {
            let (s, c) = (2.0 * PI * f64::from(i) / f64::from(sides)).sin_cos();
            positions.push(Vec3::new((ratio * c) as f32, 1.0, (ratio * s) as f32));
        }
        let triangles: Vec<_> = (0..sides)
            .map(|i| [0, 1 + i, 1 + (i + 1) % sides])
            .collect();
        let lit = mesh(&positions, &triangles);
        let p = Vec3A::new(0.0, 0.0, 0.0);
        let e = estimate(100_000, 2, |u, v| {
            let (id, pmf) = lit.lights.sample(v.x).unwrap();
            irradiance(lit.lights.get(id), p, Vec3A::Y, u) / f64::from(pmf)
        });
        let exact = 3.0 * PI * ratio * ratio / (1.0 + ratio * ratio);
        assert_near(&format!("r/h = {ratio}"), e, exact);
    }
}

#[test]
fn small_lights_far_away_tend_to_points() {
    for exponent in -12..=-4 {
        let area = 10f64.powi(exponent);
        let side = (2.0 * area).sqrt() as f32;
        let corners = [Vec3::ZERO, Vec3::X * side, Vec3::Y * side];
        let triangle = mesh(&corners, &[[0, 1, 2]]);
        let ball = sphere(Vec3::ZERO, (area / PI).sqrt() as f32, false);
        let p = Vec3A::new(1.0, -2.0, 2.0);
        let n = -p.normalize();
        for (name, lit, cos) in [("triangle", triangle, 2.0 / 3.0), ("sphere", ball, 1.0)] {
            let light = lit.lights.get(0);
            let (mean, _) = estimate(200, 3, |u, _| irradiance(light, p, n, u));
            let exact = 3.0 * area * cos / 9.0;
            let off = (mean / exact - 1.0).abs();
            assert!(
                off < 1e-4 + 2.0 * f64::from(side),
                "{name} of {area} m²: {off}"
            );
        }
    }
}

#[test]
fn inside_a_shining_sphere_the_irradiance_is_the_same_everywhere() {
    let lit = sphere(Vec3::new(5.0, 0.0, 0.0), 2.0, true);
    let light = lit.lights.get(0);
    // Nearer to the wall, what faces it makes the samples by area noisy.
    for x in [0.0, 0.5, 0.9] {
        let p = Vec3A::new(5.0 + 2.0 * x, 0.0, 0.0);
        for n in [Vec3A::X, Vec3A::NEG_X, Vec3A::Y] {
            let e = estimate(400_000, 4, |u, _| irradiance(light, p, n, u));
            assert_near(&format!("{x} {n}"), e, 3.0 * PI);
        }
    }
    // Between two points of the sphere the form factor is constant: no noise but rounding.
    let wall = Vec3A::new(7.0, 0.0, 0.0);
    let (mean, error) = estimate(1000, 5, |u, _| irradiance(light, wall, Vec3A::NEG_X, u));
    assert!((mean / (3.0 * PI) - 1.0).abs() < 1e-3 && error < 1e-3 * mean);
}

#[test]
fn nothing_is_emitted_backwards() {
    let triangle = mesh(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]]);
    let quad = mesh(
        &[Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
        &[[0, 1, 2], [0, 2, 3]],
    );
    let outward = sphere(Vec3::ZERO, 1.0, false);
    let behind = Vec3A::new(0.2, 0.2, -0.5);
    for lit in [&triangle, &quad, &outward] {
        let light = lit.lights.get(0);
        let toward = (Vec3A::new(0.2, 0.3, 0.0) - behind).normalize();
        let ray = Ray::new(behind, toward);
        let hit = lit.geometry.intersect(&ray).unwrap();
        let si = lit.geometry.interaction(&ray, &hit);
        assert_eq!(si.light, Some(0));
        assert!(light.emitted(&si, si.wo).is_black());
        assert_eq!(light.pdf_li(behind, toward, Some(&si)), 0.0);
        assert!(light.sample_li(behind, Vec2::splat(0.4)).is_none());
    }
}

#[test]
fn a_ray_to_a_sample_sees_what_the_sample_says() {
    for (i, (name, lit)) in every_kind().into_iter().enumerate() {
        let light = lit.lights.get(0);
        for k in 0..2000 {
            let mut s = IndependentSampler::new(1, Stream::Test, (700 + i as u64, k));
            let Some(sample) = light.sample_li(VIEW, s.next_2d()) else {
                assert_eq!(name, "spot");
                continue;
            };
            assert!((sample.wi.length() - 1.0).abs() < 1e-6);
            // The shadow ray ends before the light.
            let to = sample.target - VIEW;
            let mut shadow = Ray::new(VIEW, to.normalize());
            shadow.t_max = to.length() * (1.0 - 1e-6);
            assert!(!lit.geometry.occluded(&shadow), "{name} shadows itself");
            if light.is_delta() {
                assert_eq!(light.pdf_li(VIEW, sample.wi, None), 0.0);
                continue;
            }
            let ray = Ray::new(VIEW, sample.wi);
            let hit = lit.geometry.intersect(&ray);
            let si = hit.map(|hit| lit.geometry.interaction(&ray, &hit));
            let (seen, t) = match &si {
                Some(si) => (light.emitted(si, si.wo), si.t),
                None => (lit.lights.escaped(sample.wi), f32::INFINITY),
            };
            let pdf = light.pdf_li(VIEW, sample.wi, si.as_ref());
            let grazing = sample.n.is_some_and(|n| n.dot(sample.wi).abs() < 0.02);
            if !grazing && sample.distance.is_finite() {
                assert!((t / sample.distance - 1.0).abs() < 1e-3, "{name}");
                assert_eq!(seen, sample.radiance, "{name}");
                assert!((pdf / sample.pdf_dir - 1.0).abs() < 1e-3, "{name}");
            } else if si.is_none() && light.is_infinite() {
                // On the edge of a texel either side may be seen.
                let same = (pdf / sample.pdf_dir - 1.0).abs() < 1e-3 && seen == sample.radiance;
                let jitter =
                    Quat::from_rotation_arc(Vec3::Y, Vec3::new(1e-5, 1.0, 1e-5).normalize());
                let nearby = [jitter, jitter.inverse()].map(|q| light.escaped(q * sample.wi));
                assert!(same || nearby.contains(&sample.radiance), "{name}");
            }
        }
    }
}

/// Corner and edges of a receiver that all lights of [`every_kind`] shine on.
const RECEIVER: (Vec3A, Vec3A, Vec3A) = (
    Vec3A::new(-0.4, -0.3, 2.0),
    Vec3A::new(0.7, 0.0, 0.1),
    Vec3A::new(0.1, 0.8, -0.1),
);

/// Where a ray crosses the receiver, and whether from its side of negative normal.
fn crosses(ray: &Ray, n: Vec3A) -> bool {
    let (corner, e1, e2) = RECEIVER;
    let cos = ray.d.dot(n);
    let t = (corner - ray.o).dot(n) / cos;
    let q = ray.at(t) - corner;
    let area2 = e1.cross(e2);
    let x = q.cross(e2).dot(area2) / area2.length_squared();
    let y = e1.cross(q).dot(area2) / area2.length_squared();
    cos < 0.0 && t > 0.0 && (0.0..1.0).contains(&x) && (0.0..1.0).contains(&y)
}

#[test]
fn flux_on_a_receiver_is_the_same_from_either_end() {
    let (corner, e1, e2) = RECEIVER;
    let area = f64::from(e1.cross(e2).length());
    let mut compared = 0;
    for (i, (name, mut lit)) in every_kind().into_iter().enumerate() {
        // The normal faces the lights; the sky shines on it from below as well as they do.
        let n = -e1.cross(e2).normalize();
        if lit.lights.get(0).is_infinite() {
            // A scene that holds the receiver: its silhouette must be lit in full.
            lit = infinite_with_receiver(name);
        }
        let light = lit.lights.get(0);
        let stream = 20 + 2 * i as u64;
        let (li, li_error) = estimate(200_000, stream, |u, v| {
            let p = corner + e1 * v.x + e2 * v.y;
            area * irradiance(light, p, n, u)
        });
        let (le, le_error) = estimate(1_000_000, stream + 1, |u, v| {
            let sample = light.sample_le(u, v).unwrap();
            if crosses(&sample.ray, n) {
                f64::from(sample.flux()[0])
            } else {
                0.0
            }
        });
        let error = li_error.hypot(le_error);
        assert!(
            (li - le).abs() < 5.0 * error + 1e-4 * li,
            "{name}: {li} {le} ± {error}"
        );
        assert!(
            li > 0.0 && error < 0.02 * li,
            "{name}: {li} ± {error} shows nothing"
        );
        compared += 1;
    }
    assert_eq!(compared, 9);
}

/// The light at infinity of this name over a black box around the receiver.
fn infinite_with_receiver(name: &str) -> support::Lit {
    let desc = match name {
        "directional" => LightDesc::Directional {
            direction: Vec3::new(-0.05, 0.1, 2.0),
            irradiance: RADIANCE,
        },
        "constant" => LightDesc::Constant { radiance: RADIANCE },
        _ => LightDesc::Environment {
            image: support::image(),
            scale: Rgb::WHITE,
            rotation: Quat::from_rotation_y(0.7),
        },
    };
    let positions = [
        Vec3::new(-0.5, -0.4, 1.8),
        Vec3::new(0.5, -0.4, 1.8),
        Vec3::new(0.3, 0.6, 2.2),
    ];
    let input = lightscope::engine::geometry::MeshInput {
        positions: &positions,
        normals: &[],
        uvs: &[],
        triangles: &[[0, 1, 2]],
        material: 0,
    };
    let (geometry, _) = Geometry::build(&[input], &[]);
    let lights = lights_of(&[desc], &geometry).unwrap();
    support::Lit { geometry, lights }
}

#[test]
fn power_is_the_mean_flux() {
    for (i, (name, lit)) in every_kind().into_iter().enumerate() {
        let light = lit.lights.get(0);
        let e = estimate(100_000, 50 + i as u64, |u, v| {
            f64::from(light.sample_le(u, v).unwrap().flux()[0])
        });
        assert_near(name, e, f64::from(light.power()[0]));
    }
}

#[test]
fn the_ends_of_the_unit_interval_are_finite() {
    let ends = [0.0, f32::MIN_POSITIVE, 0.5, ONE_MINUS_EPSILON];
    for (name, lit) in every_kind() {
        let light = lit.lights.get(0);
        for k in 0..256 {
            let u = Vec2::new(ends[k % 4], ends[k / 4 % 4]);
            let v = Vec2::new(ends[k / 16 % 4], ends[k / 64]);
            if let Some(s) = light.sample_li(VIEW, u) {
                assert!(
                    s.wi.is_finite() && s.target.is_finite() && s.radiance.is_finite(),
                    "{name}"
                );
                assert!(
                    s.pdf_dir > 0.0 && s.pdf_dir.is_finite() && s.distance > 0.0,
                    "{name}"
                );
            } else {
                assert_eq!(name, "spot");
            }
            let s = light.sample_le(u, v).unwrap();
            assert!(
                s.ray.o.is_finite() && s.ray.d.is_finite() && s.flux().is_finite(),
                "{name}"
            );
            assert!(s.pdf_pos > 0.0 && s.pdf_dir > 0.0, "{name}");
        }
    }
}

#[test]
fn lights_of_any_power_are_chosen_with_probabilities_that_sum_to_one() {
    let (geometry, _) = Geometry::build(&[], &[]);
    let desc = |i: i32| LightDesc::Point {
        position: Vec3::ZERO,
        intensity: Rgb::splat(if i % 7 == 3 {
            0.0
        } else {
            10f32.powi(i % 25 - 12)
        }),
    };
    for n in [1, 25, 100_000] {
        let descs: Vec<_> = (0..n).map(desc).collect();
        let lights = lights_of(&descs, &geometry).unwrap();
        let dark = (0..n).filter(|i| i % 7 == 3).count();
        assert_eq!(lights.len(), n as usize - dark);
        let pmfs: Vec<f32> = (0..lights.len() as u32).map(|id| lights.pmf(id)).collect();
        assert!(pmfs.iter().all(|p| *p > 0.0));
        assert_eq!(pmfs.iter().map(|p| f64::from(*p)).sum::<f64>(), 1.0);
        for u in [0.0, 0.3, ONE_MINUS_EPSILON] {
            let (id, pmf) = lights.sample(u).unwrap();
            assert_eq!(pmf, lights.pmf(id));
        }
    }
    let empty = lights_of(&[], &geometry).unwrap();
    assert!(empty.is_empty() && empty.sample(0.5).is_none() && empty.escaped(Vec3A::X).is_black());
}

/// Lights without surface around `geometry`.
fn lights_of(descs: &[LightDesc], geometry: &Geometry) -> Result<Lights, String> {
    Lights::build(descs, &[], geometry, Silhouette::of_box(geometry))
}

fn environment(pixels: Vec<[f32; 3]>, width: usize) -> LightDesc {
    LightDesc::Environment {
        image: Arc::new(ImageData {
            name: "sky.exr".into(),
            width,
            height: pixels.len() / width,
            pixels,
        }),
        scale: Rgb::WHITE,
        rotation: Quat::IDENTITY,
    }
}

#[test]
fn environments_refuse_what_is_no_radiance_and_take_a_sun() {
    let (geometry, _) = Geometry::build(&[], &[]);
    for bad in [f32::NAN, f32::INFINITY, -1.0] {
        let mut pixels = vec![[1.0; 3]; 8];
        pixels[6][1] = bad;
        let error = lights_of(&[environment(pixels, 4)], &geometry).unwrap_err();
        assert!(
            error.contains("sky.exr") && error.contains("column 2, row 1"),
            "{error}"
        );
    }
    let black = Lights::build(
        &[environment(vec![[0.0; 3]; 8], 4)],
        &[],
        &geometry,
        Silhouette::of_box(&geometry),
    )
    .unwrap();
    assert!(black.is_empty());

    // One texel of 1e6 in a sky of 1: almost all samples see it, the estimate has no noise.
    let mut pixels = vec![[1.0; 3]; 64 * 32];
    pixels[9 * 64 + 20] = [1e6; 3];
    let lights = lights_of(&[environment(pixels, 64)], &geometry).unwrap();
    let light = lights.get(0);
    let total = estimate(50_000, 90, |u, _| {
        let s = light.sample_li(Vec3A::ZERO, u).unwrap();
        f64::from(s.radiance[0]) / f64::from(s.pdf_dir)
    });
    let sphere = 1.0; // bounding radius of an empty scene
    assert_near("sun", total, f64::from(light.power()[0]) / (PI * sphere));
    assert!(total.1 < 1e-4 * total.0);
}

#[test]
fn environment_images_stand_as_documented() {
    let (geometry, _) = Geometry::build(&[], &[]);
    let mut pixels = vec![[0.0; 3]; 32];
    for (i, p) in pixels.iter_mut().enumerate() {
        *p = [i as f32; 3];
    }
    let lights = lights_of(&[environment(pixels, 8)], &geometry).unwrap();
    let seen = |x: f32, y: f32, z: f32| lights.escaped(Vec3A::new(x, y, z).normalize())[0];
    // Row 1 of 4 is above the horizon; the middle of the image lies towards −z, its right to +x.
    assert_eq!(seen(0.1, 0.2, -1.0), 12.0);
    assert_eq!(seen(-0.1, 0.2, -1.0), 11.0);
    assert_eq!(seen(1.0, 0.2, -0.1), 13.0);
    assert_eq!(seen(0.1, -0.2, 1.0), 23.0);
    assert!(seen(0.01, 1.0, 0.0) < 8.0 && seen(0.01, -1.0, 0.0) >= 24.0);
}
