//! The worker's loop.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Instant;

use super::frames::FramePool;
use super::handle::{Mail, Shared};
use super::job::RenderJob;
use super::renderer::Renderer;
use super::schedule::{self, Progress, Step, next_step, publish_now};
use crate::engine::film::{Film, Frame};
use crate::engine::integrators::{Cancel, Cancelled};

/// A guess for the first pass of all, in seconds per pixel.
const FIRST_GUESS: f64 = 5e-6;

/// The job under way.
struct Current {
    renderer: Renderer,
    epoch: u64,
    navigating: bool,
    last_divisor: Option<u32>,
    last_publish: Instant,
    unpublished: bool,
}

struct Worker<'a> {
    shared: &'a Shared,
    pool: &'a rayon::ThreadPool,
    frames: FramePool,
    seconds_per_pixel: f64,
    current: Option<Current>,
}

/// Renders the newest job until the session closes.
pub(super) fn run(shared: &Shared, pool: &rayon::ThreadPool) {
    let mut worker = Worker {
        shared,
        pool,
        frames: FramePool::default(),
        seconds_per_pixel: FIRST_GUESS,
        current: None,
    };
    let mut idle = true;
    loop {
        match shared.look(idle) {
            Mail::Closing => return,
            Mail::Job(epoch, job) => {
                worker.accept(epoch, &job);
                idle = worker.current.is_none();
            }
            Mail::Paused => {
                worker.pause();
                idle = true;
            }
            Mail::Nothing => {
                worker.resume();
                idle = !worker.step();
            }
        }
    }
}

impl Worker<'_> {
    fn accept(&mut self, epoch: u64, job: &RenderJob) {
        let previous = self.current.take().map(|c| c.renderer);
        if let Some(why) = job.settings.integrator.refusal(&job.scene.features) {
            self.publish_error(epoch, why);
            return;
        }
        match Renderer::replace(previous, job) {
            Ok(renderer) => {
                self.current = Some(Current {
                    renderer,
                    epoch,
                    navigating: job.navigating,
                    last_divisor: None,
                    last_publish: Instant::now(),
                    unpublished: false,
                });
                // The first picture of a job is made even while the session is paused.
                self.step();
            }
            Err(error) => self.publish_error(epoch, error.to_string()),
        }
    }

    fn pause(&mut self) {
        if let Some(current) = &mut self.current {
            current.renderer.clock().pause();
        }
        self.publish(None, true);
    }

    fn resume(&mut self) {
        if let Some(current) = &mut self.current {
            current.renderer.clock().resume();
        }
    }

    /// Does one step of the job; false if there is nothing to do until the mailbox changes.
    fn step(&mut self) -> bool {
        let Some(current) = &mut self.current else {
            return false;
        };
        let size = current.renderer.size();
        let pixels = u64::from(size.x) * u64::from(size.y);
        if pixels == 0 {
            return false;
        }
        let step = next_step(&Progress {
            last_divisor: current.last_divisor,
            passes: current.renderer.passes(),
            pixels,
            seconds_per_pixel: self.seconds_per_pixel,
            navigating: current.navigating,
        });
        let cancel = match step {
            Step::Coarse {
                must_finish: true, ..
            } => Cancel::never(),
            _ => Cancel::new(Arc::clone(&self.shared.newest), current.epoch)
                .giving_way(Arc::clone(&self.shared.give_way)),
        };
        let start = Instant::now();
        let renderer = &mut current.renderer;
        let done = catch_unwind(AssertUnwindSafe(|| {
            self.pool.install(|| match step {
                Step::Coarse { divisor, .. } => renderer.render_coarse(divisor, &cancel).map(Some),
                Step::Full => renderer.render_pass(&cancel).map(|()| None),
            })
        }));
        match done {
            Ok(Ok(coarse)) => self.completed(step, coarse.as_ref(), start, pixels),
            Ok(Err(Cancelled)) => {}
            Err(_) => {
                let (epoch, pass) = (current.epoch, current.renderer.passes());
                let seed = current.renderer.seed();
                self.current = None;
                let message = format!("a bug stopped the render in pass {pass} with seed {seed}");
                self.publish_error(epoch, message);
                return false;
            }
        }
        true
    }

    fn completed(&mut self, step: Step, coarse: Option<&Film>, start: Instant, pixels: u64) {
        let Some(current) = &mut self.current else {
            return;
        };
        let divisor = match step {
            Step::Coarse { divisor, .. } => {
                current.last_divisor = Some(divisor);
                divisor
            }
            Step::Full => 1,
        };
        let cells = pixels as f64 / f64::from(divisor * divisor);
        // Coarse pictures are planned by this figure: where previews stand in for them, full
        // passes say nothing about it.
        if coarse.is_some() || !current.renderer.previewed() {
            let measured = start.elapsed().as_secs_f64() / cells.max(1.0);
            self.seconds_per_pixel = schedule::learn(self.seconds_per_pixel, measured);
        }
        current.unpublished = true;
        let since = current.last_publish.elapsed().as_secs_f64();
        if coarse.is_some() || publish_now(current.renderer.passes(), since) {
            self.publish(coarse, false);
        }
    }

    /// Publishes a coarse picture, or the sums if they changed since the last time.
    fn publish(&mut self, coarse: Option<&Film>, paused: bool) {
        let Some(current) = &mut self.current else {
            return;
        };
        if !current.unpublished && !paused || coarse.is_none() && current.renderer.passes() == 0 {
            return;
        }
        current.unpublished = false;
        current.last_publish = Instant::now();
        let mut frame = self.frames.take(current.renderer.plan());
        if let Some(frame) = Arc::get_mut(&mut frame) {
            let (renderer, epoch) = (&current.renderer, current.epoch);
            self.pool
                .install(|| renderer.snapshot(coarse, epoch, frame));
            frame.paused = paused;
        }
        self.frames.published(Arc::clone(&frame));
        self.shared.publish(frame);
    }

    fn publish_error(&mut self, epoch: u64, error: String) {
        let mut frame = Frame::failed(error);
        frame.epoch = epoch;
        self.shared.publish(Arc::new(frame));
    }
}
