//! Saving and copying: the part of the program that touches files and the clipboard.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::UVec2;

use super::app::{App, Wake};
use super::export;
use super::saver::{fresh_name, save};
use super::state::{KEY, State};
use super::workspace::Format;
use crate::engine::film::Frame;
use crate::picture::png_file;

impl App {
    /// Saves the picture under a new name in the current folder.
    pub(super) fn save(&mut self, format: Format) {
        let Some(frame) = self.workspace.frame.clone() else {
            self.workspace
                .notices
                .say("There is no picture to save yet.");
            return;
        };
        let extension = match format {
            Format::Png => "png",
            Format::Exr => "exr",
        };
        let path = fresh_name(Path::new(""), &self.workspace.proposed_stem(), extension);
        self.write_picture(path, format, frame);
    }

    /// Saves to a file whose name says the format: a picture, or else the state alone.
    pub(super) fn save_as(&mut self, path: PathBuf) {
        let Some(frame) = self.workspace.frame.clone() else {
            self.workspace
                .notices
                .say("There is no picture to save yet.");
            return;
        };
        let extension = path.extension().map(|e| e.to_ascii_lowercase());
        match extension.as_ref().and_then(|e| e.to_str()) {
            Some("png") => self.write_picture(path, Format::Png, frame),
            Some("exr") => self.write_picture(path, Format::Exr, frame),
            _ => {
                let json = self.state_of(&frame).to_json();
                self.write(path, move || Ok(json.into_bytes()));
            }
        }
    }

    fn state_of(&self, frame: &Frame) -> State {
        let workspace = &self.workspace;
        State::new(
            &workspace.model,
            frame.full_size,
            frame.passes,
            &workspace.scene_hash,
        )
        .of_frame(workspace.sequence.at)
    }

    fn write_picture(&self, path: PathBuf, format: Format, frame: Arc<Frame>) {
        let model = self.workspace.model.clone();
        let state = self.state_of(&frame).to_json();
        match format {
            Format::Png => self.write(path, move || export::png(&frame, &model, state)),
            Format::Exr => self.write(path, move || export::exr(&frame, &model, state)),
        }
    }

    /// Saves a copy of the window.
    pub(super) fn save_window(&mut self, image: &Arc<egui::ColorImage>) {
        let stem = format!("{}-window", self.workspace.model.source.short_name());
        let image = Arc::clone(image);
        let state = self
            .workspace
            .frame
            .as_ref()
            .map(|f| self.state_of(f).to_json());
        let texts: Vec<(String, String)> = state
            .into_iter()
            .map(|state| (KEY.to_owned(), state))
            .collect();
        self.write(fresh_name(Path::new(""), &stem, "png"), move || {
            let [width, height] = image.size;
            let pixels: Vec<[u8; 3]> = image.pixels.iter().map(|p| [p.r(), p.g(), p.b()]).collect();
            let size = UVec2::new(width as u32, height as u32);
            png_file::encode(size, &pixels, &texts).map_err(|error| error.to_string())
        });
    }

    pub(super) fn write(
        &self,
        path: PathBuf,
        bytes: impl FnOnce() -> Result<Vec<u8>, String> + Send + 'static,
    ) {
        let proxy = self.proxy.clone();
        let done = move |result| drop(proxy.send_event(Wake::Saved(result)));
        save(path, bytes, done);
    }

    /// Copies the picture as it is shown.
    pub(super) fn copy(&mut self) {
        let Some(frame) = self.workspace.frame.clone() else {
            self.workspace
                .notices
                .say("There is no picture to copy yet.");
            return;
        };
        let (size, pixels) = export::shown(&frame, &self.workspace.model.display);
        let bytes: Vec<u8> = pixels
            .iter()
            .flat_map(|[r, g, b]| [*r, *g, *b, 255])
            .collect();
        let image = arboard::ImageData {
            width: size.x as usize,
            height: size.y as usize,
            bytes: Cow::Owned(bytes),
        };
        let copied = match &mut self.clipboard {
            Some(clipboard) => clipboard.set_image(image),
            None => arboard::Clipboard::new().and_then(|mut clipboard| {
                let copied = clipboard.set_image(image);
                // On X11 the owner of the clipboard must live on.
                self.clipboard = Some(clipboard);
                copied
            }),
        };
        match copied {
            Ok(()) => self.workspace.notices.say("Copied the picture."),
            Err(error) => {
                let sentence = format!("The picture cannot be copied: {error}");
                self.workspace.notices.set_error("copy", sentence);
            }
        }
    }
}
