//! From tiles and sizes to the numbers the shader needs.

use glam::{UVec2, Vec2};

use super::layers::SLOTS;
use super::pipelines::{FALSE_COLOR, Variant};
use crate::engine::film::{Frame, ToneMap};
use crate::viewer::display::{Display, Tile};

/// Where the picture area lies and how the picture lies in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Magnification over the largest size that fits.
    pub zoom: f32,
    /// The point of the picture in the middle of its tile, as shares of its sides.
    pub center: Vec2,
}

impl Default for Placement {
    fn default() -> Self {
        Self {
            zoom: 1.0,
            center: Vec2::splat(0.5),
        }
    }
}

/// The shader's `Tile`.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct TileUniform {
    frame: [u32; 2],
    exposure: f32,
    surround: f32,
    offset: [f32; 2],
    scale: [f32; 2],
}

/// A rectangle of the target in physical pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelRect {
    /// Left top.
    pub min: Vec2,
    /// Width and height.
    pub size: Vec2,
}

impl PixelRect {
    /// The part of the area that a tile takes, on whole pixels.
    pub fn of_tile(self, tile: &Tile) -> Self {
        let [x, y, w, h] = tile.area;
        let min = (self.min + self.size * Vec2::new(x, y)).round();
        let max = (self.min + self.size * Vec2::new(x + w, y + h)).round();
        Self {
            min,
            size: max - min,
        }
    }
}

/// Where a picture of `full` pixels lies in a tile: its left top corner and the target's pixels
/// per pixel of the picture.
pub fn place(tile: PixelRect, full: UVec2, placement: Placement) -> (Vec2, f32) {
    let full = full.max(UVec2::ONE).as_vec2();
    let fit = (tile.size / full).min_element();
    let scale = fit * placement.zoom;
    let middle = tile.min + 0.5 * tile.size;
    let corner = middle - placement.center * full * scale;
    // On whole pixels, a picture of the tile's size is shown pixel by pixel.
    (corner.round(), scale)
}

/// The point of the picture, in its pixels, that is shown at `at` of an area of `area` pixels;
/// `None` beside the picture.
pub fn picture_point(
    display: &Display,
    placement: Placement,
    area: UVec2,
    full: UVec2,
    at: Vec2,
) -> Option<Vec2> {
    let area = PixelRect {
        min: Vec2::ZERO,
        size: area.as_vec2(),
    };
    let tiles = display.tiles();
    let mut rects = tiles.iter().map(|tile| area.of_tile(tile));
    let inside = |r: &PixelRect| at.cmpge(r.min).all() && at.cmplt(r.min + r.size).all();
    let (corner, scale) = place(rects.find(inside)?, full, placement);
    let point = (at - corner) / scale;
    let on_picture = point.cmpge(Vec2::ZERO).all() && point.cmplt(full.as_vec2()).all();
    on_picture.then_some(point)
}

/// Linear grey around the picture.
const SURROUND: f32 = 0.012;

/// The numbers of a tile at `rect` and the pipeline it needs.
pub(super) fn uniform(
    frame: &Frame,
    display: &Display,
    placement: Placement,
    tile: &Tile,
    rect: PixelRect,
) -> (TileUniform, Variant) {
    let (corner, scale) = place(rect, frame.full_size, placement);
    // A coarse frame covers the same rectangle with fewer pixels.
    let coarse = frame.size.as_vec2() / frame.full_size.max(UVec2::ONE).as_vec2();
    let scale_xy = coarse / scale;
    let curve = ToneMap::ALL.iter().position(|m| *m == display.tonemap);
    let numbers = TileUniform {
        frame: frame.size.to_array(),
        exposure: tile.exposure.exp2(),
        surround: SURROUND,
        offset: (-corner * scale_xy).to_array(),
        scale: scale_xy.to_array(),
    };
    let variant = Variant {
        curve: if display.false_color {
            FALSE_COLOR
        } else {
            curve.unwrap_or(0) as u32
        },
        smooth: frame.is_coarse() || scale < 1.0,
        layers: tile.layers.len().min(SLOTS) as u32,
    };
    (numbers, variant)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rect(x: f32, y: f32, w: f32, h: f32) -> PixelRect {
        PixelRect {
            min: Vec2::new(x, y),
            size: Vec2::new(w, h),
        }
    }

    #[test]
    fn a_picture_of_the_areas_size_is_shown_pixel_by_pixel() {
        let (corner, scale) = place(
            rect(10.0, 20.0, 641.0, 480.0),
            UVec2::new(641, 480),
            Placement::default(),
        );
        assert_eq!((corner, scale), (Vec2::new(10.0, 20.0), 1.0));
    }

    #[test]
    fn another_shape_is_shown_as_large_as_fits_in_the_middle() {
        let (corner, scale) = place(
            rect(0.0, 0.0, 400.0, 100.0),
            UVec2::new(100, 100),
            Placement::default(),
        );
        assert_eq!((corner, scale), (Vec2::new(150.0, 0.0), 1.0));
    }

    #[test]
    fn zoom_keeps_the_centre_in_the_middle() {
        let placement = Placement {
            zoom: 4.0,
            center: Vec2::new(0.25, 0.75),
        };
        let (corner, scale) = place(rect(0.0, 0.0, 200.0, 200.0), UVec2::splat(100), placement);
        assert_eq!(scale, 8.0);
        assert_eq!(corner + Vec2::new(25.0, 75.0) * scale, Vec2::splat(100.0));
    }

    #[test]
    fn points_are_found_in_every_tile() {
        let full = UVec2::new(200, 100);
        let point = |display: &Display, x: f32, y: f32| {
            picture_point(display, Placement::default(), full, full, Vec2::new(x, y))
        };
        let whole = Display::default();
        assert_eq!(point(&whole, 30.0, 40.0), Some(Vec2::new(30.0, 40.0)));
        assert_eq!(point(&whole, 200.0, 40.0), None);
        let grid = Display {
            shown: crate::viewer::display::Shown::Grid,
            ..whole
        };
        assert_eq!(point(&grid, 110.0, 60.0), Some(Vec2::new(20.0, 20.0)));
    }

    #[test]
    fn tiles_meet_without_gaps_on_odd_sizes() {
        let area = rect(0.0, 0.0, 101.0, 51.0);
        let display = Display {
            shown: crate::viewer::display::Shown::Grid,
            ..Display::default()
        };
        let rects: Vec<PixelRect> = display.tiles().iter().map(|t| area.of_tile(t)).collect();
        assert_eq!(rects[0].min.x + rects[0].size.x, rects[1].min.x);
        assert_eq!(rects[1].min.x + rects[1].size.x, 101.0);
        assert_eq!(rects[0].min.y + rects[0].size.y, rects[2].min.y);
        assert_eq!(rects[2].min.y + rects[2].size.y, 51.0);
    }
}
