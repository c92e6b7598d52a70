//! The window's contents, drawn anew for every repaint: one file a panel.

mod algorithm;
mod camera;
mod components;
mod display;
mod help;
mod notices;
mod output;
mod params;
mod picture;
mod plan;
mod scene;
mod statistics;
mod status;
mod style;
mod widgets;

use egui::{CentralPanel, Panel, ScrollArea, Ui};

use super::commands;
use super::workspace::Workspace;

pub use style::apply as apply_style;

/// Width of the panel in points.
const WIDTH: f32 = 292.0;

/// Draws everything and lets the user's input change `workspace`.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    // While a text is typed, letters are letters.
    if !ui.ctx().text_edit_focused() {
        for command in ui.input_mut(commands::pressed) {
            workspace.run(command);
        }
    }
    let now = ui.input(|input| input.time);
    workspace.notices.tick(now);
    if let Some(seconds) = workspace.notices.next_change(now) {
        ui.ctx().request_repaint_after_secs(seconds as f32);
    }
    style::follow_theme(ui, workspace.dark);

    Panel::bottom("status")
        .frame(style::status_frame(ui))
        .show_separator_line(false)
        .show(ui, |ui| status::show(ui, workspace));
    if workspace.panel {
        Panel::right("panel")
            .default_size(WIDTH)
            .size_range(240.0..=480.0)
            .show(ui, |ui| side(ui, workspace));
    }
    CentralPanel::no_frame().show(ui, |ui| picture::show(ui, workspace));
    notices::show(ui, workspace);
    help::show(ui, workspace);

    let busy = workspace.navigating || ui.input(|i| i.pointer.any_down());
    workspace.history.observe(&workspace.model, busy);
}

fn side(ui: &mut Ui, workspace: &mut Workspace) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.add_space(4.0);
        scene::show(ui, workspace);
        widgets::section(ui, "Algorithm", true, |ui| algorithm::show(ui, workspace));
        widgets::section(ui, "Components", true, |ui| components::show(ui, workspace));
        widgets::section(ui, "Display", true, |ui| display::show(ui, workspace));
        widgets::section(ui, "Camera", false, |ui| camera::show(ui, workspace));
        widgets::section(ui, "Save", true, |ui| output::show(ui, workspace));
        widgets::section(ui, "Statistics", false, |ui| {
            statistics::show(ui, workspace)
        });
        ui.add_space(8.0);
    });
}
