//! Rays against the geometry itself.

use glam::{Vec2, Vec3, Vec3A};

use super::super::case::{Case, Run};
use super::super::fits;
use super::super::scenes::{block, bumpy_sphere, tessellated_cube};
use crate::engine::geometry::{Geometry, MeshInput, Ray};
use crate::engine::math::Frame;
use crate::engine::sampling::warp::{sample_cosine_hemisphere, sample_sphere};
use crate::engine::sampling::{IndependentSampler, Sampler, Stream};
use crate::engine::scene::desc::MeshDesc;
use crate::engine::session::RenderClock;

/// Directions with zeros.
pub const AXIS: Case = Case {
    id: "axis-rays",
    label: "Rays along axes",
    summary: "Rays with components 0 and −0 at faces, edges and corners of a box, and within the \
              plane of a quad.",
    parameter: "",
    oracle: "every ray from within meets the wall at 1; a plane along the ray is missed",
    stiff: false,
    fit: fits::engine,
    run: axis,
};

/// Rays at vertices and edges.
pub const WATERTIGHT: Case = Case {
    id: "watertight",
    label: "Watertight meshes",
    summary: "Rays from within at the vertices and edges of a closed bumpy mesh and of a cube of \
              many flat squares, of several sizes and places.",
    parameter: "scale",
    oracle: "none gets out",
    stiff: false,
    fit: fits::engine,
    run: watertight,
};

/// Triangles that are none.
pub const DEGENERATE: Case = Case {
    id: "degenerate-mesh",
    label: "Degenerate triangles",
    summary: "Needles, repeated and missing vertices, NaN, infinity and 1e38.",
    parameter: "",
    oracle: "dropped with a count; what is hit is finite",
    stiff: false,
    fit: fits::engine,
    run: degenerate,
};

/// Triangles in one place.
pub const COINCIDENT: Case = Case {
    id: "coincident",
    label: "Coincident triangles",
    summary: "A hundred thousand triangles in one place; and two meshes of different materials in \
              one place.",
    parameter: "triangles",
    oracle: "the first is hit, as fast as one; the second mesh is met neither by rays nor by what \
             leaves the first. Split along the other diagonal they lie a rounding apart: reported",
    stiff: false,
    fit: fits::engine,
    run: coincident,
};

/// Two surfaces near each other.
pub const THIN: Case = Case {
    id: "thin-shell",
    label: "Thin shells",
    summary: "Rays that leave one of two parallel quads towards the other, at any tilt.",
    parameter: "gap / ulp of the coordinates",
    oracle: "none passes a gap of 8 units in the last place or more; below it is reported",
    stiff: false,
    fit: fits::engine,
    run: thin,
};

fn sampler(item: u64) -> IndependentSampler {
    IndependentSampler::new(1, Stream::Test, (item, 0))
}

fn point(s: &mut impl Sampler) -> Vec3 {
    let Vec2 { x, y } = s.next_2d();
    2.0 * Vec3::new(x, y, s.next_1d()) - Vec3::ONE
}

fn geometry(positions: &[Vec3], triangles: &[[u32; 3]]) -> (Geometry, usize) {
    let mesh = MeshInput {
        positions,
        triangles,
        ..MeshInput::default()
    };
    let (geometry, report) = Geometry::build(&[mesh], &[]);
    (geometry, report.total())
}

fn axis(run: &mut Run) {
    let MeshDesc {
        positions,
        triangles,
        ..
    } = block(0, Vec3::NEG_ONE, Vec3::ONE);
    let (cube, _) = geometry(&positions, &triangles);
    let values = [-1.0, -0.5, -0.0, 0.0, 0.5, 1.0];
    let (mut missed, mut trials) = (0, 0);
    for (axis, zero) in [0, 1, 2].into_iter().flat_map(|a| [(a, 0.0), (a, -0.0)]) {
        for (x, y) in values.iter().flat_map(|&x| values.map(|y| (x, y))) {
            for sign in [-1.0, 1.0] {
                let mut d = Vec3A::splat(zero);
                d[axis] = sign;
                let mut o = Vec3A::ZERO;
                o[(axis + 1) % 3] = x;
                o[(axis + 2) % 3] = y;
                for (from, t) in [(0.0, 1.0), (-3.0 * sign, 2.0)] {
                    o[axis] = from;
                    let hit = cube.intersect(&Ray::new(o, d));
                    missed += u64::from(hit.map(|h| h.t) != Some(t));
                    trials += 1;
                }
            }
        }
    }
    run.count(1.0, "box", missed, trials, "faces, edges and corners");
    let corners = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
    let (quad, _) = geometry(&corners, &[[0, 1, 2], [0, 2, 3]]);
    let mut s = sampler(3);
    let mut met = 0;
    for _ in 0..10_000 {
        let d = Vec3A::from(point(&mut s)).with_z(-0.0).normalize();
        let o = Vec3A::from(point(&mut s)).with_z(0.0);
        met += u64::from(quad.intersect(&Ray::new(o, d)).is_some());
    }
    run.count(2.0, "plane", met, 10_000, "rays within the plane of a quad");
}

fn watertight(run: &mut Run) {
    let rays = run.pick(300_000, 25_000_000);
    let places = [
        (1.0, Vec3::ZERO),
        (1e-6, Vec3::ZERO),
        (1e6, Vec3::ZERO),
        (1.0, Vec3::new(1e4, -3e3, 5e3)),
    ];
    for (i, (scale, center)) in places.into_iter().enumerate() {
        let place = if center == Vec3::ZERO {
            "at the origin"
        } else {
            "12000 sizes away"
        };
        for (name, mesh) in [
            ("bumpy", bumpy_sphere(24, scale, center)),
            ("flat", tessellated_cube(24, scale, center)),
        ] {
            let leaked = leaks(&mesh, rays, 10 + i as u64, scale, center);
            let curve = format!("{name}, {place}");
            run.count(f64::from(scale), &curve, leaked, 2 * rays, "");
        }
    }
}

/// Rays of `rays` at vertices and edges that get out of a mesh, and those of as many from outside
/// that pass it.
fn leaks(
    (positions, triangles): &(Vec<Vec3>, Vec<[u32; 3]>),
    rays: u64,
    item: u64,
    scale: f32,
    center: Vec3,
) -> u64 {
    let (mesh, _) = geometry(positions, triangles);
    let mut s = sampler(item);
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
        leaked += u64::from(mesh.intersect(&inside).is_none());
        let from = center + 4.0 * (target - center) + scale * point(&mut s);
        let through = Vec3A::from(target + 0.01 * (o - target) - from);
        leaked += u64::from(!mesh.occluded(&Ray::new(from.into(), through.normalize())));
    }
    leaked
}

fn degenerate(run: &mut Run) {
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
    let (mesh, dropped) = geometry(&positions, &triangles);
    run.value(1.0, "dropped", dropped as f64, 7.0, 0.0);
    let mut s = sampler(5);
    let (mut wrong, trials) = (0, 50_000);
    for _ in 0..trials {
        let target = Vec3::new(s.next_1d(), 1e-30 * s.next_1d(), 0.0);
        let o = point(&mut s);
        let ray = Ray::new(o.into(), Vec3A::from(target - o).normalize());
        if let Some(hit) = mesh.intersect(&ray) {
            let at = mesh.interaction(&ray, &hit);
            let sound = hit.t > 0.0
                && hit.t.is_finite()
                && at.p.is_finite()
                && at.p_error.is_finite()
                && at.n_g.is_normalized()
                && at.n_s.is_normalized();
            wrong += u64::from(!sound);
        }
    }
    run.count(2.0, "needle", wrong, trials, "hits that are not finite");
}

fn coincident(run: &mut Run) {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let mut alone = f64::NAN;
    for count in [1, 1000, 100_000] {
        let (mesh, _) = geometry(&corners, &vec![[0, 1, 2]; count]);
        let mut s = sampler(6);
        let (mut wrong, trials) = (0, 50_000);
        let clock = RenderClock::start();
        for _ in 0..trials {
            let target = Vec3::new(0.3 * s.next_1d() + 0.1, 0.3 * s.next_1d() + 0.1, 0.0);
            let o = target + Vec3::new(0.1, 0.2, 1.0 + s.next_1d());
            let ray = Ray::new(o.into(), Vec3A::from(target - o).normalize());
            wrong += u64::from(mesh.intersect(&ray).is_none_or(|hit| hit.prim != 0));
        }
        let seconds = clock.cpu();
        if count == 1 {
            alone = seconds;
        }
        let note = format!("{:.1} times the time of one", seconds / alone);
        run.count(count as f64, "", wrong, trials, &note);
    }
    let trials = run.pick(3000, 50_000);
    let [other, again] = twins(&[[0, 1, 2], [0, 2, 3]], trials);
    let note = "rays that miss the first of two meshes in one place, or meet the second";
    run.count(4.0, "same diagonal", other, trials, note);
    let note = "rays that leave the first and meet the second";
    run.count(4.0, "same diagonal, leaving", again, 2 * trials, note);
    // Rounded corners are not in one plane: which of the two lies before the other differs.
    let [other, again] = twins(&[[0, 1, 3], [1, 2, 3]], trials);
    let share = |n: u64, of: u64| n as f64 / of as f64;
    let note = "share that meets the second mesh, a rounding before the first";
    run.fact(4.0, "other diagonal", share(other, trials), note);
    let note = "share that leaves one and meets the other";
    run.fact(
        4.0,
        "other diagonal, leaving",
        share(again, 2 * trials),
        note,
    );
}

/// Of two quads of any tilt in one place, two meshes of the materials 0 and 1, the second of the
/// triangles `second`: how often the first is not what is met, and how often what leaves the one
/// that is met meets the other.
fn twins(second: &[[u32; 3]; 2], trials: u64) -> [u64; 2] {
    let mut s = sampler(7);
    let (mut not_first, mut met_again) = (0, 0);
    for _ in 0..trials {
        let frame = Frame::from_normal(sample_sphere(s.next_2d()));
        let center = Vec3A::from(point(&mut s));
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|[x, y]| Vec3::from(center + x * frame.s + y * frame.t));
        let quad = |material: u32, triangles| MeshInput {
            positions: &corners,
            triangles,
            material,
            ..MeshInput::default()
        };
        let meshes = [quad(0, &[[0, 1, 2], [0, 2, 3]]), quad(1, second)];
        let (both, _) = Geometry::build(&meshes, &[]);
        let aim = center + 0.9 * point(&mut s).x * frame.s + 0.9 * point(&mut s).y * frame.t;
        let ray = Ray::new(aim - 2.0 * frame.n, frame.n);
        let Some(hit) = both.intersect(&ray) else {
            not_first += 1;
            continue;
        };
        let at = both.interaction(&ray, &hit);
        not_first += u64::from(at.material != 0);
        let d = frame.to_world(sample_cosine_hemisphere(s.next_2d()));
        for d in [d, -d] {
            met_again += u64::from(both.intersect(&at.spawn_ray(d).against_all()).is_some());
        }
    }
    [not_first, met_again]
}

/// Rays that meet their own surface again, and that pass the other one.
fn shell(ulps: f32, trials: u64) -> (u64, u64) {
    let mut s = sampler(8);
    let (mut own, mut leaked) = (0, 0);
    for _ in 0..trials {
        let n = sample_sphere(s.next_2d());
        let frame = Frame::from_normal(n);
        let center = Vec3A::from(point(&mut s)).normalize();
        let gap = ulps * f32::EPSILON * 3.0;
        let quad = |lift: f32| {
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|[x, y]| Vec3::from(center + x * frame.s + y * frame.t + lift * n))
        };
        let positions: Vec<Vec3> = quad(0.0).into_iter().chain(quad(gap)).collect();
        let all = [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
        let (both, _) = geometry(&positions, &all);
        let (alone, _) = geometry(&positions[..4], &all[..2]);
        let aim = center + 0.5 * point(&mut s).x * frame.s + 0.3 * frame.t;
        let ray = Ray::new(aim - 2.0 * n, n);
        let Some(hit) = alone.intersect(&ray) else {
            continue;
        };
        let at = alone.interaction(&ray, &hit);
        let d = frame.to_world(sample_cosine_hemisphere(s.next_2d()));
        for d in [d, -d] {
            own += u64::from(alone.intersect(&at.spawn_ray(d).against_all()).is_some());
        }
        leaked += u64::from(both.intersect(&at.spawn_ray(n)).is_none());
    }
    (own, leaked)
}

fn thin(run: &mut Run) {
    let trials = run.pick(3000, 50_000);
    for ulps in [1e4_f32, 100.0, 8.0] {
        let (own, leaked) = shell(ulps, trials);
        run.count(
            f64::from(ulps),
            "leaks",
            leaked,
            trials,
            "rays that pass the other surface",
        );
        run.count(
            f64::from(ulps),
            "own",
            own,
            2 * trials,
            "rays that meet their own surface",
        );
    }
    for ulps in [4.0_f32, 2.0, 1.0, 0.5] {
        let (_, leaked) = shell(ulps, trials);
        run.fact(
            f64::from(ulps),
            "leaks",
            leaked as f64 / trials as f64,
            "share that passes",
        );
    }
}
