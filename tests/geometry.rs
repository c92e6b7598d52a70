//! Rays against triangles and spheres: nothing leaks, nothing depends on the hierarchy.

use glam::{Vec2, Vec3, Vec3A};
use lightscope::engine::geometry::{DropReport, Geometry, Hit, MeshInput, Ray, SphereInput};
use lightscope::engine::sampling::sampler::Sampler;
use lightscope::engine::stability::scenes::bumpy_sphere;

#[path = "support/rays.rs"]
mod rays;
use rays::{build, cube, direction, point, sampler};

/// The closest hit by asking each primitive on its own.
fn brute_force(parts: &[Geometry], ray: &Ray) -> Option<Hit> {
    let mut best: Option<Hit> = None;
    for (prim, part) in parts.iter().enumerate() {
        if let Some(hit) = part.intersect(ray)
            && best.is_none_or(|b| hit.t < b.t)
        {
            best = Some(Hit {
                prim: prim as u32,
                ..hit
            });
        }
    }
    best
}

#[test]
fn soup_of_triangles_and_spheres_equals_brute_force() {
    let hits = compare_soup(400, 100, 20_000);
    assert!(hits > 5_000, "{hits} hits");
}

/// Few surfaces are met one by one, more in a hierarchy: the answers do not tell.
#[test]
fn small_soups_equal_brute_force() {
    let all = [(1, 0), (0, 1), (3, 2), (16, 4), (32, 0), (29, 1), (33, 0)];
    let hits: usize = all
        .into_iter()
        .map(|(triangles, spheres)| compare_soup(triangles, spheres, 10_000))
        .sum();
    assert!(hits > 1_000, "{hits} hits");
}

/// Compares `rays` rays, and returns how many met anything.
fn compare_soup(count: u32, spheres: u32, rays: usize) -> usize {
    let mut s = sampler(1);
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..count {
        let (center, size) = (point(&mut s), s.next_1d());
        positions.extend([0; 3].map(|_| center + size * point(&mut s)));
        triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let spheres: Vec<SphereInput> = (0..spheres)
        .map(|_| SphereInput {
            center: point(&mut s),
            radius: 0.1 * s.next_1d() + 1e-6,
            inward: false,
            material: 0,
        })
        .collect();
    let mesh = MeshInput {
        positions: &positions,
        triangles: &triangles,
        ..MeshInput::default()
    };
    let (all, report) = Geometry::build(&[mesh], &spheres);
    assert_eq!(report, DropReport::default());
    let mut parts: Vec<Geometry> = triangles
        .iter()
        .map(|t| build(&positions, &[*t]).0)
        .collect();
    parts.extend(
        spheres
            .iter()
            .map(|sphere| Geometry::build(&[], &[*sphere]).0),
    );
    let mut hits = 0;
    for _ in 0..rays {
        let mut ray = Ray::new(2.0 * Vec3A::from(point(&mut s)), direction(&mut s));
        let expected = brute_force(&parts, &ray);
        assert_eq!(all.intersect(&ray), expected);
        assert_eq!(all.occluded(&ray), expected.is_some());
        if let Some(hit) = expected {
            hits += 1;
            ray.t_max = hit.t;
            assert!(!all.occluded(&ray), "the end of a ray is exclusive");
            ray.t_max = hit.t.next_up();
            assert_eq!(all.intersect(&ray), expected);
            assert!(all.occluded(&ray));
        }
    }
    hits
}

#[test]
fn an_empty_scene_is_never_hit() {
    let (empty, _) = Geometry::build(&[], &[]);
    let ray = Ray::new(Vec3A::ZERO, Vec3A::Z);
    assert_eq!(empty.intersect(&ray), None);
    assert!(!empty.occluded(&ray));
    assert!(empty.bounds().is_empty());
    assert_eq!(empty.bounding_sphere(), (Vec3A::ZERO, 0.0));
    assert_eq!(empty.primitive_count(), 0);
}

/// Rays from inside towards vertices and edges of a closed mesh; returns how many got out.
fn leaks(rays: u64, scale: f32, center: Vec3) -> usize {
    let (positions, triangles) = bumpy_sphere(24, scale, center);
    let (geometry, report) = build(&positions, &triangles);
    assert_eq!(report, DropReport::default());
    let mut s = sampler(2);
    let mut leaked = 0;
    for i in 0..rays {
        let o = center + 0.4 * scale * point(&mut s);
        let triangle = triangles[(s.next_1d() * triangles.len() as f32) as usize];
        let [a, b] = [triangle[0], triangle[1]].map(|v| positions[v as usize]);
        let target = if i % 2 == 0 {
            a
        } else {
            a.lerp(b, s.next_1d())
        };
        let inside = Ray::new(o.into(), Vec3A::from(target - o).normalize());
        leaked += usize::from(geometry.intersect(&inside).is_none());
        // From outside every ray to a point inside must enter.
        let from = center + 4.0 * (target - center) + scale * point(&mut s);
        let through = Vec3A::from(target + 0.01 * (o - target) - from);
        leaked += usize::from(!geometry.occluded(&Ray::new(from.into(), through.normalize())));
    }
    leaked
}

#[test]
fn closed_meshes_are_watertight_at_vertices_and_edges() {
    assert_eq!(leaks(500_000, 1.0, Vec3::ZERO), 0);
    assert_eq!(leaks(100_000, 1e-6, Vec3::ZERO), 0);
    assert_eq!(leaks(100_000, 1e6, Vec3::ZERO), 0);
    assert_eq!(leaks(200_000, 1.0, Vec3::new(1e4, -3e3, 5e3)), 0);
}

#[test]
fn axis_rays_with_zero_components_hit_faces_edges_and_corners() {
    let (positions, triangles) = cube(1.0, Vec3::ZERO);
    let (geometry, _) = build(&positions, &triangles);
    let values = [-1.0, -0.5, -0.0, 0.0, 0.5, 1.0];
    for (axis, zero) in [0, 1, 2].into_iter().flat_map(|a| [(a, 0.0), (a, -0.0)]) {
        for (x, y) in values.iter().flat_map(|&x| values.map(|y| (x, y))) {
            for sign in [-1.0, 1.0] {
                let mut d = Vec3A::splat(zero);
                d[axis] = sign;
                let mut o = Vec3A::splat(0.0);
                o[(axis + 1) % 3] = x;
                o[(axis + 2) % 3] = y;
                // From the middle, also along faces, edges: a wall in front is never missed.
                let hit = geometry.intersect(&Ray::new(o, d));
                assert_eq!(hit.map(|h| h.t), Some(1.0), "{o} {d}");
                o[axis] = -3.0 * sign;
                let hit = geometry.intersect(&Ray::new(o, d));
                assert_eq!(hit.map(|h| h.t), Some(2.0), "{o} {d}");
            }
        }
    }
}

#[test]
fn a_ray_in_the_plane_of_a_quad_misses_it() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
    let (quad, _) = build(&corners, &[[0, 1, 2], [0, 2, 3]]);
    let mut s = sampler(3);
    for _ in 0..10_000 {
        let d = Vec3A::from(point(&mut s)).with_z(-0.0).normalize();
        let o = Vec3A::from(point(&mut s)).with_z(0.0);
        assert_eq!(quad.intersect(&Ray::new(o, d)), None);
    }
}

#[test]
fn hits_scale_with_powers_of_two_to_the_bit() {
    let trace = |exponent: i32| -> Vec<Option<(u32, u32, u32, u32)>> {
        let k = 2.0_f32.powi(exponent);
        let (positions, triangles) = bumpy_sphere(8, k, Vec3::ZERO);
        let mesh = MeshInput {
            positions: &positions,
            triangles: &triangles,
            ..MeshInput::default()
        };
        let ball = SphereInput {
            center: Vec3::new(0.3, 0.1, 0.2) * k,
            radius: 0.4 * k,
            inward: false,
            material: 0,
        };
        let (geometry, _) = Geometry::build(&[mesh], &[ball]);
        let mut s = sampler(4);
        (0..20_000)
            .map(|_| {
                let ray = Ray::new(k * 1.5 * Vec3A::from(point(&mut s)), direction(&mut s));
                let hit = geometry.intersect(&ray)?;
                let p = geometry.interaction(&ray, &hit).p / k;
                Some((
                    hit.prim,
                    (hit.t / k).to_bits(),
                    hit.u.to_bits() ^ hit.v.to_bits(),
                    p.x.to_bits() ^ p.y.to_bits().rotate_left(9) ^ p.z.to_bits().rotate_left(18),
                ))
            })
            .collect()
    };
    let unit = trace(0);
    assert!(unit.iter().flatten().count() > 5_000);
    assert_eq!(unit, trace(20));
    assert_eq!(unit, trace(-20));
}

#[test]
fn degenerate_triangles_are_dropped_with_a_count() {
    let huge = 1e38;
    let positions = [
        Vec3::ZERO,
        Vec3::X,
        Vec3::Y,
        Vec3::new(2.0, 0.0, 0.0),
        Vec3::new(f32::NAN, 0.0, 0.0),
        Vec3::new(0.0, f32::INFINITY, 0.0),
        Vec3::new(huge, 0.0, 0.0),
        Vec3::new(0.5, 1e-30, 0.0),
    ];
    let triangles = [
        [0, 1, 2],
        [0, 1, 3],
        [0, 0, 1],
        [1, 1, 1],
        [0, 1, 4],
        [0, 1, 5],
        [0, 2, 6],
        [0, 1, 99],
        [0, 1, 7],
    ];
    let (geometry, report) = build(&positions, &triangles);
    let expected = DropReport {
        bad_index: 1,
        non_finite: 2,
        out_of_range: 1,
        zero_area: 3,
        ..DropReport::default()
    };
    assert_eq!(report, expected);
    // The needle [0, 1, 7] has area and stays.
    assert_eq!(geometry.mesh_triangles(0), 0..2);
    assert_eq!(geometry.triangle_source(1), Some((0, 8)));
    let mut s = sampler(5);
    for _ in 0..50_000 {
        let target = Vec3::new(s.next_1d(), 1e-30 * s.next_1d(), 0.0);
        let o = point(&mut s);
        let ray = Ray::new(o.into(), Vec3A::from(target - o).normalize());
        if let Some(hit) = geometry.intersect(&ray) {
            let at = geometry.interaction(&ray, &hit);
            assert!(hit.t > 0.0 && hit.t.is_finite());
            assert!(at.p.is_finite() && at.uv.is_finite() && at.p_error.is_finite());
            assert!(at.n_g.is_normalized() && at.n_s.is_normalized());
        }
    }
    let bad = [0.0, -1.0, f32::NAN, f32::INFINITY, huge].map(|radius| SphereInput {
        center: Vec3::ZERO,
        radius,
        inward: false,
        material: 0,
    });
    let (none, report) = Geometry::build(&[], &bad);
    assert_eq!((report.invalid_sphere, none.primitive_count()), (5, 0));
}

#[test]
fn coincident_triangles_give_the_lowest_and_take_bounded_time() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let apart = [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, 0.0), Vec3::ONE];
    let many = vec![[0, 1, 2]; 100_000];
    // The same corners from another one on: not recognised as equal, all are tested.
    let turned: Vec<[u32; 3]> = (0..3_000)
        .map(|i| [[0, 1, 2], [1, 2, 0], [2, 0, 1]][i % 3])
        .collect();
    for (positions, triangles) in [(&corners[..], &many), (&apart[..], &turned)] {
        let (geometry, report) = build(positions, triangles);
        assert_eq!(report.total(), 0);
        let mut s = sampler(6);
        for _ in 0..20_000 {
            let target = Vec3::new(0.3 * s.next_1d() + 0.1, 0.3 * s.next_1d() + 0.1, 0.0);
            let o = target + Vec3::new(0.1, 0.2, 1.0 + s.next_1d());
            let ray = Ray::new(o.into(), Vec3A::from(target - o).normalize());
            let hit = geometry
                .intersect(&ray)
                .expect("the ray aims at the triangles");
            assert!(hit.prim < 3);
            assert!(geometry.occluded(&ray));
        }
    }
}

#[test]
fn spheres_of_any_size_and_distance_are_hit_where_exact_arithmetic_says() {
    let mut s = sampler(7);
    for exponent in (-6..=6).map(|e| 10.0_f32.powi(e)) {
        for distance in [0.0, 10.0, 1e4] {
            let center = exponent * distance * point(&mut s);
            let sphere = SphereInput {
                center,
                radius: exponent,
                inward: false,
                material: 0,
            };
            let (geometry, _) = Geometry::build(&[], &[sphere]);
            for _ in 0..2_000 {
                // Aims at the rim with offsets down to 1e-5 of the radius, or from inside.
                let o = center + 3.0 * exponent * point(&mut s);
                let side = direction(&mut s).cross((o - center).into()).normalize();
                let grazing = 1.0 + 10.0_f32.powf(-5.0 * s.next_1d()) * (s.next_1d() - 0.5);
                let target = Vec3A::from(center) + exponent * grazing * side;
                let ray = Ray::new(o.into(), (target - Vec3A::from(o)).normalize());
                let (o, d) = (ray.o.as_dvec3() - center.as_dvec3(), ray.d.as_dvec3());
                let nearest = o - d * (o.dot(d) / d.length_squared());
                let ratio = nearest.length() / f64::from(exponent);
                let inside = o.length() < f64::from(exponent);
                let ahead = inside || o.dot(d) < 0.0;
                let hit = geometry.intersect(&ray);
                if (ratio - 1.0).abs() > 1e-9 {
                    assert_eq!(hit.is_some(), ahead && ratio < 1.0);
                }
                if let Some(hit) = hit {
                    let at = geometry.interaction(&ray, &hit);
                    let r = (at.p.as_dvec3() - center.as_dvec3()).length();
                    let bound = at.p_error.as_dvec3().length();
                    assert!((r - f64::from(exponent)).abs() <= bound);
                    let out = geometry.intersect(&at.spawn_ray(at.n_g));
                    assert_eq!(out, None, "a ray that leaves a sphere meets it no more");
                    let through = geometry.intersect(&at.spawn_ray(-at.n_g));
                    assert!(
                        through
                            .is_some_and(|h| h.t > exponent || bound > 0.01 * f64::from(exponent))
                    );
                }
            }
        }
    }
}

#[test]
fn shading_normals_and_texture_coordinates() {
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let uvs = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let with = |normals: &[Vec3]| {
        let mesh = MeshInput {
            positions: &positions,
            normals,
            uvs: &uvs,
            triangles: &[[0, 1, 2]],
            material: 3,
        };
        let (geometry, _) = Geometry::build(&[mesh], &[]);
        let ray = Ray::new(Vec3A::new(0.25, 0.5, -1.0), Vec3A::Z);
        let hit = geometry
            .intersect(&ray)
            .expect("the ray aims at the triangle");
        geometry.interaction(&ray, &hit)
    };
    let tilted = Vec3::new(0.6, 0.0, 0.8);
    let at = with(&[tilted; 3]);
    assert!((at.n_s - Vec3A::from(tilted)).length() < 1e-6);
    assert!((with(&[-tilted; 3]).n_s - Vec3A::from(tilted)).length() < 1e-6);
    assert!((at.uv - Vec2::new(0.25, 0.5)).length() < 1e-6);
    assert_eq!((at.n_g, at.material, at.wo), (Vec3A::Z, 3, Vec3A::NEG_Z));
    for degenerate in [[Vec3::ZERO; 3], [Vec3::NAN; 3], [Vec3::X; 3]] {
        assert_eq!(with(&degenerate).n_s, Vec3A::Z);
    }

    let ball = |inward| SphereInput {
        center: Vec3::ZERO,
        radius: 2.0,
        inward,
        material: 0,
    };
    for inward in [false, true] {
        let (geometry, _) = Geometry::build(&[], &[ball(inward)]);
        let seen = |o: Vec3A| {
            let ray = Ray::new(o, -o.normalize());
            let hit = geometry
                .intersect(&ray)
                .expect("the ray aims at the sphere");
            geometry.interaction(&ray, &hit)
        };
        let front = seen(Vec3A::new(0.0, 0.0, 5.0));
        assert_eq!(front.n_g, if inward { Vec3A::NEG_Z } else { Vec3A::Z });
        assert!((front.uv - Vec2::splat(0.5)).length() < 1e-6);
        assert!(seen(Vec3A::new(0.0, -5.0, 0.0)).uv.y < 1e-6);
        assert!(seen(Vec3A::new(0.0, 5.0, 0.0)).uv.y > 1.0 - 1e-6);
        assert!(seen(Vec3A::new(1.0, 0.0, 5.0)).uv.x > 0.5);
    }
}
