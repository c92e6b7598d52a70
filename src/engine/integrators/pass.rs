//! What an integrator is given for one pass.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::give_way::GiveWay;
use crate::engine::camera::Camera;
use crate::engine::plan::RenderPlan;
use crate::engine::scene::Scene;

/// The job was replaced or stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cancelled;

/// Tells whether a job is still wanted: it is while its epoch is the newest. There is no flag to
/// clear, so no cancellation can be lost.
#[derive(Clone, Debug)]
pub struct Cancel {
    newest: Arc<AtomicU64>,
    epoch: u64,
    give_way: Option<Arc<GiveWay>>,
}

impl Cancel {
    /// The token of the job `epoch`; it is cancelled by storing another number in `newest`.
    pub fn new(newest: Arc<AtomicU64>, epoch: u64) -> Self {
        Self {
            newest,
            epoch,
            give_way: None,
        }
    }

    /// The same token, whose owner also stands still while `give_way` is held.
    #[must_use]
    pub fn giving_way(self, give_way: Arc<GiveWay>) -> Self {
        Self {
            give_way: Some(give_way),
            ..self
        }
    }

    /// A token that nobody cancels.
    pub fn never() -> Self {
        Self::new(Arc::new(AtomicU64::new(0)), 0)
    }

    /// Fails once the job is no longer wanted. Until then it may wait for what goes first.
    ///
    /// # Errors
    /// [`Cancelled`] then.
    #[inline]
    pub fn check(&self) -> Result<(), Cancelled> {
        if let Some(give_way) = &self.give_way {
            give_way.wait();
        }
        if self.newest.load(Ordering::Relaxed) == self.epoch {
            Ok(())
        } else {
            Err(Cancelled)
        }
    }
}

/// One pass of a job.
#[derive(Clone, Copy)]
pub struct Pass<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The view, at the size of the film.
    pub camera: &'a Camera,
    /// What is computed and what is left out.
    pub plan: &'a RenderPlan,
    /// Seed of all random numbers of the job.
    pub seed: u64,
    /// Number of the pass, from 0.
    pub index: u64,
    /// To be asked once a tile.
    pub cancel: &'a Cancel,
}
