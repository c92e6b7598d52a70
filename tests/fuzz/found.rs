//! Inputs that once broke something, or that were made to.

use std::time::{Duration, Instant};

use lightscope::engine::io::image::{self, Encoding};
use lightscope::engine::io::scene_file;
use lightscope::picture::exr_file;

use super::allocator::peak_of;
use super::corpus::Files;
use super::targets::scene;

/// Time that none of these may take, on a machine that does other work beside.
const LONG: Duration = Duration::from_secs(20);

fn quickly<T>(what: &str, work: impl FnOnce() -> T) {
    let started = Instant::now();
    work();
    let took = started.elapsed();
    assert!(took < LONG, "{what} took {took:?}");
}

/// A parser that recurses as deep as its input nests overflows its stack, which ends the program.
#[test]
fn deep_nesting_is_refused() {
    for (name, open, close) in [
        ("a.json", "[", "]"),
        ("a.json", "{\"a\":", "}"),
        ("a.toml", "a = [", "]"),
        ("a.toml", "a = {a=", "}"),
    ] {
        let (first, rest) = match name {
            "a.toml" => (open, open.trim_start_matches("a = ")),
            _ => (open, open),
        };
        let n = 200_000;
        let text = format!("{first}{}1{}", rest.repeat(n), close.repeat(n + 1));
        quickly(name, || scene(name, text.as_bytes()));
    }
    let dotted = format!("a{} = 1", ".a".repeat(100_000));
    quickly("dotted keys", || scene("a.toml", dotted.as_bytes()));
    let header = format!("[a{}]\nb = 1", ".a".repeat(100_000));
    quickly("a dotted header", || scene("a.toml", header.as_bytes()));
}

/// Clipping the ears of a polygon takes the cube of its corners at worst.
#[test]
fn a_face_of_very_many_corners_is_read() {
    let n = 20_000;
    for zigzag in [false, true] {
        let mut text = String::new();
        for i in 0..n {
            let angle = i as f32 / n as f32 * std::f32::consts::TAU;
            let r = if zigzag && i % 2 == 0 { 0.5 } else { 1.0 };
            text += &format!("v {} {} 0\n", r * angle.cos(), r * angle.sin());
        }
        let corners: String = (1..=n).map(|i| format!(" {i}")).collect();
        text += &format!("f{corners}\n");
        quickly("a large face", || scene("a.obj", text.as_bytes()));
    }
}

/// Each name of an unknown material is compared with all that are known.
#[test]
fn very_many_unknown_materials_are_read() {
    let mut text = "mtllib all.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned();
    for i in 0..50_000 {
        text += &format!("usemtl some-unknown-name-{i}\nf 1 2 3\n");
    }
    quickly("unknown materials", || {
        scene("scenes/a.obj", text.as_bytes())
    });
}

/// The head of a file claims a picture that takes gigabytes, and nothing follows.
#[test]
fn a_claim_of_many_pixels_takes_no_memory() {
    let mut png = vec![0x89, b'P', b'N', b'G', 13, 10, 26, 10, 0, 0, 0, 13];
    let mut head = b"IHDR".to_vec();
    head.extend(16_000_u32.to_be_bytes());
    head.extend(16_000_u32.to_be_bytes());
    head.extend([8, 2, 0, 0, 0]);
    let crc = crc32(&head);
    png.extend(&head);
    png.extend(crc.to_be_bytes());
    // Some bytes of a picture, so that its head is complete.
    let data = b"IDAT\x78\x9c\x03\x00";
    png.extend(4_u32.to_be_bytes());
    png.extend(data);
    png.extend(crc32(data).to_be_bytes());
    let hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16000 +X 16000\n\x02\x02\x3e\x80".to_vec();
    for (name, bytes) in [("png", png), ("hdr", hdr)] {
        let files = Files {
            changed: name,
            bytes: &bytes,
        };
        let mut said = String::new();
        let peak = peak_of(|| {
            let error = image::read_from(&files, name, Encoding::Srgb).expect_err("no picture");
            said = error.to_string();
        });
        assert!(said.contains("more than its"), "{name}: {said}");
        assert!(peak < 1 << 20, "{name}: {peak} bytes");
    }
}

/// As above, of OpenEXR files in every encoding: the size stands in an attribute.
#[test]
fn a_claim_of_many_pixels_in_openexr_takes_no_memory() {
    let mut tried = 0;
    for mut bytes in super::corpus::images() {
        let name = b"dataWindow\0box2i\0";
        let Some(at) = bytes.windows(name.len()).position(|w| w == name) else {
            continue;
        };
        // The number of bytes, the left top pixel, then the right bottom one.
        let last = at + name.len() + 4 + 8;
        for side in [0, 4] {
            bytes[last + side..last + side + 4].copy_from_slice(&15_999_i32.to_le_bytes());
        }
        let files = Files {
            changed: "exr",
            bytes: &bytes,
        };
        let peak = peak_of(|| {
            image::read_from(&files, "exr", Encoding::Srgb).expect_err("no picture");
            exr_file::decode(&bytes).expect_err("no picture");
        });
        assert!(peak < 1 << 20, "{peak} bytes");
        tried += 1;
    }
    assert!(tried > 5);
}

/// The check sum of PNG chunks (ISO 3309).
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| {
            (c >> 1) ^ (0xedb8_8320 & (c & 1).wrapping_neg())
        })
    };
    !bytes.iter().fold(u32::MAX, step)
}

/// tobj takes three numbers for granted.
#[test]
fn a_colour_of_two_numbers_is_refused() {
    for statement in ["Kd 0.8 0", "Ks", "Ke 1 1", "Ka 1"] {
        let text = format!("newmtl red\nNs 3\n{statement}\n");
        let files = Files {
            changed: "scenes/all.mtl",
            bytes: text.as_bytes(),
        };
        let error = scene_file::load_from(&files, "scenes/all.obj").expect_err("refused");
        assert_eq!(error.line, Some(3), "{statement}: {error}");
    }
}

/// tobj multiplies indices that point before the first vertex, or far beyond the last.
#[test]
fn wild_indices_are_refused() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n";
    for face in [
        "f -4 2 3",
        "f 1/-2 2/1 3/1",
        "f 1//-2 2//1 3//1",
        "f 1//6148914691236517206 2//1 3//1",
    ] {
        let text = format!("{vertices}{face}\n");
        let files = Files {
            changed: "a.obj",
            bytes: text.as_bytes(),
        };
        let error = scene_file::load_from(&files, "a.obj").expect_err("refused");
        assert_eq!(error.line, Some(6), "{face}: {error}");
    }
    let good = format!("{vertices}f -3/-1/-1 -2/-1/-1 -1/-1/-1\n");
    let files = Files {
        changed: "a.obj",
        bytes: good.as_bytes(),
    };
    scene_file::load_from(&files, "a.obj").expect("relative indices are allowed");
}

/// What lies beyond the square root of all numbers has no direction, and a ray toward it met the
/// empty slots of the tree.
#[test]
fn lights_and_views_from_far_beyond_are_rendered() {
    let meshes = "[[meshes]]\nfile = \"cube.obj\"\nmaterial = \"a\"\n".repeat(3);
    let number = ["3.4e38", "-3.4e38", "1e30", "1e-38", "0"];
    for far in number {
        for (view, light) in [("5", far), (far, "5"), (far, far)] {
            let text = format!(
                "camera = {{ position = [0, 1, {view}], target = [0, 0, 0] }}\n\
                 [materials]\na = {{ type = \"diffuse\", reflectance = 0.5 }}\n{meshes}\
                 [[lights]]\ntype = \"point\"\nposition = [2, {light}, {light}]\nintensity = 5\n\
                 [[lights]]\ntype = \"spot\"\nposition = [{light}, 1, 2]\ndirection = [0, 0, -1]\n\
                 intensity = 3\nangle_deg = 30\nfalloff_deg = 5\n"
            );
            assert!(
                scene("scenes/a.toml", text.as_bytes()) || view == far,
                "{text}"
            );
        }
    }
}

/// A name of a megabyte is compared with the names there are.
#[test]
fn a_very_long_name_is_refused() {
    let name = "x".repeat(1 << 20);
    let text = format!("camera = {{ position = [0, 0, 0], target = [0, 0, 1] }}\n{name} = 1\n");
    quickly("a long name", || scene("a.toml", text.as_bytes()));
}
