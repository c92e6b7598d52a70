//! Estimates of photon maps against closed forms: bias, few photons, walls, corners, lenses.

#[path = "support/boxes.rs"]
mod boxes;
#[path = "support/photons.rs"]
mod photons;

use std::f32::consts::PI;

use boxes::{diffuse, glass, mirror, point_light, quad, scene};
use glam::{Vec2, Vec3};
use lightscope::engine::math::Rgb;
use lightscope::engine::photon::{
    Disc, Kernel, MapKind, MapSettings, Nearest, Numbers, Packing, PhotonMap,
};
use lightscope::engine::scene::Scene;
use lightscope::engine::scene::desc::{LightDesc, MeshDesc};
use photons::{build, estimate, landing, mean_and_error, settings};

/// A point light between a floor and a mirror ceiling: the caustic is that of the light's image,
/// E = ρ I cos/d², smooth everywhere.
fn mirror_image() -> (std::sync::Arc<Scene>, f64, f64) {
    let (ceiling, height, albedo, reflectance) = (3.0, 2.0, 0.5, 0.8);
    let floor = quad(
        0,
        Vec3::new(-20.0, 0.0, -20.0),
        Vec3::Z * 40.0,
        Vec3::X * 40.0,
    );
    // As wide as the image's light on the floor within 6 m needs.
    let mirror_plate = quad(
        1,
        Vec3::new(-3.0, ceiling, -3.0),
        Vec3::X * 6.0,
        Vec3::Z * 6.0,
    );
    let light = point_light(Vec3::new(0.0, height, 0.0), 30.0);
    let scene = scene(
        vec![diffuse("floor", albedo), mirror("mirror", reflectance)],
        vec![floor, mirror_plate],
        vec![],
        vec![light],
    );
    let distance = f64::from(2.0 * ceiling - height);
    let radiance = f64::from(albedo * reflectance * 30.0 / PI);
    (scene, distance, radiance)
}

/// In the scene `mirror_image` the bias falls with the square of the radius, and is what the
/// curvature of the irradiance makes of it.
#[test]
fn bias_falls_with_the_square_of_the_radius() {
    let (scene, distance, radiance) = mirror_image();
    let exact = radiance / (distance * distance);
    // The radius is fixed, so well-spread photons bring no bias of their own, and less noise.
    let sobol = |index| MapSettings {
        numbers: Numbers::Sobol,
        ..settings(60_000, index)
    };
    let maps: Vec<PhotonMap> = (0..16)
        .map(|i| build(&scene, MapKind::Caustic, &sobol(i)))
        .collect();
    let si = landing(&scene, Vec3::Y, Vec3::NEG_Y);
    let mut fit = Vec::new();
    for radius in [0.5_f64, 0.8, 1.2, 1.6] {
        let values: Vec<f64> = maps
            .iter()
            .map(|m| estimate(m, &scene, &si, radius as f32, 1_000_000) / exact - 1.0)
            .collect();
        let (bias, error) = mean_and_error(&values);
        let predicted = predicted(radius, distance);
        println!("radius {radius}: bias {bias:.5} ± {error:.5}, predicted {predicted:.5}");
        assert!(
            (bias - predicted).abs() < 4.0 * error,
            "{bias} ± {error}, {predicted}"
        );
        fit.push((radius.ln(), (-bias).ln(), error / bias.abs()));
    }
    let (measured, error) = slope(&fit);
    let law = fit
        .iter()
        .map(|f| (f.0, (-predicted(f.0.exp(), distance)).ln(), f.2));
    let (expected, _) = slope(&law.collect::<Vec<_>>());
    println!("slope {measured:.3} ± {error:.3}; with the next term of the series {expected:.3}");
    assert!((measured - expected).abs() < 4.0 * error && error < 0.05);
    assert!((measured - 2.0).abs() < 0.2, "{measured}");
}

/// E = E₀ (1 + s²/D²)^(−3/2): its mean over the disc, relative to E₀, less 1.
fn predicted(radius: f64, distance: f64) -> f64 {
    let x = (radius / distance).powi(2);
    2.0 * (1.0 - 1.0 / (1.0 + x).sqrt()) / x - 1.0
}

/// Weighted least squares of y over x, weights 1/σ²: the slope and its error.
fn slope(points: &[(f64, f64, f64)]) -> (f64, f64) {
    let weight = |f: &(f64, f64, f64)| 1.0 / (f.2 * f.2);
    let total: f64 = points.iter().map(weight).sum();
    let centre = |k: fn(&(f64, f64, f64)) -> f64| {
        points.iter().map(|f| weight(f) * k(f)).sum::<f64>() / total
    };
    let (x0, y0) = (centre(|f| f.0), centre(|f| f.1));
    let sxx: f64 = points.iter().map(|f| weight(f) * (f.0 - x0).powi(2)).sum();
    let sxy: f64 = points
        .iter()
        .map(|f| weight(f) * (f.0 - x0) * (f.1 - y0))
        .sum();
    (sxy / sxx, 1.0 / sxx.sqrt())
}

/// n nearest with a largest radius, whichever ends the search, without bias from the number.
#[test]
fn the_estimate_of_few_photons_is_unbiased_where_light_is_even() {
    let floor = quad(0, Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0);
    let irradiance = 2.0;
    let beam = LightDesc::Directional {
        direction: Vec3::NEG_Y,
        irradiance: Rgb::splat(irradiance),
    };
    let scene = scene(vec![diffuse("floor", 0.5)], vec![floor], vec![], vec![beam]);
    let exact = f64::from(0.5 * irradiance / PI);
    let maps: Vec<PhotonMap> = (0..16)
        .map(|i| build(&scene, MapKind::Global, &settings(4000, i)))
        .collect();
    // About 1000 photons a m²: a radius of 0.05 holds 8.
    for kernel in Kernel::ALL {
        for (n, radius) in [(5, 0.5), (8, 0.5), (8, 0.05), (20, 0.05), (50, 0.3)] {
            let each = |map: &PhotonMap| {
                let mut sum = 0.0;
                for i in 0..400 {
                    let at = |k: usize| (k as f32 - 9.5) * 0.06;
                    let o = Vec3::new(at(i % 20), 1.0, at(i / 20));
                    let si = landing(&scene, o, Vec3::NEG_Y);
                    let disc = Disc::new(&si, radius, false);
                    let bsdf = scene.bsdf(&si);
                    map.estimate(&si, &bsdf, &disc, kernel, &mut Nearest::new(n), |c| {
                        sum += f64::from(c.radiance.mean());
                    });
                }
                sum / 400.0
            };
            let (mean, error) = mean_and_error(&maps.iter().map(each).collect::<Vec<_>>());
            assert!(
                (mean - exact).abs() < 4.5 * error && error < 0.03 * exact,
                "{} {n} {radius}: {mean} ± {error}, {exact}",
                kernel.id()
            );
        }
    }
}

/// Thin walls: nothing is seen from the side that no light reaches, however close the photons.
#[test]
fn no_light_comes_through_a_wall() {
    for gap in [0.0, 1e-6, 1e-4, 1e-2] {
        let (a, b) = (Vec3::Z * 4.0, Vec3::X * 4.0);
        let mut meshes = vec![quad(0, Vec3::new(-2.0, 0.0, -2.0), a, b)];
        if gap > 0.0 {
            meshes.push(quad(0, Vec3::new(-2.0, -gap, -2.0), b, a));
        }
        let light = point_light(Vec3::new(0.0, 1.5, 0.0), 3.0);
        let scene = scene(vec![diffuse("wall", 0.7)], meshes, vec![], vec![light]);
        for packing in [Packing::Packed, Packing::Full] {
            let settings = MapSettings {
                packing,
                ..settings(50_000, 0)
            };
            let map = build(&scene, MapKind::Global, &settings);
            for i in 0..200 {
                let at = Vec2::new((i % 20) as f32, (i / 20) as f32) * 0.15 - 1.4;
                let from = |y: f32| Vec3::new(at.x, y, at.y);
                let above = landing(&scene, from(1.0), Vec3::NEG_Y);
                let below = landing(&scene, from(-1.0), Vec3::Y);
                assert!(estimate(&map, &scene, &above, 0.3, 50) > 0.0);
                assert_eq!(
                    estimate(&map, &scene, &below, 0.3, 50),
                    0.0,
                    "gap {gap} at {at}"
                );
            }
        }
    }
}

/// A corner: half of the disc is missing and the adjoining wall adds a part of it. Two radii
/// report that bias where the corner lies at some share of the radius; in the corner itself it is
/// the same at every radius and is not seen.
#[test]
fn the_bias_in_a_corner_is_bounded_and_reported() {
    let floor = quad(0, Vec3::ZERO, Vec3::Z * 4.0, Vec3::X * 4.0);
    let wall = quad(0, Vec3::ZERO, Vec3::Y * 4.0, Vec3::Z * 4.0);
    let beam = LightDesc::Directional {
        direction: Vec3::new(-1.0, -1.0, 0.0),
        irradiance: Rgb::splat(2.0),
    };
    let corner = scene(
        vec![diffuse("wall", 0.5)],
        vec![floor, wall],
        vec![],
        vec![beam],
    );
    let exact = f64::from(0.5 * 2.0 / PI) * 0.5_f64.sqrt();
    // Direct light alone: photons of the first landing.
    let first = |map: &PhotonMap, x: f32, radius: f32| {
        let si = landing(&corner, Vec3::new(x, 1.0, 2.0), Vec3::NEG_Y);
        let disc = Disc::new(&si, radius, false);
        let (mut sum, bsdf) = (0.0, corner.bsdf(&si));
        map.estimate(
            &si,
            &bsdf,
            &disc,
            Kernel::Box,
            &mut Nearest::new(100_000),
            |c| {
                if c.events == 0 {
                    sum += f64::from(c.radiance.mean());
                }
            },
        );
        sum / exact - 1.0
    };
    let maps: Vec<PhotonMap> = (0..16)
        .map(|i| build(&corner, MapKind::Global, &settings(60_000, i)))
        .collect();
    for x in [0.001_f32, 0.05, 0.1, 0.2, 0.4] {
        let each: Vec<[f64; 2]> = maps
            .iter()
            .map(|m| [first(m, x, 0.3), first(m, x, 0.3 / 4.0)])
            .collect();
        let of =
            |f: &dyn Fn(&[f64; 2]) -> f64| mean_and_error(&each.iter().map(f).collect::<Vec<_>>());
        // As `noise_and_bias` reports it, from discs of A and A/16.
        let report = |[full, shrunk]: &[f64; 2]| 4.0 / 3.0 * (full - shrunk);
        let ((full, error), (reported, _)) = (of(&|e| e[0]), of(&report));
        println!("{x} m from the corner: {full:.3} ± {error:.3}, reported {reported:.3}");
        if x > 0.04 {
            // Light is missing, and no more than is reported.
            let (rest, error) = of(&|e| e[0] - report(e));
            assert!(rest > -4.0 * error, "{rest} ± {error}");
        }
        if x > 0.3 {
            assert!(full.abs() < 4.0 * error);
        } else {
            // Half of the disc is missing at worst, and a quarter as much comes from the wall.
            assert!(full < 4.0 * error && full > -0.5, "{full}");
        }
    }
}

/// caustic-lens: a beam through a thin biconvex lens on a screen. By flux conservation the light
/// of the lens's aperture falls on a disk smaller by 1 − d/f, 1/f = (n − 1)·2/R.
#[test]
fn a_lens_concentrates_a_beam_by_flux_conservation() {
    let (ior, curvature, aperture, distance) = (1.5_f32, 10.0_f32, 0.5_f32, 4.0_f32);
    let focal = curvature / (2.0 * (ior - 1.0));
    let screen = quad(0, Vec3::new(-2.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0);
    let beam = LightDesc::Directional {
        direction: Vec3::NEG_Y,
        irradiance: Rgb::splat(1.0),
    };
    let materials = vec![diffuse("screen", 0.5), glass("lens", ior)];
    let lens = biconvex(1, Vec3::Y * distance, curvature, aperture);
    let scene = scene(materials, vec![screen, lens], vec![], vec![beam]);
    // Two surfaces at normal incidence; what is reflected between them comes out diverging.
    let fresnel = ((ior - 1.0) / (ior + 1.0)).powi(2);
    let shrink = f64::from(1.0 - distance / focal).powi(2);
    let exact = f64::from(0.5 / PI * (1.0 - fresnel).powi(2)) / shrink;
    let maps: Vec<PhotonMap> = (0..16)
        .map(|i| build(&scene, MapKind::Caustic, &settings(30_000, i)))
        .collect();
    let values = |x: f32, z: f32| {
        let si = landing(&scene, Vec3::new(x, 1.0, z), Vec3::NEG_Y);
        let each = |m: &PhotonMap| estimate(m, &scene, &si, 0.03, 1_000_000);
        mean_and_error(&maps.iter().map(each).collect::<Vec<_>>())
    };
    for (x, z) in [(0.0, 0.0), (0.04, 0.0), (0.0, -0.05)] {
        let (mean, error) = values(x, z);
        println!("({x}, {z}): {mean} ± {error}, thin lens {exact}");
        // The thin-lens formula leaves out the lens's own thickness, 2.5 % of the focal length
        // each way, and the spherical aberration: 3 % together for this aperture.
        assert!((mean / exact - 1.0).abs() < 0.03 + 4.0 * error / exact);
    }
    // Beyond the shrunk disk nothing is left but what was reflected within the glass.
    let (rim, _) = values(0.36, 0.0);
    assert!(rim < 0.05 * exact, "{rim}");
    // All of it together: the flux through the aperture.
    let flux: f64 = maps.iter().map(|m| m.counts.power[0]).sum::<f64>() / maps.len() as f64;
    let through = f64::from(PI * aperture * aperture * (1.0 - fresnel) / (1.0 + fresnel));
    assert!((flux / through - 1.0).abs() < 0.01, "{flux} {through}");
}

/// Two spherical caps of radius of curvature `r` that meet at the rim of radius `a`, with smooth
/// normals.
fn biconvex(material: usize, center: Vec3, r: f32, a: f32) -> MeshDesc {
    let (rings, spokes) = (64_u32, 256_u32);
    let depth = (r * r - a * a).sqrt();
    let mut mesh = quad(material, Vec3::ZERO, Vec3::X, Vec3::Z);
    (mesh.positions, mesh.triangles) = (Vec::new(), Vec::new());
    for side in [1.0_f32, -1.0] {
        let base = mesh.positions.len() as u32;
        for ring in 0..=rings {
            for spoke in 0..spokes {
                let s = a * ring as f32 / rings as f32;
                let (sin, cos) = (2.0 * PI * spoke as f32 / spokes as f32).sin_cos();
                let y = side * (r * r - s * s).sqrt();
                mesh.normals.push(Vec3::new(s * cos, y, s * sin) / r);
                mesh.positions
                    .push(center + Vec3::new(s * cos, y - side * depth, s * sin));
            }
        }
        for (ring, spoke) in (0..rings).flat_map(|r| (0..spokes).map(move |s| (r, s))) {
            let at = |r: u32, s: u32| base + r * spokes + s % spokes;
            let (i, j) = (at(ring, spoke), at(ring, spoke + 1));
            let (k, l) = (at(ring + 1, spoke + 1), at(ring + 1, spoke));
            for t in [[i, j, k], [i, k, l]] {
                let outward = if side > 0.0 { t } else { [t[0], t[2], t[1]] };
                mesh.triangles.push(outward);
            }
        }
    }
    mesh
}
