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

pub use crate::engine::photon::LEVELS;

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
    /// The same of walks from the lights.
    light_levels: [u64; LEVELS],
    /// How often Russian roulette was played, and survived.
    roulette: [u64; 2],
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

    /// Counts a ray of a walk from a light after `events` events.
    #[inline]
    pub fn light_ray_at(&mut self, events: u32) {
        self.rays += 1;
        self.light_levels[(events as usize).min(LEVELS - 1)] += 1;
    }

    /// Counts rays of walks from the lights that were counted elsewhere, by level.
    pub fn add_light_rays(&mut self, levels: &[u64; LEVELS]) {
        self.rays += levels.iter().sum::<u64>();
        for (sum, n) in self.light_levels.iter_mut().zip(levels) {
            *sum += n;
        }
    }

    /// Rays of walks from the lights by the number of events before them.
    pub fn light_levels(&self) -> &[u64] {
        let used = self.light_levels.iter().rposition(|n| *n > 0);
        &self.light_levels[..used.map_or(0, |last| last + 1)]
    }

    /// Counts a game of Russian roulette and hands its outcome on.
    #[inline]
    pub fn play(&mut self, survived: bool) -> bool {
        self.add_games(1, u64::from(survived));
        survived
    }

    /// Counts games that were played elsewhere.
    #[inline]
    pub fn add_games(&mut self, played: u64, survived: u64) {
        self.roulette[0] += played;
        self.roulette[1] += survived;
    }

    /// Share of the games of roulette that walks survived; None if none was played.
    pub fn survival(&self) -> Option<f64> {
        let [played, survived] = self.roulette;
        (played > 0).then(|| survived as f64 / played as f64)
    }

    /// Histogram of lengths: walks from the eye and from the lights that ended after 0, 1, 2 …
    /// events, the last standing for all longer ones. None for trees of rays, whose levels grow.
    pub fn lengths(&self) -> [Option<Vec<u64>>; 2] {
        [self.levels(), self.light_levels()].map(|levels| {
            let after = levels.iter().skip(1).chain(&[0]);
            levels
                .iter()
                .zip(after)
                .map(|(n, m)| n.checked_sub(*m))
                .collect()
        })
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
        for (sum, n) in self.light_levels.iter_mut().zip(o.light_levels) {
            *sum += n;
        }
        self.add_games(o.roulette[0], o.roulette[1]);
        self.cut_trees += o.cut_trees;
        self.dark_starts += o.dark_starts;
        self.mutations += o.mutations;
        self.accepted += o.accepted;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_what_levels_lose() {
        let mut stats = RenderStats::default();
        for length in [0, 0, 1, 3] {
            (0..=length).for_each(|events| stats.ray_at(events));
        }
        stats.light_ray_at(0);
        assert_eq!(stats.lengths(), [Some(vec![2, 1, 0, 1]), Some(vec![1])]);
        assert_eq!(stats.rays, 9);
        // A tree has more rays after an event than before.
        stats.ray_at(5);
        assert_eq!(stats.lengths()[0], None);
        assert_eq!(stats.survival(), None);
        assert!(stats.play(true) && !stats.play(false));
        assert_eq!(stats.survival(), Some(0.5));
    }
}
