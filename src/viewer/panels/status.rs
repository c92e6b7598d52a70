//! The line below the picture.

use egui::{Align, Layout, RichText, Ui};

use super::statistics::{error, seconds, speed};
use crate::viewer::commands::{Command, binding};
use crate::viewer::workspace::Workspace;

/// Draws the line.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 14.0;
        progress(ui, workspace);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            for (command, label) in [(Command::Help, "?"), (Command::Panel, "Panel")] {
                let button = ui.add(egui::Button::new(label).frame(false));
                if button.on_hover_text(binding(command).tooltip()).clicked() {
                    workspace.run(command);
                }
            }
            warnings(ui, workspace);
        });
    });
}

fn progress(ui: &mut Ui, workspace: &Workspace) {
    if let Some(source) = &workspace.loading {
        ui.spinner();
        ui.label(format!("reading {source} …"));
        return;
    }
    let Some(frame) = &workspace.frame else {
        ui.weak("no picture yet");
        return;
    };
    if workspace.paused {
        ui.strong("paused");
    }
    if frame.is_coarse() {
        let side = frame.full_size.x.div_ceil(frame.size.x.max(1));
        ui.label(format!("1 of {} pixels", side * side));
        if frame.preview {
            ui.strong("path-traced preview")
                .on_hover_text("The chosen algorithm cannot keep up with a moving view.");
        }
    } else {
        let plural = if frame.passes == 1 { "" } else { "s" };
        ui.label(format!("{} sample{plural}", frame.passes))
            .on_hover_text("Samples a pixel.");
    }
    ui.label(seconds(frame.t_wall))
        .on_hover_text("Since the view or the settings last changed.");
    if frame.stats.rays > 0 {
        ui.label(speed(frame))
            .on_hover_text("Rays, shadow rays included.");
    }
    if frame.relative_error.is_some_and(f64::is_finite) {
        ui.label(format!("error {}", error(frame)))
            .on_hover_text("Estimated root mean square error over the mean of the picture.");
    }
    ui.weak(format!("{} × {}", frame.full_size.x, frame.full_size.y));
    if workspace.placement.zoom > 1.0 {
        ui.label(format!("magnified {:.1} ×", workspace.placement.zoom))
            .on_hover_text(binding(Command::ZoomOut).tooltip());
    }
}

fn warnings(ui: &mut Ui, workspace: &Workspace) {
    let Some(frame) = &workspace.frame else {
        return;
    };
    let stats = &frame.stats;
    for (count, what) in [
        (stats.non_finite(), "samples that are no numbers"),
        (stats.faults.negative, "negative samples"),
        (stats.self_hits, "self-hits"),
        (stats.missed_edges, "missed edges"),
        (stats.cut_paths, "cut paths"),
    ] {
        if count > 0 {
            let text = RichText::new(format!("{count} {what}")).color(ui.visuals().warn_fg_color);
            ui.label(text).on_hover_text("See the section Statistics.");
        }
    }
}
