//! Where a scene comes from.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::engine::io::scene_file;
use crate::engine::scene::{SceneDesc, embedded};

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
        if embedded::all().iter().any(|scene| scene.id == name) {
            Self::Embedded(name.to_owned())
        } else {
            Self::File(PathBuf::from(name))
        }
    }

    /// Reads it.
    ///
    /// # Errors
    /// A sentence with file and line.
    pub fn read(&self) -> Result<SceneDesc, String> {
        match self {
            Self::Embedded(id) => embedded::read(id).map_err(|error| error.to_string()),
            Self::File(path) => scene_file::load(path).map_err(|error| error.to_string()),
        }
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
    fn scenes_in_folders_are_told_apart() {
        let name = |path: &str| SceneSource::File(PathBuf::from(path)).short_name();
        assert_eq!(name("a/furnace/scene.json"), "furnace");
        assert_eq!(name("a/bunny.obj"), "bunny");
        assert_eq!(name("scene.json"), "scene");
    }
}
