//! Error images and what the referee compares, over the picture.

use egui::{
    Align2, Color32, ColorImage, FontId, Painter, Pos2, Rect, TextureOptions, Ui, pos2, vec2,
};
use glam::Vec2;

use crate::viewer::gpu::{PixelRect, place};
use crate::viewer::measuring::Over;
use crate::viewer::measuring::overlay::{Overlay, Scale};
use crate::viewer::measuring::referee::Arrangement;
use crate::viewer::workspace::Workspace;

/// Size of the scale of colours in points.
const BAR: [f32; 2] = [220.0, 12.0];

/// Draws it in the picture's area.
pub fn show(ui: &Ui, workspace: &mut Workspace, rect: Rect) {
    let (placement, area) = (workspace.placement, workspace.area);
    let measuring = &mut workspace.measuring;
    let overlay = match measuring.over {
        Over::Nothing => return,
        Over::Error => &mut measuring.error_image,
        Over::Referee => {
            measuring.referee.draw(&workspace.model.display);
            &mut measuring.referee.overlay
        }
    };
    if overlay.size.min_element() == 0 {
        return;
    }
    let texture = texture(ui, overlay);
    let whole = PixelRect {
        min: Vec2::ZERO,
        size: area.as_vec2(),
    };
    let (corner, scale) = place(whole, overlay.size, placement);
    let points = 1.0 / ui.ctx().pixels_per_point();
    let min = rect.min + vec2(corner.x, corner.y) * points;
    let size = overlay.size.as_vec2() * scale * points;
    let picture = Rect::from_min_size(min, vec2(size.x, size.y));
    let painter = ui.painter().with_clip_rect(rect);
    let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    painter.image(texture, picture, uv, Color32::WHITE);
    if let Some(scale) = &overlay.scale {
        bar(&painter, rect, scale);
    }
    if measuring.over == Over::Referee {
        sides(&painter, rect, picture, workspace);
    }
}

fn texture(ui: &Ui, overlay: &mut Overlay) -> egui::TextureId {
    let version = overlay.version;
    if let Some((held, texture)) = &overlay.texture
        && *held == version
    {
        return texture.id();
    }
    let pixels = overlay.pixels.iter();
    let pixels = pixels.map(|[r, g, b, a]| Color32::from_rgba_unmultiplied(*r, *g, *b, *a));
    let size = [overlay.size.x as usize, overlay.size.y as usize];
    let image = ColorImage::new(size, pixels.collect());
    let context = ui.ctx();
    let texture = context.load_texture("overlay", image, TextureOptions::NEAREST);
    let id = texture.id();
    overlay.texture = Some((version, texture));
    id
}

/// Text on a dark ground.
fn label(painter: &Painter, at: Pos2, align: Align2, text: &str) {
    let font = FontId::proportional(13.0);
    let galley = painter.layout_no_wrap(text.to_owned(), font, Color32::WHITE);
    let ground = align.anchor_size(at, galley.size());
    painter.rect_filled(
        ground.expand2(vec2(6.0, 3.0)),
        4.0,
        Color32::from_black_alpha(190),
    );
    painter.galley(ground.min, galley, Color32::WHITE);
}

/// The scale of colours, at the bottom left.
fn bar(painter: &Painter, rect: Rect, scale: &Scale) {
    let min = rect.left_bottom() + vec2(18.0, -52.0);
    let ground = Rect::from_min_size(min - vec2(10.0, 24.0), vec2(BAR[0] + 20.0, 66.0));
    painter.rect_filled(ground, 4.0, Color32::from_black_alpha(190));
    let steps = 64;
    for i in 0..steps {
        let share = i as f32 / (steps - 1) as f32;
        let [r, g, b] = scale.color(share);
        let width = BAR[0] / steps as f32;
        let at = min + vec2(width * i as f32, 0.0);
        let cell = Rect::from_min_size(at, vec2(width + 0.5, BAR[1]));
        painter.rect_filled(cell, 0.0, Color32::from_rgb(r, g, b));
    }
    let font = FontId::proportional(12.0);
    let text = |at: Pos2, align: Align2, text: String| {
        painter.text(at, align, text, font.clone(), Color32::WHITE);
    };
    text(
        min - vec2(0.0, 5.0),
        Align2::LEFT_BOTTOM,
        scale.label.clone(),
    );
    let below = min + vec2(0.0, BAR[1] + 4.0);
    let [low, high] = scale.ends;
    text(below, Align2::LEFT_TOP, number(low));
    text(
        below + vec2(0.5 * BAR[0], 0.0),
        Align2::CENTER_TOP,
        number(0.5 * (low + high)),
    );
    let more = if scale.signed { "" } else { " and more" };
    text(
        below + vec2(BAR[0], 0.0),
        Align2::RIGHT_TOP,
        format!("{}{more}", number(high)),
    );
}

fn number(x: f32) -> String {
    let size = x.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e4).contains(&size) {
        format!("{}", (x * 1e5).round() / 1e5)
    } else {
        format!("{x:.1e}")
    }
}

/// Names of the referee's sides, and the border between them.
fn sides(painter: &Painter, rect: Rect, picture: Rect, workspace: &Workspace) {
    let referee = &workspace.measuring.referee;
    let Some(state) = &referee.state else { return };
    let [first, second] = &state.names;
    let top = rect.top() + 10.0;
    let border = match referee.arrangement {
        Arrangement::Split => 0.5,
        Arrangement::Wipe => referee.border,
        Arrangement::Flip => {
            let name = if referee.flipped { second } else { first };
            return label(
                painter,
                pos2(rect.left() + 16.0, top),
                Align2::LEFT_TOP,
                name,
            );
        }
        Arrangement::Difference => {
            let text = format!("{first} less {second}");
            return label(
                painter,
                pos2(rect.left() + 16.0, top),
                Align2::LEFT_TOP,
                &text,
            );
        }
        Arrangement::ZMap => {
            let text = format!("{first} less {second}, blocks of 8 × 8 pixels");
            return label(
                painter,
                pos2(rect.left() + 16.0, top),
                Align2::LEFT_TOP,
                &text,
            );
        }
    };
    let x = picture.left() + border * picture.width();
    painter.vline(x, picture.y_range(), egui::Stroke::new(1.0, Color32::WHITE));
    label(painter, pos2(x - 14.0, top), Align2::RIGHT_TOP, first);
    label(painter, pos2(x + 14.0, top), Align2::LEFT_TOP, second);
}
