//! The readers of everything that a user may give.

#[cfg(feature = "viewer")]
use std::fs;
#[cfg(feature = "viewer")]
use std::path::PathBuf;

use glam::UVec2;
use lightscope::cli;
use lightscope::engine::camera::Camera;
use lightscope::engine::film::Film;
use lightscope::engine::integrators::{self, Cancel, Params, Pass};
use lightscope::engine::io::image::{self, Encoding};
use lightscope::engine::io::scene_file;
use lightscope::engine::path::{Expression, PathClasses};
use lightscope::engine::plan::{LayerSettings, RenderPlan};
use lightscope::engine::scene::{Scene, SceneDesc};
use lightscope::picture::{exr_file, hdr_file, png_file};

use super::corpus::{self, Files};
use super::harness::Target;

/// Reads a scene file of that name and prepares what is sound.
pub fn scene(name: &str, bytes: &[u8]) -> bool {
    let files = Files {
        changed: name,
        bytes,
    };
    match scene_file::load_from(&files, name) {
        Ok(desc) => {
            prepare(&desc);
            true
        }
        Err(error) => {
            let sentence = error.to_string();
            assert!(
                !sentence.is_empty() && !sentence.contains('\n'),
                "{sentence:?}"
            );
            false
        }
    }
}

fn prepare(desc: &SceneDesc) {
    let Ok(scene) = Scene::build(desc) else {
        return;
    };
    let Ok(camera) = Camera::new(&scene.camera) else {
        return;
    };
    let camera = camera.with_size(UVec2::new(2, 2));
    let layers = LayerSettings {
        components: true,
        max_depth: Some(3),
        ..LayerSettings::default()
    };
    let plan = RenderPlan::new(&scene, camera.has_lens(), &layers).expect("components fit");
    // In a medium of any density a path may take as long as it likes.
    if scene.features.media {
        return;
    }
    let pass = Pass {
        scene: &scene,
        camera: &camera,
        plan: &plan,
        seed: 0,
        index: 0,
        cancel: &Cancel::never(),
    };
    for id in ["path", "bdpt"] {
        let entry = integrators::find(id).expect("an algorithm");
        let mut integrator = (entry.build)(&Params::defaults(entry.params));
        let mut film = Film::new(UVec2::new(2, 2), plan.planned);
        integrator
            .render_pass(&pass, &mut film)
            .expect("nobody cancels");
    }
}

const SCENE_WORDS: &[&str] = &[
    "materials",
    "type",
    "diffuse",
    "mirror",
    "dielectric",
    "plastic",
    "metal",
    "rough_dielectric",
    "mix",
    "weight",
    "texture",
    "checker",
    "opacity",
    "media",
    "medium",
    "interior",
    "priority",
    "region",
    "everywhere",
    "phase",
    "hg",
    "grid",
    "transform",
    "translate",
    "rotate_deg",
    "scale",
    "inward",
    "lens",
    "frames",
    "{frame}",
    "null",
    "true",
    "[",
    "]",
    "{",
    "}",
    "[[",
    "]]",
    "\"",
    "=",
    ",",
    "'''",
    "\\u0000",
    "\u{feff}",
    "é",
];

#[test]
fn toml_scenes() {
    Target {
        name: "toml-scenes",
        corpus: corpus::toml(),
        words: SCENE_WORDS,
        count: 120_000,
        memory: (2 << 20, 2000),
        sound: 0.05,
        run: |bytes| scene("scenes/a.toml", bytes),
    }
    .fuzz();
}

#[test]
fn json_scenes() {
    Target {
        name: "json-scenes",
        corpus: corpus::json(),
        words: SCENE_WORDS,
        count: 150_000,
        memory: (2 << 20, 2000),
        sound: 0.05,
        run: |bytes| scene("scenes/a.json", bytes),
    }
    .fuzz();
}

#[test]
fn obj_meshes() {
    Target {
        name: "obj-meshes",
        corpus: corpus::obj(),
        words: &[
            "v ", "vt ", "vn ", "f ", "usemtl ", "mtllib ", "o ", "g ", "s ", "/", "//", "-1",
            "\\\n",
        ],
        count: 120_000,
        memory: (1 << 20, 4000),
        sound: 0.2,
        run: |bytes| scene("scenes/a.obj", bytes),
    }
    .fuzz();
}

#[test]
fn mtl_materials() {
    Target {
        name: "mtl-materials",
        corpus: corpus::mtl(),
        words: &[
            "newmtl ", "Kd ", "Ks ", "Ke ", "Ns ", "Ni ", "d ", "Tr ", "illum ", "map_Kd ", "Pr ",
        ],
        count: 60_000,
        memory: (1 << 20, 4000),
        sound: 0.2,
        run: |bytes| {
            let files = Files {
                changed: "scenes/all.mtl",
                bytes,
            };
            let desc = scene_file::load_from(&files, "scenes/all.obj");
            desc.is_ok_and(|desc| {
                prepare(&desc);
                true
            })
        },
    }
    .fuzz();
}

#[test]
fn density_grids() {
    Target {
        name: "density-grids",
        corpus: vec![corpus::DENSITY.into(), b"1 1 1\n0.5\n".to_vec()],
        words: &[" ", "\n", "\r\n", "-", "+", "e", "."],
        count: 100_000,
        memory: (1 << 20, 2000),
        sound: 0.05,
        run: |bytes| {
            let files = GridScene(bytes);
            let desc = scene_file::load_from(&files, "scenes/a.toml");
            desc.is_ok_and(|desc| {
                prepare(&desc);
                true
            })
        },
    }
    .fuzz();
}

/// A scene whose density file is the input.
struct GridScene<'a>(&'a [u8]);

impl lightscope::engine::io::source::FileSource for GridScene<'_> {
    fn read(&self, path: &str) -> std::io::Result<std::borrow::Cow<'_, [u8]>> {
        let bytes = match path {
            "scenes/a.toml" => GRID.as_bytes(),
            _ => self.0,
        };
        Ok(bytes.into())
    }
}

const GRID: &str = r#"
camera = { position = [0, 1, 5], target = [0, 1, 0] }
[media]
smoke = { type = "grid", file = "smoke.txt", region = { min = [0, 0, 0], max = [1, 2, 1] }, sigma_t_scale = 2, albedo = 0.9 }
"#;

#[test]
fn images() {
    Target {
        name: "images",
        corpus: corpus::images(),
        words: &[
            "IHDR",
            "IDAT",
            "PLTE",
            "tRNS",
            "#?RADIANCE\n",
            "-Y 13 +X 19\n",
            "\u{1}\u{2}",
        ],
        count: 100_000,
        // A byte of deflate may stand for 1032, each of eight pixels of four channels in f32.
        memory: (6 << 20, 1032 * 8 * 48),
        sound: 0.05,
        run: |bytes| {
            let files = Files {
                changed: "a",
                bytes,
            };
            let image = image::read_from(&files, "a", Encoding::Srgb);
            image.is_ok_and(|image| {
                assert_eq!(image.pixels.len(), image.width * image.height);
                true
            })
        },
    }
    .fuzz();
}

#[test]
fn pictures() {
    Target {
        name: "pictures",
        corpus: corpus::pictures(),
        words: &[
            "lightscope:state",
            "expr1",
            "channels",
            "compression",
            "dataWindow",
        ],
        count: 60_000,
        memory: (3 << 20, 1032 * 8 * 48),
        sound: 0.05,
        run: |bytes| {
            let picture = exr_file::decode(bytes).is_ok_and(|picture| {
                let pixels = (picture.size.x * picture.size.y) as usize;
                assert!(picture.layers.iter().all(|l| l.pixels.len() == pixels));
                true
            });
            let cursor = || std::io::Cursor::new(bytes);
            let png = png_file::read_texts(cursor());
            let hdr = hdr_file::read_texts(cursor());
            picture || !png.is_empty() || !hdr.is_empty()
        },
    }
    .fuzz();
}

#[test]
fn expressions() {
    let texts = [
        "L.*E",
        "LDE",
        "L(S|G)+DE|LE",
        "L(D|V){2,5}S?E",
        "L.*D.*DS*E",
        "L((D|G)S+){0,3}E",
    ];
    Target {
        name: "expressions",
        corpus: texts.iter().map(|t| t.as_bytes().to_vec()).collect(),
        words: &[
            "L", "E", "D", "G", "S", "V", ".", "(", ")", "|", "*", "+", "?", "{", "}", ",", "{255}",
        ],
        count: 150_000,
        // A table of classes takes as much for any expression.
        memory: (3 << 20, 10_000),
        sound: 0.05,
        run: |bytes| {
            let text = String::from_utf8_lossy(bytes);
            text.parse::<Expression>().is_ok_and(|expression| {
                let again: Expression = expression.text().parse().expect("it was read before");
                assert_eq!(again, expression);
                PathClasses::with_components(&[expression]).is_ok()
            })
        },
    }
    .fuzz();
}

/// A file of this process and target.
#[cfg(feature = "viewer")]
fn scratch(name: &str, bytes: &[u8]) -> PathBuf {
    let memory = PathBuf::from("/dev/shm");
    let folder = if memory.is_dir() {
        memory
    } else {
        PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
    };
    let path = folder.join(format!("lightscope-fuzz-{}-{name}", std::process::id()));
    fs::write(&path, bytes).expect("the input can be written");
    path
}

#[cfg(feature = "viewer")]
fn open_state(name: &str, bytes: &[u8]) -> bool {
    use lightscope::viewer::model::Model;
    use lightscope::viewer::opening::Opening;
    use lightscope::viewer::source::SceneSource;
    let path = scratch(name, bytes);
    if let Ok(opening) = Opening::file(&path)
        && let Some(state) = opening.state
    {
        let mut model = Model::new(SceneSource::Embedded("jensen-box".to_owned()));
        return state.restore(&mut model).is_ok();
    }
    false
}

#[cfg(feature = "viewer")]
#[test]
fn states() {
    Target {
        name: "states",
        corpus: vec![corpus::STATE.into()],
        words: &[
            "null",
            "{}",
            "[]",
            "\"parts\"",
            "{\"expression\": 1}",
            "path",
            "bdpt",
            "file",
            "hash",
        ],
        count: 80_000,
        memory: (1 << 18, 2000),
        sound: 0.05,
        run: |bytes| open_state("a.json", bytes),
    }
    .fuzz();
    let _ = fs::remove_file(scratch("a.json", b""));
}

#[cfg(feature = "viewer")]
#[test]
fn states_in_pictures() {
    let pictures = corpus::pictures();
    for (name, run, picture) in [
        (
            "a.png",
            (|b| open_state("a.png", b)) as fn(&[u8]) -> bool,
            &pictures[0],
        ),
        ("a.exr", |b| open_state("a.exr", b), &pictures[1]),
    ] {
        Target {
            name,
            corpus: vec![picture.clone()],
            words: &["lightscope:state", "iTXt", "string", "\0"],
            count: 20_000,
            memory: (1 << 20, 1032 * 8 * 48),
            sound: 0.02,
            run,
        }
        .fuzz();
        let _ = fs::remove_file(scratch(name, b""));
    }
}

#[test]
fn command_lines() {
    let lines = [
        "render jensen-box -o a.exr --integrator path --set mode=mis --spp 4 --seconds 1.5",
        "render a.toml -o a.png --size 640x480 --threads 2 --seed 7 --max-depth 3 --exposure -1",
        "render a.json -o a.exr --expression L.*E --components --no-whole --error 0.01 --json",
        "replay cornell --integrator bdpt --set strategies=all-1,2 --index 3,4,0 --seed 1",
        "replay a.toml --stream light --index caustic,4,0 --integrator photon --frame 2",
        "compare a.exr b.exr --region 1,2,3x4 --json",
        "report cornell --reference refs --seconds 60 -o report",
        "reference jensen-box -o ref.exr --error 0.01",
        "list scenes --json",
        "info jensen-box",
        "bench rays a.obj --repeats 2",
        "jensen-box",
    ];
    Target {
        name: "command-lines",
        corpus: lines.iter().map(|l| l.as_bytes().to_vec()).collect(),
        words: &[
            " ",
            "--",
            "-",
            "=",
            "--set ",
            "--help",
            "--version",
            "-o",
            "help",
            "roulette=",
            "x",
            "--spp=",
            "--size ",
            "--index ",
            "--frames ",
            "0-3",
            "é",
            "\u{0}",
            "''",
        ],
        count: 40_000,
        memory: (1 << 20, 10_000),
        sound: 0.05,
        run: |bytes| {
            let text = String::from_utf8_lossy(bytes);
            let words: Vec<String> = text.split(' ').map(str::to_owned).collect();
            match cli::check(&words) {
                Ok(()) => true,
                Err(said) => {
                    assert!(!said.is_empty());
                    false
                }
            }
        },
    }
    .fuzz();
}
