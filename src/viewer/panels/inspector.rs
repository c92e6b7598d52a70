//! What lies under the cursor.

use egui::{Align2, Area, Color32, Grid, Id, RichText, Ui, vec2};
use glam::{UVec2, Vec2};

use super::style;
use crate::viewer::gpu::picture_point;
use crate::viewer::picking;
use crate::viewer::workspace::Workspace;

/// Distance from the corner in points.
const MARGIN: f32 = 12.0;
/// The standard error is that of the 5 × 5 pixels around: two halves of one pixel know little.
const REACH: u32 = 2;

/// Draws the values at `cursor`, in physical pixels of the picture's area, at the top right of
/// `rect`, or at the top left while the cursor would be below them.
pub fn show(ui: &Ui, workspace: &Workspace, rect: egui::Rect, cursor: Option<Vec2>) {
    if !workspace.inspector {
        return;
    }
    let quarter = rect.size() * ui.ctx().pixels_per_point() / 2.0;
    let (pivot, corner, margin) = match cursor {
        Some(at) if at.x > quarter.x && at.y < quarter.y => {
            (Align2::LEFT_TOP, rect.left_top(), MARGIN)
        }
        _ => (Align2::RIGHT_TOP, rect.right_top(), -MARGIN),
    };
    Area::new(Id::unique("inspector"))
        .pivot(pivot)
        .fixed_pos(corner + vec2(margin, MARGIN))
        .interactable(false)
        .show(ui.ctx(), |ui| {
            style::overlay_frame().show(ui, |ui| {
                ui.visuals_mut().override_text_color = Some(Color32::WHITE);
                match cursor.and_then(|cursor| values(workspace, cursor)) {
                    Some(lines) => table(ui, &lines),
                    None => {
                        ui.label("Point at the picture.");
                    }
                }
            });
        });
}

fn table(ui: &mut Ui, lines: &[(String, String)]) {
    Grid::new("values")
        .num_columns(2)
        .spacing([14.0, 2.0])
        .show(ui, |ui| {
            for (name, value) in lines {
                ui.label(name);
                ui.label(RichText::new(value).monospace());
                ui.end_row();
            }
        });
}

/// Names and values of the pixel, then of the surface.
fn values(workspace: &Workspace, cursor: Vec2) -> Option<Vec<(String, String)>> {
    let frame = workspace.frame.as_ref()?;
    let display = &workspace.model.display;
    let at = picture_point(
        display,
        workspace.placement,
        workspace.area,
        frame.full_size,
        cursor,
    )?;
    let pixel = at.as_uvec2();
    let share = frame.size.as_vec2() / frame.full_size.max(UVec2::ONE).as_vec2();
    let held = (at * share).as_uvec2().min(frame.size.max(UVec2::ONE) - 1);
    let i = held.y as usize * frame.size.x as usize + held.x as usize;
    let mut lines = vec![("pixel".to_owned(), format!("{} {}", pixel.x, pixel.y))];
    for layer in &frame.layers {
        let rgb = layer.pixels.get(i)?;
        lines.push((layer.label.clone(), rgb.map(number).join(" ")));
    }
    if let Some(error) = frame.standard_error(held, REACH) {
        lines.push(("std. error".to_owned(), error.map(number).join(" ")));
    }
    lines.push(("samples".to_owned(), frame.passes.to_string()));
    if let Some(hit) = picking::hit(workspace, cursor) {
        lines.push(("material".to_owned(), hit.material));
        lines.push(("depth".to_owned(), number(hit.distance)));
        lines.push((
            "point".to_owned(),
            hit.point.to_array().map(number).join(" "),
        ));
        lines.push((
            "normal".to_owned(),
            hit.normal.to_array().map(number).join(" "),
        ));
    }
    Some(lines)
}

/// Four digits in a column of nine.
pub fn number(x: f32) -> String {
    let magnitude = x.abs();
    if magnitude == 0.0 || (1e-3..1e5).contains(&magnitude) {
        let digits = if magnitude < 10.0 { 4 } else { 2 };
        format!("{x:>9.digits$}")
    } else {
        format!("{x:>9.2e}")
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_have_one_width() {
        for x in [0.0, 1.0, -12.5, 3.2e-7, 1e30, 0.001, 99_999.0] {
            assert_eq!(number(x).len(), 9, "{}", number(x));
        }
        assert_eq!(number(0.5).trim(), "0.5000");
        assert_eq!(number(f32::NAN).trim(), "NaN");
    }
}
