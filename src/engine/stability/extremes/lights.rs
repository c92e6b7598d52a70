//! Lights that touch what they shine on, and light that cannot be found.

use glam::Vec3;

use super::super::case::{Case, Fit, Run, decades};
use super::super::estimate::{Sampling, frame, mean_of_layer};
use super::super::fits;
use super::super::scenes::{diffuse, glass, mirror, point_light, sphere, square, view};
use crate::engine::event::Letter;
use crate::engine::math::Rgb;
use crate::engine::path::{ClassId, Expression, PathClasses};
use crate::engine::scene::desc::SceneDesc;

/// A surface within a lamp, at any distance of its wall.
pub const TOUCHING: Case = Case {
    id: "light-touching",
    label: "Lamp around and near the receiver",
    summary: "A small diffuse square within a ball that shines inward, nearer and nearer to its \
              wall, facing the middle or the wall.",
    parameter: "R / distance from the wall",
    oracle: "ρ L; of those who find it by shadow rays alone, the near wall is reported",
    stiff: true,
    fit: touching_fit,
    run: touching,
};

/// Paths that nobody can find are said to be missing.
pub const UNSAMPLEABLE: Case = Case {
    id: "unsampleable",
    label: "Paths that cannot be found",
    summary: "A point light over diffuse, mirror and glass balls: layers of the words up to three \
              events.",
    parameter: "word",
    oracle: "black exactly where the integrator names the word as missing",
    stiff: false,
    fit: fits::diffuse_in_sky,
    run: unsampleable,
};

fn touching_fit(id: &str) -> Fit {
    match id {
        "path" => fits::path_modes(id),
        "photon" | "sppm" => Fit::LeftOut("they find this light by the shadow rays of path"),
        "pssmlt" => Fit::LeftOut("it runs over bdpt, which is asked"),
        _ => fits::direct_narrow(id),
    }
}

fn touching(run: &mut Run) {
    let rho = 0.5_f32;
    for (name, toward) in [("facing the middle", -1.0), ("facing the wall", 1.0)] {
        for near in decades(1..=run.pick(4, 6), run.pick(3, 1)) {
            let gap = (1.0 / near) as f32;
            let at = Vec3::X * (1.0 - gap);
            let size = 0.01 * gap;
            let mut lamp = sphere(1, Vec3::ZERO, 1.0, true);
            lamp.emission = Some(Rgb::splat(2.0));
            let eye = at + Vec3::X * (toward * 0.5 * gap);
            let desc = SceneDesc {
                camera: view(eye, at, 1e-2, 2),
                materials: vec![diffuse("spot", rho), diffuse("lamp", 0.0)],
                meshes: vec![square(0, at, Vec3::Y * size, Vec3::Z * (size * toward))],
                spheres: vec![lamp],
                ..SceneDesc::default()
            };
            let how = Sampling::new(16, run.pick(1 << 13, 1 << 16), run.pick(0.05, 0.02));
            let job = run.job(&desc);
            let exact = f64::from(rho) * 2.0;
            // A lamp around a point is sampled by area: what is near weighs all, and is seldom
            // drawn. Who meets lamps by walks as well does not mind.
            let blind = run.id() == "whitted" || run.variant.name == "kajiya";
            if blind && toward > 0.0 && gap < 0.05 {
                run.report(near, name, &job, exact, &how);
            } else {
                run.picture(near, name, &job, exact, &how);
            }
        }
    }
}

/// Words of up to two events without `LE`, and some of three.
const WORDS: [&str; 6] = ["LDE", "LSE", "LDDE", "LDSE", "LSDE", "LSDSE"];

fn unsampleable(run: &mut Run) {
    let ball = |m, x, y, z, r| sphere(m, Vec3::new(x, y, z), r, false);
    let desc = SceneDesc {
        camera: view(
            Vec3::new(0.0, 0.6, 3.5),
            Vec3::new(0.0, -0.2, 0.0),
            50.0,
            16,
        ),
        materials: vec![
            diffuse("white", 0.8),
            glass("glass", 1.5),
            mirror("mirror", 0.9),
        ],
        spheres: vec![
            ball(0, 0.0, -7.0, 0.0, 6.0),
            ball(0, 0.8, -0.2, -3.2, 1.5),
            ball(1, -1.1, -0.4, 0.0, 0.6),
            ball(2, 0.1, -0.5, -0.6, 0.5),
            ball(0, 0.4, -0.7, 0.8, 0.3),
        ],
        lights: vec![point_light(Vec3::new(0.5, 2.0, 1.0), 5.0)],
        ..SceneDesc::default()
    };
    let mut job = run.job(&desc);
    let expressions = WORDS.iter().filter_map(|w| w.parse::<Expression>().ok());
    job.settings.layers.expressions = expressions.collect();
    let entry = job.settings.integrator;
    let missing = (entry.missing)(&job.scene.features, &job.settings.params);
    let said = missing.and_then(|m| m.words.parse::<Expression>().ok());
    let classes = said.and_then(|e| PathClasses::new(vec!["said".to_owned()], vec![e]).ok());
    let named = WORDS.map(|word| {
        let letters = word.chars().filter_map(|c| match c {
            'D' => Some(Letter::D),
            'S' => Some(Letter::S),
            _ => None,
        });
        classes.as_ref().is_some_and(|classes| {
            let class = letters.fold(ClassId::EMPTY, |c, l| classes.append(c, l));
            classes.layers(class) != 0
        })
    });
    // Rare words take many passes: black is what stays black.
    let mut seen = [false; WORDS.len()];
    let seeds = run.pick(64, 512);
    for seed in 0..seeds {
        let Some(found) = frame(&job, seed, 32) else {
            return;
        };
        let first = found.layers.len() - WORDS.len();
        for (i, seen) in seen.iter_mut().enumerate() {
            *seen |= mean_of_layer(&found, first + i) > 0.0;
        }
        if seed > 1 && seen == named.map(|named| !named) {
            break;
        }
    }
    for (i, word) in WORDS.iter().enumerate() {
        let (black, named) = (!seen[i], named[i]);
        let note = format!("{word} is {}", if black { "black" } else { "found" });
        run.count((i + 1) as f64, word, u64::from(black != named), 1, &note);
    }
}
