//! The result of a pass that may still be cancelled.

use glam::UVec2;

use super::sample::SampleRadiance;
use super::tiles::{TILE_PIXELS, Tiles};
use crate::engine::math::Rgb;

/// One sample per pixel of the whole and of each planned layer.
#[derive(Clone, Debug)]
pub struct PassBuffer {
    tiles: Tiles,
    /// Bit mask of the layers that have planes here.
    planned: u32,
    /// At least as many as there are in `tiles`.
    data: Vec<PassTile>,
}

/// One tile of a [`PassBuffer`].
#[derive(Clone, Debug)]
pub struct PassTile {
    /// `planes[p][pixel]`; plane 0 is the whole, then the planned layers in ascending order.
    planes: Vec<[[f32; 3]; TILE_PIXELS]>,
    /// Bit mask of the pixels whose sample was not finite.
    pub(super) rejected: u64,
}

impl PassBuffer {
    /// Room for a pass over `size` pixels with the layers of the bit mask `planned`.
    pub fn new(size: UVec2, planned: u32) -> Self {
        let tiles = Tiles::new(size);
        let planes = 1 + planned.count_ones() as usize;
        let tile = PassTile {
            planes: vec![[[0.0; 3]; TILE_PIXELS]; planes],
            rejected: 0,
        };
        Self {
            tiles,
            planned,
            data: vec![tile; tiles.len()],
        }
    }

    /// This buffer, or a new one, for a pass over `size` pixels with the layers `planned`. Memory
    /// of a larger picture is kept for the next one: coarse pictures and full ones take turns.
    #[must_use]
    pub fn refit(mut self, size: UVec2, planned: u32) -> Self {
        let tiles = Tiles::new(size);
        if self.planned != planned || self.data.len() < tiles.len() {
            return Self::new(size, planned);
        }
        self.tiles = tiles;
        self
    }

    /// Memory held.
    pub fn bytes(&self) -> usize {
        let plane = size_of::<[[f32; 3]; TILE_PIXELS]>();
        let planes: usize = self.data.iter().map(|tile| tile.planes.capacity()).sum();
        planes * plane + self.data.capacity() * size_of::<PassTile>()
    }

    /// How the picture is cut.
    pub fn tiles(&self) -> Tiles {
        self.tiles
    }

    /// The layers with planes here.
    pub fn planned(&self) -> u32 {
        self.planned
    }

    /// The tiles for writing, in the order of [`Tiles`].
    pub fn tiles_mut(&mut self) -> &mut [PassTile] {
        &mut self.data[..self.tiles.len()]
    }

    /// The tiles for reading.
    pub(super) fn data(&self) -> &[PassTile] {
        &self.data[..self.tiles.len()]
    }
}

impl PassTile {
    /// Starts over.
    #[inline]
    pub fn begin(&mut self) {
        self.rejected = 0;
    }

    /// Stores the sample of the pixel at `place`. A sample that is not finite is marked, never
    /// stored; returns whether it was finite.
    #[inline]
    pub fn put(&mut self, place: usize, planned: u32, sample: &SampleRadiance<'_>) -> bool {
        let finite = sample.is_finite();
        let value = |c: Rgb| if finite { c.to_array() } else { [0.0; 3] };
        self.planes[0][place] = value(sample.whole());
        let mut mask = planned;
        for plane in &mut self.planes[1..] {
            plane[place] = value(sample.layer(mask.trailing_zeros() as usize));
            mask &= mask - 1;
        }
        if !finite {
            self.rejected |= 1 << place;
        }
        finite
    }

    /// Number of planes.
    pub(super) fn planes(&self) -> usize {
        self.planes.len()
    }

    /// Values of plane `index`: 0 the whole, then the planned layers.
    pub(super) fn plane(&self, index: usize) -> &[[f32; 3]; TILE_PIXELS] {
        &self.planes[index]
    }
}
