//! The sums over all passes.

use glam::UVec2;
use rayon::prelude::*;

use super::frame::FrameLayer;
use super::halves::{ErrorEstimate, HalfSums, PixelHalves, TileHalves};
use super::pass_buffer::{PassBuffer, PassTile};
use super::splats::SplatBuffer;
use super::tiles::{TILE_PIXELS, Tiles};

type Plane = Box<[[f64; 3]; TILE_PIXELS]>;

/// Sums in f64 of all completed passes: 2²⁵ samples of 1 still count exactly.
#[derive(Clone, Debug)]
pub struct Film {
    tiles: Tiles,
    planned: u32,
    data: Vec<FilmTile>,
    passes: u64,
    /// What the means are multiplied by.
    scale: f64,
    /// Passes at which the tiles' marks were set, the newer one first; 0 before that.
    marked: [u64; 2],
}

/// Invariant: what planes hold counts only once the film has a pass. The first one makes them
/// (a film that only previews stand in for costs nothing) or writes over what is there (a film
/// that is used again costs no more).
#[derive(Clone, Debug, Default)]
struct FilmTile {
    /// Plane 0 is the whole, then the planned layers in ascending order. The last plane is the
    /// whole over the even passes alone: they use a scramble of their own, so the two halves are
    /// independent estimates and their difference measures the error (also of Sobol points, whose
    /// samples within one scramble are not independent).
    planes: Vec<Plane>,
    /// Samples that were not finite, a pixel (even and odd passes).
    rejected: Option<Box<[[u32; 2]; TILE_PIXELS]>>,
    /// Even less odd sums of the whole at two earlier passes: see [`super::halves`].
    marks: [Option<Box<[[f32; 3]; TILE_PIXELS]>>; 2],
}

impl FilmTile {
    /// Adds pass number `index`.
    fn add(&mut self, pass: &PassTile, index: u64) {
        let planes = pass.planes() + 1;
        if index == 0 {
            self.planes
                .resize_with(planes, || Box::new([[0.0; 3]; TILE_PIXELS]));
            self.rejected = None;
        }
        let source = |p: usize| if p + 1 == planes { 0 } else { p };
        let even = index.is_multiple_of(2);
        for (p, sums) in self.planes.iter_mut().enumerate() {
            let values = pass.plane(source(p));
            match index {
                0 => set_plane(sums, values),
                _ if even || p + 1 < planes => add_plane(sums, values),
                _ => {}
            }
        }
        let mut mask = pass.rejected;
        while mask != 0 {
            let rejected = self
                .rejected
                .get_or_insert_with(|| Box::new([[0; 2]; TILE_PIXELS]));
            rejected[mask.trailing_zeros() as usize][usize::from(!even)] += 1;
            mask &= mask - 1;
        }
    }

    /// Adds the sums of splats of pass number `index`. They begin the pass, or follow its samples.
    fn add_splats(&mut self, splats: &[[[f64; 3]; TILE_PIXELS]], index: u64, begin: bool) {
        let planes = splats.len() + 1;
        if begin && index == 0 {
            self.planes.clear();
            self.planes
                .resize_with(planes, || Box::new([[0.0; 3]; TILE_PIXELS]));
            self.rejected = None;
        }
        for (sums, values) in self.planes.iter_mut().zip(splats) {
            add_sums(sums, values);
        }
        if index.is_multiple_of(2) {
            add_sums(&mut self.planes[planes - 1], &splats[0]);
        }
    }

    /// Takes note of even less odd sums.
    fn mark(&mut self) {
        let [Some(whole), Some(even)] = [self.planes.first(), self.planes.last()] else {
            return;
        };
        self.marks.swap(0, 1);
        let mark = self.marks[0].get_or_insert_with(|| Box::new([[0.0; 3]; TILE_PIXELS]));
        for ((mark, even), whole) in mark.iter_mut().zip(even.iter()).zip(whole.iter()) {
            *mark = [0, 1, 2].map(|c| (2.0 * even[c] - whole[c]) as f32);
        }
    }

    /// Finite samples of the pixel at `place` among `passes` passes, of the even and odd ones.
    fn counts(&self, place: usize, passes: u64) -> [u64; 2] {
        let rejected = self.rejected.as_ref().map_or([0; 2], |r| r[place]);
        [
            passes.div_ceil(2) - u64::from(rejected[0]),
            passes / 2 - u64::from(rejected[1]),
        ]
    }
}

fn set_plane(sums: &mut [[f64; 3]; TILE_PIXELS], values: &[[f32; 3]; TILE_PIXELS]) {
    for (s, v) in sums.iter_mut().zip(values) {
        *s = v.map(f64::from);
    }
}

fn add_plane(sums: &mut [[f64; 3]; TILE_PIXELS], values: &[[f32; 3]; TILE_PIXELS]) {
    for (s, v) in sums.iter_mut().zip(values) {
        for c in 0..3 {
            s[c] += f64::from(v[c]);
        }
    }
}

fn add_sums(sums: &mut [[f64; 3]; TILE_PIXELS], values: &[[f64; 3]; TILE_PIXELS]) {
    for (s, v) in sums.iter_mut().zip(values) {
        for c in 0..3 {
            s[c] += v[c];
        }
    }
}

impl Film {
    /// An empty film of `size` pixels for the whole and the layers of the bit mask `planned`.
    pub fn new(size: UVec2, planned: u32) -> Self {
        let tiles = Tiles::new(size);
        Self {
            tiles,
            planned,
            data: vec![FilmTile::default(); tiles.len()],
            passes: 0,
            scale: 1.0,
            marked: [0; 2],
        }
    }

    /// This film without its passes, if it has that size and those layers. Its memory is kept:
    /// returning and asking for a hundred megabytes takes longer than a coarse frame.
    pub fn reuse(mut self, size: UVec2, planned: u32) -> Option<Self> {
        self.passes = 0;
        self.scale = 1.0;
        self.marked = [0; 2];
        (self.size() == size && self.planned == planned).then_some(self)
    }

    /// Size in pixels.
    pub fn size(&self) -> UVec2 {
        self.tiles.size()
    }

    /// Completed passes.
    pub fn passes(&self) -> u64 {
        self.passes
    }

    /// Memory of the sums in bytes.
    pub fn bytes(&self) -> usize {
        let planes = 2 + self.planned.count_ones() as usize;
        let marks = 2 * size_of::<[[f32; 3]; TILE_PIXELS]>();
        self.data.len() * (planes * size_of::<[[f64; 3]; TILE_PIXELS]>() + marks)
    }

    /// Adds a completed pass.
    pub fn commit(&mut self, pass: &PassBuffer) {
        debug_assert!(pass.tiles() == self.tiles && pass.planned() == self.planned);
        let index = self.passes;
        self.data
            .par_iter_mut()
            .zip(pass.data())
            .for_each(|(film, pass)| film.add(pass, index));
        self.completed();
    }

    /// Adds a completed pass of splats, and of camera samples if it had any. The splats of a pass
    /// add up to one more sample of every pixel.
    pub fn commit_splats(&mut self, samples: Option<&PassBuffer>, splats: &SplatBuffer) {
        debug_assert!(splats.fits(self.size(), self.planned));
        let index = self.passes;
        self.data.par_iter_mut().enumerate().for_each(|(i, film)| {
            if let Some(samples) = samples {
                film.add(&samples.data()[i], index);
            }
            film.add_splats(splats.tile(i), index, samples.is_none());
        });
        self.completed();
    }

    /// Counts a pass, and marks powers of two.
    fn completed(&mut self) {
        self.passes += 1;
        if self.passes >= 2 && self.passes.is_power_of_two() {
            self.data.par_iter_mut().for_each(FilmTile::mark);
            self.marked = [self.passes, self.marked[0]];
        }
    }

    /// Sets what all means are multiplied by: for sums whose normalisation is itself estimated,
    /// and becomes better known with every pass.
    pub fn set_scale(&mut self, scale: f64) {
        self.scale = scale;
    }

    /// The mean radiance of plane `plane` (0 the whole, then the planned layers), row by row from
    /// the top. A pixel without any finite sample is NaN, for the display to mark.
    fn resolve_plane(&self, plane: usize, out: &mut Vec<[f32; 3]>) {
        let size = self.size();
        out.clear();
        out.resize(size.x as usize * size.y as usize, [0.0; 3]);
        if self.passes == 0 || out.is_empty() {
            return;
        }
        self.by_rows(out, |tile, place| {
            let [even, odd] = tile.counts(place, self.passes);
            let scale = self.scale / (even + odd) as f64;
            tile.planes[plane][place].map(|s| (s * scale) as f32)
        });
    }

    /// Means of the whole and of layer after layer; layers without a plane are zero.
    pub fn resolve(&self, labels: &[String], layers: &mut Vec<FrameLayer>) {
        layers.resize_with(1 + labels.len(), FrameLayer::default);
        self.resolve_plane(0, &mut layers[0].pixels);
        layers[0].label = "whole".to_owned();
        let mut plane = 1;
        for (i, label) in labels.iter().enumerate() {
            let layer = &mut layers[1 + i];
            layer.label.clone_from(label);
            if self.planned & (1 << i) != 0 {
                self.resolve_plane(plane, &mut layer.pixels);
                plane += 1;
            } else {
                layer.pixels.clear();
                layer.pixels.resize(layers_len(self.size()), [0.0; 3]);
            }
        }
    }

    /// Halved differences of the two halves of the whole, weighted so that their squares estimate
    /// the variance of the mean; NaN in pixels that one half lacks. Empty before each half has a
    /// pass.
    pub fn resolve_differences(&self, out: &mut Vec<[f32; 3]>) {
        out.clear();
        if self.passes < 2 {
            return;
        }
        let size = self.size();
        out.resize(layers_len(size), [f32::NAN; 3]);
        let halves = 1 + self.planned.count_ones() as usize;
        self.by_rows(out, |tile, place| {
            let [even, odd] = tile.counts(place, self.passes);
            let (n_even, n_odd) = (even as f64, odd as f64);
            let (total, half) = (tile.planes[0][place], tile.planes[halves][place]);
            // Var(a − b) = σ²(1/nₑ + 1/nₒ), and the mean's variance is σ²/(nₑ + nₒ).
            let weight = self.scale * (n_even * n_odd).sqrt() / (n_even + n_odd);
            std::array::from_fn(|c| {
                let difference = half[c] / n_even - (total[c] - half[c]) / n_odd;
                (difference * weight) as f32
            })
        });
    }

    /// Writes what `value` says of each pixel, given its tile and its place there, to `out`, row
    /// by row from the top.
    fn by_rows(&self, out: &mut [[f32; 3]], value: impl Fn(&FilmTile, usize) -> [f32; 3] + Sync) {
        let size = self.size();
        let rows = size.x as usize * super::tiles::TILE as usize;
        let columns = size.x.div_ceil(super::tiles::TILE) as usize;
        out.par_chunks_mut(rows)
            .enumerate()
            .for_each(|(tile_row, rows)| {
                let top = tile_row as u32 * super::tiles::TILE;
                for t in tile_row * columns..(tile_row + 1) * columns {
                    let tile = &self.data[t];
                    for (place, pixel) in self.tiles.pixels(t) {
                        rows[((pixel.y - top) * size.x + pixel.x) as usize] = value(tile, place);
                    }
                }
            });
    }

    /// Estimated error of the whole, from its two halves. None before each half has a pass.
    pub fn error_estimate(&self) -> Option<ErrorEstimate> {
        if self.passes < 2 {
            return None;
        }
        // Summed in the order of the tiles: the same bits for any number of threads.
        let tiles = self.data.par_iter().enumerate();
        let sums: Vec<HalfSums> = tiles.map(|(t, tile)| self.tile_halves(t, tile)).collect();
        let mut all = HalfSums::default();
        sums.iter().for_each(|sums| all.add(sums));
        all.estimate()
    }

    /// The newest mark that leaves at least half as many passes after it, and its passes.
    fn usable_mark(&self) -> Option<(usize, u64)> {
        let marks = self.marked.into_iter().enumerate();
        let mut marks = marks.filter(|(_, m)| *m >= 2);
        marks.find(|(_, m)| self.passes >= m + (m / 2).max(2))
    }

    fn tile_halves(&self, index: usize, tile: &FilmTile) -> HalfSums {
        let mut pixels: TileHalves = [None; TILE_PIXELS];
        let even_plane = 1 + self.planned.count_ones() as usize;
        let mark = self.usable_mark();
        for (place, _) in self.tiles.pixels(index) {
            let [even, odd] = tile.counts(place, self.passes);
            if even == 0 || odd == 0 {
                continue;
            }
            let (total, half) = (tile.planes[0][place], tile.planes[even_plane][place]);
            let (n_even, n_odd) = (even as f64, odd as f64);
            let n = n_even + n_odd;
            let difference = [0, 1, 2].map(|c| half[c] / n_even - (total[c] - half[c]) / n_odd);
            // Var(a − b) = σ²(1/nₑ + 1/nₒ), and the mean's variance is σ²/(nₑ + nₒ).
            let scale = self.scale * (n_even * n_odd).sqrt() / n;
            // What came before the mark and what came after it, as sums.
            let parts = mark.and_then(|(which, _)| {
                let mark = tile.marks[which].as_ref()?[place].map(f64::from);
                let after = [0, 1, 2].map(|c| difference[c] * 0.5 * n - mark[c]);
                Some([mark, after])
            });
            pixels[place] = Some(PixelHalves {
                d: difference.map(|d| d * scale),
                mean: total.map(|t| self.scale * t / n),
                parts,
            });
        }
        HalfSums::of(&pixels)
    }
}

fn layers_len(size: UVec2) -> usize {
    size.x as usize * size.y as usize
}
