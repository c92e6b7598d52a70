//! The hand on the camera: mouse, wheel and flying keys.

use egui::{Event, Key, Modifiers, PointerButton, Rect, Response, Ui};
use glam::{Vec2, Vec3};

use crate::viewer::navigation;
use crate::viewer::picking;
use crate::viewer::workspace::{Hold, Workspace};

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
/// Keys that fly.
const FLYING: [Key; 6] = [Key::W, Key::A, Key::S, Key::D, Key::Q, Key::E];
/// Longest step of flight in seconds: after a stall the camera must not leap.
const MAX_STEP: f32 = 0.1;

/// Moves the camera of `workspace` as the hand on the picture, `response`, wants.
pub fn follow(ui: &Ui, response: &Response, workspace: &mut Workspace) {
    workspace.navigating = false;
    hold_flying_keys(ui, &mut workspace.flying);
    drag(ui, response, workspace);
    wheel(ui, response, workspace);
    fly(ui, response, workspace);
    if response.double_clicked() {
        focus(response, workspace);
    }
}

/// Position from the middle of the area to the right and down, in its heights.
fn centered(rect: Rect, at: egui::Pos2) -> Vec2 {
    let from = at - rect.center();
    Vec2::new(from.x, from.y) / rect.height().max(1.0)
}

/// Takes up and lets go the keys that fly. What counts is how a key was pressed: the letter of a
/// shortcut is often let go after Ctrl is, and must not fly then.
fn hold_flying_keys(ui: &Ui, flying: &mut Vec<Key>) {
    let typing = ui.ctx().text_edit_focused();
    ui.input(|i| {
        for event in &i.events {
            if let Event::Key {
                key,
                pressed: true,
                repeat: false,
                modifiers,
                ..
            } = *event
                && !(typing || modifiers.ctrl || modifiers.command || modifiers.alt)
                && FLYING.contains(&key)
                && !flying.contains(&key)
            {
                flying.push(key);
            }
        }
        // Also what was let go while another window had the keyboard.
        flying.retain(|&key| i.key_down(key));
    });
}

/// To the right, up and forward.
fn flight(flying: &[Key]) -> Vec3 {
    let held = |key| f32::from(flying.contains(&key));
    Vec3::new(
        held(Key::D) - held(Key::A),
        held(Key::E) - held(Key::Q),
        held(Key::W) - held(Key::S),
    )
}

/// Takes the events one by one: however rarely the window is drawn, no drag is lost.
fn drag(ui: &Ui, response: &Response, workspace: &mut Workspace) {
    let (events, modifiers) = ui.input(|i| (i.events.clone(), i.modifiers));
    for event in &events {
        match *event {
            Event::PointerButton {
                pos,
                button,
                pressed: true,
                ..
            } => {
                let top = ui.ctx().layer_id_at(pos);
                let on_picture = response.rect.contains(pos)
                    && top.is_none_or(|layer| layer == response.layer_id);
                workspace.hold = on_picture.then_some(Hold { button, at: pos });
            }
            Event::PointerButton { pressed: false, .. } | Event::PointerGone => {
                workspace.hold = None;
            }
            Event::PointerMoved(pos) => {
                if let Some(hold) = &mut workspace.hold {
                    let (button, moved) = (hold.button, pos - hold.at);
                    hold.at = pos;
                    move_by(ui, response, workspace, button, moved, modifiers);
                }
            }
            _ => {}
        }
    }
    workspace.navigating |= workspace.hold.is_some();
}

fn move_by(
    ui: &Ui,
    response: &Response,
    workspace: &mut Workspace,
    button: PointerButton,
    moved: egui::Vec2,
    modifiers: Modifiers,
) {
    if modifiers.command {
        let pixels = moved * ui.ctx().pixels_per_point();
        workspace.move_pixels(Vec2::new(pixels.x, pixels.y));
        return;
    }
    workspace.take_hold();
    let step = Vec2::new(moved.x, moved.y) / response.rect.height().max(1.0);
    let view = &workspace.model.view;
    let left = button == PointerButton::Primary;
    workspace.model.view = if left && flight(&workspace.flying) != Vec3::ZERO {
        navigation::look(view, step * TURN)
    } else if left && !modifiers.shift {
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
            egui::Event::MouseWheel { unit, delta, .. } => match unit {
                egui::MouseWheelUnit::Point => delta.y / POINTS_PER_NOTCH,
                egui::MouseWheelUnit::Line | egui::MouseWheelUnit::Page => delta.y,
            },
            egui::Event::Zoom(factor) => factor.ln() / NOTCH.recip().ln(),
            _ => 0.0,
        };
        i.events.iter().map(of).sum::<f32>()
    });
    let magnify = ui.input(|i| i.modifiers.command);
    if notches != 0.0 && magnify {
        let pixels = (cursor - response.rect.min) * ui.ctx().pixels_per_point();
        workspace.magnify(NOTCH.powf(-notches), Vec2::new(pixels.x, pixels.y));
    } else if notches != 0.0 {
        workspace.take_hold();
        let at = centered(response.rect, cursor);
        let factor = NOTCH.powf(notches);
        workspace.model.view = navigation::dolly(&workspace.model.view, factor, at);
    }
}

fn fly(ui: &Ui, response: &Response, workspace: &mut Workspace) {
    let direction = flight(&workspace.flying);
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
