//! Scene files that are wrong, each in one way: one sentence with file and line, and nothing else.

use std::fs;
use std::path::Path;

use crate::support::{folder, lightscope, stderr};

/// A scene without a fault; each case exchanges one piece of it.
const GOOD: &str = r#"format = 1

[camera]
position = [0, 0, 5]
target = [0, 0, 0]
vfov_deg = 40
width = 8
height = 8

[materials.white]
type = "diffuse"
reflectance = [0.5, 0.5, 0.5]

[[spheres]]
center = [0, 0, 0]
radius = 1
material = "white"

[[lights]]
type = "point"
position = [0, 3, 0]
intensity = [1, 1, 1]
"#;

/// What is taken out of [`GOOD`], what stands there instead, and what the sentence says. The line
/// it is to name ends in `#`; where none does, the line of the table that lacks something.
#[rustfmt::skip]
const FAULTS: [(&str, &str, &str); 40] = [
    ("format = 1", "format = 2 #",
     "scene: format is 1, the only one there is"),
    ("position = [0, 0, 5]\n", "",
     r#"camera: the field "position" is missing; it is a list of three numbers"#),
    ("vfov_deg = 40", "vfov = 40 #",
     r#"camera: there is no field "vfov"; did you mean "vfov_deg"?"#),
    ("vfov_deg = 40", "vfov_deg = 180 #",
     "camera: vfov_deg is to be an angle in degrees between 0 and 180, not 180"),
    ("vfov_deg = 40", r#"vfov_deg = "wide" #"#,
     r#"camera: vfov_deg is to be an angle in degrees between 0 and 180, not "wide""#),
    ("width = 8", "width = 0 #",
     "camera: width is to be a whole number of pixels from 1 to 16384, not 0"),
    ("width = 8", "width = 2.5 #",
     "not 2.5"),
    ("width = 8", "width = 100000 #",
     "not 100000"),
    ("position = [0, 0, 5]", "position = [0, 0] #",
     "camera: position is to be a list of three finite numbers, not of 2"),
    ("position = [0, 0, 5]", "position = [0, 0, nan] #",
     "camera: each number of position is to be finite, not NaN"),
    ("target = [0, 0, 0]", "target = [0, 0, 5]",
     "camera: target is the position itself; the view has no direction"),
    ("vfov_deg = 40", "up = [0, 0, 1]",
     "camera: up points along the view; it is to point elsewhere"),
    ("vfov_deg = 40", "lens = { radius = -1, focus_distance = 3 } #",
     "camera lens: radius is to be a length above 0, not -1"),
    ("vfov_deg = 40", r#"type = "fisheye" #"#,
     r#"camera: the type is "perspective", not "fisheye""#),
    (r#"type = "diffuse""#, r#"type = "difuse" #"#,
     r#"material "white": there is no type "difuse"; did you mean "diffuse"?"#),
    ("reflectance = [0.5, 0.5, 0.5]", "reflectance = [0.5, 1.5, 0.5] #",
     r#"material "white": reflectance is at most 1, not 1.5; more would make light out of nothing"#),
    ("reflectance = [0.5, 0.5, 0.5]", "reflectance = [0.5, -0.5, 0.5] #",
     r#"material "white": reflectance is to be at least 0, not -0.5"#),
    ("reflectance = [0.5, 0.5, 0.5]", r#"reflectance = { texture = "none.png" } #"#,
     "none.png: the image cannot be read: there is no such file"),
    ("reflectance = [0.5, 0.5, 0.5]", r#"reflectance = { texture = "text.png" } #"#,
     "text.png: the image cannot be decoded: it is neither PNG, JPEG, Radiance HDR nor OpenEXR"),
    ("reflectance = [0.5, 0.5, 0.5]", "reflectance = { checker = [[0, 0, 0]], scale = 4 } #",
     r#"material "white", reflectance: checker is to be a list of two colours"#),
    ("type = \"diffuse\"\nreflectance = [0.5, 0.5, 0.5]", "type = \"dielectric\"\nior = 0 #",
     r#"material "white": ior is to be an index of refraction from 0.0001 to 10000, not 0"#),
    ("type = \"diffuse\"\nreflectance = [0.5, 0.5, 0.5]", "type = \"ggx_conductor\"\nalpha = 2 #\nspecular_reflectance = [1, 1, 1]",
     r#"material "white": alpha"#),
    ("type = \"diffuse\"\nreflectance = [0.5, 0.5, 0.5]", "type = \"mix\"\nmaterials = [\"white\", \"white\"]\nweight = 0.5",
     r#"material "white": it is a mixture of itself"#),
    ("type = \"diffuse\"\nreflectance = [0.5, 0.5, 0.5]", "type = \"mix\"\nmaterials = [\"a\", \"white\"] #\nweight = 0.5",
     r#"material "white": material "a" is not defined; there are white"#),
    (r#"material = "white""#, r#"material = "whit" #"#,
     r#"sphere: material "whit" is not defined; did you mean "white"?"#),
    ("radius = 1", "radius = -1 #",
     "sphere: radius is to be a length above 0, not -1"),
    ("radius = 1", "radius = 1\ntransform = [{ scale = [1, 2, 1] }]",
     "sphere: a sphere stays a sphere: its transform scales all directions alike"),
    ("radius = 1", "radius = 1\ntransform = [{ scale = 0 }] #",
     "sphere, transform: scale is to be a number other than 0, not 0"),
    ("radius = 1", "radius = 1\ntransform = [{ shear = 0 }] #",
     "sphere, transform: a step is one of translate, rotate_deg, scale"),
    ("radius = 1", "radius = 1\ntransform = [{ rotate_deg = { axis = [0, 0, 0], angle = 3 } }] #",
     "axis has no length, so it points nowhere"),
    (r#"type = "point""#, r#"type = "pint" #"#,
     r#"light: there is no type "pint"; did you mean "point"?"#),
    ("intensity = [1, 1, 1]", "intensity = [1, -1, 1] #",
     "point light: intensity is to be at least 0, not -1"),
    ("intensity = [1, 1, 1]", r#"intensity = "bright" #"#,
     "point light: intensity"),
    ("type = \"point\"\nposition = [0, 3, 0]\nintensity = [1, 1, 1]", "type = \"directional\"\ndirection = [0, 0, 0] #\nirradiance = [1, 1, 1]",
     "directional light: direction has no length, so it points nowhere"),
    (r#"type = "point""#, "type = \"spot\"\ndirection = [0, -1, 0]\nangle_deg = 20\nfalloff_deg = 50 #",
     "spot light: falloff_deg is to be the width of the soft edge in degrees, from 0 to angle_deg, not 50"),
    ("type = \"point\"\nposition = [0, 3, 0]\nintensity = [1, 1, 1]", "type = \"environment\"\nfile = \"sky.exr\" #",
     "sky.exr: the image cannot be read: there is no such file"),
    ("[[spheres]]", "[[sphere]] #",
     r#"scene: there is no field "sphere"; did you mean "spheres"?"#),
    ("[[spheres]]", "[spheres] #",
     "scene: spheres is to be a list, not a table"),
    ("[[spheres]]", "[[meshes]]\nfile = \"none.obj\" #\nmaterial = \"white\"\n[[spheres]]",
     "mesh: none.obj: there is no such file"),
    ("[[spheres]]", "[[meshes]] #\nmaterial = \"white\"\n[[spheres]]",
     r#"mesh: the field "file" is missing; it is the name of an OBJ file"#),
];

/// Whole files: name, text, line, and what the sentence says.
#[rustfmt::skip]
const FILES: [(&str, &str, Option<usize>, &str); 14] = [
    ("a.toml", "", None, "it is empty; a scene has at least a camera"),
    ("a.toml", "camera = [", Some(1), "this is not TOML"),
    ("a.json", "{\"camera\": }", Some(1), "this is not JSON"),
    ("a.json", "{\"format\": 1,\n \"format\": 1}", Some(2), r#""format" stands here for the second time"#),
    ("a.json", "[1, 2]", Some(1), "scene"),
    ("a.toml", "name = \"no view\"", Some(1), r#"scene: the field "camera" is missing; it is a table with position and target"#),
    ("a.txt", "[camera]", None, "a scene is a .toml, .json or .obj file; this name ends otherwise"),
    ("a.obj", "v 0 0\nf 1 2 3", Some(1), "a vertex is `v x y z` with three numbers"),
    ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 x 0\nf 1 2 3", Some(3), "a vertex is `v x y z` with three numbers"),
    ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9", Some(4), "a face names a vertex that is not there"),
    ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2", Some(4), "a face names a vertex that is not there"),
    ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 a", Some(4), "a face is `f a b c` with whole numbers"),
    ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2", None, "it holds no faces; a mesh has lines `v x y z` and `f 1 2 3`"),
    ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0", None, "it holds no faces"),
];

/// Runs `info` on a file that is wrong; its one sentence.
fn refusal(folder: &Path, file: &str) -> String {
    let output = lightscope(folder, &["info", file]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{file}: {said}");
    assert!(output.stdout.is_empty(), "{file}: something on stdout");
    assert_eq!(said.lines().count(), 1, "{file}: {said}");
    said.trim_end().to_owned()
}

fn expect(said: &str, file: &str, line: Option<usize>, message: &str) {
    let place = line.map_or(format!("error: {file}: "), |l| {
        format!("error: {file}:{l}: ")
    });
    assert!(said.starts_with(&place), "not at {place}\n{said}");
    assert!(said.contains(message), "no {message:?} in\n{said}");
}

#[test]
fn one_fault_in_a_good_scene_is_one_sentence_at_its_line() {
    let folder = folder();
    let path = folder.path().join("scene.toml");
    fs::write(folder.path().join("text.png"), "no image").expect("written");
    fs::write(&path, GOOD).expect("written");
    let good = lightscope(folder.path(), &["info", "scene.toml"]);
    assert_eq!(good.status.code(), Some(0), "{}", stderr(&good));
    for (old, new, message) in FAULTS {
        assert!(GOOD.contains(old), "{old:?} is not in the good scene");
        let text = GOOD.replacen(old, new, 1);
        fs::write(&path, &text).expect("written");
        let said = refusal(folder.path(), "scene.toml");
        let marked = text.lines().position(|l| l.ends_with('#'));
        match marked {
            Some(line) => expect(&said, "scene.toml", Some(line + 1), message),
            None => assert!(
                said.starts_with("error: scene.toml:") && said.contains(message),
                "no {message:?} in\n{said}"
            ),
        }
    }
}

#[test]
fn a_file_that_is_no_scene_says_so() {
    for (name, text, line, message) in FILES {
        let folder = folder();
        fs::write(folder.path().join(name), text).expect("written");
        expect(&refusal(folder.path(), name), name, line, message);
    }
}

#[test]
fn bytes_that_are_no_text_are_no_scene() {
    let folder = folder();
    fs::write(folder.path().join("a.toml"), [0x23, 0x0a, 0xff, 0xfe]).expect("written");
    let said = refusal(folder.path(), "a.toml");
    assert!(said.contains("these bytes are no UTF-8 text"), "{said}");
}

#[test]
fn a_bad_material_file_is_named_with_its_own_line() {
    let folder = folder();
    let obj = "mtllib parts/a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl q\nf 1 2 3\n";
    fs::write(folder.path().join("a.obj"), obj).expect("written");
    fs::create_dir(folder.path().join("parts")).expect("made");
    let mtl = folder.path().join("parts/a.mtl");
    fs::write(&mtl, "newmtl q\nKd 1 zero 0\n").expect("written");
    let said = refusal(folder.path(), "a.obj");
    expect(&said, "parts/a.mtl", Some(2), "lacks a name or a number");
    // Textures lie beside the material file, not beside the mesh.
    let textured = "newmtl p\nKd 1 1 1\nnewmtl q\nKd 1 1 1\nmap_Kd none.png\n";
    fs::write(&mtl, textured).expect("written");
    let said = refusal(folder.path(), "a.obj");
    expect(
        &said,
        "parts/a.mtl",
        Some(5),
        "parts/none.png: the image cannot be read",
    );
}
