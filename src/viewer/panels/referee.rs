//! The referee: the algorithm that renders against another one.

use egui::{ComboBox, Grid, RichText, Slider, Ui};

use crate::engine::integrators::REGISTRY;
use crate::engine::measure::referee::Verdict;
use crate::viewer::measuring::Over;
use crate::viewer::measuring::curves::integrators;
use crate::viewer::measuring::referee::{Arrangement, State, sentence};
use crate::viewer::workspace::Workspace;

/// Draws the section.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    let measuring = &mut workspace.measuring;
    ComboBox::from_label("Opponent")
        .selected_text(REGISTRY[measuring.referee.opponent].label)
        .show_ui(ui, |ui| {
            for (index, label) in integrators() {
                ui.selectable_value(&mut measuring.referee.opponent, index, label);
            }
        });
    missing(ui, workspace);
    buttons(ui, workspace);
    let measuring = &mut workspace.measuring;
    if let Some(complaint) = &measuring.referee.complaint {
        ui.colored_label(ui.visuals().error_fg_color, complaint);
    }
    let Some(state) = measuring.referee.state.clone() else {
        return;
    };
    arrangement(ui, workspace);
    verdict(ui, &state);
    findings(ui, &state);
}

/// What one of the two cannot find at all: there they must differ.
fn missing(ui: &mut Ui, workspace: &Workspace) {
    let Some(made) = workspace.measuring.made() else {
        return;
    };
    let opponent = &REGISTRY[workspace.measuring.referee.opponent];
    let defaults = crate::engine::integrators::Params::defaults(opponent.params);
    let settings = &made.settings;
    let sides = [
        (settings.integrator, &settings.params),
        (opponent, &defaults),
    ];
    for (entry, params) in sides {
        if let Some(missing) = (entry.missing)(&made.scene.features, params) {
            let text = format!("{} cannot find {} here.", entry.id, missing.words);
            let text = RichText::new(text).color(ui.visuals().warn_fg_color);
            ui.label(text).on_hover_text(missing.why);
        }
    }
}

fn buttons(ui: &mut Ui, workspace: &mut Workspace) {
    ui.horizontal_wrapped(|ui| {
        let measuring = &mut workspace.measuring;
        let running = measuring.referee.is_running();
        let doc = "Render both in runs of other seeds until it is known whether they agree. The \
                   window's own render stands still meanwhile.";
        let can = measuring.made().is_some() && !running;
        let button = egui::Button::new("Start referee");
        if ui.add_enabled(can, button).on_hover_text(doc).clicked()
            && let Some(made) = measuring.made().cloned()
        {
            let opponent = &REGISTRY[measuring.referee.opponent];
            measuring.referee.start(&made, opponent, &measuring.waker);
            measuring.over = Over::Referee;
            workspace.paused = true;
        }
        let measuring = &mut workspace.measuring;
        let button = egui::Button::new("Stop referee");
        if ui.add_enabled(running, button).clicked() {
            measuring.referee.stop();
        }
        let mut on = measuring.over == Over::Referee;
        let doc = "Show both sides instead of the picture.";
        let any = measuring.referee.state.is_some();
        let check = ui.add_enabled(any, egui::Checkbox::new(&mut on, "Show sides"));
        if check.on_hover_text(doc).changed() {
            measuring.over = if on { Over::Referee } else { Over::Nothing };
        }
    });
}

fn arrangement(ui: &mut Ui, workspace: &mut Workspace) {
    let referee = &mut workspace.measuring.referee;
    ui.horizontal_wrapped(|ui| {
        for arrangement in Arrangement::ALL {
            ui.selectable_value(&mut referee.arrangement, arrangement, arrangement.label());
        }
    });
    match referee.arrangement {
        Arrangement::Wipe => {
            ui.add(
                Slider::new(&mut referee.border, 0.0..=1.0)
                    .show_value(false)
                    .text("Border"),
            );
        }
        Arrangement::Flip => {
            ui.toggle_value(&mut referee.flipped, "Other side");
        }
        _ => {}
    }
}

fn verdict(ui: &mut Ui, state: &State) {
    let color = match state.verdict {
        Verdict::Agree => egui::Color32::from_rgb(90, 170, 100),
        Verdict::Differ(_) => ui.visuals().error_fg_color,
        Verdict::Needs(_) => ui.visuals().warn_fg_color,
    };
    ui.label(RichText::new(sentence(state)).color(color).strong());
    ui.weak(format!(
        "{} runs a side, {:.1} s of both.",
        state.runs, state.seconds
    ));
}

fn findings(ui: &mut Ui, state: &State) {
    if state.findings.is_empty() {
        return;
    }
    Grid::new("findings").num_columns(4).show(ui, |ui| {
        let doc = "Of the image means, in percent of the whole's.";
        for (head, doc) in [
            ("layer", "What is compared."),
            ("means differ by", doc),
            (
                "would see",
                "The smallest difference of the means that would have been found.",
            ),
            ("blocks", "Blocks of 8 × 8 pixels that differ."),
        ] {
            ui.weak(head).on_hover_text(doc);
        }
        ui.end_row();
        for f in &state.findings {
            let percent = |x: f64| format!("{:.2} %", x * 100.0);
            let name = RichText::new(format!("{}{}", f.label, if f.differs { " ≠" } else { "" }));
            ui.label(if f.differs {
                name.color(ui.visuals().error_fg_color)
            } else {
                name
            });
            let error = format!("{} ± {}", percent(f.difference), percent(f.standard_error));
            ui.label(error);
            ui.label(percent(f.detectable));
            ui.label(f.blocks.to_string());
            ui.end_row();
        }
    });
}
