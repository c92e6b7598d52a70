//! Mouse and keys on the picture.

use egui::{Event, Key, Modifiers, MouseWheelUnit, PointerButton, Pos2, TouchPhase, Vec2, pos2};
use egui_kittest::kittest::Queryable;
use lightscope::engine::film::ToneMap;
use lightscope::engine::scene::desc::CameraDesc;
use lightscope::viewer::display::Shown;
use lightscope::viewer::workspace::Request;

use crate::desk::{Desk, desk};

const MIDDLE: Pos2 = pos2(350.0, 680.0);

fn view(desk: &Desk) -> CameraDesc {
    desk.state().model.view
}

fn button(desk: &Desk, pos: Pos2, button: PointerButton, pressed: bool, modifiers: Modifiers) {
    let event = Event::PointerButton {
        pos,
        button,
        pressed,
        modifiers,
    };
    desk.event_modifiers(event, modifiers);
}

fn drag(desk: &mut Desk, with: PointerButton, by: Vec2, modifiers: Modifiers) {
    desk.hover_at(MIDDLE);
    desk.step();
    button(desk, MIDDLE, with, true, modifiers);
    desk.step();
    desk.event_modifiers(Event::PointerMoved(MIDDLE + by), modifiers);
    desk.step();
    button(desk, MIDDLE + by, with, false, modifiers);
    desk.step();
}

fn wheel(desk: &mut Desk, at: Pos2, lines: f32) {
    desk.hover_at(at);
    desk.step();
    desk.event(Event::MouseWheel {
        unit: MouseWheelUnit::Line,
        source: egui::MouseWheelSource::Wheel,
        delta: Vec2::new(0.0, lines),
        phase: TouchPhase::Move,
        modifiers: Modifiers::NONE,
    });
    desk.run_steps(2);
}

#[test]
fn a_left_drag_orbits_and_is_one_step_of_undo() {
    let mut desk = desk();
    let before = view(&desk);
    drag(
        &mut desk,
        PointerButton::Primary,
        Vec2::new(80.0, 20.0),
        Modifiers::NONE,
    );
    let after = view(&desk);
    assert_ne!(after.position, before.position);
    desk.run_steps(2);
    desk.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    desk.step();
    assert_eq!(view(&desk), before);
    desk.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    desk.step();
    assert_eq!(view(&desk), after);
    desk.key_press(Key::Home);
    desk.step();
    assert_eq!(view(&desk), before);
}

#[test]
fn a_drag_within_one_repaint_is_not_lost() {
    let mut desk = desk();
    let before = view(&desk);
    desk.hover_at(MIDDLE);
    desk.step();
    let to = MIDDLE + Vec2::new(50.0, 0.0);
    let press = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    let events = [
        press(MIDDLE, true),
        Event::PointerMoved(to),
        press(to, false),
    ];
    desk.input_mut().events.extend(events);
    desk.step();
    assert_ne!(view(&desk).position, before.position);
    assert!(desk.state().hold.is_none());
}

#[test]
fn middle_right_and_shift_drags_pan() {
    for (with, modifiers) in [
        (PointerButton::Middle, Modifiers::NONE),
        (PointerButton::Secondary, Modifiers::NONE),
        (PointerButton::Primary, Modifiers::SHIFT),
    ] {
        let mut desk = desk();
        let before = view(&desk);
        drag(&mut desk, with, Vec2::new(40.0, 0.0), modifiers);
        let after = view(&desk);
        let turned = |v: &CameraDesc| (v.target - v.position).normalize();
        assert_ne!(after.position, before.position, "{with:?}");
        assert!(
            turned(&after).dot(turned(&before)) > 0.999_99,
            "{with:?} turns"
        );
    }
}

#[test]
fn the_wheel_dollies_on_the_picture_alone() {
    let mut desk = desk();
    let before = view(&desk);
    wheel(&mut desk, pos2(850.0, 300.0), 3.0);
    assert_eq!(view(&desk), before, "the panel scrolls, the camera stays");
    wheel(&mut desk, MIDDLE, 3.0);
    let near = view(&desk);
    let step = near.position - before.position;
    assert!(step.dot(before.target - before.position) > 0.0, "{step}");
    wheel(&mut desk, MIDDLE, -3.0);
    let back = view(&desk);
    assert!(back.position.distance(before.position) < 1e-3, "{back:?}");
}

#[test]
fn flying_goes_on_while_the_key_is_held() {
    let mut desk = desk();
    desk.key_down(Key::W);
    desk.run_steps(5);
    let five = view(&desk).position;
    desk.run_steps(5);
    let ten = view(&desk).position;
    desk.key_up(Key::W);
    desk.run_steps(3);
    let stopped = view(&desk).position;
    desk.run_steps(3);
    assert!(five != ten);
    assert_eq!(view(&desk).position, stopped);
}

#[test]
fn the_letter_of_a_shortcut_does_not_fly_when_ctrl_is_let_go_first() {
    let mut desk = desk();
    let before = view(&desk);
    let letter = |desk: &Desk, pressed, modifiers| {
        let event = Event::Key {
            key: Key::E,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers,
        };
        desk.event_modifiers(event, modifiers);
    };
    letter(&desk, true, Modifiers::COMMAND);
    desk.run_steps(2);
    // The system repeats a held key, now without Ctrl.
    letter(&desk, true, Modifiers::NONE);
    desk.run_steps(5);
    letter(&desk, false, Modifiers::NONE);
    desk.run_steps(2);
    assert_eq!(view(&desk), before);
    desk.key_down(Key::E);
    desk.run_steps(2);
    assert_ne!(view(&desk), before, "alone it flies");
}

#[test]
fn a_double_click_brings_the_point_to_the_middle() {
    let mut desk = desk();
    let before = view(&desk);
    let at = MIDDLE + Vec2::new(60.0, 60.0);
    desk.hover_at(at);
    desk.step();
    for _ in 0..2 {
        button(&desk, at, PointerButton::Primary, true, Modifiers::NONE);
        button(&desk, at, PointerButton::Primary, false, Modifiers::NONE);
        desk.step();
    }
    let after = view(&desk);
    assert_eq!(after.position, before.position);
    assert_ne!(after.target, before.target);
}

#[test]
fn keys_change_what_is_shown() {
    let mut desk = desk();
    let press = |desk: &mut Desk, key| {
        desk.key_press(key);
        desk.step();
    };
    for (key, part) in [Key::Num1, Key::Num2, Key::Num3, Key::Num4]
        .into_iter()
        .zip(0..)
    {
        press(&mut desk, key);
        assert_eq!(desk.state().model.display.shown.solo(), Some(part));
    }
    press(&mut desk, Key::Num0);
    assert_eq!(desk.state().model.display.shown, Shown::Whole);
    press(&mut desk, Key::Num5);
    assert_eq!(desk.state().model.display.shown, Shown::Grid);
    press(&mut desk, Key::Plus);
    assert!(desk.state().model.display.exposure > 0.3);
    press(&mut desk, Key::T);
    assert_eq!(desk.state().model.display.tonemap, ToneMap::Reinhard);
    press(&mut desk, Key::Space);
    assert!(desk.state().paused);
    press(&mut desk, Key::P);
    assert!(desk.query_by_label("Integrator").is_none());
    desk.key_press_modifiers(Modifiers::COMMAND, Key::Q);
    desk.step();
    assert_eq!(desk.state().requests, [Request::Quit]);
}

#[test]
fn letters_typed_into_a_field_are_no_commands() {
    let mut desk = desk();
    desk.get_by_label("Seed").click();
    desk.run();
    desk.key_press(Key::P);
    desk.key_press(Key::Num5);
    desk.step();
    assert!(desk.state().preferences.panel);
    assert_eq!(desk.state().model.display.shown, Shown::Whole);
}
