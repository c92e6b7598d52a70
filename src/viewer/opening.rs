//! What a name on the command line, a chosen file or a dropped one holds: a scene, or a state.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use super::source::{Read, SceneSource};
use super::state::{KEY, State};
use crate::picture::{exr_file, png_file};

/// Something to be shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Opening {
    /// The scene.
    pub source: SceneSource,
    /// Which frame of it, if it is a sequence.
    pub frame: u32,
    /// All the rest, where a state says it.
    pub state: Option<Box<State>>,
}

impl Opening {
    /// What a user means by `name`.
    ///
    /// # Errors
    /// A sentence, if a picture holds no state, or a state cannot be read. Scenes are not read
    /// here.
    pub fn named(name: &str) -> Result<Self, String> {
        match SceneSource::named(name) {
            SceneSource::File(path) => Self::file(&path),
            source => Ok(Self::scene(source)),
        }
    }

    /// A scene with the settings there are.
    pub fn scene(source: SceneSource) -> Self {
        Self::of_frame(source, 0)
    }

    /// A frame of a sequence with the settings there are.
    pub fn of_frame(source: SceneSource, frame: u32) -> Self {
        Self {
            source,
            frame,
            state: None,
        }
    }

    /// Reads the scene.
    pub fn read(&self) -> Read {
        self.source.read_frame(self.frame)
    }

    /// What a file holds.
    ///
    /// # Errors
    /// As [`Self::named`].
    pub fn file(path: &Path) -> Result<Self, String> {
        let extension = path.extension().map(|e| e.to_ascii_lowercase());
        let text = match extension.as_ref().and_then(|e| e.to_str()) {
            Some("png") => Some(png_text(path)?),
            Some("exr") => Some(exr_text(path)?),
            Some("json") => json_state(path),
            _ => None,
        };
        let Some(text) = text else {
            return Ok(Self::scene(SceneSource::File(path.to_owned())));
        };
        let state = State::from_json(&text).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(Self {
            source: state.source(Some(path)),
            frame: state.frame(),
            state: Some(Box::new(state)),
        })
    }
}

fn png_text(path: &Path) -> Result<String, String> {
    let file = File::open(path).map_err(|error| format!("{}: {error}", path.display()))?;
    png_file::read_text(BufReader::new(file), KEY).ok_or_else(|| no_state(path))
}

fn exr_text(path: &Path) -> Result<String, String> {
    exr_file::read_text(path, KEY).ok_or_else(|| no_state(path))
}

fn no_state(path: &Path) -> String {
    format!(
        "{} holds no state: only pictures that this program saved say what makes them",
        path.display()
    )
}

/// The text of a JSON file, if it is a state and no scene.
fn json_state(path: &Path) -> Option<String> {
    // What cannot be read is told by the scene's reader.
    let text = std::fs::read_to_string(path).ok()?;
    let value: serde_json::Value = serde_json::from_str(&text).ok()?;
    value.get("lightscope")?;
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::viewer::model::Model;
    use glam::UVec2;

    #[test]
    fn states_are_found_in_json_png_and_exr() {
        let folder = tempfile::tempdir().expect("a folder");
        let model = Model::new(SceneSource::Embedded("jensen-box".to_owned()));
        let state = State::new(&model, UVec2::new(2, 1), 3, "");
        let texts = [(KEY.to_owned(), state.to_json())];
        let size = UVec2::new(2, 1);
        let png = png_file::encode(size, &[[0; 3]; 2], &texts).expect("a PNG");
        let exr = exr_file::encode(size, &[("whole", &[[0.0; 3]; 2])], &texts).expect("an EXR");
        let expected = Opening {
            source: model.source.clone(),
            frame: 0,
            state: Some(Box::new(state)),
        };
        for (name, bytes) in [
            ("a.json", texts[0].1.as_bytes().to_vec()),
            ("a.png", png),
            ("a.EXR", exr),
        ] {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).expect("a file");
            assert_eq!(Opening::file(&path).as_ref(), Ok(&expected), "{name}");
        }
    }

    #[test]
    fn scenes_are_no_states_and_strange_pictures_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let scene = folder.path().join("scene.json");
        std::fs::write(&scene, "{\"camera\": {}}").expect("a file");
        let opening = Opening::file(&scene).expect("a scene");
        assert_eq!(opening, Opening::scene(SceneSource::File(scene)));
        let png = folder.path().join("a.png");
        let bytes = png_file::encode(UVec2::ONE, &[[0; 3]], &[]).expect("a PNG");
        std::fs::write(&png, bytes).expect("a file");
        let error = Opening::file(&png).expect_err("no state");
        assert!(error.contains("a.png holds no state"), "{error}");
        assert!(Opening::file(&folder.path().join("missing.exr")).is_err());
    }
}
