//! The picture's area: what is drawn there.

use egui::{Align2, Color32, FontId, Rect, Sense, Ui, vec2};
use glam::{UVec2, Vec2};

use super::{hand, inspector, overlay, photon_lines, pixel_values};
use crate::viewer::display::Tile;
use crate::viewer::gpu::PictureCallback;
use crate::viewer::photons;
use crate::viewer::workspace::Workspace;

/// Draws the picture and lets the hand move it.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    let rect = ui.available_rect_before_wrap();
    let scale = ui.ctx().pixels_per_point();
    workspace.area = UVec2::new(
        pixels(rect.min.x, rect.max.x, scale),
        pixels(rect.min.y, rect.max.y, scale),
    );
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Picture"));
    hand::follow(ui, &response, workspace);
    if workspace.photons.choice.asks
        && response.clicked()
        && let Some(at) = response.interact_pointer_pos()
    {
        let at = (at - rect.min) * scale;
        photons::ask(workspace, Vec2::new(at.x, at.y));
    }
    if let Some(frame) = &workspace.frame {
        let callback = PictureCallback {
            frame: frame.clone(),
            number: workspace.frame_number,
            display: workspace.model.display,
            placement: workspace.placement,
            points: photon_lines::layer(workspace),
            area: rect,
        };
        let paint = egui_wgpu::Callback::new_paint_callback(rect, callback);
        ui.painter().add(paint);
        photon_lines::show(ui, workspace, rect);
        labels(ui, rect, &workspace.model.display.tiles());
        pixel_values::show(ui, workspace, rect);
    }
    overlay::show(ui, workspace, rect);
    let cursor = response.hover_pos().map(|at| (at - rect.min) * scale);
    inspector::show(ui, workspace, rect, cursor.map(|c| Vec2::new(c.x, c.y)));
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
