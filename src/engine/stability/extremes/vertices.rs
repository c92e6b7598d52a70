//! What connects: vertices close to each other, smooth normals, chains without a start.

use glam::Vec3;

use super::super::case::{Case, Fit, Run, decades};
use super::super::estimate::{Sampling, frame, mean_of, mean_of_layer, means};
use super::super::fits;
use super::super::scenes::{block, diffuse, job_of, mirror, point_light, sky, sphere, view};
use crate::engine::integrators;
use crate::engine::math::Rgb;
use crate::engine::scene::desc::{MeshDesc, SceneDesc};

/// Corners.
pub const NEAR: Case = Case {
    id: "near-vertices",
    label: "In the corner of a shining box",
    summary: "A closed diffuse box that emits E everywhere, seen nearer and nearer to a corner, \
              where vertices of both walks crowd.",
    parameter: "size / distance from the corner",
    oracle: "E/(1−ρ)",
    stiff: false,
    fit: near_fit,
    run: near,
};

/// Normals that are not those of the surface.
pub const NORMALS: Case = Case {
    id: "shading-normals",
    label: "Smooth normals on a coarse mesh",
    summary: "A diffuse ball of a few large facets with smooth normals, under a constant sky.",
    parameter: "rows of facets",
    oracle: "path tracing by chance hits alone, which asks for no density of a light",
    stiff: false,
    fit: normals_fit,
    run: normals,
};

/// Chains.
pub const METROPOLIS: Case = Case {
    id: "metropolis",
    label: "Markov chains without a start",
    summary: "A scene whose light no independent sample finds, and two lit islands.",
    parameter: "",
    oracle: "black and said so; the mean over seeds is that of path tracing",
    stiff: false,
    fit: metropolis_fit,
    run: metropolis,
};

fn near_fit(id: &str) -> Fit {
    match id {
        "photon" => Fit::LeftOut(
            "an estimate over a disc loses what lies beyond the edge: that bias is reported by photon-estimate",
        ),
        "sppm" => Fit::LeftOut("its discs reach beyond the edges until they have shrunk"),
        "whitted" | "monte-carlo" => Fit::LeftOut("integrating-sphere asks their short words"),
        "pssmlt" => Fit::LeftOut("it runs over bdpt, which is asked"),
        "light" => Fit::LeftOut("no light path lands in so narrow a view by chance"),
        _ => fits::closed_room(id),
    }
}

fn near(run: &mut Run) {
    let rho = 0.5_f32;
    for near in decades(1..=run.pick(5, 6), 2) {
        let gap = (1.0 / near) as f32;
        let mut walls = block(0, Vec3::NEG_ONE, Vec3::ONE);
        // Fronts inward.
        walls.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        walls.emission = Some(Rgb::WHITE);
        let desc = SceneDesc {
            camera: view(
                Vec3::ZERO,
                Vec3::new(1.0, 1.0 - gap, 1.0 - 2.0 * gap),
                (10.0 * gap).min(10.0),
                2,
            ),
            materials: vec![diffuse("wall", rho)],
            meshes: vec![walls],
            ..SceneDesc::default()
        };
        let how = Sampling::new(16, run.pick(1024, 8192), run.pick(0.05, 0.01));
        let job = run.job(&desc);
        run.picture(near, "", &job, 1.0 / (1.0 - f64::from(rho)), &how);
    }
}

fn normals_fit(id: &str) -> Fit {
    match id {
        "pssmlt" => Fit::LeftOut("it runs over bdpt, which is asked"),
        "photon" | "sppm" | "whitted" => {
            Fit::LeftOut("they find this light by the shadow rays of path")
        }
        _ => fits::diffuse_in_sky(id),
    }
}

/// A ball of `rows` rows of facets with the normals of the sphere.
fn faceted(rows: u32) -> MeshDesc {
    use std::f32::consts::PI;
    let columns = 2 * rows;
    let mut positions = Vec::new();
    for row in 0..=rows {
        for column in 0..columns {
            let (theta, phi) = (
                PI * row as f32 / rows as f32,
                2.0 * PI * column as f32 / columns as f32,
            );
            let (sin, cos) = theta.sin_cos();
            positions.push(Vec3::new(sin * phi.cos(), cos, sin * phi.sin()));
        }
    }
    let at = |row: u32, column: u32| row * columns + column % columns;
    let mut triangles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let (a, b) = (at(row, column), at(row, column + 1));
            let (c, d) = (at(row + 1, column), at(row + 1, column + 1));
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    MeshDesc {
        name: "ball".into(),
        normals: positions.clone(),
        positions,
        triangles,
        ..MeshDesc::default()
    }
}

fn normals(run: &mut Run) {
    for rows in [3, 4, 8] {
        let desc = SceneDesc {
            camera: view(Vec3::new(0.5, 1.0, 4.0), Vec3::ZERO, 8.0, 8),
            materials: vec![diffuse("white", 0.8)],
            meshes: vec![faceted(rows)],
            lights: vec![sky(1.0)],
            ..SceneDesc::default()
        };
        let hits = job_of(&integrators::path::ENTRY, &[("mode", "hits")], &desc);
        let (exact, half) = mean_of(&means(&hits, run.pick(256, 2048)));
        // Few light paths land in the view.
        let bound = if run.id() == "light" {
            0.06
        } else {
            run.pick(0.03, 0.01)
        };
        let how = Sampling {
            rounding: 2e-5 + half / exact,
            ..Sampling::new(16, run.pick(1024, 8192), bound)
        };
        let job = run.job(&desc);
        run.picture(f64::from(rows), "", &job, exact, &how);
    }
}

fn metropolis_fit(id: &str) -> Fit {
    match id {
        "pssmlt" => fits::diffuse_in_sky(id),
        _ => Fit::LeftOut("it has no chains"),
    }
}

fn metropolis(run: &mut Run) {
    // A point light seen in a mirror alone.
    let dark = SceneDesc {
        camera: view(Vec3::Z * 4.0, Vec3::ZERO, 20.0, 8),
        materials: vec![mirror("mirror", 1.0)],
        spheres: vec![sphere(0, Vec3::ZERO, 1.0, false)],
        lights: vec![point_light(Vec3::new(0.0, 3.0, 3.0), 1.0)],
        ..SceneDesc::default()
    };
    let found = frame(&run.job(&dark), 0, 2);
    let said = found.as_ref().is_some_and(|f| f.stats.dark_starts > 0);
    let black = found.as_ref().map_or(f64::NAN, |f| mean_of_layer(f, 0));
    run.value(1.0, "dark start", black, 0.0, 0.0);
    run.count(
        2.0,
        "said so",
        u64::from(!said),
        1,
        "counted as a start without light",
    );

    // Two balls under lamps of their own, a wall between: no small step leads across.
    let mut islands = SceneDesc {
        camera: view(Vec3::Z * 8.0, Vec3::ZERO, 40.0, 8),
        materials: vec![diffuse("white", 0.8), diffuse("black", 0.0)],
        ..SceneDesc::default()
    };
    for (x, power) in [(-1.5, 20.0), (1.5, 0.02)] {
        islands
            .spheres
            .push(sphere(0, Vec3::new(x, 0.0, 0.0), 1.0, false));
        islands
            .lights
            .push(point_light(Vec3::new(x, 1.0, 2.0), power));
    }
    let thin = Vec3::new(0.01, 9.0, 4.0);
    islands.meshes.push(block(1, -thin, thin));
    let path = job_of(&integrators::path::ENTRY, &[("mode", "kajiya")], &islands);
    let (exact, half) = mean_of(&means(&path, run.pick(64, 512)));
    let how = Sampling {
        rounding: 2e-5 + half / exact,
        ..Sampling::new(16, run.pick(256, 4096), run.pick(0.05, 0.02))
    };
    let job = run.job(&islands);
    run.picture(3.0, "two islands", &job, exact, &how);
}
