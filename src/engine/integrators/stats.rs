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

/// Levels that are counted apart.
pub const LEVELS: usize = 16;

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
    /// Times that a medium was denser than the bound its tracking steps by: those parts of it are
    /// rendered thinner than they are.
    pub exceeded_majorants: u64,
    /// Microfacet samples below the horizon: no error, they carry no light.
    pub below_horizon: u64,
    /// Rays of walks from the eye by the number of events before them; the last counts all longer
    /// ones, too.
    levels: [u64; LEVELS],
    /// Trees of rays that were cut at their largest number.
    pub cut_trees: u64,
    /// Times that no independent sample found light for Markov chains to start from.
    pub dark_starts: u64,
    /// Proposals of Markov chains.
    pub mutations: u64,
    /// Those that were accepted.
    pub accepted: u64,
}

impl RenderStats {
    /// Counts a ray of a walk from the eye after `events` events.
    #[inline]
    pub fn ray_at(&mut self, events: u32) {
        self.rays += 1;
        self.levels[(events as usize).min(LEVELS - 1)] += 1;
    }

    /// Rays of walks from the eye by the number of events before them, up to the last that has any.
    pub fn levels(&self) -> &[u64] {
        let used = self.levels.iter().rposition(|n| *n > 0);
        &self.levels[..used.map_or(0, |last| last + 1)]
    }

    /// Share of the mutations of Markov chains that were accepted; None without any.
    pub fn acceptance(&self) -> Option<f64> {
        (self.mutations > 0).then(|| self.accepted as f64 / self.mutations as f64)
    }

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
        self.exceeded_majorants += o.exceeded_majorants;
        self.below_horizon += o.below_horizon;
        for (sum, n) in self.levels.iter_mut().zip(o.levels) {
            *sum += n;
        }
        self.cut_trees += o.cut_trees;
        self.dark_starts += o.dark_starts;
        self.mutations += o.mutations;
        self.accepted += o.accepted;
    }
}
