//! A state: all that makes the picture, as JSON. It is a file of its own, and a text in every
//! saved picture; restoring it renders the same bits again.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::{UVec2, Vec3};
use serde::{Deserialize, Serialize};

use super::display::{Display, EXPOSURES, PARTS, Shown};
use super::model::{MAX_PIXELS, Model, PictureSize, SIDES};
use super::source::SceneSource;
use crate::engine::film::ToneMap;
use crate::engine::integrators::{self, Params};
use crate::engine::path::{Expression, ExpressionError};
use crate::engine::plan::LayerSettings;
use crate::engine::scene::desc::{CameraDesc, LensDesc};
use crate::engine::session::Settings;

/// Name of the text in PNG and EXR files.
pub const KEY: &str = "lightscope:state";
/// The only format there is so far.
const FORMAT: u32 = 1;

/// All that makes the picture, as it is written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct State {
    /// The format; a file with this field is a state and no scene.
    lightscope: u32,
    version: String,
    scene: SavedScene,
    /// Which frame of a sequence.
    #[serde(default, skip_serializing_if = "is_first")]
    frame: u32,
    camera: SavedCamera,
    size: [u32; 2],
    integrator: String,
    parameters: BTreeMap<String, String>,
    max_depth: Option<u32>,
    expressions: Vec<String>,
    /// The whole and the components were left out.
    #[serde(default)]
    only_expressions: bool,
    display: SavedDisplay,
    seed: u64,
    passes: u64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, deny_unknown_fields)]
enum SavedScene {
    Embedded { id: String },
    File { path: PathBuf, hash: String },
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SavedCamera {
    position: Vec3,
    target: Vec3,
    up: Vec3,
    vfov_deg: f32,
    lens: Option<SavedLens>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SavedLens {
    radius: f32,
    focus_distance: f32,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SavedDisplay {
    shown: SavedShown,
    exposure: f32,
    part_exposure: [f32; PARTS],
    tonemap: String,
    false_color: bool,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum SavedShown {
    Whole,
    Parts([bool; PARTS]),
    Grid,
    Expression(u8),
}

/// FNV-1a over 64 bits, in hexadecimal: tells whether a scene file has changed.
pub fn hash(bytes: &[u8]) -> String {
    let step = |h: u64, b: &u8| (h ^ u64::from(*b)).wrapping_mul(0x0000_0100_0000_01b3);
    format!("{:016x}", bytes.iter().fold(0xcbf2_9ce4_8422_2325, step))
}

impl State {
    /// The state of a picture of `size` pixels after `passes` passes. `scene_hash` is that of the
    /// scene file as it was read.
    pub fn new(model: &Model, size: UVec2, passes: u64, scene_hash: &str) -> Self {
        let settings = &model.settings;
        let text =
            |(name, value): (&str, &integrators::ParamValue)| (name.to_owned(), value.to_string());
        let expressions = settings.layers.expressions.iter();
        Self {
            lightscope: FORMAT,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scene: SavedScene::new(&model.source, scene_hash),
            frame: 0,
            camera: SavedCamera::new(&model.view),
            size: size.to_array(),
            integrator: settings.integrator.id.to_owned(),
            parameters: settings.params.iter().map(text).collect(),
            max_depth: settings.layers.max_depth,
            expressions: expressions.map(|e| e.text().to_owned()).collect(),
            only_expressions: settings.layers.no_whole,
            display: SavedDisplay::new(&model.display),
            seed: settings.seed,
            passes,
        }
    }

    /// The same of a frame of a sequence.
    pub fn of_frame(self, frame: u32) -> Self {
        Self { frame, ..self }
    }

    /// Which frame of a sequence; of stills the only one, 0.
    pub fn frame(&self) -> u32 {
        self.frame
    }

    /// As it is written.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    /// Reads it.
    ///
    /// # Errors
    /// A sentence with the line.
    pub fn from_json(text: &str) -> Result<Self, String> {
        let state: Self = serde_json::from_str(text)
            .map_err(|error| format!("this is no state that can be read: {error}"))?;
        if state.lightscope != FORMAT {
            return Err(format!(
                "its format is {}, and only {FORMAT} is known: a newer version wrote it",
                state.lightscope
            ));
        }
        Ok(state)
    }

    /// Where its scene comes from. A file that moved along with the one that holds the state, at
    /// `beside`, is found there.
    pub fn source(&self, beside: Option<&Path>) -> SceneSource {
        match &self.scene {
            SavedScene::Embedded { id } => SceneSource::Embedded(id.clone()),
            SavedScene::File { path, .. } => {
                let folder = beside.and_then(Path::parent);
                let moved = folder
                    .zip(path.file_name())
                    .map(|(folder, name)| folder.join(name));
                let here = moved.filter(|moved| !path.exists() && moved.exists());
                SceneSource::File(here.unwrap_or_else(|| path.clone()))
            }
        }
    }

    /// Hash of the scene file as it was.
    pub fn scene_hash(&self) -> Option<&str> {
        match &self.scene {
            SavedScene::Embedded { .. } => None,
            SavedScene::File { hash, .. } => Some(hash),
        }
    }

    /// Puts everything but the scene into `model`.
    ///
    /// # Errors
    /// A sentence that says which part cannot be used; `model` is then as it was.
    pub fn restore(&self, model: &mut Model) -> Result<(), String> {
        let settings = self.settings()?;
        let display = self.display.restored()?;
        let size = UVec2::from_array(self.size);
        let sides = size.to_array().iter().all(|side| SIDES.contains(side));
        if !sides || u64::from(size.x) * u64::from(size.y) > MAX_PIXELS {
            return Err(format!(
                "a picture of {} × {} pixels cannot be made",
                size.x, size.y
            ));
        }
        if let Shown::Expression(i) = display.shown
            && usize::from(i) >= settings.layers.expressions.len()
        {
            return Err(format!(
                "there is no expression number {}",
                u32::from(i) + 1
            ));
        }
        let mut restored = model.clone();
        restored.view = self.camera.restored(&model.view);
        restored.size = PictureSize::Fixed(size);
        restored.settings = settings;
        restored.display = display;
        restored.camera(size)?;
        *model = restored;
        Ok(())
    }

    fn settings(&self) -> Result<Settings, String> {
        let integrator = integrators::find(&self.integrator)
            .ok_or_else(|| format!("there is no integrator \"{}\"", self.integrator))?;
        let mut params = Params::defaults(integrator.params);
        for (name, value) in &self.parameters {
            params.set(integrator.params, name, value)?;
        }
        let expressions: Result<Vec<Expression>, ExpressionError> =
            self.expressions.iter().map(|text| text.parse()).collect();
        Ok(Settings {
            integrator,
            params,
            layers: LayerSettings {
                components: !self.only_expressions,
                no_whole: self.only_expressions,
                max_depth: self.max_depth,
                expressions: expressions.map_err(|error| error.to_string())?,
            },
            seed: self.seed,
        })
    }
}

fn is_first(frame: &u32) -> bool {
    *frame == 0
}

impl SavedScene {
    fn new(source: &SceneSource, hash: &str) -> Self {
        match source {
            SceneSource::Embedded(id) => Self::Embedded { id: id.clone() },
            SceneSource::File(path) => Self::File {
                // The picture may be opened from another folder.
                path: std::path::absolute(path).unwrap_or_else(|_| path.clone()),
                hash: hash.to_owned(),
            },
        }
    }
}

impl SavedCamera {
    fn new(view: &CameraDesc) -> Self {
        Self {
            position: view.position,
            target: view.target,
            up: view.up,
            vfov_deg: view.vfov_deg,
            lens: view.lens.map(|lens| SavedLens {
                radius: lens.radius,
                focus_distance: lens.focus_distance,
            }),
        }
    }

    fn restored(&self, view: &CameraDesc) -> CameraDesc {
        CameraDesc {
            position: self.position,
            target: self.target,
            up: self.up,
            vfov_deg: self.vfov_deg,
            lens: self.lens.as_ref().map(|lens| LensDesc {
                radius: lens.radius,
                focus_distance: lens.focus_distance,
            }),
            ..*view
        }
    }
}

impl SavedDisplay {
    fn new(display: &Display) -> Self {
        Self {
            shown: match display.shown {
                Shown::Whole => SavedShown::Whole,
                Shown::Parts(on) => SavedShown::Parts(on),
                Shown::Grid => SavedShown::Grid,
                Shown::Expression(i) => SavedShown::Expression(i),
            },
            exposure: display.exposure,
            part_exposure: display.part_exposure,
            tonemap: display.tonemap.id().to_owned(),
            false_color: display.false_color,
        }
    }

    fn restored(&self) -> Result<Display, String> {
        let tonemap = ToneMap::find(&self.tonemap)
            .ok_or_else(|| format!("there is no tone map \"{}\"", self.tonemap))?;
        let mut exposures = self.part_exposure.iter().chain([&self.exposure]);
        if !exposures.all(|ev| EXPOSURES.contains(ev)) {
            return Err("an exposure lies outside −16 to 16 stops".to_owned());
        }
        Ok(Display {
            shown: match self.shown {
                SavedShown::Whole => Shown::Whole,
                SavedShown::Parts(on) => Shown::Parts(on),
                SavedShown::Grid => Shown::Grid,
                SavedShown::Expression(i) => Shown::Expression(i),
            },
            exposure: self.exposure,
            part_exposure: self.part_exposure,
            tonemap,
            false_color: self.false_color,
        })
    }
}

#[cfg(test)]
mod tests;
