//! Scenes with a closed form, their numbers as sliders, and whether the picture is right.

use egui::{Color32, ComboBox, Grid, RichText, Slider, Ui};

use super::statistics::faults;
use super::widgets::figure;
use crate::engine::stability::stress::{Experiment, Knob, PREFIX, Stress, measure};
use crate::viewer::source::SceneSource;
use crate::viewer::workspace::{Request, Workspace};

/// Draws the experiment, its sliders, and the verdict.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    let shown = current(workspace);
    let mut next = shown.clone();
    let name = shown.as_ref().map_or("none", |s| s.experiment.name());
    ComboBox::from_label("Experiment")
        .selected_text(name)
        .show_ui(ui, |ui| {
            for experiment in Experiment::ALL {
                let is_shown = shown.as_ref().is_some_and(|s| s.experiment == experiment);
                let label = ui.selectable_label(is_shown, experiment.name());
                if label.on_hover_text(experiment.summary()).clicked() {
                    next = Some(Stress::new(experiment));
                }
            }
        });
    let Some(stress) = &mut next else {
        ui.weak("Scenes whose radiance is known, to be driven to extremes.");
        return;
    };
    ui.weak(stress.experiment.summary());
    for (knob, value) in stress.experiment.knobs().iter().zip(&mut stress.values) {
        slider(ui, knob, value);
    }
    if next != shown {
        let id = next.as_ref().map(Stress::to_string).unwrap_or_default();
        workspace
            .requests
            .push(Request::Load(SceneSource::Embedded(id)));
        return;
    }
    if let Some(stress) = shown {
        verdict(ui, workspace, &stress);
    }
}

/// The experiment that is shown or on its way.
fn current(workspace: &Workspace) -> Option<Stress> {
    let source = workspace.loading.as_ref();
    match source.unwrap_or(&workspace.model.source) {
        SceneSource::Embedded(id) if id.starts_with(PREFIX) => Stress::parse(id).ok(),
        _ => None,
    }
}

fn slider(ui: &mut Ui, knob: &Knob, value: &mut f64) {
    let [least, most] = knob.range;
    let slider = Slider::new(value, least..=most)
        .logarithmic(knob.logarithmic)
        .smallest_positive(1e-3)
        .text(knob.label);
    ui.add(slider)
        .on_hover_text(format!("{least} to {most}; default {}.", knob.default));
}

/// What is right, what was measured, and the counters.
fn verdict(ui: &mut Ui, workspace: &Workspace, stress: &Stress) {
    let of_it = workspace.sequence.is_shown_by(workspace.frame_number);
    let frame = workspace.frame.as_ref();
    let Some(frame) = frame.filter(|_| of_it && workspace.loading.is_none()) else {
        return;
    };
    let exact = stress.exact();
    Grid::new("stress").num_columns(2).show(ui, |ui| {
        let doc = "The closed form: mean radiance of every pixel (W·sr⁻¹·m⁻²).";
        figure(ui, "Right", format!("{exact:.6}"), doc);
        if let Some(found) = measure(frame, exact) {
            let doc = "Mean of the picture, and its standard error.";
            let value = format!("{:.6} ± {:.6}", found.mean, found.error);
            figure(ui, "Measured", value, doc);
            let doc = "(Measured − right) / right.";
            let value = format!("{:+.3} %", 100.0 * (found.mean / exact - 1.0));
            figure(ui, "Deviation", value, doc);
        }
    });
    let (text, colour) = match judged(workspace, exact) {
        Err(why) => (why, ui.visuals().weak_text_color()),
        Ok(None) => ("not yet known to half a percent".into(), Color32::GRAY),
        Ok(Some(true)) => ("holds".into(), Color32::from_rgb(60, 160, 80)),
        Ok(Some(false)) => ("WRONG".into(), Color32::from_rgb(210, 60, 50)),
    };
    let doc = "Right to a thousandth and three standard errors, and no error counted.";
    ui.label(RichText::new(text).color(colour).strong())
        .on_hover_text(doc);
    Grid::new("counters")
        .num_columns(2)
        .show(ui, |ui| faults(ui, frame, workspace));
}

/// Whether the picture holds, `None` while that is open; or why it is no picture of that closed form.
fn judged(workspace: &Workspace, exact: f64) -> Result<Option<bool>, String> {
    let (model, frame) = (&workspace.model, workspace.frame.as_ref());
    if model.view != model.home {
        return Err("The closed form is that of the scene's own view.".into());
    }
    if model.settings.layers.no_whole || model.settings.layers.max_depth.is_some() {
        return Err("The closed form is that of all light.".into());
    }
    let features = workspace.scene.as_ref().map(|scene| &scene.features);
    let entry = model.settings.integrator;
    let missing = features.and_then(|f| (entry.missing)(f, &model.settings.params));
    if let Some(missing) = missing {
        return Err(format!("This algorithm does not find {}.", missing.words));
    }
    let frame = frame.filter(|frame| !frame.preview);
    let Some(frame) = frame else { return Ok(None) };
    if frame.stats.errors().iter().any(|count| *count > 0) {
        return Ok(Some(false));
    }
    Ok(measure(frame, exact).and_then(|found| found.holds))
}
