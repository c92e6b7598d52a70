//! Which scene.

use egui::{ComboBox, DragValue, RichText, Slider, Ui};

use super::widgets;
use crate::engine::io::embedded;
use crate::viewer::commands::Command;
use crate::viewer::sequence::MAX_PASSES;
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
    frames(ui, workspace);
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

/// The frames of a sequence: which one, and whether they follow one another.
fn frames(ui: &mut Ui, workspace: &mut Workspace) {
    let Some(count) = workspace.scene.as_ref().and_then(|s| s.frames) else {
        return;
    };
    let mut at = workspace.sequence.at;
    ui.horizontal(|ui| {
        let sequence = &mut workspace.sequence;
        let label = if sequence.plays { "Stop" } else { "Play" };
        let doc = "Show the frames one after another, 24 a second or as quickly as they can be \
                   rendered; or stop.";
        if ui.button(label).on_hover_text(doc).clicked() {
            sequence.plays = !sequence.plays;
        }
        let passes = DragValue::new(&mut sequence.passes)
            .range(1..=MAX_PASSES)
            .suffix(" spp");
        let label = ui.label("with");
        ui.add(passes).labelled_by(label.id).on_hover_text(format!(
            "Samples of each pixel before the next frame, 1 to {MAX_PASSES}. Default 1."
        ));
    });
    let slider = Slider::new(&mut at, 0..=count - 1).text("Frame");
    let doc = format!("Which of the {count} frames of the sequence is shown.");
    if ui.add(slider).on_hover_text(doc).changed() {
        workspace.requests.push(Request::Frame(at));
    }
}
