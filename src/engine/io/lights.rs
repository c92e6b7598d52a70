//! The field `lights`: emitters without surface.

use glam::{Quat, Vec3};

use super::error::{InputError, did_you_mean};
use super::fields::Fields;
use super::image::Encoding;
use super::materials::Colors;
use super::value::Node;
use crate::engine::math::Rgb;
use crate::engine::scene::desc::LightDesc;

const TYPES: [&str; 5] = ["point", "spot", "directional", "constant", "environment"];

/// Reads one light.
pub fn read(file: &str, node: &Node, colors: &mut Colors<'_>) -> Result<LightDesc, InputError> {
    let mut f = Fields::new(file, node, "light")?;
    f.text("name")?;
    let (kind, line) = f.required_text("type", "the kind of light, such as \"point\"")?;
    f.what = format!("{kind} light");
    let light = match kind {
        "point" => LightDesc::Point {
            position: f.vector("position")?,
            intensity: amounts(&mut f, "intensity")?,
        },
        "spot" => spot(&mut f)?,
        "directional" => LightDesc::Directional {
            direction: f.direction("direction")?,
            irradiance: amounts(&mut f, "irradiance")?,
        },
        "constant" => LightDesc::Constant {
            radiance: amounts(&mut f, "radiance")?,
        },
        "environment" => {
            let (name, line) = f.required_text("file", "the name of an image")?;
            let scale = match f.take("scale") {
                Some(node) => f.amounts(node, "scale")?,
                None => Rgb::WHITE,
            };
            let angle = f.number_or("rotate_deg", 0.0, "an angle in degrees", |_| true)?;
            let image = colors.image(file, line, name, Encoding::Srgb)?;
            let rotation = Quat::from_axis_angle(Vec3::Y, angle.to_radians());
            LightDesc::Environment {
                image,
                scale,
                rotation,
            }
        }
        other => {
            let hint = did_you_mean(other, TYPES);
            let known = if hint.is_empty() {
                format!("; there are {}", TYPES.join(", "))
            } else {
                hint
            };
            let message = format!("light: there is no type \"{other}\"{known}");
            return Err(InputError::at(file, line, message));
        }
    };
    f.finish()?;
    Ok(light)
}

fn spot(f: &mut Fields<'_>) -> Result<LightDesc, InputError> {
    let position = f.vector("position")?;
    let direction = f.direction("direction")?;
    let intensity = amounts(f, "intensity")?;
    let half = "half the opening angle in degrees, above 0 and at most 180";
    let angle_deg = f.number("angle_deg", half, |x| x > 0.0 && x <= 180.0)?;
    let edge = "the width of the soft edge in degrees, from 0 to angle_deg";
    let falloff_deg = f.number_or("falloff_deg", 0.0, edge, |x| (0.0..=angle_deg).contains(&x))?;
    Ok(LightDesc::Spot {
        position,
        direction,
        intensity,
        angle_deg,
        falloff_deg,
    })
}

fn amounts(f: &mut Fields<'_>, name: &'static str) -> Result<Rgb, InputError> {
    let node = f.required(name, "a list of three numbers of at least 0")?;
    f.amounts(node, name)
}
