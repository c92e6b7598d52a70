//! Small parts that all panels share.

use egui::{CollapsingHeader, DragValue, Response, RichText, Ui, emath::Numeric};

use crate::viewer::commands::{Command, binding};
use crate::viewer::workspace::Workspace;

/// A section of the panel that folds; whether it is folded is remembered.
pub fn section(
    ui: &mut Ui,
    workspace: &mut Workspace,
    title: &str,
    open: bool,
    contents: fn(&mut Ui, &mut Workspace),
) {
    ui.add_space(4.0);
    ui.separator();
    let open = workspace
        .preferences
        .sections
        .get(title)
        .copied()
        .unwrap_or(open);
    let header = CollapsingHeader::new(RichText::new(title).strong())
        .default_open(open)
        .show_unindented(ui, |ui| contents(ui, workspace))
        .header_response;
    if header.clicked() {
        workspace
            .preferences
            .sections
            .insert(title.to_owned(), !open);
    }
}

/// A button that carries out a command.
pub fn command(ui: &mut Ui, workspace: &mut Workspace, command: Command) {
    command_labelled(ui, workspace, command, binding(command).label, true);
}

/// A button that carries out a command under another name, greyed out if it cannot.
pub fn command_labelled(
    ui: &mut Ui,
    workspace: &mut Workspace,
    command: Command,
    label: &str,
    enabled: bool,
) {
    let button = ui.add_enabled(enabled, egui::Button::new(label));
    if button.on_hover_text(binding(command).tooltip()).clicked() {
        workspace.run(command);
    }
}

/// A number to be dragged or typed, after its name. Its accessible name is `name`.
pub fn number<N: Numeric>(
    ui: &mut Ui,
    name: &str,
    tooltip: &str,
    value: &mut N,
    set: impl FnOnce(DragValue<'_>) -> DragValue<'_>,
) -> Response {
    ui.horizontal(|ui| {
        let label = ui.label(name).on_hover_text(tooltip);
        let drag = ui.add(set(DragValue::new(value)));
        drag.labelled_by(label.id).on_hover_text(tooltip)
    })
    .inner
}

/// Name and value of a figure.
pub fn figure(ui: &mut Ui, name: &str, value: impl Into<String>, tooltip: &str) {
    ui.label(RichText::new(name).weak()).on_hover_text(tooltip);
    ui.label(value.into()).on_hover_text(tooltip);
    ui.end_row();
}
