//! Direct light of lamps near and far, large and small.

use glam::Vec3;

use super::super::case::{Case, Fit, Run, decades};
use super::super::estimate::Sampling;
use super::super::scenes::{diffuse, point_light, sphere, square, view};
use super::super::{fits, oracles};
use crate::engine::math::Rgb;
use crate::engine::scene::desc::{MeshDesc, SceneDesc};

/// A point light over a plane.
pub const FALLOFF: Case = Case {
    id: "point-falloff",
    label: "Plane under a point light",
    summary: "A diffuse plane under a point light on the axis of the view, everything scaled.",
    parameter: "distance d",
    oracle: "ρ I cosθ/(π r²), averaged over the view",
    stiff: false,
    fit: fits::direct_point,
    run: falloff,
};

/// A disk over a point.
pub const DISK: Case = Case {
    id: "disk-light",
    label: "Point under a disk",
    summary: "A diffuse point under a parallel coaxial disk of radius r at height h.",
    parameter: "r/h",
    oracle: "ρ L r²/(r²+h²)",
    stiff: false,
    fit: disk_fit,
    run: disk,
};

/// The same light through less and less area.
pub const SMALL: Case = Case {
    id: "far-small-light",
    label: "Small lights",
    summary: "A diffuse point under a ball whose radiance grows as its area A shrinks.",
    parameter: "1/A",
    oracle: "ρ L r²/d², the same for every A",
    stiff: true,
    fit: small_fit,
    run: small,
};

fn falloff(run: &mut Run) {
    let rho = 0.5_f32;
    for d in decades(-6..=6, run.pick(6, 3)) {
        let d = d as f32;
        let intensity = 7.0 * d * d;
        let desc = SceneDesc {
            camera: view(Vec3::Y * (2.0 * d), Vec3::ZERO, 40.0, 4),
            materials: vec![diffuse("floor", rho)],
            meshes: vec![square(
                0,
                Vec3::ZERO,
                Vec3::Z * (4.0 * d),
                Vec3::X * (4.0 * d),
            )],
            lights: vec![point_light(Vec3::Y * d, intensity)],
            ..SceneDesc::default()
        };
        let tan = 20_f64.to_radians().tan();
        let (d, intensity) = (f64::from(d), f64::from(intensity));
        let exact = oracles::falloff(f64::from(rho), intensity, d, 2.0 * d, tan);
        let how = Sampling::new(4, 2048, run.pick(0.01, 0.002));
        let job = run.job(&desc);
        run.picture(d, "", &job, exact, &how);
    }
}

/// A small diffuse square at the origin, seen slantwise from beside the axis.
fn spot(rho: f32, size: f32) -> SceneDesc {
    SceneDesc {
        camera: view(Vec3::new(0.5, 0.5, 0.2), Vec3::ZERO, 1e-3, 2),
        materials: vec![diffuse("spot", rho), diffuse("lamp", 0.0)],
        meshes: vec![square(0, Vec3::ZERO, Vec3::Z * size, Vec3::X * size)],
        ..SceneDesc::default()
    }
}

/// A disk of that many triangles at height 1 that shines downward.
fn disk_mesh(radius: f32, sides: u32) -> MeshDesc {
    let mut positions = vec![Vec3::Y];
    for i in 0..sides {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(sides);
        let (s, c) = angle.sin_cos();
        let r = f64::from(radius);
        positions.push(Vec3::new((r * c) as f32, 1.0, (r * s) as f32));
    }
    MeshDesc {
        name: "disk".into(),
        positions,
        triangles: (0..sides)
            .map(|i| [0, 1 + i, 1 + (i + 1) % sides])
            .collect(),
        material: 1,
        emission: Some(Rgb::splat(2.0)),
        ..MeshDesc::default()
    }
}

fn disk_fit(id: &str) -> Fit {
    match id {
        "photon" | "sppm" | "vcm" | "pssmlt" => Fit::LeftOut(
            "they find this light by the shadow rays of path and bdpt, which are asked",
        ),
        _ => fits::direct_narrow(id),
    }
}

fn disk(run: &mut Run) {
    for ratio in decades(-6..=6, run.pick(3, 1)) {
        // 1024 sides: the inscribed area is short by 6e-6.
        let mut desc = spot(0.5, 0.01);
        desc.meshes.push(disk_mesh(ratio as f32, 1024));
        let exact = 0.5 * 2.0 * ratio * ratio / (1.0 + ratio * ratio);
        let job = run.job(&desc);
        let how = Sampling::new(16, run.pick(4096, 16384), run.pick(0.02, 0.005));
        run.picture(ratio, "", &job, exact, &how);
    }
}

fn small_fit(id: &str) -> Fit {
    match id {
        "path" => fits::path_modes(id),
        _ => fits::direct_narrow(id),
    }
}

fn small(run: &mut Run) {
    let hits = run.variant.name == "hits";
    // By chance hits a ball of area A is found once in 2π/A samples.
    let least = match hits {
        true => run.pick(-2, -3),
        false => -12,
    };
    for inverse in decades(0..=-least, if hits { 1 } else { run.pick(4, 2) }) {
        let area = 1.0 / inverse;
        let radius = (area / (4.0 * std::f64::consts::PI)).sqrt() as f32;
        let r = f64::from(radius);
        let radiance = (0.1 / (r * r)) as f32;
        let mut desc = spot(0.5, 0.01);
        let mut lamp = sphere(1, Vec3::Y, radius, false);
        lamp.emission = Some(Rgb::splat(radiance));
        desc.spheres.push(lamp);
        let exact = 0.5 * f64::from(radiance) * r * r;
        let job = run.job(&desc);
        let bound = if hits {
            run.pick(0.1, 0.05)
        } else {
            run.pick(0.02, 0.005)
        };
        // Ten hits a run, at the least.
        let first = if hits {
            (4.0 * inverse * 10.0 * 3.15 / 4.0) as u64
        } else {
            16
        };
        let how = Sampling::new(first.max(16), run.pick(1 << 17, 1 << 20), bound);
        run.picture(inverse, "", &job, exact, &how);
    }
}
