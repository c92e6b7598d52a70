//! How wrong the picture is: the plot, the reference, the error image.

use egui::{ComboBox, DragValue, ProgressBar, RichText, Ui};

use super::error_plot;
use super::statistics::seconds;
use crate::engine::integrators::REGISTRY;
use crate::engine::measure::error_image::ErrorKind;
use crate::engine::measure::unseen;
use crate::viewer::browser::Purpose;
use crate::viewer::measuring::curves::integrators;
use crate::viewer::measuring::reference::Making;
use crate::viewer::measuring::{Along, Over};
use crate::viewer::workspace::{Request, Workspace};

/// Seconds that a reference takes where nothing else was chosen.
const MAKER_SECONDS: f64 = 30.0;

/// Draws the section.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    reference(ui, workspace);
    ui.add_space(4.0);
    error_plot::show(ui, workspace, 190.0, false);
    ui.horizontal_wrapped(|ui| {
        let along = &mut workspace.measuring.along;
        for (choice, name) in [(Along::Seconds, "seconds"), (Along::Samples, "samples")] {
            let doc = "What runs along the plot.";
            ui.selectable_value(along, choice, name).on_hover_text(doc);
        }
        let large = &mut workspace.measuring.large;
        let doc = "Show the plot in a window of its own (M).";
        ui.toggle_value(large, "Large plot").on_hover_text(doc);
        if ui
            .button("Clear curves")
            .on_hover_text("Begin the curves again.")
            .clicked()
        {
            workspace.measuring.curves.clear();
        }
    });
    target(ui, workspace);
    slope(ui, workspace);
    save(ui, workspace);
    error_image(ui, workspace);
}

/// What errors are measured against, and how to get another.
fn reference(ui: &mut Ui, workspace: &mut Workspace) {
    let measuring = &mut workspace.measuring;
    let known = measuring.reference.clone();
    let suits = measuring.usable_reference().is_some();
    match (&known, &measuring.making) {
        (_, Some(making)) => {
            let error = making
                .error()
                .map_or(String::new(), |e| format!(", error {:.2} %", e * 100.0));
            let bar =
                ProgressBar::new(making.share()).text(format!("rendering a reference{error}"));
            ui.add(bar);
            ui.ctx().request_repaint_after_secs(0.5);
        }
        (Some(reference), None) => {
            let own = reference
                .error
                .map_or(String::new(), |e| format!(", own error {:.2} %", e * 100.0));
            ui.label(format!("Reference: {}{own}", reference.label));
            let frame = workspace.frame.as_ref();
            let noise = frame.and_then(|f| f.relative_error).filter(|_| suits);
            if reference
                .error
                .zip(noise)
                .is_some_and(|(own, e)| own > 0.5 * e)
            {
                let text = "Its own error is part of what is measured: give it more time.";
                ui.label(RichText::new(text).color(ui.visuals().warn_fg_color));
            }
            if !suits {
                let [w, h] = reference.size.to_array();
                let text = format!("It is of another picture ({w} × {h}): errors are estimated.");
                ui.label(RichText::new(text).color(ui.visuals().warn_fg_color));
            }
        }
        (None, None) => {
            ui.label("No reference: errors are estimated.")
                .on_hover_text("From the difference of two independent halves of the picture.");
        }
    }
    if let Some(made) = measuring.made().filter(|_| !suits)
        && let Some(unseen) = unseen(made.settings.integrator.id, &made.settings.params)
    {
        ui.weak(format!("The estimate is noise alone; {unseen}."));
    }
    if let Some(complaint) = measuring.curves.complaint.clone() {
        ui.horizontal_wrapped(|ui| {
            ui.colored_label(ui.visuals().error_fg_color, complaint);
            if ui.small_button("Dismiss complaint").clicked() {
                workspace.measuring.curves.complaint = None;
            }
        });
    }
    reference_buttons(ui, workspace);
}

fn reference_buttons(ui: &mut Ui, workspace: &mut Workspace) {
    ui.horizontal_wrapped(|ui| {
        let doc = "Measure against an EXR or HDR file.";
        if ui.button("Open reference…").on_hover_text(doc).clicked() {
            workspace.choose_file(Purpose::Reference);
        }
        let doc = "Go back to estimated errors.";
        let any = workspace.measuring.reference.is_some() || workspace.measuring.making.is_some();
        let button = egui::Button::new("No reference");
        if ui.add_enabled(any, button).on_hover_text(doc).clicked() {
            workspace.measuring.making = None;
            workspace.measuring.drop_reference();
        }
    });
    let measuring = &mut workspace.measuring;
    if measuring.maker_seconds <= 0.0 {
        measuring.maker_seconds = MAKER_SECONDS;
    }
    ui.horizontal_wrapped(|ui| {
        let doc = "Render a reference of this view on half of the cores.";
        let can = measuring.made().is_some() && measuring.making.is_none();
        let button = egui::Button::new("Make reference");
        if ui.add_enabled(can, button).on_hover_text(doc).clicked()
            && let Some(made) = measuring.made().cloned()
        {
            let entry = &REGISTRY[measuring.maker];
            match Making::start(&made, entry, measuring.maker_seconds, &measuring.waker) {
                Ok(making) => measuring.making = Some(making),
                Err(sentence) => measuring.curves.complaint = Some(sentence),
            }
        }
        let drag = DragValue::new(&mut measuring.maker_seconds);
        let label = ui.label("for");
        ui.add(drag.range(1.0..=86_400.0).suffix(" s"))
            .labelled_by(label.id)
            .on_hover_text("Seconds that the reference may take. From 1 to 86400, default 30.");
    });
    ComboBox::from_label("Made by")
        .selected_text(REGISTRY[measuring.maker].label)
        .show_ui(ui, |ui| {
            for (index, label) in integrators() {
                ui.selectable_value(&mut measuring.maker, index, label);
            }
        });
}

/// The error that is good enough, and when it is reached.
fn target(ui: &mut Ui, workspace: &mut Workspace) {
    let target = workspace.preferences.target_error;
    ui.horizontal_wrapped(|ui| {
        let label = ui.label("Target");
        let mut percent = target * 100.0;
        let speed = percent * 0.01;
        let drag = DragValue::new(&mut percent)
            .range(0.001..=100.0)
            .speed(speed);
        let drag = ui
            .add(drag.max_decimals(3).suffix(" %"))
            .labelled_by(label.id);
        if drag
            .on_hover_text("The error that is good enough, the line in the plot.")
            .changed()
        {
            workspace.preferences.target_error = percent / 100.0;
        }
        let frame = workspace.frame.as_ref();
        let now = frame.map_or((0.0, 0), |f| (f.t_wall, f.passes));
        let text = match workspace.measuring.prediction(target) {
            Some(p) if p.passes <= now.1 as f64 => "is reached.".to_owned(),
            Some(p) => format!(
                "after {} ({:.0} samples), in {}.",
                seconds(p.seconds),
                p.passes,
                seconds((p.seconds - now.0).max(0.0))
            ),
            None => "is not foreseen yet.".to_owned(),
        };
        ui.label(text)
            .on_hover_text("If the error goes on as its recent samples do. Bias stays.");
    });
}

fn slope(ui: &mut Ui, workspace: &Workspace) {
    let measuring = &workspace.measuring;
    let measured = measuring.usable_reference().is_some();
    for track in measuring.curves.tracks() {
        let Some(rate) = measuring.curves.rate(track, measured) else {
            continue;
        };
        let [r, g, b] = track.color;
        ui.horizontal(|ui| {
            let (at, _) = ui.allocate_exact_size(egui::vec2(10.0, 10.0), egui::Sense::hover());
            let color = egui::Color32::from_rgb(r, g, b);
            ui.painter().rect_filled(at, 2.0, color);
            ui.label(format!("{}: slope {:.2}", track.label, rate.slope))
                .on_hover_text("Fitted to error against samples; −0.5 for independent numbers.");
        });
    }
}

fn save(ui: &mut Ui, workspace: &mut Workspace) {
    ui.horizontal_wrapped(|ui| {
        for (extension, label) in [
            ("png", "Plot PNG"),
            ("svg", "Plot SVG"),
            ("csv", "Plot CSV"),
        ] {
            let doc = "Save the plot under a new name in the current folder.";
            if ui.button(label).on_hover_text(doc).clicked() {
                workspace.requests.push(Request::SavePlot(extension));
            }
        }
    });
}

fn error_image(ui: &mut Ui, workspace: &mut Workspace) {
    let measuring = &mut workspace.measuring;
    let can = measuring.usable_reference().is_some();
    ui.horizontal_wrapped(|ui| {
        let mut on = measuring.over == Over::Error;
        let doc = "Show where the picture differs from the reference.";
        let check = ui.add_enabled(can, egui::Checkbox::new(&mut on, "Error image"));
        if check.on_hover_text(doc).changed() {
            measuring.over = if on { Over::Error } else { Over::Nothing };
        }
        for kind in ErrorKind::ALL {
            let doc = "Which error: of what size, relative to the reference, or with its sign.";
            ui.add_enabled_ui(on, |ui| {
                ui.selectable_value(&mut measuring.kind, kind, kind.label())
                    .on_hover_text(doc);
            });
        }
    });
}
