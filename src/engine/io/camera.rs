//! The field `camera`.

use glam::Vec3;

use super::error::InputError;
use super::fields::Fields;
use super::value::Node;
use crate::engine::scene::desc::{CameraDesc, LensDesc};

/// Largest side of a picture in pixels.
const MAX_SIDE: f32 = 16384.0;

/// Reads the camera.
pub fn read(file: &str, node: &Node) -> Result<CameraDesc, InputError> {
    let mut f = Fields::new(file, node, "camera")?;
    let default = CameraDesc::default();
    if let Some((kind, line)) = f.text("type")?
        && kind != "perspective"
    {
        let message = format!("the type is \"perspective\", not \"{kind}\"");
        return Err(f.error_at(line, &message));
    }
    let position = f.vector("position")?;
    let target = f.vector("target")?;
    let up = match f.take("up") {
        Some(node) => Vec3::from(f.triple(node, "up")?),
        None => Vec3::Y,
    };
    if position == target {
        return Err(f.error("target is the position itself; the view has no direction"));
    }
    if (target - position)
        .normalize_or_zero()
        .cross(up.normalize_or_zero())
        .length()
        < 1e-6
    {
        return Err(f.error("up points along the view; it is to point elsewhere"));
    }
    let angle = "an angle in degrees between 0 and 180";
    let vfov_deg = f.number_or("vfov_deg", default.vfov_deg, angle, |x| {
        x > 0.0 && x < 180.0
    })?;
    let side = "a whole number of pixels from 1 to 16384";
    let whole = |x: f32| (1.0..=MAX_SIDE).contains(&x) && x.fract() == 0.0;
    let width = f.number_or("width", default.width as f32, side, whole)? as u32;
    let height = f.number_or("height", default.height as f32, side, whole)? as u32;
    let lens = f
        .take("lens")
        .map(|node| read_lens(file, node))
        .transpose()?;
    f.finish()?;
    Ok(CameraDesc {
        position,
        target,
        up,
        vfov_deg,
        width,
        height,
        lens,
    })
}

fn read_lens(file: &str, node: &Node) -> Result<LensDesc, InputError> {
    let mut f = Fields::new(file, node, "camera lens")?;
    let radius = f.number("radius", "a length above 0", |x| x > 0.0)?;
    let focus_distance = f.number("focus_distance", "a length above 0", |x| x > 0.0)?;
    f.finish()?;
    Ok(LensDesc {
        radius,
        focus_distance,
    })
}
