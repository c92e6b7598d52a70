//! What inputs are made from, and the files that scenes among them find.

use std::borrow::Cow;
use std::fs;
use std::io::{Cursor, Error, ErrorKind};
use std::path::Path;
use std::sync::OnceLock;

use glam::UVec2;
use image::{DynamicImage, ImageFormat, Rgb32FImage, RgbImage};
use lightscope::engine::io::source::FileSource;
use lightscope::picture::{exr_file, hdr_file, png_file};

/// The files of a folder of the project, by name.
pub fn folder(path: &str, extension: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let entries = fs::read_dir(folder).expect("a folder of the project");
    let mut files: Vec<_> = entries
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == extension))
        .map(|path| {
            let name = path
                .file_name()
                .expect("a name")
                .to_string_lossy()
                .into_owned();
            (name, fs::read(path).expect("readable"))
        })
        .collect();
    files.sort();
    files
}

/// The embedded scenes as TOML.
pub fn toml() -> Vec<Vec<u8>> {
    let mut scenes: Vec<Vec<u8>> = folder("assets/scenes", "toml")
        .into_iter()
        .map(|f| f.1)
        .collect();
    scenes.push(ALL_FIELDS.as_bytes().to_vec());
    scenes
}

/// The reference scenes as JSON.
pub fn json() -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference");
    let entries = fs::read_dir(folder).expect("the reference scenes");
    let mut scenes: Vec<Vec<u8>> = entries
        .filter_map(|entry| fs::read(entry.ok()?.path().join("scene.json")).ok())
        .collect();
    scenes.sort();
    assert!(scenes.len() > 5);
    scenes
}

/// Small meshes of the project, and one with all that an OBJ file may hold.
pub fn obj() -> Vec<Vec<u8>> {
    let files = folder("assets/scenes", "obj").into_iter().map(|f| f.1);
    let mut meshes: Vec<Vec<u8>> = files.filter(|f| f.len() < 4000).collect();
    meshes.push(ALL_OF_OBJ.as_bytes().to_vec());
    meshes
}

/// Material files.
pub fn mtl() -> Vec<Vec<u8>> {
    let mut files: Vec<Vec<u8>> = folder("assets/scenes", "mtl")
        .into_iter()
        .map(|f| f.1)
        .collect();
    files.push(ALL_OF_MTL.as_bytes().to_vec());
    files
}

/// Small pictures in every format and kind that is read.
pub fn images() -> Vec<Vec<u8>> {
    let (w, h) = (19, 13);
    let rgb = RgbImage::from_fn(w, h, |x, y| {
        image::Rgb([x as u8 * 13, y as u8 * 17, (x * y) as u8])
    });
    let float = Rgb32FImage::from_fn(w, h, |x, y| image::Rgb([x as f32, 0.1 * y as f32, 7.5]));
    let rgb = DynamicImage::ImageRgb8(rgb);
    let mut all = Vec::new();
    let mut write = |image: DynamicImage, format| {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).expect("encodable");
        all.push(bytes.into_inner());
    };
    for png in [
        rgb.clone(),
        DynamicImage::ImageLuma8(rgb.to_luma8()),
        DynamicImage::ImageRgba8(rgb.to_rgba8()),
        DynamicImage::ImageRgb16(rgb.to_rgb16()),
        DynamicImage::ImageLumaA16(rgb.to_luma_alpha16()),
    ] {
        write(png, ImageFormat::Png);
    }
    write(rgb.clone(), ImageFormat::Jpeg);
    write(DynamicImage::ImageLuma8(rgb.to_luma8()), ImageFormat::Jpeg);
    write(DynamicImage::ImageRgb32F(float.clone()), ImageFormat::Hdr);
    all.extend(pictures());
    all.extend(exr_encodings());
    all
}

/// OpenEXR files in several encodings.
fn exr_encodings() -> Vec<Vec<u8>> {
    use exr::prelude::{
        Blocks, Compression, Encoding, Image, LayerAttributes, LineOrder, SpecificChannels,
        WritableImage, f16,
    };
    let kinds = [
        (Compression::Uncompressed, Blocks::ScanLines),
        (Compression::RLE, Blocks::ScanLines),
        (Compression::ZIP16, Blocks::ScanLines),
        (Compression::PIZ, Blocks::ScanLines),
        (Compression::PXR24, Blocks::ScanLines),
        (Compression::B44, Blocks::ScanLines),
        (Compression::ZIP1, Blocks::Tiles(exr::math::Vec2(8, 8))),
    ];
    let encode = |(compression, blocks)| {
        let encoding = Encoding {
            compression,
            blocks,
            line_order: LineOrder::Increasing,
        };
        let pixel = |at: exr::math::Vec2<usize>| {
            let x = f16::from_f32(at.x() as f32);
            (x, f16::from_f32(0.5), f16::from_f32(at.y() as f32))
        };
        let channels = SpecificChannels::rgb(pixel);
        let layer =
            exr::image::Layer::new((19, 13), LayerAttributes::default(), encoding, channels);
        let mut bytes = Cursor::new(Vec::new());
        Image::from_layer(layer)
            .write()
            .non_parallel()
            .to_buffered(&mut bytes)
            .expect("encodable");
        bytes.into_inner()
    };
    kinds.into_iter().map(encode).collect()
}

/// Pictures as this program writes them, with texts.
pub fn pictures() -> Vec<Vec<u8>> {
    let size = UVec2::new(5, 4);
    let texts = [("lightscope:state".to_owned(), STATE.to_owned())];
    let pixels = [[0.25_f32, 1.0, 3.0]; 20];
    let layers = [("whole", &pixels[..]), ("direct", &pixels[..])];
    vec![
        png_file::encode(size, &[[1, 2, 3]; 20], &texts).expect("a PNG"),
        exr_file::encode(size, &layers, &texts).expect("an EXR"),
        hdr_file::encode(size, &pixels, &texts).expect("an HDR"),
    ]
}

/// Files beside a scene that is being tried; the file `changed` is the input.
pub struct Files<'a> {
    pub changed: &'a str,
    pub bytes: &'a [u8],
}

impl FileSource for Files<'_> {
    fn read(&self, path: &str) -> std::io::Result<Cow<'_, [u8]>> {
        static BESIDE: OnceLock<Vec<(String, Vec<u8>)>> = OnceLock::new();
        if path == self.changed {
            return Ok(Cow::Borrowed(self.bytes));
        }
        let beside = BESIDE.get_or_init(|| {
            let mut files = folder("assets/scenes", "obj");
            files.extend(folder("assets/scenes", "mtl"));
            for scene in [
                "cornell-glossy",
                "ajar-door",
                "caustic-ring",
                "closed-room",
                "point-light",
            ] {
                files.extend(folder(&format!("tests/reference/{scene}"), "obj"));
            }
            files.push(("all.obj".to_owned(), ALL_OF_OBJ.as_bytes().to_vec()));
            files.push(("all.mtl".to_owned(), ALL_OF_MTL.as_bytes().to_vec()));
            files.push(("a.png".to_owned(), images().swap_remove(0)));
            files.push(("smoke.txt".to_owned(), DENSITY.as_bytes().to_vec()));
            files
        });
        let name = path.rsplit('/').next().unwrap_or(path);
        // What is generated within the program, or large, is stood in for by something small.
        let stand_in = match name.rsplit_once('.').map(|(_, end)| end) {
            Some("obj") => "cube.obj",
            Some("txt") => "smoke.txt",
            Some("hdr" | "png" | "jpg" | "exr") => "a.png",
            _ => name,
        };
        let named = |name: &str| beside.iter().find(|(known, _)| known == name);
        let found = named(name).or_else(|| named(stand_in));
        let missing = || Error::from(ErrorKind::NotFound);
        found.map(|f| Cow::Borrowed(&*f.1)).ok_or_else(missing)
    }
}

/// A density file.
pub const DENSITY: &str = "2 3 2\n0 0.5 1 0 0.25 1e-3\n2 3 4 5 6 7\n";

/// A scene that names what the embedded ones leave out.
pub const ALL_FIELDS: &str = r#"
format = 1
name = "all"
description = "every field"
frames = 3
camera = { position = [0, 1, 5], target = [0, 1, 0], up = [0, 1, 0], vfov_deg = 40, width = 8, height = 6, lens = { radius = 0.1, focus_distance = 4 } }
medium = "smoke"

[materials]
a = { type = "diffuse", reflectance = { texture = "a.png", scale = 0.5, encoding = "linear" } }
b = { type = "mirror", reflectance = 0.9 }
c = { type = "dielectric", ior = 1.5 }
d = { type = "rough_dielectric", ior = 1.5, alpha = 0.2 }
e = { type = "mix", materials = ["a", "b"], weight = 0.25 }
f = { type = "diffuse", reflectance = { checker = [[1, 0, 0], 0.5], scale = 3 }, opacity = 0.5 }

[media]
smoke = { type = "grid", file = "smoke.txt", region = { min = [0, 0, 0], max = [1, 2, 1] }, sigma_t_scale = 2, albedo = 0.9, majorant_scale = 1, phase = { type = "hg", g = 0.3 } }
milk = { type = "homogeneous", sigma_t = [1, 2, 3], albedo = [0.9, 0.8, 1], emission = 0.1, phase = { type = "rayleigh" } }

[[meshes]]
name = "all"
file = "all.obj"
material = "a"
emission = [1, 2, 3]
transform = [{ translate = [1, 0, 0] }, { rotate_deg = { axis = [0, 1, 0], angle = 45 } }, { scale = 2 }]

[[meshes]]
file = "cube.obj"
material = "c"
interior = "milk"
priority = 2

[[spheres]]
center = [0, 1, 0]
radius = 1
material = "d"
inward = true

[[lights]]
type = "point"
position = [0, 3, 0]
intensity = 10

[[lights]]
type = "spot"
position = [0, 3, 0]
direction = [0, -1, 0]
intensity = [1, 2, 3]
angle_deg = 30
falloff_deg = 20

[[lights]]
type = "directional"
direction = [0, -1, 1]
irradiance = 1

[[lights]]
type = "constant"
radiance = 0.2
"#;

/// An OBJ file with polygons, groups, smoothing, texture coordinates and relative indices.
pub const ALL_OF_OBJ: &str = "# all\nmtllib all.mtl\no one\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
v 0.5 0.25 0 1.0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1 0\nvn 0 0 1\ns 1\ng a b\nusemtl red\n\
f 1/1/1 2/2/1 3/3/1 4/4/1\nusemtl glass\nf -5//-1 -4//-1 -3//-1\ns off\ng c\nusemtl none\n\
f 1 2 5 3 4\nf 1/1 2/2 3/3\nl 1 2\np 1\n";

/// A material file with every statement that is read.
pub const ALL_OF_MTL: &str = "newmtl red\nKd 0.8 0.1 0.1\nKs 0.1 0.1 0.1\nNs 40\nd 0.5\nillum 2\n\
map_Kd -s 2 2 2 a.png\n\nnewmtl glass\nKd 0 0 0\nKt 1 1 1\nNi 1.5\nillum 7\nTf 1 1 1\n\n\
newmtl lamp\nKe 5 5 5\nKd 0 0 0\nillum 3\nTr 0.2\nmap_d a.png\nmap_Ke a.png\n";

/// A state, as the window saves it.
pub const STATE: &str = r#"{
  "lightscope": 1, "version": "0.1.0", "scene": {"id": "jensen-box"},
  "camera": {"position": [0, 1, 5], "target": [0, 1, 0], "up": [0, 1, 0], "vfov_deg": 40,
    "lens": {"radius": 0.1, "focus_distance": 4}},
  "size": [64, 48], "integrator": "path",
  "parameters": {"mode": "mis", "roulette": "4", "sampler": "sobol", "equiangular": "on"},
  "max_depth": 7, "expressions": ["L.*DSE", "LE"], "only_expressions": false,
  "display": {"shown": "whole", "exposure": 0.5, "part_exposure": [0, 0, 0, 0],
    "tonemap": "agx", "false_color": false},
  "seed": 3, "passes": 16
}"#;
