//! All keys and what the mouse does, over the picture.

use egui::{Align2, Grid, RichText, Ui, Window};

use crate::viewer::commands::TABLE;
use crate::viewer::workspace::Workspace;

/// What the mouse and the flying keys do.
pub const HANDS: [(&str, &str); 10] = [
    ("Left drag", "Orbit about the target"),
    ("Middle or right drag, Shift + left drag", "Pan"),
    ("Wheel, pinch", "Dolly toward the cursor"),
    (
        "Double click",
        "Focus: the point becomes target and centre of orbits",
    ),
    ("W A S D", "Fly forward, left, back, right"),
    ("Q E", "Fly down, up"),
    ("Left drag while flying", "Look around"),
    ("Shift while flying", "Four times as fast"),
    ("Ctrl + wheel", "Magnify the pixels under the cursor"),
    ("Ctrl + drag", "Move the magnified picture"),
];

/// Draws the overlay.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    if !workspace.help {
        return;
    }
    let mut open = true;
    let height = ui.ctx().content_rect().height() - 80.0;
    Window::new("Keys and mouse")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .max_height(height)
        .default_height(height)
        .vscroll(true)
        .show(ui.ctx(), |ui| {
            Grid::new("hands")
                .num_columns(2)
                .spacing([24.0, 4.0])
                .show(ui, |ui| {
                    for (hand, what) in HANDS {
                        line(ui, hand, what);
                    }
                    ui.end_row();
                    for binding in TABLE {
                        line(ui, &binding.key_text(), binding.doc);
                    }
                });
        });
    let escape = ui.input_mut(|i| i.consume_key(egui::Modifiers::NONE, egui::Key::Escape));
    workspace.help = open && !escape;
}

fn line(ui: &mut Ui, keys: &str, what: &str) {
    ui.label(RichText::new(keys).strong());
    ui.label(what);
    ui.end_row();
}
