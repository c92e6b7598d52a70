//! Which algorithm, and its parameters.

use egui::{ComboBox, RichText, Ui};

use super::{params, plan, widgets};
use crate::engine::integrators::{Params, REGISTRY};
use crate::viewer::workspace::Workspace;

/// Draws the choice of the integrator and a control for each of its parameters.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    let settings = &mut workspace.model.settings;
    let before = settings.integrator;
    let combo = ComboBox::from_label("Integrator")
        .selected_text(before.label)
        .show_ui(ui, |ui| {
            for entry in REGISTRY {
                let is_chosen = entry.id == settings.integrator.id;
                let choice = ui.selectable_label(is_chosen, entry.label);
                if choice.on_hover_text(entry.summary).clicked() && !is_chosen {
                    settings.integrator = entry;
                    settings.params = Params::defaults(entry.params);
                }
            }
        });
    combo.response.on_hover_text(before.summary);
    let features = workspace.scene.as_ref().map(|scene| &scene.features);
    let specs = settings.integrator.params;
    params::show(ui, specs, &mut settings.params, features);
    depth(ui, &mut settings.layers.max_depth);
    widgets::number(
        ui,
        "Seed",
        "Seed of all random numbers; another seed gives another, equally right picture. Default 0.",
        &mut settings.seed,
        |drag| drag.speed(0.05),
    );
    missing(ui, workspace);
    plan::show(ui, workspace);
}

/// Depth that is proposed where none was set.
const PROPOSED_DEPTH: u32 = 8;
/// Deepest that the control goes.
const MAX_DEPTH: u32 = 1000;

fn depth(ui: &mut Ui, max_depth: &mut Option<u32>) {
    let doc = "Most scattering events of a path: 0 shows emitters only, 1 direct light. Off: no \
               limit, the default.";
    ui.horizontal(|ui| {
        let mut limited = max_depth.is_some();
        if ui
            .checkbox(&mut limited, "Limit depth")
            .on_hover_text(doc)
            .changed()
        {
            *max_depth = limited.then_some(PROPOSED_DEPTH);
        }
        if let Some(depth) = max_depth {
            widgets::number(ui, "events", doc, depth, |drag| {
                drag.range(0..=MAX_DEPTH).speed(0.05)
            });
        }
    });
}

/// What the integrator cannot find in this scene.
fn missing(ui: &mut Ui, workspace: &Workspace) {
    let Some(scene) = &workspace.scene else {
        return;
    };
    let settings = &workspace.model.settings;
    let missing = (settings.integrator.missing)(&scene.features, &settings.params);
    if let Some(missing) = missing {
        let text = format!("Cannot find the paths {}: {}.", missing.words, missing.why);
        ui.label(RichText::new(text).color(ui.visuals().warn_fg_color));
    }
}
