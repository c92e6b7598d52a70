//! The embedded scenes with pictures.

use egui::{
    Align2, Button, Color32, ColorImage, Image, Key, RichText, ScrollArea, TextureOptions, Ui,
    Window,
};

use crate::engine::io::embedded;
use crate::viewer::source::SceneSource;
use crate::viewer::thumbnails::SIZE;
use crate::viewer::workspace::{Request, Workspace};

/// Pictures a row.
const COLUMNS: usize = 4;

/// Draws the gallery while it is open.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    if !workspace.gallery {
        return;
    }
    let mut open = true;
    let mut chosen = None;
    let height = ui.ctx().content_rect().height() - 100.0;
    Window::new("Scenes")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .show(ui.ctx(), |ui| {
            ScrollArea::vertical()
                .min_scrolled_height(height)
                .max_height(height)
                .show(ui, |ui| {
                    egui::Grid::new("gallery")
                        .spacing([10.0, 10.0])
                        .show(ui, |ui| {
                            for (i, scene) in embedded::all().iter().enumerate() {
                                if card(ui, workspace, scene.id) {
                                    chosen = Some(scene.id);
                                }
                                if i % COLUMNS == COLUMNS - 1 {
                                    ui.end_row();
                                }
                            }
                        });
                });
        });
    if let Some(id) = chosen {
        let source = SceneSource::Embedded(id.to_owned());
        workspace.requests.push(Request::Load(source));
        open = false;
    }
    let escape = ui.input_mut(|i| i.consume_key(egui::Modifiers::NONE, Key::Escape));
    workspace.gallery = open && !escape;
}

/// A picture and its name; true if it was clicked.
fn card(ui: &mut Ui, workspace: &mut Workspace, id: &'static str) -> bool {
    ui.vertical(|ui| {
        ui.set_width(SIZE.x as f32);
        let size = egui::vec2(SIZE.x as f32, SIZE.y as f32);
        let clicked = match texture(ui, workspace, id) {
            Some(texture) => {
                let image = Image::new((texture.id(), size));
                let button = ui.add(Button::image(image).frame(false));
                button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, id));
                button.clicked()
            }
            None => ui.add_sized(size, Button::new(id)).clicked(),
        };
        ui.label(RichText::new(id));
        clicked
    })
    .inner
}

fn texture(ui: &Ui, workspace: &mut Workspace, id: &'static str) -> Option<egui::TextureHandle> {
    if let Some(texture) = workspace.textures.get(id) {
        return Some(texture.clone());
    }
    let thumbnail = workspace.thumbnails.iter().find(|t| t.id == id)?;
    let pixels = thumbnail
        .pixels
        .iter()
        .map(|[r, g, b]| Color32::from_rgb(*r, *g, *b));
    let image = ColorImage::new([SIZE.x as usize, SIZE.y as usize], pixels.collect());
    let texture = ui.ctx().load_texture(id, image, TextureOptions::LINEAR);
    workspace.textures.insert(id, texture.clone());
    Some(texture)
}
