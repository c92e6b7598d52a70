//! Plain random numbers: a counter-based hash.

use glam::Vec2;

use super::sampler::{Sampler, Stream};
use crate::engine::math::hash::{combine, mix64, unit_f32};

/// Independent uniform numbers.
#[derive(Clone, Debug)]
pub struct IndependentSampler {
    key: u64,
    dimension: u64,
}

impl IndependentSampler {
    /// The numbers of item `index` of `stream`; `index` is a pair, say pixel and sample.
    #[inline]
    pub fn new(seed: u64, stream: Stream, index: (u64, u64)) -> Self {
        let key = combine(combine(combine(seed, stream as u64), index.0), index.1);
        Self { key, dimension: 0 }
    }
}

impl Sampler for IndependentSampler {
    #[inline]
    fn seek(&mut self, dimension: u32) {
        self.dimension = u64::from(dimension);
    }

    #[inline]
    fn next_1d(&mut self) -> f32 {
        self.dimension += 1;
        // SplitMix64 with the dimension as its counter.
        unit_f32(mix64(self.key.wrapping_add(
            self.dimension.wrapping_mul(0x9e37_79b9_7f4a_7c15),
        )))
    }

    #[inline]
    fn next_2d(&mut self) -> Vec2 {
        let x = self.next_1d();
        Vec2::new(x, self.next_1d())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_depend_on_the_dimension_alone() {
        let mut a = IndependentSampler::new(7, Stream::Test, (3, 4));
        let mut b = a.clone();
        let tenth = (0..10).map(|_| a.next_1d()).last().unwrap();
        b.seek(9);
        assert_eq!(b.next_1d(), tenth);
    }

    #[test]
    fn neighbouring_indices_are_uncorrelated() {
        let n = 100_000;
        let mut sum = 0.0;
        for i in 0..n {
            let mut a = IndependentSampler::new(0, Stream::Test, (0, i));
            let mut b = IndependentSampler::new(0, Stream::Test, (0, i + 1));
            sum += f64::from(a.next_1d() - 0.5) * f64::from(b.next_1d() - 0.5);
        }
        // The product has standard deviation 1/12.
        assert!((sum / n as f64).abs() < 5.0 / 12.0 / (n as f64).sqrt());
    }
}
