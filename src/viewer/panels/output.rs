//! Size of the picture, and taking it away.

use egui::Ui;
use glam::UVec2;

use super::widgets;
use crate::viewer::commands::Command;
use crate::viewer::model::{PictureSize, SIDES};
use crate::viewer::workspace::Workspace;

/// Draws the controls.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    size(ui, workspace);
    ui.horizontal_wrapped(|ui| {
        for command in [
            Command::SavePng,
            Command::SaveExr,
            Command::SaveAs,
            Command::Copy,
            Command::SaveWindow,
        ] {
            widgets::command(ui, workspace, command);
        }
    });
}

fn size(ui: &mut Ui, workspace: &mut Workspace) {
    let doc = "Render a picture of a size of its own. Off: as many pixels as the window has.";
    let pixels = workspace.pixels();
    let mut fixed = workspace.model.size != PictureSize::Window;
    ui.horizontal(|ui| {
        if ui
            .checkbox(&mut fixed, "Fixed size")
            .on_hover_text(doc)
            .changed()
        {
            workspace.model.size = if fixed {
                PictureSize::Fixed(pixels)
            } else {
                PictureSize::Window
            };
        }
        let PictureSize::Fixed(UVec2 { x, y }) = &mut workspace.model.size else {
            ui.weak(format!("{} × {}", pixels.x, pixels.y));
            return;
        };
        for (name, side) in [("width", x), ("height", y)] {
            let doc = format!("Pixels of the picture's {name}. From 1 to 16384.");
            widgets::number(ui, name, &doc, side, |drag| drag.range(SIDES));
        }
    });
}
