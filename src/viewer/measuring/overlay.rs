//! A picture over the picture, with a scale of colours.

use glam::UVec2;

use crate::engine::measure::blocks::BLOCK;
use crate::engine::measure::error_image::{ErrorImage, ErrorKind};
use crate::picture::colors;

/// Pixels to be drawn, and what their colours mean.
#[derive(Default)]
pub struct Overlay {
    /// Pixels each way; zero if there is nothing to draw.
    pub size: UVec2,
    /// Red, green, blue, opacity.
    pub pixels: Vec<[u8; 4]>,
    /// What the colours mean.
    pub scale: Option<Scale>,
    /// Counts changes.
    pub version: u64,
    /// On the graphics card.
    pub texture: Option<(u64, egui::TextureHandle)>,
}

/// A scale of colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// What is shown.
    pub label: String,
    /// Values at its ends.
    pub ends: [f32; 2],
    /// Blue to red about zero; otherwise viridis.
    pub signed: bool,
}

impl Scale {
    /// The colour at a share of it.
    pub fn color(&self, share: f32) -> [u8; 3] {
        if self.signed {
            colors::blue_red(2.0 * share - 1.0)
        } else {
            colors::viridis(share)
        }
    }
}

impl Overlay {
    /// Draws nothing.
    pub fn clear(&mut self) {
        self.set(UVec2::ZERO, Vec::new(), None);
    }

    /// Draws these pixels.
    pub fn set(&mut self, size: UVec2, pixels: Vec<[u8; 4]>, scale: Option<Scale>) {
        (self.size, self.pixels, self.scale) = (size, pixels, scale);
        self.version += 1;
    }

    /// Draws an error image.
    pub fn set_error(&mut self, image: &ErrorImage) {
        let signed = image.kind == ErrorKind::Signed;
        let label = match image.kind {
            ErrorKind::Absolute => "absolute error, radiance",
            ErrorKind::Relative => "relative error",
            ErrorKind::Signed => "signed error, radiance",
        };
        let scale = Scale {
            label: label.to_owned(),
            ends: [if signed { -image.scale } else { 0.0 }, image.scale],
            signed,
        };
        let color = |v: &f32| {
            let place = image.place(*v);
            let [r, g, b] = place.map_or(colors::NO_NUMBER, |x| {
                scale.color(if signed { 0.5 + 0.5 * x } else { x })
            });
            [r, g, b, 255]
        };
        let pixels = image.values.iter().map(color).collect();
        self.set(image.size, pixels, Some(scale));
    }

    /// Draws deviations of blocks in standard errors over a picture of `size` pixels.
    pub fn set_z_map(&mut self, size: UVec2, z: &[f32]) {
        const END: f32 = 6.0;
        let scale = Scale {
            label: "difference in standard errors".to_owned(),
            ends: [-END, END],
            signed: true,
        };
        let columns = size.x.div_ceil(BLOCK);
        let pixel = |i: u32| {
            let (x, y) = (i % size.x, i / size.x);
            let block = (y / BLOCK) * columns + x / BLOCK;
            let [r, g, b] = scale.color(0.5 + 0.5 * z[block as usize] / END);
            [r, g, b, 255]
        };
        let pixels = (0..size.x * size.y).map(pixel).collect();
        self.set(size, pixels, Some(scale.clone()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_cover_their_pixels() {
        let mut overlay = Overlay::default();
        overlay.set_z_map(UVec2::new(10, 9), &[0.0, 6.0, -6.0, 99.0]);
        let at = |x: usize, y: usize| overlay.pixels[y * 10 + x];
        let rgb = |p: [u8; 3]| [p[0], p[1], p[2], 255];
        assert_eq!(at(7, 7), rgb(colors::blue_red(0.0)));
        assert_eq!(
            (at(8, 0), at(9, 8)),
            (rgb(colors::blue_red(1.0)), rgb(colors::blue_red(1.0)))
        );
        assert_eq!(at(0, 8), rgb(colors::blue_red(-1.0)));
    }

    #[test]
    fn signed_errors_are_white_at_zero() {
        let (x, r) = ([[1.0; 3], [3.0; 3]], [[1.0; 3], [1.0; 3]]);
        let image = ErrorImage::new(ErrorKind::Signed, UVec2::new(2, 1), &x, &r).expect("equal");
        let mut overlay = Overlay::default();
        overlay.set_error(&image);
        let white = colors::blue_red(0.0);
        assert_eq!(overlay.pixels[0][..3], white);
        assert!(
            overlay
                .scale
                .as_ref()
                .is_some_and(|s| s.signed && s.ends[0] < 0.0)
        );
    }
}
