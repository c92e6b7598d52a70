//! What no sound render has is counted, and no embedded scene has any of it.

mod support;

use std::sync::Arc;

use glam::{UVec2, Vec3A};
use lightscope::engine::geometry::{Departure, RayFault};
use lightscope::engine::integrators::REGISTRY;
use lightscope::engine::io::embedded;
use lightscope::engine::scene::Scene;
use support::render::{job, render, scene_from_toml};

/// Parameters that make a small picture quick.
fn quick(id: &str) -> &'static [(&'static str, &'static str)] {
    match id {
        "photon" => &[
            ("caustic-photons", "2000"),
            ("global-photons", "2000"),
            ("volume-photons", "2000"),
        ],
        "pssmlt" => &[("bootstrap", "1000"), ("chains", "16")],
        "monte-carlo" => &[("rays", "2")],
        _ => &[],
    }
}

#[test]
fn no_embedded_scene_has_errors_with_any_algorithm() {
    for scene in embedded::all() {
        let desc = embedded::read(scene.id).unwrap_or_else(|e| panic!("{e}"));
        let prepared = Arc::new(Scene::build(&desc).unwrap_or_else(|e| panic!("{e}")));
        for entry in REGISTRY {
            if entry.refusal(&prepared.features).is_some() {
                continue;
            }
            let mut job = job(&prepared, entry.id, quick(entry.id));
            job.size = UVec2::new(32, 24);
            let stats = render(&job, 2).stats;
            let bad: Vec<_> = stats.bad_samples().collect();
            assert_eq!(stats.errors(), [0; 6], "{} {}: {bad:?}", scene.id, entry.id);
            assert!(bad.is_empty());
        }
    }
}

/// Light beyond what f32 can hold: the shadow ray's estimate overflows.
const TOO_BRIGHT: &str = r#"
camera = { position = [0, 1, 5], target = [0, 1, 0], vfov_deg = 40, width = 8, height = 8 }
[materials]
white = { type = "diffuse", reflectance = 0.8 }
[[spheres]]
center = [0, 0, 0]
radius = 1
material = "white"
[[lights]]
type = "point"
position = [0, 1.4, 0]
intensity = [3e38, 3e38, 3e38]
"#;

#[test]
fn what_overflows_is_counted_kept_and_named() {
    let scene = scene_from_toml(TOO_BRIGHT);
    for id in ["path", "light", "bdpt", "vcm", "photon", "sppm", "pssmlt"] {
        let mut job = job(&scene, id, quick(id));
        job.size = UVec2::new(32, 32);
        let frame = render(&job, 4);
        let stats = frame.stats;
        assert!(stats.faults.infinite > 0, "{id}: {:?}", stats.faults);
        assert_eq!(
            stats.bad_samples().count(),
            4.min(stats.errors().iter().sum::<u64>()) as usize,
            "{id}"
        );
        // Where every sample was left out there is no mean; nowhere is it infinite.
        let values = frame.layers[0].pixels.iter().flatten();
        assert!(values.into_iter().all(|x| !x.is_infinite()), "{id}");
    }
}

/// A cube, a flipped cube and an open box, each of its own.
fn boxes() -> Arc<Scene> {
    let folder = tempfile::tempdir().expect("a folder");
    let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
    let faces = [
        "1 4 3 2", "5 6 7 8", "1 2 6 5", "4 8 7 3", "1 5 8 4", "2 3 7 6",
    ];
    let flipped: Vec<String> = faces
        .iter()
        .map(|f| f.split(' ').rev().collect::<Vec<_>>().join(" "))
        .collect();
    let text = |faces: &[&str]| {
        let lines: String = faces.iter().map(|f| format!("f {f}\n")).collect();
        format!("{corners}{lines}")
    };
    let flipped: Vec<&str> = flipped.iter().map(String::as_str).collect();
    let write = |name: &str, text: String| {
        std::fs::write(folder.path().join(name), text).expect("a file");
    };
    write("cube.obj", text(&faces));
    write("flipped.obj", text(&flipped));
    write("open.obj", text(&faces[1..]));
    let mut scene = String::from(
        "camera = { position = [0, 1, 5], target = [0, 1, 0] }\n\
         [materials]\nwhite = { type = \"diffuse\", reflectance = 0.8 }\n",
    );
    for (i, name) in ["cube", "flipped", "open"].iter().enumerate() {
        scene += &format!(
            "[[meshes]]\nfile = \"{name}.obj\"\nmaterial = \"white\"\n\
             transform = [{{ translate = [{}, 0, 0] }}]\n",
            3 * i
        );
    }
    scene += "[[spheres]]\ncenter = [20, 0, 0]\nradius = 1\nmaterial = \"white\"\n\
              [[spheres]]\ncenter = [30, 0, 0]\nradius = 1\nmaterial = \"white\"\ninward = true\n";
    let path = folder.path().join("boxes.toml");
    std::fs::write(&path, scene).expect("a file");
    support::render::load(&path)
}

#[test]
fn closed_surfaces_are_known_from_open_ones() {
    let scene = boxes();
    let missed = |prim: u32, front: bool| scene.ray_fault(Departure { prim, front }, None);
    for prim in 0..12 {
        assert_eq!(missed(prim, false), Some(RayFault::MissedEdge));
        assert_eq!(missed(prim, true), None);
        assert_eq!(missed(12 + prim, true), Some(RayFault::MissedEdge));
        assert_eq!(missed(12 + prim, false), None);
    }
    for prim in 24..34 {
        assert_eq!((missed(prim, true), missed(prim, false)), (None, None));
    }
    let (ball, hollow) = (34, 35);
    assert_eq!(missed(ball, false), Some(RayFault::MissedEdge));
    assert_eq!(missed(ball, true), None);
    assert_eq!(missed(hollow, true), Some(RayFault::MissedEdge));
    assert_eq!(scene.ray_fault(Departure::NOWHERE, None), None);
}

#[test]
fn a_surface_is_met_again_only_from_within_a_sphere() {
    let scene = boxes();
    let at = |o: [f32; 3], d: [f32; 3]| {
        let ray = lightscope::engine::geometry::Ray::new(Vec3A::from(o), Vec3A::from(d));
        scene.intersect(&ray, || 0.0).expect("a hit")
    };
    // A triangle of the cube, and the ball from without and from within.
    let wall = at([0.3, 0.4, 5.0], [0.0, 0.0, -1.0]);
    let outside = at([20.0, 0.0, 5.0], [0.0, 0.0, -1.0]);
    let inside = at([20.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let left = |prim, front| Departure { prim, front };
    let hit = Some(RayFault::SelfHit);
    for front in [false, true] {
        assert_eq!(scene.ray_fault(left(wall.prim, front), Some(&wall)), hit);
        assert_eq!(
            scene.ray_fault(left(wall.prim + 1, front), Some(&wall)),
            None
        );
    }
    let ball = outside.prim;
    assert_eq!(inside.prim, ball);
    assert_eq!(
        scene.ray_fault(left(ball, false), Some(&inside)),
        None,
        "a chord"
    );
    assert_eq!(scene.ray_fault(left(ball, true), Some(&inside)), hit);
    assert_eq!(scene.ray_fault(left(ball, false), Some(&outside)), hit);
    assert_eq!(scene.ray_fault(left(ball, true), Some(&outside)), hit);
}
