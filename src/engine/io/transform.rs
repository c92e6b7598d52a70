//! The field `transform`: a list of steps, applied in order.

use glam::{Affine3A, Mat3A, Quat, Vec3};

use super::error::InputError;
use super::fields::Fields;
use super::value::{Node, Value};

/// Reads `transform` of a table: steps `{ translate = [x, y, z] }`,
/// `{ rotate_deg = { axis = [x, y, z], angle = a } }` and `{ scale = s }` or
/// `{ scale = [x, y, z] }`.
pub fn read(f: &mut Fields<'_>) -> Result<Option<Affine3A>, InputError> {
    let steps = f.list("transform")?;
    let mut all = Affine3A::IDENTITY;
    for step in steps {
        all = read_step(f.file(), step, &f.what)? * all;
    }
    Ok((!steps.is_empty()).then_some(all))
}

fn read_step(file: &str, node: &Node, what: &str) -> Result<Affine3A, InputError> {
    let mut f = Fields::new(file, node, format!("{what}, transform"))?;
    let step = if let Some(node) = f.take("translate") {
        Affine3A::from_translation(Vec3::from(f.triple(node, "translate")?))
    } else if let Some(node) = f.take("rotate_deg") {
        rotation(file, node, what)?
    } else if let Some(node) = f.take("scale") {
        let scale = match node.value {
            Value::Number(_) => {
                Vec3::splat(f.number_in(node, "scale", "a number other than 0", |x| x != 0.0)?)
            }
            _ => Vec3::from(f.triple(node, "scale")?),
        };
        if scale.min_element() == 0.0 || scale.max_element() == 0.0 {
            return Err(f.error_at(node.line, "scale by 0 leaves nothing; use another number"));
        }
        Affine3A::from_scale(scale)
    } else {
        return Err(f.error("a step is one of translate, rotate_deg, scale"));
    };
    f.finish()?;
    Ok(step)
}

fn rotation(file: &str, node: &Node, what: &str) -> Result<Affine3A, InputError> {
    let mut f = Fields::new(file, node, format!("{what}, rotate_deg"))?;
    let axis = f.direction("axis")?;
    let angle = f.number("angle", "an angle in degrees", |_| true)?;
    f.finish()?;
    Ok(Affine3A::from_quat(Quat::from_axis_angle(
        axis.normalize(),
        angle.to_radians(),
    )))
}

/// The factor of a transform that scales all directions alike; `None` otherwise.
pub fn uniform_scale(transform: &Affine3A) -> Option<f32> {
    let m: Mat3A = transform.matrix3;
    let lengths = [m.x_axis.length(), m.y_axis.length(), m.z_axis.length()];
    let same = lengths
        .iter()
        .all(|l| (l - lengths[0]).abs() <= 1e-5 * lengths[0]);
    let square = m.x_axis.dot(m.y_axis).abs() <= 1e-5 * lengths[0] * lengths[0];
    (same && square).then_some(lengths[0])
}
