//! Counts that every render keeps.

use std::ops::AddAssign;

use glam::UVec2;

/// A camera sample that brought no finite radiance: enough to compute it again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BadSample {
    /// Its pixel.
    pub pixel: UVec2,
    /// Its pass.
    pub pass: u64,
}

/// What one or more passes did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RenderStats {
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Camera samples.
    pub samples: u64,
    /// Samples whose radiance was NaN or infinite; they are left out of the mean.
    pub non_finite: u64,
    /// The first of them.
    pub first_non_finite: Option<BadSample>,
    /// Paths that were cut at the largest number of events a path may have.
    pub cut_paths: u64,
    /// Microfacet samples below the horizon: no error, they carry no light.
    pub below_horizon: u64,
    /// Proposals of Markov chains.
    pub mutations: u64,
    /// Those that were accepted.
    pub accepted: u64,
}

impl RenderStats {
    /// Counts a sample that was not finite.
    pub fn add_bad(&mut self, sample: BadSample) {
        self.non_finite += 1;
        self.first_non_finite = self.first_non_finite.or(Some(sample));
    }
}

impl AddAssign for RenderStats {
    fn add_assign(&mut self, o: Self) {
        self.rays += o.rays;
        self.samples += o.samples;
        self.non_finite += o.non_finite;
        self.first_non_finite = self.first_non_finite.or(o.first_non_finite);
        self.cut_paths += o.cut_paths;
        self.below_horizon += o.below_horizon;
        self.mutations += o.mutations;
        self.accepted += o.accepted;
    }
}
