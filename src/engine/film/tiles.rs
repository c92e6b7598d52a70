//! The picture cut into squares of pixels, the unit of parallel work.

use glam::UVec2;

/// Side of a tile in pixels.
pub const TILE: u32 = 8;
/// Pixels of a full tile. Tiles at the right and lower edge leave some unused.
pub const TILE_PIXELS: usize = (TILE * TILE) as usize;

/// The tiles of a picture, row by row from the top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tiles {
    size: UVec2,
    columns: u32,
}

impl Tiles {
    /// Tiles of a picture of `size` pixels.
    pub fn new(size: UVec2) -> Self {
        Self {
            size,
            columns: size.x.div_ceil(TILE),
        }
    }

    /// Size of the picture in pixels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// Number of tiles.
    pub fn len(&self) -> usize {
        self.columns as usize * self.size.y.div_ceil(TILE) as usize
    }

    /// True for a picture without pixels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The pixels of tile `index`: place within the tile, and position in the picture.
    pub fn pixels(&self, index: usize) -> impl Iterator<Item = (usize, UVec2)> + use<> {
        let index = index as u32;
        let origin = UVec2::new(index % self.columns, index / self.columns) * TILE;
        let extent = (self.size - origin).min(UVec2::splat(TILE));
        (0..extent.y).flat_map(move |y| {
            (0..extent.x).map(move |x| ((y * TILE + x) as usize, origin + UVec2::new(x, y)))
        })
    }

    /// The tile that holds `pixel`, and the pixel's place within it.
    pub fn locate(&self, pixel: UVec2) -> (usize, usize) {
        let tile = pixel / TILE;
        let within = pixel % TILE;
        (
            (tile.y * self.columns + tile.x) as usize,
            (within.y * TILE + within.x) as usize,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_each_pixel_once() {
        for (w, h) in [(1, 1), (8, 8), (9, 7), (64, 48), (1, 100), (0, 5), (5, 0)] {
            let tiles = Tiles::new(UVec2::new(w, h));
            let mut count = vec![0; (w * h) as usize];
            for t in 0..tiles.len() {
                for (place, p) in tiles.pixels(t) {
                    assert_eq!(tiles.locate(p), (t, place));
                    count[(p.y * w + p.x) as usize] += 1;
                }
            }
            assert!(count.iter().all(|&c| c == 1));
        }
    }
}
