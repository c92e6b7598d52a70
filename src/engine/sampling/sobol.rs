//! Owen-scrambled Sobol points (Burley 2020, *Practical Hash-based Owen Scrambling*).

use std::sync::LazyLock;

use glam::{UVec2, Vec2};
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
/// Groups that are stratified together: each further block of them takes another scramble.
const SETS: usize = sobol_burley::NUM_DIMENSION_SETS_4D as usize;
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
    (0..SETS as u32).map(group).collect()
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

/// What is added to all points of a net, digit by digit: a point of another sequence.
///
/// With point q of a sequence added to point p of a net, the points of one q and all p are a net,
/// and those of one p and all q a sequence: a net that is moved as a whole keeps its strata, and so
/// does a sequence (digital shifts; Dick and Pillichshammer 2010, *Digital Nets and Sequences*,
/// section 4.4). A pass then spreads its paths evenly over the lights, and so do all passes of one
/// pixel.
#[derive(Clone, Debug)]
pub struct Shift {
    /// Bits reversed.
    groups: [[u32; GROUP as usize]; SETS],
    /// Distinguishes the scrambles of dimensions beyond those.
    key: u32,
}

impl Shift {
    const NONE: Self = Self {
        groups: [[0; GROUP as usize]; SETS],
        key: 0,
    };

    /// By point `index.1` of the sequence of item `index.0` of `stream`.
    pub fn new(seed: u64, stream: Stream, index: (u64, u64)) -> Self {
        let sampler = SobolSampler::new(seed, stream, index);
        let groups = std::array::from_fn(|set| sampler.scrambled(set as u32).into());
        let key = hash(sampler.scramble ^ sampler.point);
        Self { groups, key }
    }
}

static UNMOVED: Shift = Shift::NONE;

/// A point of the Owen-scrambled Sobol sequence that belongs to one item (a pixel, say).
#[derive(Clone, Debug)]
pub struct SobolSampler<'a> {
    scramble: u32,
    point: u32,
    /// Block of dimensions that `index_rev` is shuffled for.
    block: u32,
    index_rev: u32,
    dimension: u32,
    group: [f32; GROUP as usize],
    shift: &'a Shift,
}

impl SobolSampler<'static> {
    /// Point `index.1` of the sequence of item `index.0` of `stream`.
    #[inline]
    pub fn new(seed: u64, stream: Stream, index: (u64, u64)) -> Self {
        Self::shifted(seed, stream, index, &UNMOVED)
    }
}

impl<'a> SobolSampler<'a> {
    /// The same, moved by `shift`.
    #[inline]
    pub fn shifted(seed: u64, stream: Stream, index: (u64, u64), shift: &'a Shift) -> Self {
        let block = index.1 >> BLOCK_BITS;
        let key = combine(combine(combine(seed, stream as u64), index.0), block);
        let mut new = Self {
            scramble: (key ^ (key >> 32)) as u32,
            point: (index.1 & ((1 << BLOCK_BITS) - 1)) as u32,
            block: 0,
            index_rev: 0,
            dimension: 0,
            group: [0.0; GROUP as usize],
            shift,
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
        self.scramble ^ self.block.wrapping_mul(0x9e37_79b9 ^ self.shift.key)
    }

    /// Group `set` of the current block, bits reversed.
    #[inline]
    fn scrambled(&self, set: u32) -> Int4 {
        let points = unscrambled(self.index_rev, &GROUPS[set as usize]);
        let key = set ^ self.block_scramble().wrapping_mul(0x9c8f_2d3b);
        let mut lanes = Int4::from([0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8]);
        lanes ^= [key; 4].into();
        owen_scramble_int4_rev(points, hash_int4(lanes))
    }

    /// Evaluates the four dimensions around the current one, as `sobol_burley::sample_4d` does.
    #[inline]
    fn load(&mut self) {
        let (block, set) = (
            self.dimension / GROUP / SETS as u32,
            self.dimension / GROUP % SETS as u32,
        );
        if block != self.block {
            self.shuffle(block);
        }
        let mut scrambled = self.scrambled(set);
        scrambled ^= self.shift.groups[set as usize].into();
        self.group = scrambled.reverse_bits().to_f32_norm();
    }
}

impl Sampler for SobolSampler<'_> {
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

/// Place of a pixel of a square of 256 on a curve that fills each quarter, and each quarter of
/// those, before the next (Morton 1966): neighbours take points that are spread evenly.
pub fn morton(pixel: UVec2) -> u64 {
    let spread = |v: u32| {
        let v = (v | (v << 4)) & 0x0f0f;
        let v = (v | (v << 2)) & 0x3333;
        (v | (v << 1)) & 0x5555
    };
    u64::from(spread(pixel.x) | (spread(pixel.y) << 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_points_are_a_net() {
        // Owen scrambling keeps the (0, 2)-net property: each of 16 elementary intervals holds
        // one of the first 16 points, whatever its shape.
        for pixel in 0..4 {
            let point = |i| SobolSampler::new(5, Stream::Test, (pixel, i)).next_2d();
            let points: Vec<Vec2> = (0..16).map(point).collect();
            assert!(is_net(&points), "{pixel}");
        }
    }

    /// Whether elementary intervals of every shape hold one of sixteen points each.
    fn is_net(points: &[Vec2]) -> bool {
        [(16, 1), (8, 2), (4, 4), (2, 8), (1, 16)]
            .into_iter()
            .all(|(nx, ny)| {
                let mut seen = [false; 16];
                for u in points {
                    seen[(u.x * nx as f32) as usize * ny + (u.y * ny as f32) as usize] = true;
                }
                seen.iter().all(|&x| x)
            })
    }

    #[test]
    fn a_net_that_is_shifted_stays_one_and_so_do_the_shifts_of_a_point() {
        let shifts: Vec<Shift> = (0..16)
            .map(|q| Shift::new(5, Stream::Test, (0, q)))
            .collect();
        for dimension in [0, 2, 254, 256] {
            let point = |p: u64, q: usize| {
                let mut s = SobolSampler::shifted(5, Stream::Test, (1, p), &shifts[q]);
                s.seek(dimension);
                s.next_2d()
            };
            // All dimensions but the first pairs of a sequence are nets of a lower quality.
            for i in 0..16 {
                let of_a_pass: Vec<Vec2> = (0..16).map(|p| point(p, i)).collect();
                let of_a_pixel: Vec<Vec2> = (0..16).map(|q| point(i as u64, q)).collect();
                if dimension == 0 {
                    assert!(is_net(&of_a_pass) && is_net(&of_a_pixel), "{i}");
                }
                for (k, u) in of_a_pixel.iter().enumerate() {
                    assert!(!of_a_pixel[..k].contains(u), "{dimension} {i} {k}");
                }
            }
        }
    }

    #[test]
    fn a_curve_through_a_square_meets_each_pixel_once_and_quarters_one_after_another() {
        let mut seen = vec![false; 1 << 16];
        for y in 0..256 {
            for x in 0..256 {
                let place = morton(UVec2::new(x, y));
                assert_eq!(place >> 14, u64::from(y / 128 * 2 + x / 128));
                seen[place as usize] = true;
            }
        }
        assert!(seen.iter().all(|&x| x));
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
