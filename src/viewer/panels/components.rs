//! The four components of light.

use egui::{RichText, Ui};

use crate::engine::path::COMPONENTS;
use crate::viewer::commands::{Command, binding};
use crate::viewer::display::{PARTS, Shown};
use crate::viewer::workspace::{VOLUME, Workspace};

/// Draws the switches, the solo buttons and the badge.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    egui::Grid::new("components").num_columns(2).show(ui, |ui| {
        for part in 0..PARTS {
            component(ui, workspace, part);
            ui.end_row();
        }
        let scene = workspace.scene.as_ref();
        if scene.is_some_and(|s| s.features.volume) {
            volume(ui, workspace);
            ui.end_row();
        }
    });
    ui.horizontal(|ui| {
        let shown = workspace.model.display.shown;
        for (command, on) in [
            (Command::Whole, shown == Shown::Whole),
            (Command::Grid, shown == Shown::Grid),
        ] {
            let line = binding(command);
            let button = ui.selectable_label(on, line.label);
            if button.on_hover_text(line.tooltip()).clicked() {
                workspace.run(command);
            }
        }
    });
    badge(ui, workspace);
}

fn component(ui: &mut Ui, workspace: &mut Workspace, part: usize) {
    let (name, expression) = COMPONENTS[part];
    let line = binding(Command::Solo(part));
    let shown = workspace.model.display.shown;
    let mut on = shown.parts()[part];
    let doc = format!("{} Path expression {expression}.", line.doc);
    if ui.checkbox(&mut on, name).on_hover_text(doc).changed() {
        workspace.model.display.shown = shown.toggled(part);
    }
    let solo = ui.selectable_label(shown.solo() == Some(part), format!("only {name}"));
    if solo.on_hover_text(line.tooltip()).clicked() {
        workspace.run(Command::Solo(part));
    }
    if is_empty(workspace, part) {
        ui.label(RichText::new("empty").weak())
            .on_hover_text("No path of this scene belongs to this component.");
    }
}

/// The light of media, which is part of all four.
fn volume(ui: &mut Ui, workspace: &mut Workspace) {
    let line = binding(Command::Volume);
    ui.label("of these");
    let solo = ui.selectable_label(workspace.shows_volume(), "only volume");
    let doc = format!("{} Path expression {VOLUME}.", line.tooltip());
    if solo.on_hover_text(doc).clicked() {
        workspace.run(Command::Volume);
    }
}

/// True if the plan proves the component to be black.
fn is_empty(workspace: &Workspace, part: usize) -> bool {
    let frame = workspace.frame.as_ref();
    frame.is_some_and(|f| f.plan.asked & (1 << part) != 0 && f.plan.planned & (1 << part) == 0)
}

fn badge(ui: &mut Ui, workspace: &Workspace) {
    let balance = workspace.balance;
    let (Some(mean), Some(rms)) = (balance.mean, balance.rms) else {
        return;
    };
    let text = format!("Sum of parts − whole: {:+.2e}", mean);
    ui.label(RichText::new(text).weak()).on_hover_text(format!(
        "The whole has sums of its own. Mean difference over the mean of the whole; the root mean \
         square difference is {rms:.1e}. Only rounding may be left."
    ));
}
