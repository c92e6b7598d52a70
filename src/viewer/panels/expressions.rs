//! Path expressions, typed while one looks on.

use egui::{Key, Popup, PopupCloseBehavior, RichText, TextEdit, Ui};

use crate::engine::path::{Expression, ExpressionError, PathClasses};
use crate::viewer::balance::Balance;
use crate::viewer::display::Shown;
use crate::viewer::workspace::Workspace;

/// Most expressions at once.
const MOST: usize = 8;

/// Expressions to begin with, and what they mean.
const EXAMPLES: [(&str, &str); 10] = [
    ("LDE", "direct light on diffuse surfaces"),
    ("LS+DE", "caustics of mirrors and glass"),
    ("LS+DS+E", "caustics seen in a mirror or through glass"),
    ("L.*DDE", "light between diffuse surfaces"),
    ("LDDE", "one bounce between diffuse surfaces"),
    ("L.{3,}E", "three events or more"),
    ("LDS*E|LGS*E|LS*E", "what Whitted's ray tracing finds"),
    (
        "L(D|G).*E",
        "light that leaves for a diffuse or glossy surface",
    ),
    ("L.*SE", "what is seen in a mirror or through glass"),
    ("L.*G.*E", "all that has a glossy event"),
];

/// Draws the field and the list.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    field(ui, workspace);
    let texts: Vec<String> = {
        let list = &workspace.model.settings.layers.expressions;
        list.iter().map(|e| e.text().to_owned()).collect()
    };
    for (i, text) in texts.iter().enumerate() {
        ui.horizontal(|ui| {
            let shown = workspace.model.display.shown == Shown::Expression(i as u8);
            let button = ui.selectable_label(shown, RichText::new(text).monospace());
            let button = button.on_hover_text("Show the light of these paths alone, or the whole.");
            if button.clicked() {
                workspace.show_expression((!shown).then_some(i));
            }
            let remove = ui.small_button("×").on_hover_text("Remove it.");
            let name = format!("Remove {text}");
            remove.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
            if remove.clicked() {
                workspace.remove_expression(i);
            }
        });
    }
    if texts.is_empty() {
        return;
    }
    let mut only = workspace.model.settings.layers.no_whole;
    let doc = "Leave out the whole and the components: a walk stops once it can no longer become \
               a path of any expression. Off by default.";
    if ui
        .checkbox(&mut only, "Compute only these")
        .on_hover_text(doc)
        .changed()
    {
        workspace.compute_only_expressions(only);
    }
    badge(ui, workspace.typed_balance);
}

fn field(ui: &mut Ui, workspace: &mut Workspace) {
    let mut text = std::mem::take(&mut workspace.expression_text);
    let checked = check(&text, &workspace.model.settings.layers.expressions);
    let (mut add, mut chosen) = (false, None);
    ui.horizontal(|ui| {
        let label = ui.label("Paths");
        let color = checked.is_err().then(|| ui.visuals().error_fg_color);
        let edit = TextEdit::singleline(&mut text)
            .hint_text("LS+DE")
            .font(egui::TextStyle::Monospace)
            .desired_width(ui.available_width() - 130.0)
            .text_color_opt(color);
        let edit = ui.add(edit).labelled_by(label.id).on_hover_text(
            "A path from light to eye: L, then D diffuse, G glossy, S mirror or glass, . any; \
             ( ) | * + ? {2,3}; then E.",
        );
        let entered = edit.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
        let button = ui.add_enabled(matches!(checked, Ok(Some(_))), egui::Button::new("Add"));
        add = button
            .on_hover_text("Give these paths a layer. (Enter)")
            .clicked()
            || entered;
        let examples = ui.button("Examples");
        Popup::menu(&examples)
            .close_behavior(PopupCloseBehavior::CloseOnClick)
            .show(|ui| {
                for (example, meaning) in EXAMPLES {
                    let line = ui.button(format!("{example}   {meaning}"));
                    if line.clicked() {
                        chosen = Some(example);
                    }
                }
            });
    });
    if let Err((place, message)) = &checked {
        if let Some(place) = place {
            let before: String = text.chars().take(*place).collect();
            let rest: String = text.chars().skip(*place).collect();
            ui.label(RichText::new(format!("{before}»{rest}")).monospace().weak());
        }
        ui.label(RichText::new(message).color(ui.visuals().error_fg_color));
    }
    if let Some(example) = chosen {
        text = example.to_owned();
    } else if add && let Ok(Some(expression)) = checked {
        workspace.add_expression(expression);
        text.clear();
    }
    workspace.expression_text = text;
}

/// What is typed, if it can be added to `list`; otherwise where and why not. Nothing typed is no
/// error.
fn check(text: &str, list: &[Expression]) -> Result<Option<Expression>, (Option<usize>, String)> {
    if text.is_empty() {
        return Ok(None);
    }
    let why = |e: ExpressionError| (e.position, e.message);
    let expression: Expression = text.parse().map_err(why)?;
    if list.len() >= MOST {
        return Err((
            None,
            format!("{MOST} expressions at once are enough; remove one"),
        ));
    }
    let mut all = list.to_vec();
    all.push(expression.clone());
    PathClasses::with_components(&all).map_err(|e| (None, e.message))?;
    Ok(Some(expression))
}

/// The sum of the typed expressions against the whole.
fn badge(ui: &mut Ui, balance: Balance) {
    let (Some(mean), Some(rms)) = (balance.mean, balance.rms) else {
        return;
    };
    let text = format!("Sum of these − whole: {mean:+.2e}");
    ui.label(RichText::new(text).weak()).on_hover_text(format!(
        "Expressions that share no path and together name all of them add up to the whole, which \
         has sums of its own: only rounding is then left. Mean difference over the mean of the \
         whole; the root mean square difference is {rms:.1e}."
    ));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn examples_can_be_read_all_together_or_alone() {
        for (text, _) in EXAMPLES {
            assert!(matches!(check(text, &[]), Ok(Some(_))), "{text}");
        }
    }

    #[test]
    fn mistakes_are_told_with_their_place() {
        assert_eq!(check("", &[]), Ok(None));
        let (place, message) = check("LD(SE", &[]).expect_err("a mistake");
        assert!(place.is_some() && !message.is_empty());
        let one: Expression = "LDE".parse().expect("well-formed");
        let full = vec![one; MOST];
        assert!(check("LE", &full).is_err());
        assert!(check("LE", &full[1..]).is_ok());
    }
}
