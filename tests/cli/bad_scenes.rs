//! Scene files that are wrong, each in one way: one sentence with file and line, and nothing else.

use std::fs;
use std::path::Path;

use crate::support::{folder, lightscope, stderr, stdout};

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

/// The same for media: what stands in place of the line `format = 1`, and of `radius = 1`.
#[rustfmt::skip]
const MEDIA_FAULTS: [(&str, &str, &str); 25] = [
    (r#"medium = { type = "fog", region = "everywhere" } #"#, "",
     r#"medium: there is no type "fog"; there are homogeneous, grid"#),
    (r#"medium = { type = "homogenous", region = "everywhere" } #"#, "",
     r#"there is no type "homogenous"; did you mean "homogeneous"?"#),
    (r#"medium = { type = "homogeneous", region = "everywhere", albedo = 1 } #"#, "",
     r#"medium: the field "sigma_t" is missing; it is extinction per length"#),
    (r#"medium = { type = "homogeneous", region = "everywhere", sigma_t = -1, albedo = 1 } #"#, "",
     "medium: sigma_t is to be at least 0"),
    (r#"medium = { type = "homogeneous", region = "everywhere", sigma_t = 1 } #"#, "",
     r#"medium: the field "albedo" is missing"#),
    (r#"medium = { type = "homogeneous", region = "everywhere", sigma_t = 1, albedo = 1.5 } #"#, "",
     "medium: albedo is at most 1, not 1.5; more would make light out of nothing"),
    (r#"medium = { type = "homogeneous", sigma_t = 1, albedo = 1 } #"#, "",
     r#"medium: the field "region" is missing; it is "everywhere" or a table with min and max"#),
    (r#"medium = { type = "homogeneous", region = "nowhere", sigma_t = 1, albedo = 1 } #"#, "",
     r#"medium: region is to be "everywhere" or a table with min and max, not "nowhere""#),
    (r#"medium = { type = "homogeneous", region = { min = [0, 0, 0], max = [1, 0, 1] }, sigma_t = 1, albedo = 1 } #"#, "",
     "medium, region: max is to lie above min along every axis"),
    (r#"medium = { type = "homogeneous", region = "everywhere", sigma_t = 1, albedo = 1, phase = { type = "hg", g = 1 } } #"#, "",
     "medium, phase: g is to be a mean cosine between -1 and 1, not 1"),
    (r#"medium = { type = "homogeneous", region = "everywhere", sigma_t = 1, albedo = 1, phase = { type = "mie" } } #"#, "",
     r#"medium, phase: there is no type "mie"; there are isotropic, hg, rayleigh"#),
    (r#"medium = { type = "homogeneous", region = "everywhere", sigma_t = 1, albedo = 1, density = 2 } #"#, "",
     r#"medium: there is no field "density""#),
    (r#"medium = { type = "grid", region = "everywhere", sigma_t_scale = 1, albedo = 1 } #"#, "",
     "medium: a grid fills a box: its region is a table with min and max"),
    (r#"medium = { type = "grid", region = { min = [0, 0, 0], max = [1, 1, 1] }, file = "none.txt", sigma_t_scale = 1, albedo = 1 } #"#, "",
     "medium: none.txt: there is no such file"),
    (r#"medium = { type = "grid", region = { min = [0, 0, 0], max = [1, 1, 1] }, file = "few.txt", sigma_t_scale = 1, albedo = 1 } #"#, "",
     "medium: few.txt: it holds 3 numbers, not 2 · 2 · 2"),
    (r#"medium = { type = "grid", region = { min = [0, 0, 0], max = [1, 1, 1] }, file = "few.txt", sigma_t_scale = 1, albedo = 1, majorant_scale = 0 } #"#, "",
     "few.txt: it holds 3 numbers"),
    (r#"medium = "fog" #"#, "",
     r#"medium "fog" is not defined; media are defined in the table media"#),
    (r#"media.vacuum = { type = "homogeneous", sigma_t = 1, albedo = 1 } #"#, "",
     r#""vacuum" is the medium that is nothing; choose another name"#),
    (r#"media = [1] #"#, "", "media is to be a table of fields, not a list"),
    (r#"media.fog = { type = "homogeneous", sigma_t = 1, albedo = 1 }"#, "radius = 1\ninterior = \"fig\" #",
     r#"sphere: medium "fig" is not defined; did you mean "fog"?"#),
    ("", "radius = 1\ninterior = 7 #", "sphere: interior is to be a text"),
    ("", "radius = 1\npriority = 2 #",
     "sphere: priority decides between interiors that overlap; give an interior, too"),
    ("", "radius = 1\ninterior = \"vacuum\"\npriority = 0.5 #",
     "sphere: priority is to be a whole number from -1000000 to 1000000, not 0.5"),
    ("frames = 0 #", "", "scene: frames is to be a whole number of frames from 1 to 1000000, not 0"),
    (r#"medium = { type = "homogeneous", region = "everywhere", sigma_t = [0, 1, 1], albedo = 0, emission = 1 }"#, "",
     "it is everywhere and emits without extinction, which would be endlessly bright"),
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
fn one_fault_of_a_medium_is_one_sentence_at_its_line() {
    let folder = folder();
    let path = folder.path().join("scene.toml");
    fs::write(folder.path().join("few.txt"), "2 2 2\n1 2 3\n").expect("written");
    for (top, sphere, message) in MEDIA_FAULTS {
        let mut text = GOOD.replacen("format = 1", top, 1);
        if !sphere.is_empty() {
            text = text.replacen("radius = 1", sphere, 1);
        }
        fs::write(&path, &text).expect("written");
        let said = refusal(folder.path(), "scene.toml");
        match text.lines().position(|l| l.ends_with('#')) {
            Some(line) => expect(&said, "scene.toml", Some(line + 1), message),
            None => assert!(said.contains(message), "no {message:?} in\n{said}"),
        }
    }
    // A boundary that bounds nothing.
    fs::write(
        &path,
        GOOD.replacen(r#"material = "white""#, r#"material = "none""#, 1),
    )
    .expect("written");
    let said = refusal(folder.path(), "scene.toml");
    assert!(
        said.contains("a medium's invisible boundary; give an interior, too"),
        "{said}"
    );
    // Density files that are wrong, at their own lines.
    let scene = GOOD.replacen(
        "format = 1",
        r#"medium = { type = "grid", region = { min = [0, 0, 0], max = [1, 1, 1] }, file = "d.txt", sigma_t_scale = 1, albedo = 1 }"#,
        1,
    );
    fs::write(&path, scene).expect("written");
    for (density, line, message) in [
        (
            "",
            1,
            "the first line is to be `nx ny nz`, three whole numbers above 0",
        ),
        ("2 0 2\n", 1, "the first line is to be"),
        (
            "1 1 1\nx\n",
            2,
            "a density is a finite number of at least 0, not \"x\"",
        ),
        ("1 1 1\n\n-1\n", 3, "not \"-1\""),
        ("1 1 1\nnan\n", 2, "not \"nan\""),
        (
            "1 1 1\n1\n2 3\n",
            3,
            "there are more numbers than 1 · 1 · 1 voxels",
        ),
        (
            "99999 99999 99999\n",
            1,
            "99999 · 99999 · 99999 voxels are more than 2^30",
        ),
    ] {
        fs::write(folder.path().join("d.txt"), density).expect("written");
        let said = refusal(folder.path(), "scene.toml");
        expect(&said, "d.txt", Some(line), message);
    }
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
    let output = lightscope(folder.path(), &["info", "a.obj"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let warning = "warning: parts/a.mtl:5: parts/none.png: the image cannot be read";
    assert!(stdout(&output).contains(warning), "{}", stdout(&output));
}
