//! The scenes within the program: the files of `assets/scenes`, and meshes made when they are read.

use std::borrow::Cow;
use std::io::{Error, ErrorKind};

use super::error::InputError;
use super::source::FileSource;
use super::{generated, scene_file, smoke};
use crate::engine::scene::desc::SceneDesc;
use crate::engine::stability::stress::{self, Stress};

/// A scene within the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EmbeddedScene {
    /// Id on the command line.
    pub id: &'static str,
}

/// Names the scene files in the order of the window's list.
macro_rules! scenes {
    ($($id:literal)*) => {
        const SCENES: &[EmbeddedScene] = &[$(EmbeddedScene { id: $id }),*];
        const SCENE_FILES: &[(&str, &[u8])] = &[$((
            concat!($id, ".toml"),
            include_bytes!(concat!("../../../assets/scenes/", $id, ".toml")),
        )),*];
    };
}

/// Names the files that scenes refer to.
macro_rules! parts {
    ($($name:literal)*) => {
        const PARTS: &[(&str, &[u8])] = &[$((
            $name,
            include_bytes!(concat!("../../../assets/scenes/", $name)),
        )),*];
    };
}

scenes! {
    "jensen-box" "cornell" "glossy" "kajiya-spheres" "metal-ring" "cognac-glass" "pool"
    "veach-plates" "ajar-door" "many-lights" "sky-sun" "mesh-100k" "vcm-sun" "vcm-ceiling"
    "vcm-point" "vcm-environment" "fog-spot" "glass-volume-caustic" "smoke" "milk"
}

parts! {
    "ajar-block.obj" "ajar-door.obj" "ajar-floor.obj" "ajar-lamp.obj" "ajar-walls.obj"
    "cognac.mtl" "cornell-lamp.obj" "cornell-left.obj" "cornell-right.obj" "cornell-shell.obj"
    "cornell-short-block.obj" "cornell-tall-block.obj" "cube.obj" "quad.obj" "sky.hdr"
    "vcm-back.obj" "vcm-ceiling.obj" "vcm-floor.obj" "vcm-left.obj" "vcm-right.obj"
    "veach-plate-1.obj" "veach-plate-2.obj" "veach-plate-3.obj" "veach-plate-4.obj"
}

/// The files of the program.
struct Embedded;

impl FileSource for Embedded {
    fn read(&self, path: &str) -> std::io::Result<Cow<'_, [u8]>> {
        let files = SCENE_FILES.iter().chain(PARTS);
        if let Some((_, bytes)) = files.into_iter().find(|(name, _)| *name == path) {
            return Ok(Cow::Borrowed(bytes));
        }
        generated::obj(path)
            .or_else(|| smoke::density(path))
            .map(|text| Cow::Owned(text.into_bytes()))
            .ok_or_else(|| Error::from(ErrorKind::NotFound))
    }
}

/// The embedded scenes, in the order in which they are listed.
pub fn all() -> &'static [EmbeddedScene] {
    SCENES
}

/// Whether `id` names a scene within the program: one of [`all`], or an experiment of
/// [`stress`] with its numbers.
pub fn contains(id: &str) -> bool {
    id.starts_with(stress::PREFIX) || SCENES.iter().any(|scene| scene.id == id)
}

/// The embedded scene called `id`.
///
/// # Errors
/// If there is none.
pub fn read(id: &str) -> Result<SceneDesc, InputError> {
    read_frame(id, 0)
}

/// Frame `frame` of the embedded scene called `id`.
///
/// # Errors
/// If there is none.
pub fn read_frame(id: &str, frame: u32) -> Result<SceneDesc, InputError> {
    if id.starts_with(stress::PREFIX) {
        let stress = Stress::parse(id).map_err(|message| InputError::in_file(id, message))?;
        return Ok(stress.scene());
    }
    scene_file::load_frame_from(&Embedded, &format!("{id}.toml"), frame)
}
