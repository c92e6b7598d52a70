//! Scenes as users have them: the embedded ones, and OBJ files from other programs.

mod support;

use std::f32::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use glam::{UVec2, Vec3, Vec3A};
use lightscope::engine::io::{embedded, scene_file};
use lightscope::engine::scene::Scene;
use lightscope::engine::scene::desc::{ColorDesc, MaterialDesc, SceneDesc};
use support::render::{job, render};

/// The OBJ file `a.obj` with these files beside it.
fn open(files: &[(&str, &[u8])]) -> SceneDesc {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, bytes) in files {
        fs::write(folder.path().join(name), bytes).expect("written");
    }
    scene_file::load(&folder.path().join("a.obj")).unwrap_or_else(|e| panic!("{e}"))
}

fn build(desc: &SceneDesc) -> Arc<Scene> {
    Arc::new(Scene::build(desc).unwrap_or_else(|e| panic!("{e}")))
}

/// Sum of the areas of a mesh's triangles.
fn area(desc: &SceneDesc, mesh: usize) -> f32 {
    let mesh = &desc.meshes[mesh];
    let corner = |t: &[u32; 3], i: usize| mesh.positions[t[i] as usize];
    let twice = |t| {
        (corner(t, 1) - corner(t, 0))
            .cross(corner(t, 2) - corner(t, 0))
            .length()
    };
    0.5 * mesh.triangles.iter().map(twice).sum::<f32>()
}

/// One pass of `path` with its components at 48×36.
fn one_pass(scene: &Arc<Scene>) -> Vec<(String, f64)> {
    let mut job = job(scene, "path", &[]);
    job.size = UVec2::new(48, 36);
    let frame = render(&job, 1);
    assert_eq!(frame.stats.non_finite(), 0, "{}: non-finite", scene.name);
    assert_eq!(frame.stats.cut_paths, 0, "{}: cut paths", scene.name);
    let means = frame.layers.iter().map(|layer| {
        let sum: f64 = layer.pixels.iter().flatten().map(|x| f64::from(*x)).sum();
        (layer.label.clone(), sum / layer.pixels.len() as f64)
    });
    means.collect()
}

#[test]
fn every_embedded_scene_opens_says_what_it_shows_and_shines() {
    let ids: Vec<&str> = embedded::all().iter().map(|s| s.id).collect();
    assert!(ids.len() >= 16, "{ids:?}");
    for id in ids {
        let desc = embedded::read(id).unwrap_or_else(|e| panic!("{e}"));
        let line = &desc.description;
        assert!(line.len() > 20 && line.len() < 140, "{id}: {line}");
        assert!(line.ends_with(['.', '?']), "{id}: {line}");
        assert!(!line.contains('\n'), "{id}: {line}");
        let scene = build(&desc);
        assert!(scene.warnings.is_empty(), "{id}: {:?}", scene.warnings);
        let means = one_pass(&scene);
        assert_eq!(means.len(), 5, "{id}: the whole and four components");
        assert!(means.iter().all(|(_, m)| m.is_finite()), "{id}: {means:?}");
        assert!(means[0].1 > 0.0, "{id} is black");
        // The whole has samples of its own sums; one pass is one set of paths for all layers.
        let parts: f64 = means[1..].iter().map(|(_, m)| m).sum();
        let gap = (parts - means[0].1).abs() / means[0].1;
        // Emitters seen directly belong to `direct`, so nothing is left over.
        assert!(gap < 1e-4, "{id}: parts {parts}, whole {}", means[0].1);
    }
}

#[test]
fn what_the_embedded_scenes_are_there_for_is_in_them() {
    let mean_of = |id: &str, label: &str| {
        let scene = build(&embedded::read(id).expect("an embedded scene"));
        let means = one_pass(&scene);
        means.iter().find(|(l, _)| l == label).expect("a layer").1
    };
    for id in ["jensen-box", "metal-ring", "cognac-glass", "pool"] {
        assert!(mean_of(id, "caustic") > 0.0, "{id} has no caustic");
    }
    for id in ["jensen-box", "veach-plates", "vcm-ceiling"] {
        assert!(mean_of(id, "specular") > 0.0, "{id} mirrors nothing");
    }
    for id in ["cornell", "ajar-door"] {
        assert!(mean_of(id, "indirect") > 0.0, "{id} has no indirect light");
        assert_eq!(mean_of(id, "caustic"), 0.0, "{id} has nothing specular");
    }
    let mesh = build(&embedded::read("mesh-100k").expect("an embedded scene"));
    assert!(mesh.geometry.primitive_count() > 90_000);
}

/// A torus as scanners give it: more than 100 000 triangles, no normals, no groups, a header.
fn scan() -> String {
    let (around, across) = (400_u32, 130_u32);
    let mut text = "# 52000 vertices, 104000 faces\n".to_owned();
    for (i, j) in (0..around).flat_map(|i| (0..across).map(move |j| (i, j))) {
        let (u, v) = (
            i as f32 / around as f32 * TAU,
            j as f32 / across as f32 * TAU,
        );
        let r = 2.0 + 0.5 * v.cos();
        let (x, y, z) = (r * u.cos(), 0.5 * v.sin(), r * u.sin());
        writeln!(text, "v {x:.6} {y:.6} {z:.6} ").expect("text");
    }
    let at = |i: u32, j: u32| (i % around) * across + (j % across) + 1;
    for (i, j) in (0..around).flat_map(|i| (0..across).map(move |j| (i, j))) {
        let (a, b, c, d) = (at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
        writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").expect("text");
    }
    text
}

#[test]
fn a_scan_of_100_000_triangles_without_normals_opens_under_a_soft_sky() {
    let desc = open(&[("a.obj", scan().as_bytes())]);
    assert_eq!(desc.meshes.len(), 1);
    assert_eq!(desc.meshes[0].triangles.len(), 104_000);
    assert!(desc.meshes[0].normals.is_empty());
    // Pappus: 2π·2 · 2π·0.5; chords are a little shorter.
    let exact = TAU * 2.0 * TAU * 0.5;
    let got = area(&desc, 0);
    assert!(got < exact && got > 0.999 * exact, "{got} of {exact}");
    assert!(desc.warnings.iter().any(|w| w.contains("soft sky")));
    let scene = build(&desc);
    assert_eq!(scene.geometry.primitive_count(), 104_000);
    let bounds = scene.geometry.bounds();
    let close = |a: Vec3A, b: Vec3| (Vec3::from(a) - b).abs().max_element() < 1e-3;
    assert!(close(bounds.min, Vec3::new(-2.5, -0.5, -2.5)), "{bounds:?}");
    assert!(close(bounds.max, Vec3::new(2.5, 0.5, 2.5)), "{bounds:?}");
    // All of it is in view: no ray from the eye to a vertex leaves the picture's cone.
    let view = desc.camera;
    let axis = (view.target - view.position).normalize();
    let half = (0.5 * view.vfov_deg).to_radians().cos();
    let seen = |p: &Vec3| (*p - view.position).normalize().dot(axis) >= half;
    assert!(desc.meshes[0].positions.iter().all(seen));
    assert!(one_pass(&scene)[0].1 > 0.0);
}

const ROOM: &str = "mtllib a.mtl
o room
v 0 0 0
v 4 0 0
v 4 0 4
v 0 0 4
v 0 3 0
v 4 3 0
v 4 3 4
v 0 3 4
vt 0 0
vt 1 0
vt 1 1
vt 0 1
g floor
usemtl tiles
f 1/1 4/4 3/3 2/2
g back
usemtl paint
f -8 -7 -3 -4
g lamp
usemtl lamp
f 5 6 7 8
g sill
usemtl glass
v 1 1 1
v 2 1 1
v 2 2 1
v 1.5 1.2 1
v 1 2 1
f 9 10 11 12 13
";

const ROOM_MTL: &str = "newmtl tiles
Kd 0.5 0.5 0.5
map_Kd tiles.png
newmtl paint
Kd 0.6 0.1 0.1
Ks 0.2 0.2 0.2
Ns 50
newmtl lamp
Kd 0 0 0
Ke 5 4 3
newmtl glass
Kd 0 0 0
Ni 1.33
illum 7
d 0.1
";

/// A checkered PNG of 2×2 pixels.
fn tiles() -> Vec<u8> {
    let pixels = image::RgbImage::from_fn(2, 2, |x, y| image::Rgb([255 * ((x + y) % 2) as u8; 3]));
    let mut png = std::io::Cursor::new(Vec::new());
    pixels
        .write_to(&mut png, image::ImageFormat::Png)
        .expect("a picture");
    png.into_inner()
}

#[test]
fn groups_materials_textures_and_concave_faces_arrive() {
    let png = tiles();
    let files: [(&str, &[u8]); 3] = [
        ("a.obj", ROOM.as_bytes()),
        ("a.mtl", ROOM_MTL.as_bytes()),
        ("tiles.png", &png),
    ];
    let desc = open(&files);
    assert!(desc.warnings.is_empty(), "{:?}", desc.warnings);
    let counts: Vec<usize> = desc.meshes.iter().map(|m| m.triangles.len()).collect();
    assert_eq!(counts, [2, 2, 2, 3], "two a quadrangle, three a pentagon");
    let areas: Vec<f32> = (0..4).map(|m| area(&desc, m)).collect();
    // The notch takes a triangle of base 1 and height 0.8 out of a square of side 1.
    for (got, right) in areas.iter().zip([16.0, 12.0, 16.0, 0.6]) {
        assert!((got - right).abs() < 1e-5, "{areas:?}");
    }
    assert_eq!(desc.meshes[0].uvs.len(), desc.meshes[0].positions.len());
    let material = |m: usize| &desc.materials[desc.meshes[m].material].material;
    let MaterialDesc::Diffuse { reflectance } = material(0) else {
        panic!("tiles: {:?}", material(0));
    };
    assert!(matches!(reflectance, ColorDesc::Texture { .. }));
    assert!(matches!(material(1), MaterialDesc::Sum { .. }), "paint");
    assert!(
        matches!(material(3), MaterialDesc::Dielectric { ior, .. } if *ior == 1.33),
        "glass: {:?}",
        material(3)
    );
    let emits: Vec<bool> = desc.meshes.iter().map(|m| m.emission.is_some()).collect();
    assert_eq!(emits, [false, false, true, false]);
    assert!(desc.lights.is_empty(), "no sky: the lamp shines");
    let scene = build(&desc);
    assert_eq!(scene.geometry.primitive_count(), 9);
    let bounds = scene.geometry.bounds();
    assert_eq!(Vec3::from(bounds.min), Vec3::ZERO);
    assert_eq!(Vec3::from(bounds.max), Vec3::new(4.0, 3.0, 4.0));
    assert!(one_pass(&scene)[0].1 > 0.0, "lit by the lamp alone");
}

#[test]
fn broken_geometry_is_dropped_with_a_count_in_words() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv 0 inf 0\nv 1e38 0 0\n\
                f 1 2 3\nf 1 1 2\nf 1 2 4\nf 1 2 5\nf 1 3 6\n";
    let scene = build(&open(&[("a.obj", text.as_bytes())]));
    assert_eq!(scene.geometry.primitive_count(), 1);
    let said = scene.warnings.join("\n");
    let counts = "dropped: 2 triangles with coordinates that are no numbers, 1 triangle with \
                  coordinates beyond 1e18, 1 triangle without area";
    assert!(said.contains(counts), "{said}");
    assert!(one_pass(&scene)[0].1.is_finite());
}

#[test]
fn a_missing_material_file_is_a_warning_and_its_faces_are_grey() {
    let text = "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
    let desc = open(&[("a.obj", text.as_bytes())]);
    assert!(desc.warnings[0].contains("gone.mtl: there is no such file"));
    let grey = &desc.materials[desc.meshes[0].material].material;
    assert!(matches!(grey, MaterialDesc::Diffuse { .. }));
}

#[test]
fn the_reference_scenes_open_as_they_are() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference");
    let scenes = fs::read_dir(folder).expect("the references");
    let mut opened = 0;
    for scene in scenes.map(|s| s.expect("an entry").path().join("scene.json")) {
        if scene.exists() {
            let desc = scene_file::load(&scene).unwrap_or_else(|e| panic!("{e}"));
            assert!(build(&desc).warnings.is_empty(), "{}", scene.display());
            opened += 1;
        }
    }
    assert!(opened >= 8, "{opened}");
}

/// Radiance of a square of this material in the middle of the picture, under a sky of radiance 1.
fn under_a_white_sky(material: &str) -> [f64; 3] {
    let obj = "mtllib a.mtl\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nusemtl m\nf 4 3 2 1\n";
    let mtl = format!("newmtl m\n{material}\n");
    let desc = open(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())]);
    let mut job = job(&build(&desc), "path", &[]);
    job.size = UVec2::splat(9);
    let frame = render(&job, 256);
    frame.layers[0].pixels[4 * 9 + 4].map(f64::from)
}

#[test]
fn kd_and_ks_reflect_what_they_say() {
    // A GGX lobe of α = 0.014 loses less than a percent to shadowing at this angle, and the pixel's
    // standard error is below that: 0.015 on each side.
    for (material, right) in [
        ("Kd 0 0 0\nKs 0.9 0 0\nNs 10000\nillum 2", [0.9, 0.0, 0.0]),
        ("Kd 0.2 0.2 0.2\nKs 0.5 0.5 0.5\nNs 10000", [0.7; 3]),
        ("Kd 0.8 0.8 0.8\nKs 1 1 1\nNs 10\nillum 1", [0.8; 3]),
        ("Kd 0.8 0.4 0.2\nKs 0.5 0.5 0.5", [0.8, 0.4, 0.2]),
        (
            "Kd 0.6 0.2 0.2\nKs 0.6 0.6 0.6\nNs 10000",
            [1.0, 2.0 / 3.0, 2.0 / 3.0],
        ),
    ] {
        let got = under_a_white_sky(material);
        for (got, right) in got.iter().zip(right) {
            assert!(
                (got - right).abs() < 0.015,
                "{material}: {got} instead of {right}"
            );
        }
    }
}

#[test]
fn what_an_mtl_file_asks_in_vain_is_told() {
    let obj = "mtllib a.mtl\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n\
               f 1 3 2\nusemtl n\nf 3 2 1\n";
    let mtl = "newmtl m\nKd 2 2 2\nmap_Kd gone.png\nmap_d leaf.png\nmap_Ke tiles.png\n";
    let png = tiles();
    let desc = open(&[
        ("a.obj", obj.as_bytes()),
        ("a.mtl", mtl.as_bytes()),
        ("tiles.png", &png),
    ]);
    let said = desc.warnings.join("\n");
    for part in [
        "a.mtl:2: Kd is brought between 0 and 1",
        "a.mtl:3: ",
        "gone.png: the image cannot be read: there is no such file; the plain colour is used",
        "a.mtl:4: map_d is not looked at",
        "a.mtl:5: a lamp has one colour, the mean of map_Ke",
        "a.obj:9: no material is called \"n\", so its faces are grey",
        "some faces have no texture coordinates",
    ] {
        assert!(said.contains(part), "no {part:?} in\n{said}");
    }
    let emission = desc.meshes[0].emission.expect("it shines");
    assert!((emission.mean() - 0.5).abs() < 1e-6, "two of four pixels");
}

#[test]
fn of_two_faces_in_one_place_the_one_that_shines_counts_once() {
    let floor = r#"camera = { position = [0, 2, 6], target = [0, 1, 0], width = 16, height = 16 }
materials.white = { type = "diffuse", reflectance = [0.5, 0.5, 0.5] }
"#;
    let mean = |meshes: &str, integrator: &str, mode: &[(&str, &str)]| {
        let folder = tempfile::tempdir().expect("a folder");
        let quad = "v -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\n";
        for (name, faces) in [
            ("one.obj", "f 1 2 3 4\n"),
            ("two.obj", "f 1 2 3 4\nf 3 4 1 2\nf 1 2 3 4\n"),
        ] {
            fs::write(folder.path().join(name), format!("{quad}{faces}")).expect("written");
        }
        let ground = "v -5 0 -5\nv -5 0 5\nv 5 0 5\nv 5 0 -5\nf 1 2 3 4\n";
        fs::write(folder.path().join("floor.obj"), ground).expect("written");
        let path = folder.path().join("a.toml");
        let ground = "[[meshes]]\nfile = \"floor.obj\"\nmaterial = \"white\"\n";
        fs::write(&path, format!("{floor}{ground}{meshes}")).expect("written");
        let desc = scene_file::load(&path).unwrap_or_else(|e| panic!("{e}"));
        let job = job(&build(&desc), integrator, mode);
        let frame = render(&job, 64);
        let sum: f64 = frame.layers[0].pixels.iter().map(|p| f64::from(p[0])).sum();
        sum / 256.0
    };
    let mesh = |file: &str, more: &str| {
        format!("[[meshes]]\nfile = \"{file}\"\nmaterial = \"white\"\n{more}\n")
    };
    let lamp = "emission = [3, 3, 3]";
    let right = mean(&mesh("one.obj", lamp), "path", &[]);
    assert!(right > 0.0);
    for meshes in [
        mesh("two.obj", lamp),
        mesh("one.obj", "") + &mesh("one.obj", lamp),
        mesh("one.obj", lamp) + &mesh("one.obj", ""),
    ] {
        for (integrator, set) in [
            ("path", &[("mode", "mis")][..]),
            ("path", &[("mode", "kajiya")]),
            ("path", &[("mode", "hits")]),
            ("bdpt", &[]),
        ] {
            let got = mean(&meshes, integrator, set);
            let off = (got / right - 1.0).abs();
            assert!(
                off < 0.05,
                "{integrator} {set:?}: {got}, not {right}\n{meshes}"
            );
        }
    }
}
