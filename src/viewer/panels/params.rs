//! A control for each parameter of an integrator, made from its description.

use egui::{ComboBox, Slider, TextEdit, Ui};

use super::{strategies, widgets};
use crate::engine::integrators::{ParamKind, ParamSpec, Params};
use crate::engine::scene::features::SceneFeatures;

/// Widest range of integers that a slider shows; wider ones are dragged or typed.
const SLIDER_RANGE: i64 = 200;

/// Draws the controls of those of `specs` that matter in a scene of these features, and stores what
/// the user chooses.
pub fn show(
    ui: &mut Ui,
    specs: &'static [ParamSpec],
    params: &mut Params,
    features: Option<&SceneFeatures>,
) {
    for spec in specs {
        if features.is_some_and(|features| !(spec.matters)(features)) {
            continue;
        }
        let text = match spec.kind {
            ParamKind::Choice(words) => choice(ui, spec, words, params),
            ParamKind::Switch => switch(ui, spec, params),
            ParamKind::Integer(lo, hi) => integer(ui, spec, lo, hi, params),
            ParamKind::Number(lo, hi) => number(ui, spec, lo, hi, params),
            ParamKind::Strategies => words(ui, spec, params).or(strategies::show(ui, spec, params)),
        };
        if let Some(text) = text {
            // The controls offer only what the description allows.
            let stored = params.set(specs, spec.name, &text);
            debug_assert_eq!(stored, Ok(()));
        }
    }
}

/// A parameter's name as a label.
fn label(spec: &ParamSpec) -> String {
    let name = spec.name.replace('-', " ");
    let mut letters = name.chars();
    let first = letters.next().map(|c| c.to_uppercase().to_string());
    first.unwrap_or_default() + letters.as_str()
}

fn tooltip(spec: &ParamSpec) -> String {
    format!(
        "{} It is {}; default {}.",
        spec.doc,
        spec.range(),
        spec.default
    )
}

fn choice(
    ui: &mut Ui,
    spec: &ParamSpec,
    words: &'static [&'static str],
    params: &Params,
) -> Option<String> {
    let mut chosen = params.choice(spec.name);
    let before = chosen;
    let combo = ComboBox::from_label(label(spec))
        .selected_text(chosen)
        .show_ui(ui, |ui| {
            for word in words {
                ui.selectable_value(&mut chosen, word, *word);
            }
        });
    combo.response.on_hover_text(tooltip(spec));
    (chosen != before).then(|| chosen.to_owned())
}

fn switch(ui: &mut Ui, spec: &ParamSpec, params: &Params) -> Option<String> {
    let mut on = params.switch(spec.name);
    let changed = ui
        .checkbox(&mut on, label(spec))
        .on_hover_text(tooltip(spec))
        .changed();
    changed.then(|| if on { "on" } else { "off" }.to_owned())
}

fn integer(ui: &mut Ui, spec: &ParamSpec, lo: i64, hi: i64, params: &Params) -> Option<String> {
    let mut value = params.integer(spec.name);
    let suffix = suffix(spec);
    let response = if hi - lo <= SLIDER_RANGE {
        let slider = Slider::new(&mut value, lo..=hi)
            .text(label(spec))
            .suffix(suffix);
        ui.add(slider).on_hover_text(tooltip(spec))
    } else {
        let speed = (value.abs() as f64 * 0.01).max(0.1);
        widgets::number(ui, &label(spec), &tooltip(spec), &mut value, |drag| {
            drag.range(lo..=hi).speed(speed).suffix(suffix)
        })
    };
    response.changed().then(|| value.to_string())
}

fn number(ui: &mut Ui, spec: &ParamSpec, lo: f64, hi: f64, params: &Params) -> Option<String> {
    let mut value = params.number(spec.name);
    // Ranges over several powers of ten are judged by factors.
    let logarithmic = lo > 0.0 && hi / lo > 1e3;
    let slider = Slider::new(&mut value, lo..=hi)
        .logarithmic(logarithmic)
        .text(label(spec))
        .suffix(suffix(spec));
    let changed = ui.add(slider).on_hover_text(tooltip(spec)).changed();
    changed.then(|| value.to_string())
}

/// A line of text; what cannot be read stays in it, marked, until it is mended.
fn words(ui: &mut Ui, spec: &ParamSpec, params: &Params) -> Option<String> {
    let id = ui.scope_id().with(spec.name);
    let stored = params.text(spec.name);
    let typed = ui.data_mut(|d| d.get_temp::<String>(id));
    let mut text = typed.unwrap_or_else(|| stored.clone());
    let wrong = spec.parse(&text).is_err();
    let response = ui
        .horizontal(|ui| {
            let name = ui.label(label(spec));
            let color = wrong.then(|| ui.visuals().error_fg_color);
            let edit = TextEdit::singleline(&mut text).text_color_opt(color);
            ui.add(edit).labelled_by(name.id)
        })
        .inner
        .on_hover_text(tooltip(spec));
    if response.has_focus() || wrong {
        ui.data_mut(|d| d.insert_temp(id, text.clone()));
    } else {
        ui.data_mut(|d| d.remove::<String>(id));
    }
    (response.changed() && text != stored && spec.parse(&text).is_ok()).then_some(text)
}

fn suffix(spec: &ParamSpec) -> String {
    if spec.unit.is_empty() {
        String::new()
    } else {
        format!(" {}", spec.unit)
    }
}
