//! Exposure and tone map.

use egui::{ComboBox, Slider, Ui};

use super::widgets;
use crate::engine::film::ToneMap;
use crate::engine::path::COMPONENTS;
use crate::viewer::commands::{Command, binding};
use crate::viewer::display::{EXPOSURES, Shown};
use crate::viewer::workspace::Workspace;

/// Draws the controls.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    let display = &mut workspace.model.display;
    let exposure = Slider::new(&mut display.exposure, EXPOSURES)
        .text("Exposure")
        .suffix(" EV")
        .max_decimals(2);
    ui.add(exposure).on_hover_text(
        "Stops: one more is twice as bright. From −16 to 16, default 0 (keys + and −).",
    );
    let shows_parts = display.shown == Shown::Grid || display.shown.solo().is_some();
    if shows_parts {
        for (part, (name, _)) in COMPONENTS.iter().enumerate() {
            if display.shown == Shown::Grid || display.shown.solo() == Some(part) {
                let slider = Slider::new(&mut display.part_exposure[part], EXPOSURES)
                    .text(format!("+ {name}"))
                    .suffix(" EV")
                    .max_decimals(2);
                ui.add(slider).on_hover_text(
                    "Stops more for this component where it is shown alone. From −16 to 16, \
                     default 0.",
                );
            }
        }
    }
    let false_color = display.false_color;
    ui.add_enabled_ui(!false_color, |ui| {
        ComboBox::from_label("Tone map")
            .selected_text(display.tonemap.label())
            .show_ui(ui, |ui| {
                for map in ToneMap::ALL {
                    ui.selectable_value(&mut display.tonemap, map, map.label());
                }
            });
    });
    let line = binding(Command::FalseColor);
    ui.checkbox(&mut display.false_color, line.label)
        .on_hover_text(line.tooltip());
    ui.horizontal(|ui| {
        widgets::command(ui, workspace, Command::AutoExposure);
        widgets::command(ui, workspace, Command::Inspector);
        widgets::command(ui, workspace, Command::Theme);
    });
}
