//! Errors and messages, on the picture.

use egui::{Align2, Area, Id, RichText, Ui, vec2};

use super::style;
use crate::viewer::workspace::Workspace;

/// Distance from the corner in points.
const MARGIN: f32 = 12.0;
/// Height of the status line in points.
const STATUS: f32 = 28.0;
/// Widest in points.
const WIDTH: f32 = 460.0;

/// Draws what there is to say, bottom left.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    let errors = workspace.notices.errors().to_vec();
    let messages: Vec<String> = workspace.notices.messages().map(str::to_owned).collect();
    if errors.is_empty() && messages.is_empty() {
        return;
    }
    let mut read = None;
    Area::new(Id::unique("notices"))
        .anchor(Align2::LEFT_BOTTOM, vec2(MARGIN, -MARGIN - STATUS))
        .show(ui.ctx(), |ui| {
            ui.set_max_width(WIDTH.min(ui.ctx().content_rect().width() - 2.0 * MARGIN));
            for (subject, sentence) in &errors {
                style::overlay_frame().show(ui, |ui| {
                    ui.horizontal_top(|ui| {
                        if ui.small_button("Dismiss").clicked() {
                            read = Some(*subject);
                        }
                        let color = egui::Color32::from_rgb(255, 170, 140);
                        ui.add(egui::Label::new(RichText::new(sentence).color(color)).wrap());
                    });
                });
            }
            for message in &messages {
                style::overlay_frame().show(ui, |ui| {
                    let text = RichText::new(message).color(egui::Color32::WHITE);
                    ui.add(egui::Label::new(text).wrap());
                });
            }
        });
    if let Some(subject) = read {
        workspace.notices.clear_error(subject);
    }
}
