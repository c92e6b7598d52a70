//! The picture's area: what is drawn there, and the hand on the camera.

use egui::{Align2, Color32, FontId, Key, PointerButton, Rect, Response, Sense, Ui, vec2};
use glam::{UVec2, Vec2, Vec3};

use crate::viewer::display::Tile;
use crate::viewer::gpu::PictureCallback;
use crate::viewer::navigation;
use crate::viewer::picking;
use crate::viewer::workspace::Workspace;

/// Turn of the view for a drag over the height of the picture, in radians.
const TURN: f32 = std::f32::consts::PI;
/// Distance after one notch of the wheel, over the distance before.
const NOTCH: f32 = 0.88;
/// Points of a touchpad that count as one notch.
const POINTS_PER_NOTCH: f32 = 50.0;
/// Flight in distances to the target a second.
const SPEED: f32 = 0.7;
/// Factor on the speed while Shift is held.
const FAST: f32 = 4.0;
/// Longest step of flight in seconds: after a stall the camera must not leap.
const MAX_STEP: f32 = 0.1;

/// Draws the picture and follows the hand.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    let rect = ui.available_rect_before_wrap();
    let scale = ui.ctx().pixels_per_point();
    workspace.area = UVec2::new(
        pixels(rect.min.x, rect.max.x, scale),
        pixels(rect.min.y, rect.max.y, scale),
    );
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Picture"));
    workspace.navigating = false;
    drag(ui, &response, workspace);
    wheel(ui, &response, workspace);
    fly(ui, &response, workspace);
    if response.double_clicked() {
        focus(&response, workspace);
    }
    ui.painter().rect_filled(rect, 0.0, Color32::from_gray(26));
    if let Some(frame) = &workspace.frame {
        let callback = PictureCallback {
            frame: frame.clone(),
            number: workspace.frame_number,
            display: workspace.model.display,
            placement: workspace.placement,
            area: rect,
        };
        let paint = egui_wgpu::Callback::new_paint_callback(rect, callback);
        ui.painter().add(paint);
        labels(ui, rect, &workspace.model.display.tiles());
    }
}

/// Whole physical pixels between two positions in points.
fn pixels(min: f32, max: f32, scale: f32) -> u32 {
    ((max * scale).round() - (min * scale).round()).max(0.0) as u32
}

/// Names of pictures that stand side by side, and lines between them.
fn labels(ui: &Ui, rect: Rect, tiles: &[Tile]) {
    if tiles.len() > 1 {
        let line = egui::Stroke::new(1.0, Color32::from_gray(70));
        ui.painter().hline(rect.x_range(), rect.center().y, line);
        ui.painter().vline(rect.center().x, rect.y_range(), line);
    }
    for tile in tiles {
        let Some(label) = tile.label else { continue };
        let [x, y, _, _] = tile.area;
        let at = rect.min + vec2(x * rect.width(), y * rect.height()) + vec2(10.0, 8.0);
        let font = FontId::proportional(14.0);
        let painter = ui.painter();
        let galley = painter.layout_no_wrap(label.to_owned(), font.clone(), Color32::WHITE);
        let ground = Rect::from_min_size(at, galley.size()).expand2(vec2(6.0, 3.0));
        painter.rect_filled(ground, 4.0, Color32::from_black_alpha(170));
        painter.text(at, Align2::LEFT_TOP, label, font, Color32::WHITE);
    }
}

/// Position from the middle of the area to the right and down, in its heights.
fn centered(rect: Rect, at: egui::Pos2) -> Vec2 {
    let from = at - rect.center();
    Vec2::new(from.x, from.y) / rect.height().max(1.0)
}

fn flying_keys(ui: &Ui) -> Vec3 {
    if ui.ctx().text_edit_focused() {
        return Vec3::ZERO;
    }
    ui.input(|i| {
        if i.modifiers.ctrl || i.modifiers.command || i.modifiers.alt {
            return Vec3::ZERO;
        }
        let axis = |more, less| f32::from(i.key_down(more)) - f32::from(i.key_down(less));
        Vec3::new(
            axis(Key::D, Key::A),
            axis(Key::E, Key::Q),
            axis(Key::W, Key::S),
        )
    })
}

fn drag(ui: &Ui, response: &Response, workspace: &mut Workspace) {
    let moved = response.drag_delta();
    let shift = ui.input(|i| i.modifiers.shift);
    if !response.dragged() {
        return;
    }
    workspace.navigating = true;
    if moved == egui::Vec2::ZERO {
        return;
    }
    workspace.take_hold();
    let step = Vec2::new(moved.x, moved.y) / response.rect.height().max(1.0);
    let view = &workspace.model.view;
    let left = response.dragged_by(PointerButton::Primary);
    workspace.model.view = if left && flying_keys(ui) != Vec3::ZERO {
        navigation::look(view, step * TURN)
    } else if left && !shift {
        navigation::orbit(view, step * TURN)
    } else {
        navigation::pan(view, step)
    };
}

fn wheel(ui: &Ui, response: &Response, workspace: &mut Workspace) {
    let Some(cursor) = response.hover_pos() else {
        return;
    };
    let notches = ui.input(|i| {
        let of = |event: &egui::Event| match event {
            egui::Event::MouseWheel {
                unit,
                delta,
                modifiers,
                ..
            } if !modifiers.command => match unit {
                egui::MouseWheelUnit::Point => delta.y / POINTS_PER_NOTCH,
                egui::MouseWheelUnit::Line | egui::MouseWheelUnit::Page => delta.y,
            },
            egui::Event::Zoom(factor) => factor.ln() / NOTCH.recip().ln(),
            _ => 0.0,
        };
        i.events.iter().map(of).sum::<f32>()
    });
    if notches != 0.0 {
        workspace.take_hold();
        let at = centered(response.rect, cursor);
        let factor = NOTCH.powf(notches);
        workspace.model.view = navigation::dolly(&workspace.model.view, factor, at);
    }
}

fn fly(ui: &Ui, response: &Response, workspace: &mut Workspace) {
    let direction = flying_keys(ui);
    if direction == Vec3::ZERO {
        return;
    }
    let (seconds, shift) = ui.input(|i| (i.stable_dt.min(MAX_STEP), i.modifiers.shift));
    let speed = SPEED * if shift { FAST } else { 1.0 };
    workspace.take_hold();
    let step = direction * navigation::distance(&workspace.model.view) * speed * seconds;
    workspace.model.view = navigation::fly(&workspace.model.view, step);
    response.ctx.request_repaint();
}

fn focus(response: &Response, workspace: &mut Workspace) {
    let Some(at) = response.interact_pointer_pos() else {
        return;
    };
    let from_corner = (at - response.rect.min) * response.ctx.pixels_per_point();
    if let Some(hit) = picking::hit(workspace, Vec2::new(from_corner.x, from_corner.y)) {
        workspace.model.view = navigation::focus(&workspace.model.view, hit.point);
    }
}
