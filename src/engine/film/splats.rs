//! Radiance that lands on pixels in no order: what light paths and Markov chains bring.
//!
//! A chunk of work writes its splats into a [`SplatList`] of its own. Lists are merged in the
//! order of the chunks, binned by tile, so that the sums have the same bits for any number of
//! threads. Sums are in f64: a focused caustic may put a hundred thousand splats on one pixel.

use glam::{UVec2, Vec2};
use rayon::prelude::*;

use super::tiles::{TILE_PIXELS, Tiles};
use crate::engine::math::{Fault, FaultCounts, Rgb};
use crate::engine::path::{ClassId, PathClasses};

/// Radiance of one path for one pixel.
#[derive(Clone, Copy, Debug)]
struct Splat {
    /// Tile · [`TILE_PIXELS`] + place within the tile.
    place: u32,
    class: ClassId,
    value: [f32; 3],
}

/// The splats of one chunk of work, in the order in which they were made.
#[derive(Clone, Debug)]
pub struct SplatList {
    tiles: Tiles,
    splats: Vec<Splat>,
    faults: FaultCounts,
}

impl SplatList {
    /// An empty list for a picture of `size` pixels.
    pub fn new(size: UVec2) -> Self {
        Self {
            tiles: Tiles::new(size),
            splats: Vec::new(),
            faults: FaultCounts::default(),
        }
    }

    /// Adds radiance of a path of class `class` at the film position `film`, in pixels, which
    /// lies on the film.
    #[inline]
    pub fn add(&mut self, film: Vec2, class: ClassId, value: Rgb) {
        if matches!(
            self.faults.look_at(value),
            Some(Fault::Nan | Fault::Infinite)
        ) {
            return; // left out
        }
        let (tile, place) = self.tiles.locate(film.as_uvec2());
        self.splats.push(Splat {
            place: (tile * TILE_PIXELS + place) as u32,
            class,
            value: value.to_array(),
        });
    }

    /// What was wrong with splats since this was asked last. Those that were no numbers are left
    /// out.
    pub fn take_faults(&mut self) -> FaultCounts {
        std::mem::take(&mut self.faults)
    }

    /// Number of splats.
    pub fn len(&self) -> usize {
        self.splats.len()
    }

    /// True without splats.
    pub fn is_empty(&self) -> bool {
        self.splats.is_empty()
    }
}

type Plane = [[f64; 3]; TILE_PIXELS];

/// The sums of all splats of one pass: of the whole, then of the planned layers.
#[derive(Clone, Debug)]
pub struct SplatBuffer {
    tiles: Tiles,
    planned: u32,
    /// By tile, plane after plane.
    sums: Vec<Vec<Plane>>,
}

impl SplatBuffer {
    /// Memory held.
    pub fn bytes(&self) -> usize {
        self.sums
            .iter()
            .map(|tile| size_of_val(tile.as_slice()))
            .sum()
    }

    /// Room for a pass over `size` pixels with the layers of the bit mask `planned`.
    pub fn new(size: UVec2, planned: u32) -> Self {
        let tiles = Tiles::new(size);
        let planes = 1 + planned.count_ones() as usize;
        let black = vec![[[0.0; 3]; TILE_PIXELS]; planes];
        Self {
            tiles,
            planned,
            sums: vec![black; tiles.len()],
        }
    }

    /// Whether it was made for this size and these layers.
    pub fn fits(&self, size: UVec2, planned: u32) -> bool {
        self.tiles.size() == size && self.planned == planned
    }

    /// Starts over.
    pub fn clear(&mut self) {
        let planes = self.sums.par_iter_mut().flatten();
        planes.for_each(|plane| *plane = [[0.0; 3]; TILE_PIXELS]);
    }

    /// Adds the splats of `lists`, each value times `scale`, in the order of the lists.
    pub fn merge(&mut self, lists: &[SplatList], classes: &PathClasses, scale: f64) {
        let (order, first) = self.by_tile(lists);
        let planned = self.planned;
        self.sums
            .par_iter_mut()
            .enumerate()
            .for_each(|(tile, planes)| {
                for splat in &order[first[tile]..first[tile + 1]] {
                    let place = splat.place as usize % TILE_PIXELS;
                    let value = splat.value.map(|v| f64::from(v) * scale);
                    add(&mut planes[0][place], value);
                    let belongs = classes.layers(splat.class) & planned;
                    let mut mask = belongs;
                    while mask != 0 {
                        let bit = mask.trailing_zeros();
                        // Planes of layers stand in ascending order behind that of the whole.
                        let below = planned & ((1 << bit) - 1);
                        add(&mut planes[1 + below.count_ones() as usize][place], value);
                        mask &= mask - 1;
                    }
                }
            });
    }

    /// All splats sorted by tile, those of one tile in their old order, and where each tile begins.
    fn by_tile(&self, lists: &[SplatList]) -> (Vec<Splat>, Vec<usize>) {
        let all = || lists.iter().flat_map(|l| &l.splats);
        let mut first = vec![0; self.tiles.len() + 1];
        for splat in all() {
            first[1 + splat.place as usize / TILE_PIXELS] += 1;
        }
        for tile in 0..self.tiles.len() {
            first[tile + 1] += first[tile];
        }
        let mut next = first.clone();
        let nothing = Splat {
            place: 0,
            class: ClassId::EMPTY,
            value: [0.0; 3],
        };
        let mut order = vec![nothing; first[self.tiles.len()]];
        for splat in all() {
            let slot = &mut next[splat.place as usize / TILE_PIXELS];
            order[*slot] = *splat;
            *slot += 1;
        }
        (order, first)
    }

    /// Sums of the planes of the tile `index`.
    pub(super) fn tile(&self, index: usize) -> &[Plane] {
        &self.sums[index]
    }
}

#[inline]
fn add(sum: &mut [f64; 3], value: [f64; 3]) {
    for (s, v) in sum.iter_mut().zip(value) {
        *s += v;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::event::Letter;

    #[test]
    fn splats_land_on_their_pixel_and_layers_in_any_number_of_lists() {
        let (size, classes) = (UVec2::new(19, 11), PathClasses::components());
        // The layers direct (bit 0) and indirect (bit 3).
        let planned = 0b1001;
        let words = [
            ClassId::EMPTY,
            classes.of(Letter::S),
            classes.join(classes.of(Letter::D), classes.of(Letter::D)),
        ];
        let position = |i: u32| Vec2::new((i * 7 % 19) as f32 + 0.5, (i * 5 % 11) as f32 + 0.5);
        let fill = |lists: &mut [SplatList]| {
            let per_list = 300 / lists.len() as u32;
            for i in 0..300 {
                let list = &mut lists[(i / per_list) as usize];
                let value = Rgb::new(1.0 + i as f32, 0.1, 0.0);
                list.add(position(i), words[i as usize % 3], value);
            }
        };
        let mut expected = vec![[[0.0_f64; 3]; 3]; 19 * 11];
        for i in 0..300_u32 {
            let pixel = position(i).as_uvec2();
            let sums = &mut expected[(pixel.y * 19 + pixel.x) as usize];
            let value = [2.0 * f64::from(1 + i), 2.0 * f64::from(0.1_f32), 0.0];
            add(&mut sums[0], value);
            match i % 3 {
                0 => add(&mut sums[1], value),
                2 => add(&mut sums[2], value),
                _ => {}
            }
        }
        for count in [1, 3, 10] {
            let mut lists = vec![SplatList::new(size); count];
            fill(&mut lists);
            let mut buffer = SplatBuffer::new(size, planned);
            buffer.merge(&lists, &classes, 2.0);
            let tiles = Tiles::new(size);
            for t in 0..tiles.len() {
                for (place, p) in tiles.pixels(t) {
                    let found: Vec<_> = buffer.tile(t).iter().map(|plane| plane[place]).collect();
                    assert_eq!(found, expected[(p.y * 19 + p.x) as usize]);
                }
            }
            buffer.clear();
            assert_eq!(buffer.tile(0)[0][0], [0.0; 3]);
        }
    }

    #[test]
    fn what_is_not_finite_is_counted_and_left_out() {
        let mut list = SplatList::new(UVec2::new(4, 4));
        list.add(Vec2::ZERO, ClassId::EMPTY, Rgb::splat(f32::NAN));
        list.add(Vec2::ZERO, ClassId::EMPTY, Rgb::splat(f32::INFINITY));
        list.add(Vec2::ZERO, ClassId::EMPTY, Rgb::splat(-1.0));
        let faults = list.take_faults();
        assert_eq!((faults.nan, faults.infinite, faults.negative), (1, 1, 1));
        assert_eq!(
            (list.len(), list.take_faults()),
            (1, FaultCounts::default())
        );
    }
}
