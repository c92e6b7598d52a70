//! Where a scene comes from.

use std::borrow::Cow;
use std::cell::RefCell;
use std::fmt;
use std::path::{Path, PathBuf};

use super::state::hash;
use crate::engine::io::{Disk, FileSource, embedded, scene_file};
use crate::engine::scene::SceneDesc;

/// An embedded scene or a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SceneSource {
    /// Id of a scene within the program.
    Embedded(String),
    /// A scene file or mesh.
    File(PathBuf),
}

impl SceneSource {
    /// What a user means by `name`: the id of an embedded scene wins over a file.
    pub fn named(name: &str) -> Self {
        if embedded::contains(name) {
            Self::Embedded(name.to_owned())
        } else {
            Self::File(PathBuf::from(name))
        }
    }

    /// Reads it. Besides the scene it tells which files it is made of, also where it fails: an
    /// error goes away when one of them is mended.
    pub fn read(&self) -> Read {
        self.read_frame(0)
    }

    /// Reads a frame of a sequence; a still has frame 0 only.
    pub fn read_frame(&self, frame: u32) -> Read {
        let path = match self {
            Self::Embedded(id) => {
                return Read {
                    desc: embedded::read_frame(id, frame).map_err(|error| error.to_string()),
                    files: Vec::new(),
                    hash: String::new(),
                };
            }
            Self::File(path) => path.to_string_lossy(),
        };
        let disk = RecordingDisk::default();
        let desc = scene_file::load_frame_from(&disk, &path, frame);
        let desc = desc.map_err(|error| error.to_string());
        let (files, hash) = disk.0.into_inner();
        Read { desc, files, hash }
    }

    /// The file, if it is one.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::Embedded(_) => None,
            Self::File(path) => Some(path),
        }
    }

    /// A short name for titles and proposed file names.
    pub fn short_name(&self) -> String {
        match self {
            Self::Embedded(id) => id.clone(),
            Self::File(path) => {
                let stem = |p: &Path| p.file_stem().map(|s| s.to_string_lossy().into_owned());
                let own = stem(path).unwrap_or_default();
                // Many folders hold a `scene.json`: the folder tells them apart.
                match path.parent().and_then(stem).filter(|_| own == "scene") {
                    Some(folder) => folder,
                    None => own,
                }
            }
        }
    }
}

/// What came of reading.
pub struct Read {
    /// The scene, or a sentence with file and line.
    pub desc: Result<SceneDesc, String>,
    /// The files it is made of, the scene file first.
    pub files: Vec<PathBuf>,
    /// Hash of the scene file.
    pub hash: String,
}

/// The disk, and what was read from it: the files, and the hash of the first.
#[derive(Default)]
struct RecordingDisk(RefCell<(Vec<PathBuf>, String)>);

impl FileSource for RecordingDisk {
    fn read(&self, path: &str) -> std::io::Result<Cow<'_, [u8]>> {
        let bytes = Disk.read(path).map(|bytes| Cow::Owned(bytes.into_owned()));
        let mut record = self.0.borrow_mut();
        if let (Ok(bytes), true) = (&bytes, record.0.is_empty()) {
            record.1 = hash(bytes);
        }
        record.0.push(PathBuf::from(path));
        bytes
    }
}

impl fmt::Display for SceneSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Embedded(id) => f.write_str(id),
            Self::File(path) => write!(f, "{}", path.display()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_files_of_a_scene_are_known() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("tests/reference/cornell-diffuse/scene.json");
        let read = SceneSource::File(path.clone()).read();
        assert!(read.desc.is_ok());
        assert_eq!(read.files[0], path);
        assert!(
            read.files.len() > 1,
            "its meshes are files: {:?}",
            read.files
        );
        assert_eq!(read.hash, hash(&std::fs::read(&path).expect("a file")));
        let missing = SceneSource::File(PathBuf::from("missing.toml")).read();
        assert!(missing.desc.is_err());
        assert_eq!(missing.files, [PathBuf::from("missing.toml")]);
    }

    #[test]
    fn scenes_in_folders_are_told_apart() {
        let name = |path: &str| SceneSource::File(PathBuf::from(path)).short_name();
        assert_eq!(name("a/furnace/scene.json"), "furnace");
        assert_eq!(name("a/bunny.obj"), "bunny");
        assert_eq!(name("scene.json"), "scene");
    }
}
