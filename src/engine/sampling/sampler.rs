//! What an estimator asks of its random numbers.

use glam::Vec2;

/// A family of random numbers that must not be correlated with the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum Stream {
    /// Camera samples: the index is a pixel and a sample number.
    Camera = 1,
    /// Light paths: the index is a path number.
    Light = 2,
    /// Monte Carlo estimates made while a scene is prepared.
    Preparation = 3,
    /// Tests.
    Test = 4,
    /// Gather rays: the index is drawn by the sample they belong to, or made of a record's place.
    Gather = 5,
    /// Mutations of Markov chains: the index is a chain and a step.
    Chain = 6,
    /// Independent samples that chains start from and their normalisation is estimated by.
    Bootstrap = 7,
    /// Light paths whose vertices are merged: the index is a path number.
    Photon = 8,
}

/// Uniform numbers in [0, 1) for one sample, dimension after dimension.
///
/// An estimator reserves a fixed block of dimensions per path vertex with [`Sampler::seek`], so
/// that a decision at one vertex (a lobe, a layer left out) shifts no number of a later one.
pub trait Sampler {
    /// Continues with dimension `dimension`.
    fn seek(&mut self, dimension: u32);

    /// The number of the current dimension; moves on by one.
    fn next_1d(&mut self) -> f32;

    /// The numbers of two dimensions that are stratified together; moves on by two.
    fn next_2d(&mut self) -> Vec2;
}
