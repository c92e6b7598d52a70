//! Owen-scrambled Sobol points (Burley 2020, *Practical Hash-based Owen Scrambling*).

use std::sync::LazyLock;

use glam::Vec2;
use sobol_burley::parts::{
    Int4, hash, hash_int4, owen_scramble_int4_rev, owen_scramble_rev, sobol_rev,
};

use super::sampler::{Sampler, Stream};
use crate::engine::math::float::ONE_MINUS_EPSILON;
use crate::engine::math::hash::combine;

/// Points of one scrambled sequence come in groups of four dimensions.
const GROUP: u32 = 4;
/// `sobol_burley` is defined below 2¹⁶ points; later blocks take another scramble.
const BLOCK_BITS: u32 = 16;

/// Bits of a point's index that one step of [`unscrambled`] looks up.
const DIGIT_BITS: u32 = 4;
const DIGITS: usize = (BLOCK_BITS / DIGIT_BITS) as usize;
/// What each value of each digit of an index adds to four dimensions.
type Group = [[[u32; GROUP as usize]; 1 << DIGIT_BITS]; DIGITS];

/// The direction vectors of `sobol_burley`, added up for every digit: a point then takes four
/// look-ups instead of an exclusive or a bit. All bits are reversed, as they are there.
static GROUPS: LazyLock<Vec<Group>> = LazyLock::new(|| {
    let group = |set: u32| {
        let digit = |d: usize| {
            let shift = u32::BITS - DIGIT_BITS * (d as u32 + 1);
            let value = |v: usize| {
                [0, 1, 2, 3].map(|lane| sobol_rev((v as u32) << shift, set * GROUP + lane))
            };
            std::array::from_fn(value)
        };
        std::array::from_fn(digit)
    };
    (0..sobol_burley::NUM_DIMENSION_SETS_4D)
        .map(group)
        .collect()
});

/// Point `index_rev` of four dimensions before their scramble.
#[inline]
fn unscrambled(index_rev: u32, group: &Group) -> Int4 {
    let mut sum = [0; GROUP as usize];
    for (d, values) in group.iter().enumerate() {
        let shift = u32::BITS - DIGIT_BITS * (d as u32 + 1);
        let value = values[(index_rev >> shift) as usize & ((1 << DIGIT_BITS) - 1)];
        for (sum, value) in sum.iter_mut().zip(value) {
            *sum ^= value;
        }
    }
    sum.into()
}

/// A point of the Owen-scrambled Sobol sequence that belongs to one item (a pixel, say).
#[derive(Clone, Debug)]
pub struct SobolSampler {
    scramble: u32,
    point: u32,
    /// Block of dimensions that `index_rev` is shuffled for.
    block: u32,
    index_rev: u32,
    dimension: u32,
    group: [f32; GROUP as usize],
}

impl SobolSampler {
    /// Point `index.1` of the sequence of item `index.0` of `stream`.
    #[inline]
    pub fn new(seed: u64, stream: Stream, index: (u64, u64)) -> Self {
        let block = index.1 >> BLOCK_BITS;
        let key = combine(combine(combine(seed, stream as u64), index.0), block);
        let mut new = Self {
            scramble: (key ^ (key >> 32)) as u32,
            point: (index.1 & ((1 << BLOCK_BITS) - 1)) as u32,
            block: 0,
            index_rev: 0,
            dimension: 0,
            group: [0.0; GROUP as usize],
        };
        new.shuffle(0);
        new
    }

    /// Shuffles the order of the points: 256 dimensions are stratified together, each further
    /// block takes another scramble.
    #[inline]
    fn shuffle(&mut self, block: u32) {
        self.block = block;
        let key = hash(self.block_scramble() ^ 0x79c6_8e4a);
        self.index_rev = owen_scramble_rev(self.point.reverse_bits(), key);
    }

    #[inline]
    fn block_scramble(&self) -> u32 {
        self.scramble ^ self.block.wrapping_mul(0x9e37_79b9)
    }

    /// Evaluates the four dimensions around the current one, as `sobol_burley::sample_4d` does.
    #[inline]
    fn load(&mut self) {
        let sets = sobol_burley::NUM_DIMENSION_SETS_4D;
        let (block, set) = (self.dimension / GROUP / sets, self.dimension / GROUP % sets);
        if block != self.block {
            self.shuffle(block);
        }
        let points = unscrambled(self.index_rev, &GROUPS[set as usize]);
        let key = set ^ self.block_scramble().wrapping_mul(0x9c8f_2d3b);
        let lanes = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8].map(|lane| lane ^ key);
        let scrambled = owen_scramble_int4_rev(points, hash_int4(lanes.into()));
        self.group = scrambled.reverse_bits().to_f32_norm();
    }
}

impl Sampler for SobolSampler {
    #[inline]
    fn seek(&mut self, dimension: u32) {
        self.dimension = dimension;
        if !dimension.is_multiple_of(GROUP) {
            self.load();
        }
    }

    #[inline]
    fn next_1d(&mut self) -> f32 {
        let lane = self.dimension % GROUP;
        if lane == 0 {
            self.load();
        }
        self.dimension += 1;
        self.group[lane as usize].min(ONE_MINUS_EPSILON)
    }

    #[inline]
    fn next_2d(&mut self) -> Vec2 {
        // A pair stays within one group: only there it is stratified as a pair.
        if self.dimension % GROUP == GROUP - 1 {
            self.dimension += 1;
        }
        let x = self.next_1d();
        Vec2::new(x, self.next_1d())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_points_are_a_net() {
        // Owen scrambling keeps the (0, 2)-net property: each of 16 elementary intervals holds
        // one of the first 16 points, whatever its shape.
        for (pixel, (nx, ny)) in [(0, (16, 1)), (1, (4, 4)), (2, (1, 16)), (3, (2, 8))] {
            let mut seen = [false; 16];
            for i in 0..16 {
                let mut s = SobolSampler::new(5, Stream::Test, (pixel, i));
                let u = s.next_2d();
                seen[(u.x * nx as f32) as usize * ny + (u.y * ny as f32) as usize] = true;
            }
            assert!(seen.iter().all(|&x| x), "{nx}x{ny}");
        }
    }

    #[test]
    fn points_are_those_of_the_library() {
        for (item, point) in [(0, 0), (1, 1), (2, 77), (3, 4096), (4, 65535)] {
            let mut s = SobolSampler::new(9, Stream::Test, (item, point));
            for set in 0..2 * sobol_burley::NUM_DIMENSION_SETS_4D {
                let (block, set) = (
                    set / sobol_burley::NUM_DIMENSION_SETS_4D,
                    set % sobol_burley::NUM_DIMENSION_SETS_4D,
                );
                let scramble = s.scramble ^ block.wrapping_mul(0x9e37_79b9);
                let expected = sobol_burley::sample_4d(point as u32, set, scramble);
                assert_eq!(
                    [0; 4].map(|_| s.next_1d()),
                    expected,
                    "{point} {block} {set}"
                );
            }
        }
    }

    #[test]
    fn seeking_matches_counting() {
        let mut a = SobolSampler::new(1, Stream::Test, (9, 1000));
        let all: Vec<f32> = (0..600).map(|_| a.next_1d()).collect();
        for d in [0usize, 1, 3, 4, 255, 256, 257, 511, 512, 599] {
            a.seek(d as u32);
            assert_eq!(a.next_1d(), all[d]);
        }
        assert!(all[..256] != all[256..512], "blocks of dimensions repeat");
    }

    #[test]
    fn points_beyond_the_first_block_are_new() {
        let u = |i| SobolSampler::new(1, Stream::Test, (0, i)).next_1d();
        let first: Vec<f32> = (0..64).map(u).collect();
        let later: Vec<f32> = ((1 << 16)..(1 << 16) + 64).map(u).collect();
        assert_ne!(first, later);
    }
}
