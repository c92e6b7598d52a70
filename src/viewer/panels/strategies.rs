//! The strategies of bidirectional path tracing as a table: a row for each number of vertices from
//! the light, a column for each from the lens.

use egui::{Grid, Ui};

use crate::engine::integrators::bidirectional::Strategies;
use crate::engine::integrators::{ParamSpec, Params};

/// Rows from s = 0 on.
const ROWS: usize = 6;
/// Columns from t = 1 on.
const COLUMNS: usize = 6;

/// Draws the table; returns the words that a click makes of `spec`'s.
pub fn show(ui: &mut Ui, spec: &ParamSpec, params: &Params) -> Option<String> {
    let words = params.text(spec.name);
    let strategies = params.strategies(spec.name);
    let mut changed = None;
    let title = format!("Table of {}", spec.name);
    ui.collapsing(title, |ui| {
        Grid::new(spec.name).spacing([2.0, 2.0]).show(ui, |ui| {
            for s in 0..ROWS {
                for t in 1..=COLUMNS {
                    if s + t < 2 {
                        ui.label("");
                        continue;
                    }
                    let cell = ui.selectable_label(strategies.is_on(s, t), format!("{s},{t}"));
                    let cell = cell.on_hover_text(doc(s, t));
                    if cell.clicked() {
                        let alone = ui.input(|i| i.modifiers.shift);
                        changed = Some(clicked(&words, &strategies, (s, t), alone));
                    }
                }
                ui.end_row();
            }
        });
    });
    changed
}

/// A click switches a strategy; with Shift it stands alone, or all are on again.
fn clicked(words: &str, strategies: &Strategies, (s, t): (usize, usize), alone: bool) -> String {
    let own = format!("{s},{t}");
    match alone {
        true if words == own => "all".to_owned(),
        true => own,
        false => strategies.toggled_words(words, s, t),
    }
}

fn doc(s: usize, t: usize) -> String {
    let what = match (s, t) {
        (0, _) => "the walk from the lens meets a light by itself".to_owned(),
        (1, 1) => "a point of a light is joined to the lens".to_owned(),
        (1, _) => "a shadow ray".to_owned(),
        (_, 1) => "the walk from the light is joined to the lens".to_owned(),
        _ => "a connection of both walks".to_owned(),
    };
    format!(
        "{s} vertices from the light, {t} from the lens: {what}. A click switches it; with Shift it \
         stands alone."
    )
}
