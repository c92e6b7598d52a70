//! Two renders of the same view, run against each other for a [`Referee`].

use super::referee::{Referee, Rules};
use crate::engine::integrators::{Cancel, Cancelled};
use crate::engine::math::hash::combine;
use crate::engine::path::ExpressionError;
use crate::engine::session::{RenderJob, Renderer};

/// Seconds that a run takes at least, where the number of its passes is not given: what is
/// prepared before the first pass then does not take most of the time.
const RUN_SECONDS: f64 = 0.25;
/// Most passes of a run.
const MAX_PASSES: u64 = 1024;

/// Renders runs of both sides in turn.
pub struct Duel {
    jobs: [RenderJob; 2],
    passes: [Option<u64>; 2],
    referee: Referee,
    seed: u64,
    run: u64,
}

impl Duel {
    /// Two jobs of the same size and layers. Seeds are made from that of the first. `passes` of
    /// a run; otherwise as many as take a quarter of a second.
    pub fn new(jobs: [RenderJob; 2], rules: Rules, passes: Option<u64>) -> Self {
        let seed = jobs[0].settings.seed;
        Self {
            jobs,
            passes: [passes; 2],
            referee: Referee::new(rules),
            seed,
            run: 0,
        }
    }

    /// Renders one more run of both sides.
    ///
    /// # Errors
    /// If their expressions together need too large a table.
    pub fn step(&mut self, cancel: &Cancel) -> Result<Result<(), Cancelled>, ExpressionError> {
        for side in 0..2 {
            let mut job = self.jobs[side].clone();
            job.settings.seed = combine(self.seed, 2 * self.run + side as u64);
            let mut renderer = Renderer::new(&job)?;
            loop {
                if renderer.render_pass(cancel).is_err() {
                    return Ok(Err(Cancelled));
                }
                let (passes, seconds) = (renderer.passes(), renderer.clock().wall());
                // The first run finds out how long a pass takes: the number of passes depends on
                // the time, never on what was seen. Even, so that both halves count alike.
                let long_enough = seconds >= RUN_SECONDS && passes.is_multiple_of(2);
                let done = self.passes[side].map_or(long_enough, |wanted| passes >= wanted);
                if done || passes >= MAX_PASSES {
                    self.passes[side] = Some(passes);
                    break;
                }
            }
            let seconds = renderer.clock().wall();
            self.referee.add(side, &renderer.frame(), seconds);
        }
        self.run += 1;
        Ok(Ok(()))
    }

    /// What was found so far.
    pub fn referee(&self) -> &Referee {
        &self.referee
    }
}
