//! Every sampling routine of lights and cameras against the density it claims.

#[path = "support/chi_square.rs"]
mod chi_square;
#[path = "support/lights.rs"]
mod support;

use chi_square::{SphereGrid, assert_family, p_value, test_directions};
use glam::{DVec3, Vec2, Vec3, Vec3A};
use lightscope::engine::camera::Camera;
use lightscope::engine::geometry::Ray;
use lightscope::engine::light::{Light, Silhouette};
use lightscope::engine::sampling::{IndependentSampler, Sampler, Stream};
use lightscope::engine::scene::desc::{CameraDesc, LensDesc};

const SAMPLES: u64 = 300_000;
const BINS: usize = 12;

fn numbers(stream: u64) -> impl FnMut() -> (Vec2, Vec2) {
    let mut index = 0;
    move || {
        let mut s = IndependentSampler::new(7, Stream::Test, (stream, index));
        index += 1;
        (s.next_2d(), s.next_2d())
    }
}

/// Solid angle in f64 (van Oosterom and Strackee 1983), the volume from the sides: unit vectors to
/// a far triangle differ in their last digits only.
fn solid_angle(corners: [DVec3; 3], p: DVec3) -> f64 {
    let side = |i: usize| corners[i] - corners[0];
    let volume = (corners[0] - p).dot(side(1).cross(side(2))).abs();
    let to = corners.map(|v| v - p);
    let lengths = to.map(DVec3::length);
    let [a, b, c] = [to[0] / lengths[0], to[1] / lengths[1], to[2] / lengths[2]];
    let triple = volume / (lengths[0] * lengths[1] * lengths[2]);
    2.0 * triple.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

/// The point of a triangle at (x, y) of the unit square; rows of equal area.
fn point(corners: [DVec3; 3], x: f64, y: f64) -> DVec3 {
    let s = x.sqrt();
    corners[0] * (1.0 - s) + corners[1] * ((1.0 - y) * s) + corners[2] * (y * s)
}

/// Smallest barycentric coordinate of `q` in a triangle, and its bin there.
fn bin(corners: [DVec3; 3], q: DVec3) -> (f64, usize) {
    let (e1, e2) = (corners[1] - corners[0], corners[2] - corners[0]);
    let (n, to) = (e1.cross(e2), q - corners[0]);
    let b1 = to.cross(e2).dot(n) / n.length_squared();
    let b2 = e1.cross(to).dot(n) / n.length_squared();
    let s = b1 + b2;
    let index = |x: f64| ((x * BINS as f64) as usize).min(BINS - 1);
    let k = index(s * s) * BINS + index(b2 / s);
    (b1.min(b2).min(1.0 - s), k)
}

/// The triangle that holds `q` and the bin there, as one index.
fn bin_of(shapes: &[[DVec3; 3]], q: DVec3) -> usize {
    let bins = shapes.iter().map(|&v| bin(v, q)).enumerate();
    let (shape, (least, k)) = bins.max_by(|a, b| a.1.0.total_cmp(&b.1.0)).unwrap();
    assert!(least > -1e-3, "{q} is not on the light");
    shape * BINS * BINS + k
}

/// Samples the light of `triangles` as seen from `p`: counts by bin against exact solid angles.
fn test_flat(positions: &[Vec3], triangles: &[[u32; 3]], p: Vec3A, stream: u64) -> f64 {
    let lit = support::mesh(positions, triangles);
    assert_eq!(lit.lights.len(), 1);
    let light = lit.lights.get(0);
    let shapes: Vec<[DVec3; 3]> = triangles
        .iter()
        .map(|t| t.map(|i| positions[i as usize].as_dvec3()))
        .collect();
    let eye = p.as_dvec3();
    let mut probabilities = Vec::new();
    for &corners in &shapes {
        for k in 0..BINS * BINS {
            let at =
                |i: usize, j: usize| point(corners, i as f64 / BINS as f64, j as f64 / BINS as f64);
            let (i, j) = (k / BINS, k % BINS);
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            probabilities.push(solid_angle([a, b, c], eye) + solid_angle([a, c, d], eye));
        }
    }
    let total: f64 = probabilities.iter().sum();
    probabilities.iter_mut().for_each(|p| *p /= total);
    let mut counts = vec![0; probabilities.len()];
    let mut next = numbers(stream);
    for _ in 0..SAMPLES {
        let sample = light.sample_li(p, next().0).unwrap();
        let claimed = f64::from(sample.pdf_dir) * total;
        assert!(
            (claimed - 1.0).abs() < 1e-3,
            "solid angle off by {claimed} from {p}"
        );
        let q = sample.target.as_dvec3();
        counts[bin_of(&shapes, q)] += 1;
    }
    p_value(&probabilities, &counts)
}

/// Where to look at the triangle (0,0,0) (1,0,0) (0,1,0) from: usual and extreme places.
fn views() -> Vec<Vec3A> {
    let mut views = vec![
        Vec3A::new(0.3, 0.2, 1.0),
        Vec3A::new(-2.0, 0.5, 0.3),
        Vec3A::new(10.0, -7.0, 30.0),
        Vec3A::new(300.0, 100.0, 2000.0),
        Vec3A::new(1e6, 2e6, 3e6),
        Vec3A::new(2.0, 3.0, 1e-3),
    ];
    // Over the inside, the edges, the corners, and beside them.
    for height in [1e-1, 1e-2, 1e-3] {
        for (x, y) in [
            (0.3, 0.3),
            (0.5, 0.0),
            (0.0, 0.5),
            (0.5, 0.5),
            (0.0, 0.0),
            (1.0, 0.0),
        ] {
            views.push(Vec3A::new(x, y, height));
        }
        views.push(Vec3A::new(0.5, -1e-3, height));
    }
    views
}

#[test]
fn triangles_and_quads_are_uniform_over_their_solid_angle() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(0.9, 1.1, 0.0)];
    let mut p_values = Vec::new();
    for (i, view) in views().into_iter().enumerate() {
        for (kind, triangles) in [
            ("triangle", &[[0, 1, 2]][..]),
            ("turned", &[[2, 0, 1]]),
            ("quad", &[[0, 1, 2], [1, 3, 2]]),
        ] {
            let scale = [1e-6, 1.0, 1e5][i % 3];
            let positions = corners.map(|v| v * scale);
            let p = test_flat(&positions, triangles, view * scale, i as u64);
            p_values.push((format!("{kind} from {view}"), p));
        }
    }
    let needle = [Vec3::ZERO, Vec3::X, Vec3::new(0.4, 1e-3, 0.0)];
    for (i, view) in [Vec3A::new(0.4, 0.1, 0.2), Vec3A::new(-0.5, 1e-4, 1e-3)]
        .into_iter()
        .enumerate()
    {
        let p = test_flat(&needle, &[[0, 1, 2]], view, 100 + i as u64);
        p_values.push((format!("needle from {view}"), p));
    }
    assert_family(&p_values);
}

#[test]
fn spheres_are_uniform_over_their_cone() {
    let mut p_values = Vec::new();
    for (i, ratio) in [1.0001, 1.01, 1.5, 10.0, 1e4, 1e7].into_iter().enumerate() {
        let radius = [1e-6_f32, 1.0, 1e4][i % 3];
        let lit = support::sphere(Vec3::ZERO, radius, false);
        let light = lit.lights.get(0);
        let p = Vec3A::new(0.48, 0.6, -0.64) * (ratio as f32 * radius);
        let distance = p.as_dvec3().length() / f64::from(radius);
        let sin2 = 1.0 / (distance * distance);
        let drop = sin2 / (1.0 + (1.0 - sin2).sqrt());
        let axis = -p.as_dvec3().normalize();
        let (s, t) = axis.any_orthonormal_pair();
        let mut counts = vec![0; BINS * BINS];
        let mut next = numbers(200 + i as u64);
        for _ in 0..SAMPLES {
            let sample = light.sample_li(p, next().0).unwrap();
            let claimed = f64::from(sample.pdf_dir) * std::f64::consts::TAU * drop;
            assert!(
                (claimed - 1.0).abs() < 1e-3,
                "{ratio}: cone off by {claimed}"
            );
            // Near the surface the direction has more digits, far from it the point.
            let d = if ratio < 2.0 {
                sample.wi.as_dvec3().normalize()
            } else {
                (sample.target.as_dvec3() - p.as_dvec3()).normalize()
            };
            let x = 0.5 * (d - axis).length_squared() / drop;
            let y = d.dot(t).atan2(d.dot(s)) / std::f64::consts::TAU;
            assert!(x < 1.001, "{ratio}: outside the cone");
            let index = |x: f64| ((x * BINS as f64) as usize).min(BINS - 1);
            counts[index(x) * BINS + index(y.rem_euclid(1.0))] += 1;
        }
        let uniform = vec![1.0 / counts.len() as f64; counts.len()];
        p_values.push((format!("{ratio} radii"), p_value(&uniform, &counts)));
    }
    assert_family(&p_values);
}

/// Density in which the scene would claim to have sampled `d` at `p`.
fn pdf_li(lit: &support::Lit, light: &Light, p: Vec3A, d: Vec3A) -> f64 {
    let ray = Ray::new(p, d);
    let hit = lit.geometry.intersect(&ray);
    let si = hit.map(|hit| lit.geometry.interaction(&ray, &hit));
    f64::from(light.pdf_li(p, d, si.as_ref()))
}

#[test]
fn directions_to_lights_follow_pdf_li() {
    let mut p_values = Vec::new();
    for (i, (name, lit)) in support::every_kind().into_iter().enumerate() {
        let light = lit.lights.get(0);
        if light.is_delta() {
            continue;
        }
        let spread = if light.is_infinite() || name == "inward" {
            2.0
        } else {
            0.3
        };
        let grid = SphereGrid::new(Vec3A::new(0.1, 0.05, -1.0), spread);
        let mut next = numbers(300 + i as u64);
        let p = test_directions(
            &grid,
            SAMPLES,
            |d| pdf_li(&lit, light, support::VIEW, d),
            || Some(light.sample_li(support::VIEW, next().0)?.wi),
        );
        p_values.push((name.to_owned(), p));
    }
    assert_eq!(p_values.len(), 6);
    assert_family(&p_values);
}

#[test]
fn rays_from_lights_follow_pdf_le() {
    let mut p_values = Vec::new();
    for (i, (name, lit)) in support::every_kind().into_iter().enumerate() {
        let light = lit.lights.get(0);
        let mut next = numbers(400 + i as u64);
        let n = light.sample_le(next().0, next().1).unwrap().n;
        let is_sphere = matches!(light, Light::Sphere(_));
        if !matches!(light, Light::Directional(_)) {
            // Directions, for one normal; those of a sphere are turned into its frame.
            let axis = n.unwrap_or(Vec3A::Z);
            let grid = SphereGrid::new(axis, 1.0);
            let p = test_directions(
                &grid,
                SAMPLES,
                |d| f64::from(light.pdf_le(n, d).1),
                || {
                    let (u_pos, u_dir) = next();
                    let sample = light.sample_le(u_pos, u_dir)?;
                    if !is_sphere {
                        return Some(sample.ray.d);
                    }
                    let local = sample.n?;
                    let turn = glam::Quat::from_rotation_arc(local.into(), Vec3::from(axis));
                    Some(turn * sample.ray.d)
                },
            );
            p_values.push((format!("{name}: directions"), p));
        }
        if is_sphere {
            let grid = SphereGrid::new(Vec3A::Y, 2.0);
            let uniform = 0.25 / std::f64::consts::PI;
            let p = test_directions(
                &grid,
                SAMPLES,
                |_| uniform,
                || {
                    let (u_pos, u_dir) = next();
                    light.sample_le(u_pos, u_dir)?.n
                },
            );
            p_values.push((format!("{name}: positions"), p));
        }
        if let Light::Directional(_) = light {
            // Start points on the disk: rings of equal area, and sectors.
            let mut counts = vec![0; BINS * BINS];
            for _ in 0..SAMPLES {
                let sample = light.sample_le(next().0, next().1).unwrap();
                let d = sample.ray.d.as_dvec3();
                let o = sample.ray.o.as_dvec3();
                let (s, t) = d.normalize().any_orthonormal_pair();
                let (x, y) = (o.dot(s), o.dot(t));
                let index = |x: f64| ((x * BINS as f64) as usize).min(BINS - 1);
                let sector = (y.atan2(x) / std::f64::consts::TAU).rem_euclid(1.0);
                counts[index(x * x + y * y) * BINS + index(sector)] += 1;
            }
            let uniform = vec![1.0 / counts.len() as f64; counts.len()];
            p_values.push((format!("{name}: positions"), p_value(&uniform, &counts)));
        }
    }
    assert_family(&p_values);
}

/// Whether the line through `o` along `d` meets the box of half sides `half` around the origin.
fn meets_box(o: DVec3, d: DVec3, half: DVec3) -> bool {
    let (mut first, mut last) = (f64::NEG_INFINITY, f64::INFINITY);
    for i in 0..3 {
        if d[i] == 0.0 {
            if o[i].abs() > half[i] {
                return false;
            }
            continue;
        }
        let (a, b) = ((-half[i] - o[i]) / d[i], (half[i] - o[i]) / d[i]);
        first = first.max(a.min(b));
        last = last.min(a.max(b));
    }
    first <= last
}

#[test]
fn light_from_infinity_is_spread_evenly_over_the_shadow_of_the_scene() {
    let box_and_plate = [
        (Vec3::new(2.0, 3.0, 1.0), Vec3A::new(0.01, -0.02, 1.0)),
        (Vec3::new(2.0, 0.0, 4.0), Vec3A::new(0.3, -0.4, 0.2)),
    ];
    let mut p_values = Vec::new();
    for (k, (size, flat)) in box_and_plate.into_iter().enumerate() {
        let directions = [Vec3A::new(-1.0, 1.5, -1.0), Vec3A::Y, flat];
        let half = 0.5 * size;
        let corners = [-half, half, Vec3::new(half.x, -half.y, -half.z)];
        let lit = support::mesh(&corners, &[[0, 1, 2]]);
        let silhouette = Silhouette::of_box(&lit.geometry);
        // A little larger than the scene, and never flat.
        let half = half.as_dvec3() + 1e-3 * half.as_dvec3().length();
        for (i, d) in directions.into_iter().enumerate() {
            let d = d.normalize();
            let axis = d.as_dvec3();
            let (s, t) = axis.normalize().any_orthonormal_pair();
            let extent = half.length();
            let place = |x: f64| (x - 0.5) * 2.0 * extent;
            let fine = 400 * BINS;
            let mut shadow = vec![0.0; BINS * BINS];
            for y in 0..fine {
                for x in 0..fine {
                    let at = |i: usize| place((i as f64 + 0.5) / fine as f64);
                    if meets_box(s * at(x) + t * at(y), axis, half) {
                        shadow[y / 400 * BINS + x / 400] += 1.0;
                    }
                }
            }
            let total: f64 = shadow.iter().sum();
            let area = total * (2.0 * extent / fine as f64).powi(2);
            let claimed = f64::from(silhouette.pdf_pos(d)) * area;
            assert!((claimed - 1.0).abs() < 0.01, "{size} {d}: {claimed}");
            shadow.iter_mut().for_each(|p| *p /= total);
            let mut counts = vec![0; BINS * BINS];
            let mut next = numbers(700 + 10 * k as u64 + i as u64);
            for _ in 0..SAMPLES {
                let ray = silhouette.enter(d, next().0);
                let o = ray.o.as_dvec3();
                assert!(o.dot(axis) < 0.0 && meets_box(o, axis, half * 1.00001));
                let index = |x: f64| ((0.5 + x / (2.0 * extent)) * BINS as f64) as usize;
                counts[index(o.dot(t)) * BINS + index(o.dot(s))] += 1;
            }
            p_values.push((format!("{size} along {d}"), p_value(&shadow, &counts)));
        }
    }
    assert_family(&p_values);
}

/// Far from the origin the centre of the scene is rounded by as much as the scene is large.
#[test]
fn light_from_infinity_reaches_all_of_a_scene_far_from_the_origin() {
    let mut next = numbers(800);
    for k in 0..2000 {
        let (u, v) = next();
        let offset = 10.0_f32.powi(k % 8);
        let low = (Vec3::new(u.x, u.y, v.x) - 0.5) * offset;
        let size = Vec3::new(1.0 + v.y, 1.0 + u.y, 1.5);
        let corners = [low, low + size, Vec3::new(low.x + size.x, low.y, low.z)];
        let lit = support::mesh(&corners, &[[0, 1, 2]]);
        let silhouette = Silhouette::of_box(&lit.geometry);
        let (min, max) = (lit.geometry.bounds().min, lit.geometry.bounds().max);
        let ends = [Vec2::ZERO, Vec2::splat(1.0 - f32::EPSILON / 2.0)];
        for (axis, d) in [Vec3A::X, Vec3A::Y, Vec3A::NEG_Z].into_iter().enumerate() {
            let [a, b] = ends.map(|u| silhouette.enter(d, u).o);
            for side in (0..3).filter(|side| *side != axis) {
                let (first, last) = (a[side].min(b[side]), a[side].max(b[side]));
                assert!(first <= min[side] && max[side] <= last, "{low} {size} {d}");
            }
        }
    }
}

#[test]
fn flat_lights_emit_evenly_over_their_area() {
    let square = [Vec3::ZERO, Vec3::X, Vec3::new(0.9, 1.1, 0.0), Vec3::Y];
    let mut p_values = Vec::new();
    for (i, triangles) in [&[[0, 1, 2]][..], &[[0, 1, 2], [0, 2, 3]]]
        .into_iter()
        .enumerate()
    {
        let lit = support::mesh(&square, triangles);
        let light = lit.lights.get(0);
        let shapes: Vec<[DVec3; 3]> = triangles
            .iter()
            .map(|t| t.map(|i| square[i as usize].as_dvec3()))
            .collect();
        let areas: Vec<f64> = shapes
            .iter()
            .map(|v| 0.5 * (v[1] - v[0]).cross(v[2] - v[0]).length())
            .collect();
        let total: f64 = areas.iter().sum();
        assert!((f64::from(light.pdf_le(Some(Vec3A::Z), Vec3A::Z).0) * total - 1.0).abs() < 1e-6);
        let cells = (BINS * BINS) as f64;
        let probabilities: Vec<f64> = areas
            .iter()
            .flat_map(|a| vec![a / total / cells; BINS * BINS])
            .collect();
        let mut counts = vec![0; probabilities.len()];
        let mut next = numbers(500 + i as u64);
        for _ in 0..SAMPLES {
            let (u_pos, u_dir) = next();
            let q = light.sample_le(u_pos, u_dir).unwrap().p.as_dvec3();
            counts[bin_of(&shapes, q)] += 1;
        }
        p_values.push((
            format!("{} triangles", triangles.len()),
            p_value(&probabilities, &counts),
        ));
    }
    assert_family(&p_values);
}

#[test]
fn camera_rays_follow_pdf_we() {
    let desc = CameraDesc {
        position: Vec3::new(1.0, 2.0, 3.0),
        target: Vec3::new(0.0, 0.5, -1.0),
        vfov_deg: 70.0,
        width: 30,
        height: 20,
        ..CameraDesc::default()
    };
    let lens = LensDesc {
        radius: 0.4,
        focus_distance: 3.0,
    };
    let mut p_values = Vec::new();
    for (i, lens) in [None, Some(lens)].into_iter().enumerate() {
        let camera = Camera::new(&CameraDesc { lens, ..desc }).unwrap();
        let u_lens = Vec2::new(0.9, 0.3);
        let o = camera.generate_ray(Vec2::ZERO, u_lens).o;
        let grid = SphereGrid::new(camera.forward(), 0.7);
        let mut next = numbers(600 + i as u64);
        let p = test_directions(
            &grid,
            SAMPLES,
            |d| f64::from(camera.pdf_we(&Ray::new(o, d)).1),
            || {
                let film = next().0 * Vec2::new(30.0, 20.0);
                Some(camera.generate_ray(film, u_lens).d)
            },
        );
        p_values.push((format!("{lens:?}"), p));
    }
    assert_family(&p_values);
}
