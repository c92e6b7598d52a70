//! Everything the window knows, without threads, files or graphics: panels read and change it,
//! the program around it carries out what it asks for.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{UVec2, Vec2};

use super::balance::Balance;
use super::browser::{Browser, Purpose};
use super::commands::Command;
use super::display::{EXPOSURES, Shown};
use super::exposure::auto_exposure;
use super::gpu::{Placement, picture_point};
use super::history::History;
use super::measuring::Measuring;
use super::model::Model;
use super::navigation;
use super::notices::Notices;
use super::opening::Opening;
use super::photons::Photons;
use super::preferences::Preferences;
use super::sequence::Sequence;
use super::source::SceneSource;
use super::thumbnails::Thumbnail;
use crate::engine::film::{Frame, ToneMap};
use crate::engine::path::{Expression, PathClasses};
use crate::engine::scene::Scene;

/// All light that a medium scatters.
pub const VOLUME: &str = "L.*V.*E";
/// Largest magnification: a pixel is then larger than its numbers.
const MAX_ZOOM: f32 = 256.0;

/// What the program around the workspace is asked to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Read a scene.
    Load(SceneSource),
    /// Read a file: a scene, a state or a picture that holds one.
    Open(PathBuf),
    /// Save to a file whose name says the format.
    SaveAs(PathBuf),
    /// Read the scene again.
    Reload,
    /// Read a frame of the sequence.
    Frame(u32),
    /// Save under a new name.
    Save(Format),
    /// Save the plot of errors under a new name that ends so: png, svg or csv.
    SavePlot(&'static str),
    /// Save the whole window.
    SaveWindow,
    /// Copy the picture to the clipboard.
    Copy,
    /// Fill the screen, or leave it.
    FullScreen,
    /// Close.
    Quit,
}

impl Request {
    /// Whether it takes the picture away.
    pub fn needs_picture(&self) -> bool {
        matches!(self, Self::Save(_) | Self::SaveAs(_) | Self::Copy)
    }
}

/// What is saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// The picture as shown.
    Png,
    /// Radiance and layers.
    Exr,
}

/// A button that was pressed on the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// The button.
    pub button: egui::PointerButton,
    /// Where the pointer is, in points.
    pub at: egui::Pos2,
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
    /// Sum of the typed expressions against the whole.
    pub typed_balance: Balance,
    /// What is being typed into the field of expressions.
    pub expression_text: String,
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
    /// Bytes of the picture on the graphics card.
    pub gpu_bytes: u64,
    /// The hand is on the camera.
    pub navigating: bool,
    /// The button that moves the camera.
    pub hold: Option<Hold>,
    /// The keys that fly and are held.
    pub flying: Vec<egui::Key>,
    /// The render stands still.
    pub paused: bool,
    /// Which frame of a sequence is shown.
    pub sequence: Sequence,
    /// How the picture lies in its area.
    pub placement: Placement,
    /// The help overlay is shown.
    pub help: bool,
    /// The gallery is shown.
    pub gallery: bool,
    /// Its pictures, as far as they are rendered.
    pub thumbnails: Vec<Thumbnail>,
    /// Its pictures on the graphics card.
    pub textures: BTreeMap<&'static str, egui::TextureHandle>,
    /// The values under the cursor are shown.
    pub inspector: bool,
    /// What is shown of photon maps.
    pub photons: Photons,
    /// How wrong the picture is.
    pub measuring: Measuring,
    /// A file is being chosen.
    pub browser: Option<Browser>,
    /// Hash of the scene file as it was read.
    pub scene_hash: String,
    /// What is remembered.
    pub preferences: Preferences,
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
            typed_balance: Balance::default(),
            expression_text: String::new(),
            notices: Notices::default(),
            loading: None,
            requests: Vec::new(),
            area: UVec2::ZERO,
            max_pixels: u64::MAX,
            gpu_bytes: 0,
            navigating: false,
            hold: None,
            flying: Vec::new(),
            paused: false,
            sequence: Sequence::default(),
            placement: Placement::default(),
            help: false,
            gallery: false,
            thumbnails: Vec::new(),
            textures: BTreeMap::new(),
            inspector: false,
            photons: Photons::default(),
            measuring: Measuring::default(),
            browser: None,
            scene_hash: String::new(),
            preferences: Preferences::default(),
        }
    }

    /// Pixels of the picture.
    pub fn pixels(&self) -> UVec2 {
        self.model.pixels(self.area, self.max_pixels)
    }

    /// Shows another scene, or the same one read again, `hash` being that of its file.
    pub fn show_scene(&mut self, opening: Opening, scene: Arc<Scene>, again: bool, hash: String) {
        self.notices.clear_error("scene");
        if !again || self.model.home != scene.camera {
            self.model.view = scene.camera;
        }
        self.model.home = scene.camera;
        self.model.source = opening.source;
        if !again {
            self.sequence = Sequence::default();
        }
        self.sequence.show(opening.frame, self.frame_number);
        self.scene = Some(scene);
        self.scene_hash = hash;
        if let Some(path) = self.model.source.path() {
            self.preferences.opened(path);
        }
        if let Some(state) = opening.state {
            if state.scene_hash().is_some_and(|h| h != self.scene_hash) {
                let text = "The scene file has changed since this picture was saved.";
                self.notices.say(text);
            }
            match state.restore(&mut self.model) {
                Ok(()) => {}
                Err(why) => self
                    .notices
                    .set_error("scene", format!("The state cannot be restored: {why}.")),
            }
        }
        if !again {
            self.placement = Placement::default();
            self.photons.found = None;
            self.history = History::new(&self.model);
        }
    }

    /// Lets the user choose a file.
    pub fn choose_file(&mut self, purpose: Purpose) {
        let name = match purpose {
            Purpose::Open | Purpose::Reference => String::new(),
            Purpose::Save => format!("{}.png", self.proposed_stem()),
        };
        let recent = self
            .preferences
            .recent
            .first()
            .and_then(|path| path.parent());
        let folder = match purpose {
            Purpose::Open | Purpose::Reference => recent.unwrap_or(Path::new(".")).to_owned(),
            Purpose::Save => PathBuf::from("."),
        };
        self.browser = Some(Browser::new(purpose, &folder, &name));
    }

    /// Start of the names that are proposed for files.
    pub fn proposed_stem(&self) -> String {
        let passes = self.frame.as_ref().map_or(0, |frame| frame.passes);
        format!("{}-{passes}spp", self.model.source.short_name())
    }

    /// Gives the paths of an expression a layer, and shows it.
    pub fn add_expression(&mut self, expression: Expression) {
        let list = &mut self.model.settings.layers.expressions;
        let known = list.iter().position(|e| e.text() == expression.text());
        let at = known.unwrap_or_else(|| {
            list.push(expression);
            list.len() - 1
        });
        self.show_expression(Some(at));
    }

    /// Shows an expression alone, or the whole.
    pub fn show_expression(&mut self, number: Option<usize>) {
        let shown = number.and_then(|i| u8::try_from(i).ok());
        self.model.display.shown = shown.map_or(Shown::Whole, Shown::Expression);
    }

    /// Shows the light that a medium scatters alone, or the whole.
    fn toggle_volume(&mut self) {
        if !self.scene.as_ref().is_some_and(|s| s.features.volume) {
            self.notices
                .say("Nothing in this scene scatters light in a volume.");
            return;
        }
        if self.shows_volume() {
            return self.show_expression(None);
        }
        let Ok(volume) = VOLUME.parse::<Expression>() else {
            return;
        };
        let mut all = self.model.settings.layers.expressions.clone();
        all.push(volume.clone());
        match PathClasses::with_components(&all) {
            Ok(_) => self.add_expression(volume),
            Err(error) => self.notices.say(format!("{}.", error.message)),
        }
    }

    /// Whether the light that a medium scatters is shown alone.
    pub fn shows_volume(&self) -> bool {
        let list = &self.model.settings.layers.expressions;
        let at = list.iter().position(|e| e.text() == VOLUME);
        at.is_some_and(|i| self.model.display.shown == Shown::Expression(i as u8))
    }

    /// Takes an expression's layer away.
    pub fn remove_expression(&mut self, number: usize) {
        self.model.settings.layers.expressions.remove(number);
        if let Shown::Expression(i) = self.model.display.shown {
            let i = usize::from(i);
            let left = (i != number).then(|| i - usize::from(i > number));
            self.show_expression(left);
        }
    }

    /// Leaves out the whole and the components, or computes them again.
    pub fn compute_only_expressions(&mut self, only: bool) {
        let layers = &mut self.model.settings.layers;
        layers.no_whole = only;
        layers.components = !only;
        if only && !matches!(self.model.display.shown, Shown::Expression(_)) {
            self.show_expression(Some(0));
        }
    }

    /// Computes again what is shown: neither the whole nor a component is there while only
    /// expressions are computed.
    pub fn settle(&mut self) {
        let shows_expression = matches!(self.model.display.shown, Shown::Expression(_));
        if self.model.settings.layers.no_whole && !shows_expression {
            self.compute_only_expressions(false);
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

    /// Magnifies the picture's pixels by `factor` about a point of its area in physical pixels.
    pub fn magnify(&mut self, factor: f32, at: Vec2) {
        let zoom = (self.placement.zoom * factor).clamp(1.0, MAX_ZOOM);
        let full = self.pixels();
        let (display, area) = (&self.model.display, self.area);
        let Some(before) = picture_point(display, self.placement, area, full, at) else {
            return;
        };
        self.placement.zoom = zoom;
        if zoom == 1.0 {
            self.placement = Placement::default();
        } else if let Some(after) = picture_point(display, self.placement, area, full, at) {
            self.placement.center += (before - after) / full.as_vec2();
        }
    }

    /// Moves the magnified picture with the hand, by physical pixels.
    pub fn move_pixels(&mut self, by: Vec2) {
        let share = if self.model.display.shown == Shown::Grid {
            0.5
        } else {
            1.0
        };
        let fit = (self.area.as_vec2() * share / self.pixels().as_vec2()).min_element();
        let shift = by / (fit * self.placement.zoom) / self.pixels().as_vec2();
        self.placement.center = (self.placement.center - shift).clamp(Vec2::ZERO, Vec2::ONE);
        if self.placement.zoom == 1.0 {
            self.placement = Placement::default();
        }
    }

    /// True while a lower resolution stands in for the picture.
    pub fn is_coarse(&self) -> bool {
        self.frame.as_ref().is_some_and(|frame| frame.is_coarse())
    }

    /// Takes a frame over; a failed one says why and leaves the old picture.
    pub fn show_frame(&mut self, frame: Arc<Frame>) {
        if let Some(error) = &frame.error {
            self.notices.set_error("render", error.clone());
            return;
        }
        self.notices.clear_error("render");
        // Between two frames of a sequence the last one is the better picture.
        if self.sequence.plays && frame.is_coarse() && !self.navigating {
            return;
        }
        self.balance = Balance::of_components(&frame);
        self.typed_balance = Balance::of_expressions(&frame);
        self.frame = Some(frame);
        self.frame_number += 1;
    }

    /// Carries out a command.
    pub fn run(&mut self, command: Command) {
        match command {
            Command::Open => self.choose_file(Purpose::Open),
            Command::SaveAs => self.choose_file(Purpose::Save),
            Command::Gallery => self.gallery = !self.gallery,
            Command::Inspector => self.inspector = !self.inspector,
            Command::ZoomOut => self.placement = Placement::default(),
            Command::Reload => self.requests.push(Request::Reload),
            Command::SavePng => self.requests.push(Request::Save(Format::Png)),
            Command::SaveExr => self.requests.push(Request::Save(Format::Exr)),
            Command::SaveWindow => self.requests.push(Request::SaveWindow),
            Command::Copy => self.requests.push(Request::Copy),
            Command::FullScreen => self.requests.push(Request::FullScreen),
            Command::Quit => self.requests.push(Request::Quit),
            Command::Undo => self.history.undo(&mut self.model),
            Command::Redo => self.history.redo(&mut self.model),
            Command::Volume => self.toggle_volume(),
            Command::Home => self.model.view = self.model.home,
            Command::Pause => self.paused = !self.paused,
            Command::ErrorPlot => self.measuring.large = !self.measuring.large,
            Command::Panel => self.preferences.panel = !self.preferences.panel,
            Command::Help => self.help = !self.help,
            Command::Theme => self.preferences.dark = !self.preferences.dark,
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
