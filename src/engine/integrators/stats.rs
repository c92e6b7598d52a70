//! Counts that every render keeps.

use std::ops::AddAssign;

use super::replay::SampleId;
use crate::engine::geometry::RayFault;
use crate::engine::math::FaultCounts;

/// A sample in which something went wrong: enough to compute it again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BadSample {
    /// Its name.
    pub id: SampleId,
    /// What went wrong, one of [`ERRORS`].
    pub what: &'static str,
}

/// What counts as an error, the worst first, in the order of [`RenderStats::errors`].
pub const ERRORS: [&str; 6] = [
    "its light was not a number",
    "its light was infinite",
    "its light was negative",
    "a ray met the surface that it left",
    "a ray slipped out of a closed surface",
    "it was cut at the largest number of events",
];

/// How many bad samples are kept.
const KEPT: usize = 4;

pub use crate::engine::photon::LEVELS;

/// What one or more passes did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RenderStats {
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Camera samples.
    pub samples: u64,
    /// Samples whose radiance was NaN or infinite, which are left out of the mean, or negative.
    pub faults: FaultCounts,
    /// Rays that met the surface that they left, where they could not.
    pub self_hits: u64,
    /// Rays that left the scene from within a closed surface: they slipped through an edge.
    pub missed_edges: u64,
    /// The first samples with errors.
    bad: [Option<BadSample>; KEPT],
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

    /// Samples that were left out because their radiance was NaN or infinite.
    pub fn non_finite(&self) -> u64 {
        self.faults.non_finite()
    }

    /// How often each of [`ERRORS`] happened. All are zero in a sound render of a sound scene.
    #[inline]
    pub fn errors(&self) -> [u64; ERRORS.len()] {
        [
            self.faults.nan,
            self.faults.infinite,
            self.faults.negative,
            self.self_hits,
            self.missed_edges,
            self.cut_paths,
        ]
    }

    /// Counts what is wrong with a ray, if anything is.
    #[inline]
    pub fn count_ray_fault(&mut self, fault: Option<RayFault>) {
        match fault {
            None => {}
            Some(RayFault::SelfHit) => self.self_hits += 1,
            Some(RayFault::MissedEdge) => self.missed_edges += 1,
        }
    }

    /// Keeps the name of the sample that was taken since [`Self::errors`] were `before`, if there
    /// are more now, and if it is one of the first.
    #[inline]
    pub fn keep_if_bad(&mut self, before: &[u64; ERRORS.len()], id: impl FnOnce() -> SampleId) {
        let now = self.errors();
        // Not by comparing the arrays, which calls a function for every sample.
        if (0..now.len()).fold(0, |all, i| all | (now[i] ^ before[i])) != 0 {
            let worst = (0..now.len()).find(|i| now[*i] != before[*i]);
            let what = ERRORS[worst.unwrap_or(0)];
            self.keep(BadSample { id: id(), what });
        }
    }

    /// Keeps a bad sample, if it is one of the first.
    pub fn keep(&mut self, sample: BadSample) {
        if let Some(free) = self.bad.iter_mut().find(|kept| kept.is_none()) {
            *free = Some(sample);
        }
    }

    /// The first samples in which something went wrong.
    pub fn bad_samples(&self) -> impl Iterator<Item = BadSample> {
        self.bad.into_iter().flatten()
    }
}

impl AddAssign for RenderStats {
    fn add_assign(&mut self, o: Self) {
        self.rays += o.rays;
        self.samples += o.samples;
        self.faults += o.faults;
        self.self_hits += o.self_hits;
        self.missed_edges += o.missed_edges;
        o.bad_samples().for_each(|sample| self.keep(sample));
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
