//! The numbers of pixels that are magnified enough to hold them.

use egui::{Align2, Color32, FontId, Rect, Ui, pos2, vec2};
use glam::Vec2;

use super::inspector::number;
use crate::viewer::gpu::{PixelRect, place};
use crate::viewer::workspace::Workspace;

/// Side of a pixel in points from which on its numbers are shown.
const ROOM: f32 = 64.0;

/// Draws red, green and blue into every visible pixel of the area `rect`.
pub fn show(ui: &Ui, workspace: &Workspace, rect: Rect) {
    let Some(frame) = workspace.frame.as_ref().filter(|frame| !frame.is_coarse()) else {
        return;
    };
    let per_point = ui.ctx().pixels_per_point();
    let area = PixelRect {
        min: Vec2::ZERO,
        size: workspace.area.as_vec2(),
    };
    for tile in workspace.model.display.tiles() {
        let bounds = area.of_tile(&tile);
        let (corner, scale) = place(bounds, frame.full_size, workspace.placement);
        if scale / per_point < ROOM {
            return;
        }
        let last = frame.size.as_ivec2() - 1;
        let first_seen = ((bounds.min - corner) / scale).floor().as_ivec2();
        let last_seen = ((bounds.min + bounds.size - corner) / scale)
            .floor()
            .as_ivec2();
        let clip = Rect::from_min_size(
            at(rect, bounds.min, per_point),
            size(bounds.size, per_point),
        );
        let painter = ui.painter().with_clip_rect(clip);
        for y in first_seen.y.max(0)..=last_seen.y.min(last.y) {
            for x in first_seen.x.max(0)..=last_seen.x.min(last.x) {
                let i = y as usize * frame.size.x as usize + x as usize;
                let layers = tile.layers.iter().filter_map(|&l| frame.layers.get(l));
                let rgb = layers.fold([0.0; 3], |sum: [f32; 3], layer| {
                    std::array::from_fn(|c| sum[c] + layer.pixels[i][c])
                });
                let middle = corner + (Vec2::new(x as f32, y as f32) + 0.5) * scale;
                numbers(&painter, at(rect, middle, per_point), rgb);
            }
        }
    }
}

fn at(rect: Rect, pixels: Vec2, per_point: f32) -> egui::Pos2 {
    rect.min + vec2(pixels.x, pixels.y) / per_point
}

fn size(pixels: Vec2, per_point: f32) -> egui::Vec2 {
    vec2(pixels.x, pixels.y) / per_point
}

/// White on a dark ground: readable on every colour.
fn numbers(painter: &egui::Painter, middle: egui::Pos2, rgb: [f32; 3]) {
    let ground = Rect::from_center_size(middle, vec2(58.0, 38.0));
    painter.rect_filled(ground, 3.0, Color32::from_black_alpha(150));
    for (value, dy) in rgb.into_iter().zip([-12.0, 0.0, 12.0]) {
        let at = pos2(middle.x, middle.y + dy);
        let font = FontId::monospace(10.0);
        painter.text(
            at,
            Align2::CENTER_CENTER,
            number(value),
            font,
            Color32::WHITE,
        );
    }
}
