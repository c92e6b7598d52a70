//! Which scene.

use egui::{ComboBox, RichText, Ui};

use super::widgets;
use crate::engine::io::embedded;
use crate::viewer::commands::Command;
use crate::viewer::source::SceneSource;
use crate::viewer::workspace::{Request, Workspace};

/// Draws the scene picker and what the scene says about itself.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    let mut chosen = workspace.model.source.clone();
    let before = chosen.clone();
    ui.horizontal(|ui| {
        ComboBox::from_label("Scene")
            .selected_text(chosen.short_name())
            .width(ui.available_width() - 60.0)
            .height(360.0)
            .show_ui(ui, |ui| {
                for scene in embedded::all() {
                    let source = SceneSource::Embedded(scene.id.to_owned());
                    ui.selectable_value(&mut chosen, source, scene.id);
                }
            });
    });
    if chosen != before {
        workspace.requests.push(Request::Load(chosen));
    }
    if let Some(scene) = &workspace.scene {
        if !scene.description.is_empty() {
            ui.label(RichText::new(&scene.description).weak());
        }
        for warning in &scene.warnings {
            ui.label(RichText::new(format!("Note: {warning}")).weak());
        }
    }
    ui.horizontal(|ui| {
        widgets::command(ui, workspace, Command::Open);
        widgets::command(ui, workspace, Command::Gallery);
        if workspace.model.source.path().is_some() {
            widgets::command(ui, workspace, Command::Reload);
        }
    });
    ui.horizontal(|ui| {
        let paused = workspace.paused;
        let label = if paused { "Go on" } else { "Pause" };
        widgets::command_labelled(ui, workspace, Command::Pause, label, true);
        let (undo, redo) = (workspace.history.can_undo(), workspace.history.can_redo());
        widgets::command_labelled(ui, workspace, Command::Undo, "Undo", undo);
        widgets::command_labelled(ui, workspace, Command::Redo, "Redo", redo);
    });
}
