//! Rays against triangles and spheres: nothing leaks, nothing depends on the hierarchy.

use glam::{Vec2, Vec3, Vec3A};
use lightscope::engine::geometry::{DropReport, Geometry, Hit, MeshInput, Ray, SphereInput};
use lightscope::engine::sampling::independent::IndependentSampler;
use lightscope::engine::sampling::sampler::{Sampler, Stream};
use lightscope::engine::sampling::warp::sample_sphere;

fn sampler(index: u64) -> IndependentSampler {
    IndependentSampler::new(1, Stream::Test, (index, 0))
}

fn direction(s: &mut impl Sampler) -> Vec3A {
    sample_sphere(s.next_2d())
}

fn point(s: &mut impl Sampler) -> Vec3 {
    let Vec2 { x, y } = s.next_2d();
    2.0 * Vec3::new(x, y, s.next_1d()) - Vec3::ONE
}

fn build(positions: &[Vec3], triangles: &[[u32; 3]]) -> (Geometry, DropReport) {
    let mesh = MeshInput {
        positions,
        triangles,
        ..MeshInput::default()
    };
    Geometry::build(&[mesh], &[])
}

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
    let mut s = sampler(1);
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..400_u32 {
        let (center, size) = (point(&mut s), s.next_1d());
        positions.extend([0; 3].map(|_| center + size * point(&mut s)));
        triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let spheres: Vec<SphereInput> = (0..100)
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
    for _ in 0..20_000 {
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
    assert!(hits > 5_000, "{hits} hits");
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
