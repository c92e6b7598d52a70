//! Bytes of saved pictures. What they look like is what the window shows.

use glam::UVec2;

use super::display::Display;
use super::false_color::false_color;
use super::model::Model;
use super::state::KEY;
use crate::engine::film::Frame;
use crate::engine::film::tonemap::{NAN_COLOR, tonemap};
use crate::picture::{exr_file, origin, png_file};

/// What the window shows for a pixel that is infinite.
const INFINITE_COLOR: [u8; 3] = [0, 255, 255];

/// The picture as it is shown, pixel by pixel; four pictures side by side make one of twice the
/// size.
pub fn shown(frame: &Frame, display: &Display) -> (UVec2, Vec<[u8; 3]>) {
    let tiles = display.tiles();
    let columns = if tiles.len() > 1 { 2 } else { 1 };
    let size = frame.size * columns;
    let mut pixels = vec![[0; 3]; size.x as usize * size.y as usize];
    for tile in &tiles {
        let left = (tile.area[0] * size.x as f32) as usize;
        let top = (tile.area[1] * size.y as f32) as usize;
        for y in 0..frame.size.y as usize {
            for x in 0..frame.size.x as usize {
                let i = y * frame.size.x as usize + x;
                let layers = tile.layers.iter().filter_map(|&l| frame.layers.get(l));
                let rgb = layers.fold([0.0; 3], |sum: [f32; 3], layer| {
                    std::array::from_fn(|c| sum[c] + layer.pixels[i][c])
                });
                let at = (top + y) * size.x as usize + left + x;
                pixels[at] = bytes(display, tile.exposure, rgb);
            }
        }
    }
    (size, pixels)
}

fn bytes(display: &Display, exposure: f32, rgb: [f32; 3]) -> [u8; 3] {
    if rgb.iter().any(|x| x.is_nan()) {
        NAN_COLOR
    } else if rgb.iter().any(|x| x.is_infinite()) {
        INFINITE_COLOR
    } else if display.false_color {
        false_color(exposure, rgb)
    } else {
        tonemap(display.tonemap, exposure, rgb)
    }
}

/// A PNG file of the picture as shown.
///
/// # Errors
/// A sentence.
pub fn png(frame: &Frame, model: &Model, state: String) -> Result<Vec<u8>, String> {
    let (size, pixels) = shown(frame, &model.display);
    png_file::encode(size, &pixels, &texts(frame, model, state)).map_err(|error| error.to_string())
}

/// An EXR file of the whole and all layers.
///
/// # Errors
/// A sentence.
pub fn exr(frame: &Frame, model: &Model, state: String) -> Result<Vec<u8>, String> {
    // The whole comes first, if it was computed.
    let first = usize::from(!frame.plan.whole);
    let layers: Vec<(&str, &[[f32; 3]])> = frame
        .layers
        .iter()
        .skip(first)
        .map(|layer| (layer.label.as_str(), layer.pixels.as_slice()))
        .collect();
    exr_file::encode(frame.size, &layers, &texts(frame, model, state))
        .map_err(|error| error.to_string())
}

/// What a file says about its origin.
fn texts(frame: &Frame, model: &Model, state: String) -> Vec<(String, String)> {
    let mut texts = origin::texts(&model.source.to_string(), &model.settings, frame);
    texts.push((KEY.to_owned(), state));
    texts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::film::FrameLayer;
    use crate::engine::plan::RenderPlan;
    use crate::viewer::display::Shown;

    #[test]
    fn side_by_side_every_component_has_its_quarter() {
        let mut frame = Frame::empty(std::sync::Arc::new(RenderPlan::nothing()));
        frame.size = UVec2::new(3, 2);
        frame.layers = [9.0, 0.0, 0.25, 0.5, f32::NAN]
            .map(|value| FrameLayer {
                label: String::new(),
                pixels: vec![[value; 3]; 6],
            })
            .to_vec();
        let display = Display {
            shown: Shown::Grid,
            ..Display::default()
        };
        let (size, pixels) = shown(&frame, &display);
        assert_eq!(size, UVec2::new(6, 4));
        let at = |x: usize, y: usize| pixels[y * 6 + x];
        assert_eq!([at(2, 1), at(3, 0), at(0, 3)], [[0; 3], [137; 3], [188; 3]]);
        assert_eq!(at(5, 3), NAN_COLOR);
        let whole = shown(&frame, &Display::default());
        assert_eq!(whole, (UVec2::new(3, 2), vec![[255; 3]; 6]));
    }
}
