//! The window's contents, drawn anew for every repaint: one file a panel.

mod algorithm;
mod browser;
mod camera;
mod components;
mod display;
mod error;
mod error_plot;
mod expressions;
mod gallery;
mod hand;
mod help;
mod inspector;
mod notices;
mod output;
mod overlay;
mod params;
mod photon_lines;
mod photons;
mod picture;
mod pixel_values;
mod plan;
mod referee;
mod scene;
mod statistics;
mod status;
mod strategies;
mod stress;
mod style;
mod widgets;

use egui::{CentralPanel, Panel, ScrollArea, Ui};

use super::commands;
use super::sequence;
use super::workspace::{Request, Workspace};

pub use style::apply as apply_style;

/// Title, whether it is open at first, and contents of a section.
type Section = (&'static str, bool, fn(&mut Ui, &mut Workspace));

/// The panel's sections from top to bottom.
const SECTIONS: [Section; 11] = [
    ("Algorithm", true, algorithm::show),
    ("Components", true, components::show),
    ("Expressions", false, expressions::show),
    ("Photons", false, photons::show),
    ("Display", true, display::show),
    ("Camera", false, camera::show),
    ("Save", true, output::show),
    ("Statistics", false, statistics::show),
    ("Error", false, error::show),
    ("Referee", false, referee::show),
    ("Stress", false, stress::show),
];

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
    if let Some(file) = ui.input(|input| input.raw.dropped_files.last().cloned()) {
        workspace
            .requests
            .push(Request::Open(file.path().to_owned()));
    }
    workspace.measuring.poll();
    style::follow_theme(ui, workspace.preferences.dark);

    Panel::bottom("status")
        .frame(style::status_frame(ui))
        .show_separator_line(false)
        .show(ui, |ui| status::show(ui, workspace));
    if workspace.preferences.panel {
        let panel = Panel::right("panel")
            .default_size(workspace.preferences.panel_width)
            .size_range(240.0..=480.0)
            .show(ui, |ui| side(ui, workspace));
        workspace.preferences.panel_width = panel.response.rect.width();
    }
    photons::keep_up(ui, workspace);
    if let Some(seconds) = sequence::play(workspace, now) {
        ui.ctx().request_repaint_after_secs(seconds as f32);
    }
    CentralPanel::no_frame().show(ui, |ui| picture::show(ui, workspace));
    error_plot::large(ui, workspace);
    notices::show(ui, workspace);
    help::show(ui, workspace);
    gallery::show(ui, workspace);
    browser::show(ui, workspace);

    workspace.settle();
    let busy = workspace.navigating || ui.input(|i| i.pointer.any_down());
    workspace.history.observe(&workspace.model, busy);
}

fn side(ui: &mut Ui, workspace: &mut Workspace) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.add_space(4.0);
        scene::show(ui, workspace);
        for (title, open, contents) in SECTIONS {
            widgets::section(ui, workspace, title, open, contents);
        }
        ui.add_space(8.0);
    });
}
