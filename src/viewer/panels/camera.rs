//! The camera in numbers, and views along the axes.

use egui::Ui;
use glam::Vec3;

use super::widgets;
use crate::engine::scene::desc::{CameraDesc, LensDesc};
use crate::viewer::commands::Command;
use crate::viewer::navigation;
use crate::viewer::workspace::Workspace;

/// Names of views and where they look.
const PRESETS: [(&str, Vec3); 6] = [
    ("Front", Vec3::NEG_Z),
    ("Back", Vec3::Z),
    ("Left", Vec3::X),
    ("Right", Vec3::NEG_X),
    ("Top", Vec3::NEG_Y),
    ("Bottom", Vec3::Y),
];

/// Draws the fields. A view that makes no camera is not taken over.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    let mut view = workspace.model.view;
    point(
        ui,
        "Position",
        "The eye, in lengths of the scene.",
        &mut view.position,
    );
    point(
        ui,
        "Target",
        "The point in the middle, about which the view turns.",
        &mut view.target,
    );
    widgets::number(
        ui,
        "Opening angle",
        "Vertical, in degrees. From 1 to 170.",
        &mut view.vfov_deg,
        |drag| drag.range(1.0..=170.0).speed(0.2).suffix("°"),
    );
    lens(ui, &mut view);
    if view != workspace.model.view && navigation::is_usable(&view) {
        workspace.model.view = view;
        workspace.navigating = true;
    }
    ui.horizontal_wrapped(|ui| {
        for (name, direction) in PRESETS {
            let tooltip = format!("Look at the target from {}.", place(name));
            if ui.button(name).on_hover_text(tooltip).clicked() {
                workspace.model.view = navigation::along(&workspace.model.view, direction);
            }
        }
        widgets::command(ui, workspace, Command::Home);
    });
}

fn place(name: &str) -> String {
    match name {
        "Top" => "above".to_owned(),
        "Bottom" => "below".to_owned(),
        "Left" | "Right" => format!("the {}", name.to_lowercase()),
        _ => format!("the {} (along z)", name.to_lowercase()),
    }
}

fn point(ui: &mut Ui, name: &str, tooltip: &str, value: &mut Vec3) {
    ui.label(name).on_hover_text(tooltip);
    // A small share of the distance to the origin a pixel, whatever the size of the scene.
    let speed = (f64::from(value.length()) * 0.004).max(1e-4);
    ui.horizontal(|ui| {
        for (axis, number) in ["x", "y", "z"].into_iter().zip(value.as_mut()) {
            let label = ui.label(axis);
            let drag = egui::DragValue::new(number).speed(speed).max_decimals(4);
            ui.add(drag)
                .labelled_by(label.id)
                .on_hover_text(format!("{tooltip} Any number."));
        }
    });
}

fn lens(ui: &mut Ui, view: &mut CameraDesc) {
    let doc = "A thin lens blurs what lies before and behind the plane in focus. Off: a pinhole.";
    let distance = navigation::distance(view);
    let mut has_lens = view.lens.is_some();
    if ui
        .checkbox(&mut has_lens, "Lens")
        .on_hover_text(doc)
        .changed()
    {
        view.lens = has_lens.then_some(LensDesc {
            radius: distance * 0.02,
            focus_distance: distance,
        });
    }
    let Some(lens) = &mut view.lens else { return };
    let smallest = f32::MIN_POSITIVE;
    widgets::number(
        ui,
        "Radius",
        "Of the aperture, in lengths of the scene. Above 0.",
        &mut lens.radius,
        |drag| {
            drag.range(smallest..=f32::MAX)
                .speed(distance * 1e-4)
                .max_decimals(5)
        },
    );
    widgets::number(
        ui,
        "Focus distance",
        "Of the plane in focus along the view, in lengths of the scene. Above 0.",
        &mut lens.focus_distance,
        |drag| {
            drag.range(smallest..=f32::MAX)
                .speed(distance * 2e-3)
                .max_decimals(4)
        },
    );
}
