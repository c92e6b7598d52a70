use super::*;
use crate::engine::camera::Camera;
use crate::engine::scene::desc::LensDesc;

fn view() -> CameraDesc {
    CameraDesc {
        position: Vec3::new(1.0, 2.0, 8.0),
        target: Vec3::new(0.5, 1.0, -1.0),
        ..CameraDesc::default()
    }
}

/// Where the picture shows `point`, from the middle to the right and down in picture heights.
fn seen_at(view: &CameraDesc, point: Vec3) -> Vec2 {
    let [right, up, forward] = axes(view);
    let to = point - view.position;
    let scale = 1.0 / (2.0 * half_height(view) * to.dot(forward));
    Vec2::new(to.dot(right), -to.dot(up)) * scale
}

fn assert_near(a: Vec2, b: Vec2) {
    assert!(a.distance(b) < 1e-4, "{a} is not {b}");
}

#[test]
fn orbits_keep_target_distance_and_horizon() {
    let mut v = view();
    for i in 0..1000 {
        v = orbit(&v, Vec2::new(0.3, (i as f32 * 0.7).sin()));
        assert!(is_usable(&v), "{v:?}");
        assert!((distance(&v) / distance(&view()) - 1.0).abs() < 1e-3);
        assert_eq!((v.target, v.up), (view().target, view().up));
        assert!(axes(&v)[0].y.abs() < 1e-4, "the horizon tilts");
    }
}

#[test]
fn dragging_right_brings_the_left_side_to_the_front() {
    // A point on the near side follows the hand.
    let v = view();
    let near = v.target - axes(&v)[2] * 2.0;
    let moved = orbit(&v, Vec2::new(0.1, 0.0));
    assert!(seen_at(&moved, near).x > seen_at(&v, near).x);
    let moved = orbit(&v, Vec2::new(0.0, 0.1));
    assert!(seen_at(&moved, near).y > seen_at(&v, near).y);
}

#[test]
fn orbiting_stops_at_the_poles() {
    let over = orbit(&view(), Vec2::new(0.0, 10.0));
    assert!(is_usable(&over) && axes(&over)[2].y < -0.999);
    let under = orbit(&view(), Vec2::new(0.0, -10.0));
    assert!(is_usable(&under) && axes(&under)[2].y > 0.999);
}

#[test]
fn panning_moves_the_target_plane_with_the_hand() {
    let v = view();
    let shift = Vec2::new(0.25, -0.125);
    let moved = pan(&v, shift);
    assert_near(seen_at(&moved, v.target), shift);
    assert_eq!(distance(&moved), distance(&v));
}

#[test]
fn dollying_keeps_the_point_under_the_cursor() {
    let v = view();
    let [right, up, _] = axes(&v);
    let point = v.target + right * 0.7 - up * 0.3;
    let cursor = seen_at(&v, point);
    for factor in [0.5, 0.9, 1.1, 3.0] {
        let moved = dolly(&v, factor, cursor);
        assert_near(seen_at(&moved, point), cursor);
        assert!((distance(&moved) / distance(&v) - factor).abs() < 1e-4);
    }
}

#[test]
fn dollying_never_reaches_the_target() {
    let mut v = view();
    for _ in 0..1000 {
        v = dolly(&v, 0.8, Vec2::ZERO);
    }
    assert!(is_usable(&v) && Camera::new(&v).is_ok(), "{v:?}");
}

#[test]
fn flying_moves_eye_and_target_alike() {
    let v = view();
    let moved = fly(&v, Vec3::new(1.0, 2.0, 3.0));
    let shift = moved.position - v.position;
    assert!((shift - (moved.target - v.target)).length() < 1e-5);
    let [right, up, forward] = axes(&v);
    let parts = Vec3::new(shift.dot(right), shift.dot(up), shift.dot(forward));
    assert!((parts - Vec3::new(1.0, 2.0, 3.0)).length() < 1e-4);
}

#[test]
fn looking_turns_about_the_eye() {
    let v = view();
    let moved = look(&v, Vec2::new(0.2, 0.0));
    assert_eq!(moved.position, v.position);
    // Looking to the right, what was in the middle is on the left.
    assert!(seen_at(&moved, v.target).x < -0.05);
    let moved = look(&v, Vec2::new(0.0, 0.2));
    assert!(seen_at(&moved, v.target).y < -0.05);
}

#[test]
fn the_target_moves_along_the_view_to_the_middle_of_the_scene() {
    let v = view();
    let center = v.position + axes(&v)[2] * 20.0 + axes(&v)[0] * 3.0;
    let deep = with_target_in(&v, center, 5.0);
    assert_near(seen_at(&deep, v.target), Vec2::ZERO);
    assert!((distance(&deep) - 20.0).abs() < 1e-3);
    assert_eq!(with_target_in(&v, center, 50.0), v, "it lies in the scene");
    let behind = v.position - axes(&v)[2];
    assert_eq!(with_target_in(&v, behind, 0.1), v);
}

#[test]
fn a_point_in_focus_is_in_the_middle_and_sharp() {
    let mut v = view();
    v.lens = Some(LensDesc {
        radius: 0.1,
        focus_distance: 1.0,
    });
    let point = Vec3::new(0.3, 0.4, 0.5);
    let focused = focus(&v, point);
    assert_near(seen_at(&focused, point), Vec2::ZERO);
    let distance = focused.position.distance(point);
    assert_eq!(focused.lens.map(|l| l.focus_distance), Some(distance));
    // The eye itself cannot be looked at.
    assert_eq!(focus(&v, v.position), v);
}

#[test]
fn presets_look_along_their_axis_from_the_same_distance() {
    for direction in [
        Vec3::X,
        Vec3::NEG_X,
        Vec3::Y,
        Vec3::NEG_Y,
        Vec3::Z,
        Vec3::NEG_Z,
    ] {
        let v = along(&view(), direction);
        assert!(is_usable(&v), "{direction}");
        assert!((distance(&v) / distance(&view()) - 1.0).abs() < 1e-4);
        assert!(axes(&v)[2].dot(direction) > 0.999);
    }
}
