//! What the plan leaves out, on demand.

use egui::{CollapsingHeader, Ui};

use crate::viewer::workspace::Workspace;

/// Draws the list, folded until someone asks.
pub fn show(ui: &mut Ui, workspace: &Workspace) {
    let Some(frame) = &workspace.frame else {
        return;
    };
    let left_out = &frame.plan.left_out;
    if left_out.is_empty() {
        return;
    }
    let title = format!("Left out for this scene ({})", left_out.len());
    CollapsingHeader::new(title)
        .id_salt("left out")
        .show(ui, |ui| {
            for item in left_out {
                ui.label(format!("{}: {}", item.what, item.why));
            }
        })
        .header_response
        .on_hover_text("What need not be computed here; the picture is the same without it.");
}
