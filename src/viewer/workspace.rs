//! Everything the window knows, without threads, files or graphics: panels read and change it,
//! the program around it carries out what it asks for.

use std::sync::Arc;

use glam::UVec2;

use super::balance::Balance;
use super::commands::Command;
use super::display::{EXPOSURES, Shown};
use super::exposure::auto_exposure;
use super::gpu::Placement;
use super::history::History;
use super::model::Model;
use super::navigation;
use super::notices::Notices;
use super::source::SceneSource;
use crate::engine::film::{Frame, ToneMap};
use crate::engine::scene::Scene;

/// What the program around the workspace is asked to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Read a scene.
    Load(SceneSource),
    /// Read the scene again.
    Reload,
    /// Save under a new name.
    Save(Format),
    /// Save the whole window.
    SaveWindow,
    /// Copy the picture to the clipboard.
    Copy,
    /// Fill the screen, or leave it.
    FullScreen,
    /// Close.
    Quit,
}

/// What is saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// The picture as shown.
    Png,
    /// Radiance and layers.
    Exr,
}

/// The state of the window.
pub struct Workspace {
    /// All that makes the picture.
    pub model: Model,
    /// The scene, once it is read.
    pub scene: Option<Arc<Scene>>,
    /// The frame that is shown.
    pub frame: Option<Arc<Frame>>,
    /// Counts frames, so that each is uploaded once.
    pub frame_number: u64,
    /// Sum of parts against the whole.
    pub balance: Balance,
    /// Undo and redo.
    pub history: History,
    /// Sentences for the user.
    pub notices: Notices,
    /// What is being read.
    pub loading: Option<SceneSource>,
    /// Requests of this repaint.
    pub requests: Vec<Request>,
    /// Physical pixels of the picture's area.
    pub area: UVec2,
    /// Most pixels the graphics card holds.
    pub max_pixels: u64,
    /// The hand is on the camera.
    pub navigating: bool,
    /// The render stands still.
    pub paused: bool,
    /// How the picture lies in its area.
    pub placement: Placement,
    /// The panel is shown.
    pub panel: bool,
    /// The help overlay is shown.
    pub help: bool,
    /// The dark theme is chosen.
    pub dark: bool,
}

impl Workspace {
    /// Nothing read yet.
    pub fn new(source: SceneSource) -> Self {
        let model = Model::new(source);
        Self {
            history: History::new(&model),
            model,
            scene: None,
            frame: None,
            frame_number: 0,
            balance: Balance::default(),
            notices: Notices::default(),
            loading: None,
            requests: Vec::new(),
            area: UVec2::ZERO,
            max_pixels: u64::MAX,
            navigating: false,
            paused: false,
            placement: Placement::default(),
            panel: true,
            help: false,
            dark: true,
        }
    }

    /// Pixels of the picture.
    pub fn pixels(&self) -> UVec2 {
        self.model.pixels(self.area, self.max_pixels)
    }

    /// Shows another scene, or the same one read again.
    pub fn show_scene(&mut self, source: SceneSource, scene: Arc<Scene>, again: bool) {
        self.notices.clear_error("scene");
        if !again || self.model.home != scene.camera {
            self.model.view = scene.camera;
        }
        self.model.home = scene.camera;
        self.model.source = source;
        self.scene = Some(scene);
        if !again {
            self.placement = Placement::default();
            self.history = History::new(&self.model);
        }
    }

    /// To be called before the hand moves the camera.
    pub fn take_hold(&mut self) {
        self.navigating = true;
        // The view the scene opens with is rendered as it is written, until it is moved.
        if self.model.view == self.model.home
            && let Some(scene) = &self.scene
        {
            let (center, radius) = scene.geometry.bounding_sphere();
            self.model.view = navigation::with_target_in(&self.model.view, center.into(), radius);
        }
    }

    /// Takes a frame over; a failed one says why and leaves the old picture.
    pub fn show_frame(&mut self, frame: Arc<Frame>) {
        if let Some(error) = &frame.error {
            self.notices.set_error("render", error.clone());
            return;
        }
        self.notices.clear_error("render");
        self.balance.update(&frame);
        self.frame = Some(frame);
        self.frame_number += 1;
    }

    /// Carries out a command.
    pub fn run(&mut self, command: Command) {
        match command {
            Command::Reload => self.requests.push(Request::Reload),
            Command::SavePng => self.requests.push(Request::Save(Format::Png)),
            Command::SaveExr => self.requests.push(Request::Save(Format::Exr)),
            Command::SaveWindow => self.requests.push(Request::SaveWindow),
            Command::Copy => self.requests.push(Request::Copy),
            Command::FullScreen => self.requests.push(Request::FullScreen),
            Command::Quit => self.requests.push(Request::Quit),
            Command::Undo => self.history.undo(&mut self.model),
            Command::Redo => self.history.redo(&mut self.model),
            Command::Home => self.model.view = self.model.home,
            Command::Pause => self.paused = !self.paused,
            Command::Panel => self.panel = !self.panel,
            Command::Help => self.help = !self.help,
            Command::Theme => self.dark = !self.dark,
            Command::Whole
            | Command::Solo(_)
            | Command::Grid
            | Command::FalseColor
            | Command::Brighter
            | Command::Darker
            | Command::AutoExposure
            | Command::NextToneMap => self.change_display(command),
        }
    }

    fn change_display(&mut self, command: Command) {
        let display = &mut self.model.display;
        let expose = |ev: f32| ev.clamp(*EXPOSURES.start(), *EXPOSURES.end());
        match command {
            Command::Whole => display.shown = Shown::Whole,
            Command::Solo(part) => display.shown = display.shown.soloed(part),
            Command::Grid if display.shown == Shown::Grid => display.shown = Shown::Whole,
            Command::Grid => display.shown = Shown::Grid,
            Command::FalseColor => display.false_color = !display.false_color,
            Command::Brighter => display.exposure = expose(display.exposure + 1.0 / 3.0),
            Command::Darker => display.exposure = expose(display.exposure - 1.0 / 3.0),
            Command::NextToneMap => {
                let all = ToneMap::ALL;
                let at = all.iter().position(|m| *m == display.tonemap).unwrap_or(0);
                display.tonemap = all[(at + 1) % all.len()];
            }
            Command::AutoExposure => {
                let tiles = display.tiles();
                let layers: Vec<usize> = tiles.iter().flat_map(|t| t.layers.clone()).collect();
                let found = self.frame.as_ref().and_then(|f| auto_exposure(f, &layers));
                if let Some(ev) = found {
                    display.exposure = expose(ev);
                }
            }
            _ => {}
        }
    }
}
