//! Owen-scrambled Sobol points (Burley 2020, *Practical Hash-based Owen Scrambling*).

use glam::Vec2;

use super::sampler::{Sampler, Stream};
use crate::engine::math::float::ONE_MINUS_EPSILON;
use crate::engine::math::hash::combine;

/// Points of one scrambled sequence come in groups of four dimensions.
const GROUP: u32 = 4;
/// `sobol_burley` is defined below 2¹⁶ points; later blocks take another scramble.
const BLOCK_BITS: u32 = 16;

/// A point of the Owen-scrambled Sobol sequence that belongs to one item (a pixel, say).
#[derive(Clone, Debug)]
pub struct SobolSampler {
    key: u64,
    point: u32,
    dimension: u32,
    group: [f32; GROUP as usize],
}

impl SobolSampler {
    /// Point `index.1` of the sequence of item `index.0` of `stream`.
    #[inline]
    pub fn new(seed: u64, stream: Stream, index: (u64, u64)) -> Self {
        let block = index.1 >> BLOCK_BITS;
        let key = combine(combine(combine(seed, stream as u64), index.0), block);
        let point = (index.1 & ((1 << BLOCK_BITS) - 1)) as u32;
        Self {
            key,
            point,
            dimension: 0,
            group: [0.0; GROUP as usize],
        }
    }

    /// Evaluates the four dimensions around the current one.
    #[inline]
    fn load(&mut self) {
        let set = self.dimension / GROUP;
        // 256 dimensions are stratified together; each further block takes another scramble.
        let (block, set) = (
            set / sobol_burley::NUM_DIMENSION_SETS_4D,
            set % sobol_burley::NUM_DIMENSION_SETS_4D,
        );
        let scramble = (self.key ^ (self.key >> 32)) as u32 ^ block.wrapping_mul(0x9e37_79b9);
        self.group = sobol_burley::sample_4d(self.point, set, scramble);
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
