//! Moving the camera: pure functions from view to view.
//!
//! A view turns about its target, which lies in the middle of the picture. All of them keep the
//! up direction: the horizon stays level.

use glam::{Quat, Vec2, Vec3};

use crate::engine::scene::desc::CameraDesc;

/// Smallest angle between view direction and up direction, in radians.
const POLE: f32 = 0.01;

/// Right, up and forward of a view, unit vectors.
pub fn axes(view: &CameraDesc) -> [Vec3; 3] {
    let forward = (view.target - view.position).normalize_or(Vec3::NEG_Z);
    let right = forward
        .cross(view.up)
        .try_normalize()
        .unwrap_or_else(|| forward.any_orthonormal_vector());
    [right, right.cross(forward), forward]
}

/// Distance from eye to target.
pub fn distance(view: &CameraDesc) -> f32 {
    view.position.distance(view.target)
}

/// Half the picture's height at distance 1.
fn half_height(view: &CameraDesc) -> f32 {
    (0.5 * view.vfov_deg.to_radians()).tan()
}

/// The direction of view turned by `yaw` about the up direction and by `pitch` upward, radians.
fn turned(view: &CameraDesc, yaw: f32, pitch: f32) -> Vec3 {
    let up = view.up.normalize_or(Vec3::Y);
    let [right, _, forward] = axes(view);
    let angle = forward.angle_between(up);
    let pitch = pitch.clamp(
        (angle - std::f32::consts::PI + POLE).min(0.0),
        (angle - POLE).max(0.0),
    );
    Quat::from_axis_angle(up, yaw) * Quat::from_axis_angle(right, pitch) * forward
}

/// Turns the eye about the target, as if the scene were taken by the hand: `angle` in radians to
/// the right and down.
#[must_use]
pub fn orbit(view: &CameraDesc, angle: Vec2) -> CameraDesc {
    let forward = turned(view, -angle.x, -angle.y);
    CameraDesc {
        position: view.target - forward * distance(view),
        ..*view
    }
}

/// Turns the view about the eye: `angle` in radians to the right and down.
#[must_use]
pub fn look(view: &CameraDesc, angle: Vec2) -> CameraDesc {
    let forward = turned(view, -angle.x, -angle.y);
    CameraDesc {
        target: view.position + forward * distance(view),
        ..*view
    }
}

/// Moves eye and target so that the plane of the target follows the hand: `shift` to the right
/// and down in picture heights.
#[must_use]
pub fn pan(view: &CameraDesc, shift: Vec2) -> CameraDesc {
    let [right, up, _] = axes(view);
    let height = 2.0 * half_height(view) * distance(view);
    let shift = (up * shift.y - right * shift.x) * height;
    CameraDesc {
        position: view.position + shift,
        target: view.target + shift,
        ..*view
    }
}

/// Multiplies the distance to the target by `factor` and keeps the point of the target's plane
/// under the cursor where it is; `cursor` counts from the middle of the picture, to the right and
/// down, in picture heights.
#[must_use]
pub fn dolly(view: &CameraDesc, factor: f32, cursor: Vec2) -> CameraDesc {
    let [right, up, _] = axes(view);
    let height = 2.0 * half_height(view) * distance(view);
    let fixed = view.target + (right * cursor.x - up * cursor.y) * height;
    // Nearer than this the eye would not move in single precision.
    let nearest = 1e-5 * view.target.length().max(view.position.length());
    if distance(view) * factor <= nearest {
        return *view;
    }
    CameraDesc {
        position: fixed + (view.position - fixed) * factor,
        target: fixed + (view.target - fixed) * factor,
        ..*view
    }
}

/// Moves eye and target by `step` to the right, up and forward in lengths of the scene.
#[must_use]
pub fn fly(view: &CameraDesc, step: Vec3) -> CameraDesc {
    let [right, up, forward] = axes(view);
    let shift = right * step.x + up * step.y + forward * step.z;
    CameraDesc {
        position: view.position + shift,
        target: view.target + shift,
        ..*view
    }
}

/// The same view with its target as deep as `center`, unless it lies within `radius` of it: files
/// often put the target just before the eye, and orbits would turn about nothing.
#[must_use]
pub fn with_target_in(view: &CameraDesc, center: Vec3, radius: f32) -> CameraDesc {
    let [_, _, forward] = axes(view);
    let depth = (center - view.position).dot(forward);
    let target = view.position + forward * depth;
    // Behind the eye, or in it, there is nothing to turn about.
    let before_eye = depth.is_finite() && depth > 0.05 * view.position.distance(center);
    if before_eye && view.target.distance(center) > radius {
        CameraDesc { target, ..*view }
    } else {
        *view
    }
}

/// Looks at `point`, which becomes the centre of orbits and, with a lens, is in focus.
#[must_use]
pub fn focus(view: &CameraDesc, point: Vec3) -> CameraDesc {
    let mut focused = CameraDesc {
        target: point,
        ..*view
    };
    let distance = distance(&focused);
    if let Some(lens) = &mut focused.lens {
        lens.focus_distance = distance;
    }
    if is_usable(&focused) { focused } else { *view }
}

/// Looks at the target along `direction` from the same distance.
#[must_use]
pub fn along(view: &CameraDesc, direction: Vec3) -> CameraDesc {
    let up = view.up.normalize_or(Vec3::Y);
    let mut forward = direction.normalize_or(Vec3::NEG_Z);
    if forward.cross(up).length() < POLE {
        // Seen from above or below: a little off the pole, so that what was to the right stays.
        let [right, _, _] = axes(view);
        forward = (forward + POLE * forward.dot(up).signum() * up.cross(right)).normalize();
    }
    CameraDesc {
        position: view.target - forward * distance(view),
        ..*view
    }
}

/// True if a camera can be made of the view.
pub fn is_usable(view: &CameraDesc) -> bool {
    let forward = view.target - view.position;
    forward.is_finite()
        && forward.length() > 0.0
        && forward.normalize_or_zero().cross(view.up).length() > 1e-4 * view.up.length()
}

#[cfg(test)]
mod tests;
