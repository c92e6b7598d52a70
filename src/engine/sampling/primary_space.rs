//! The unit cube that a Markov chain walks in (Kelemen, Szirmay-Kalos, Antal and Csonka 2002, *A
//! Simple and Robust Mutation Strategy for the Metropolis Light Transport Algorithm*).
//!
//! A state is the list of uniform numbers from which an estimator made its sample. A proposal
//! replaces all of them (a large step) or moves each a little (a small step). Both are symmetric.
//! Coordinates are touched only when an estimator asks for them, and then catch up with the steps
//! they missed.

use std::f32::consts::PI;

use glam::Vec2;

use super::independent::IndependentSampler;
use super::sampler::{Sampler, Stream};
use crate::engine::math::float::ONE_MINUS_EPSILON;
use crate::engine::math::hash::combine;

/// Where the random numbers of one step come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepKey {
    /// Family.
    pub stream: Stream,
    /// Item, such as a chain.
    pub item: u64,
    /// Number of the step.
    pub step: u64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Coordinate {
    value: f32,
    /// The time at which it was last moved; 0: never asked for.
    moved: u64,
    /// Both as they were before the proposal under way.
    kept: (f32, u64),
}

/// Dimensions of the random numbers behind one coordinate: a fresh value, and two for a move.
const NUMBERS: u32 = 4;

/// The state of a chain, or of the part of it that one walk uses.
#[derive(Clone, Debug)]
pub struct PrimarySpace {
    seed: u64,
    /// Standard deviation of a small step.
    size: f32,
    coordinates: Vec<Coordinate>,
    /// Counts accepted steps from 1, the proposal under way included.
    time: u64,
    /// Time and random numbers of the last large step, the origin at first.
    fresh: (u64, StepKey),
    /// The same before the proposal under way.
    fresh_kept: (u64, StepKey),
    /// The random numbers of the proposal under way.
    key: StepKey,
    dimension: u32,
}

impl PrimarySpace {
    /// The state of the independent sample `origin`. `salt` tells apart the spaces that one sample
    /// uses; `size` is the standard deviation of small steps.
    pub fn new(seed: u64, salt: u64, origin: StepKey, size: f32) -> Self {
        Self {
            seed: combine(seed, salt),
            size,
            coordinates: Vec::new(),
            time: 1,
            fresh: (1, origin),
            fresh_kept: (1, origin),
            key: origin,
            dimension: 0,
        }
    }

    /// Begins a proposal with the random numbers of `key`.
    pub fn propose(&mut self, key: StepKey, large: bool) {
        self.time += 1;
        self.key = key;
        self.fresh_kept = self.fresh;
        if large {
            self.fresh = (self.time, key);
        }
        self.dimension = 0;
    }

    /// Forgets the proposal; without this it is the state.
    pub fn reject(&mut self) {
        for c in self.coordinates.iter_mut().filter(|c| c.moved == self.time) {
            (c.value, c.moved) = c.kept;
        }
        self.fresh = self.fresh_kept;
        self.time -= 1;
    }

    fn numbers(&self, key: StepKey, coordinate: u32) -> IndependentSampler {
        let mut numbers = IndependentSampler::new(self.seed, key.stream, (key.item, key.step));
        numbers.seek(coordinate * NUMBERS);
        numbers
    }

    /// Brings coordinate `i` to the present.
    fn catch_up(&self, i: u32, mut c: Coordinate) -> Coordinate {
        if c.moved == self.time {
            return c;
        }
        c.kept = (c.value, c.moved);
        // The last large step replaced all coordinates.
        if c.moved < self.fresh.0 {
            c.value = self.numbers(self.fresh.1, i).next_1d();
            c.moved = self.fresh.0;
        }
        // The small steps since, all at once: normal moves add up to one of √n times their size.
        if c.moved < self.time {
            let missed = (self.time - c.moved) as f32;
            let mut numbers = self.numbers(self.key, i);
            numbers.seek(i * NUMBERS + 1);
            let step = self.size * missed.sqrt() * normal(numbers.next_2d());
            let moved = c.value + step;
            c.value = (moved - moved.floor()).min(ONE_MINUS_EPSILON);
            c.moved = self.time;
        }
        c
    }
}

/// A number of the standard normal distribution (Box and Muller 1958).
fn normal(u: Vec2) -> f32 {
    let (r, phi) = ((-2.0 * (1.0 - u.x).ln()).sqrt(), 2.0 * PI * u.y);
    r * phi.cos()
}

impl Sampler for PrimarySpace {
    fn seek(&mut self, dimension: u32) {
        self.dimension = dimension;
    }

    fn next_1d(&mut self) -> f32 {
        let i = self.dimension as usize;
        if i >= self.coordinates.len() {
            self.coordinates.resize(i + 1, Coordinate::default());
        }
        let c = self.catch_up(self.dimension, self.coordinates[i]);
        self.coordinates[i] = c;
        self.dimension += 1;
        c.value
    }

    fn next_2d(&mut self) -> Vec2 {
        let x = self.next_1d();
        Vec2::new(x, self.next_1d())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(step: u64) -> StepKey {
        StepKey {
            stream: Stream::Test,
            item: 0,
            step,
        }
    }

    fn read(space: &mut PrimarySpace, n: u32) -> Vec<f32> {
        space.seek(0);
        (0..n).map(|_| space.next_1d()).collect()
    }

    #[test]
    fn a_rejected_proposal_leaves_no_trace() {
        let mut space = PrimarySpace::new(1, 0, key(0), 0.01);
        let before = read(&mut space, 10);
        for step in 1..100 {
            space.propose(key(step), step % 3 == 0);
            let proposed = read(&mut space, 10);
            assert!(proposed.iter().zip(&before).all(|(a, b)| a != b));
            space.reject();
            // Coordinates beyond those read so far belong to the state too.
            assert_eq!(read(&mut space, 10), before);
        }
        let mut fresh = PrimarySpace::new(1, 0, key(0), 0.01);
        assert_eq!(read(&mut fresh, 20), read(&mut space, 20));
    }

    #[test]
    fn coordinates_that_were_not_asked_for_catch_up() {
        // One coordinate is read every step, the other only after 16: both have moved as far.
        let (n, size) = (4000, 0.01_f64);
        let mut squares = [0.0; 2];
        for run in 0..n {
            let mut space = PrimarySpace::new(run, 0, key(0), size as f32);
            let before = read(&mut space, 2);
            for step in 1..=16 {
                space.propose(key(step), false);
                read(&mut space, if step == 16 { 2 } else { 1 });
            }
            let after = read(&mut space, 2);
            for i in 0..2 {
                let d = f64::from(after[i] - before[i]);
                squares[i] += (d - d.round()).powi(2);
            }
        }
        for sum in squares {
            // The variance of a variance of n normal numbers is 2/n of its square.
            let ratio = sum / n as f64 / (16.0 * size * size);
            assert!(
                (ratio - 1.0).abs() < 5.0 * (2.0 / n as f64).sqrt(),
                "{ratio}"
            );
        }
    }

    #[test]
    fn a_chain_of_accepted_steps_stays_uniform() {
        let mut space = PrimarySpace::new(3, 0, key(0), 0.1);
        let (n, mut counts) = (200_000, [0.0; 10]);
        for step in 1..=n {
            space.propose(key(step), step % 5 == 0);
            counts[(read(&mut space, 1)[0] * 10.0) as usize] += 1.0;
        }
        // Neighbouring states are correlated: a chi-square of independent ones would be about 9.
        let expected = n as f64 / 10.0;
        let chi: f64 = counts
            .iter()
            .map(|c: &f64| (c - expected).powi(2) / expected)
            .sum();
        assert!(chi < 200.0, "{counts:?}");
    }
}
