//! One job, pass after pass, on the calling thread's pool. The session's worker and the command
//! line both drive it.

use std::sync::Arc;

use glam::UVec2;

use super::clock::RenderClock;
use super::job::{RenderJob, Settings};
use crate::engine::camera::Camera;
use crate::engine::film::{ErrorEstimate, Film, Frame, Memory};
use crate::engine::integrators::{
    Cancel, Cancelled, Integrator, Params, Pass, Recording, RenderStats, ReplayError, SampleId,
};
use crate::engine::path::ExpressionError;
use crate::engine::plan::RenderPlan;
use crate::engine::scene::Scene;

/// A render under way.
pub struct Renderer {
    scene: Arc<Scene>,
    camera: Camera,
    size: UVec2,
    settings: Settings,
    plan: Arc<RenderPlan>,
    integrator: Box<dyn Integrator>,
    /// Stands in for coarse pictures that the integrator cannot deliver.
    preview: Option<Box<dyn Integrator>>,
    /// The last coarse picture was a preview.
    previewed: bool,
    film: Film,
    stats: RenderStats,
    clock: RenderClock,
}

impl Renderer {
    /// Accepts a job; `t_wall` counts from here.
    ///
    /// # Errors
    /// If its expressions together need too large a table.
    pub fn new(job: &RenderJob) -> Result<Self, ExpressionError> {
        let clock = RenderClock::start();
        let lens = job.camera.has_lens();
        let plan = RenderPlan::new(&job.scene, lens, &job.settings.layers)?;
        Ok(Self::with_plan(job, plan, clock))
    }

    /// Accepts a job in place of `previous`, and keeps its integrator if only the view changed,
    /// or if the integrator can take the new settings: what it prepared survives.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn replace(previous: Option<Self>, job: &RenderJob) -> Result<Self, ExpressionError> {
        let mut renderer = Self::new(job)?;
        let Some(mut previous) = previous else {
            return Ok(renderer);
        };
        if let Some(film) = previous.film.reuse(job.size, renderer.plan.planned) {
            renderer.film = film;
        }
        renderer.preview = previous.preview;
        let (old, new) = (&previous.settings, &job.settings);
        let keeps = old.same_integrator(new)
            || std::ptr::eq(old.integrator, new.integrator)
                && previous.integrator.update(&new.params);
        if Arc::ptr_eq(&previous.scene, &job.scene) && keeps {
            renderer.integrator = previous.integrator;
        }
        Ok(renderer)
    }

    /// Renders with a plan of the caller's: for the test that a plan changes nothing.
    pub fn with_plan(job: &RenderJob, plan: RenderPlan, clock: RenderClock) -> Self {
        Self {
            scene: Arc::clone(&job.scene),
            camera: job.camera.with_size(job.size),
            size: job.size,
            settings: job.settings.clone(),
            film: Film::new(job.size, plan.planned),
            integrator: (job.settings.integrator.build)(&job.settings.params),
            preview: None,
            previewed: false,
            plan: Arc::new(plan),
            stats: RenderStats::default(),
            clock,
        }
    }

    /// Computes the next pass.
    ///
    /// # Errors
    /// [`Cancelled`] if `cancel` says so; the sums are then as before.
    pub fn render_pass(&mut self, cancel: &Cancel) -> Result<(), Cancelled> {
        let pass = Pass {
            scene: &self.scene,
            camera: &self.camera,
            plan: &self.plan,
            seed: self.settings.seed,
            index: self.film.passes(),
            cancel,
        };
        self.stats += self.integrator.render_pass(&pass, &mut self.film)?;
        Ok(())
    }

    /// Computes one sample of this job again and writes its steps down.
    ///
    /// # Errors
    /// Why it cannot, in one sentence; [`ReplayError::Cancelled`] if `cancel` says so.
    pub fn replay(
        &mut self,
        sample: &SampleId,
        cancel: &Cancel,
        to: &mut Recording,
    ) -> Result<(), ReplayError> {
        if let SampleId::Camera { pixel, .. } = sample
            && pixel.cmpge(self.size).any()
        {
            let (x, y, size) = (pixel.x, pixel.y, self.size);
            return Err(ReplayError::Cannot(format!(
                "a picture of {}x{} pixels has no pixel {x},{y}",
                size.x, size.y
            )));
        }
        let pass = Pass {
            scene: &self.scene,
            camera: &self.camera,
            plan: &self.plan,
            seed: self.settings.seed,
            index: sample.pass(),
            cancel,
        };
        self.integrator.replay(&pass, sample, to)
    }

    /// A picture of one sample a pixel at 1 / `divisor` of the resolution. It does not enter the
    /// sums.
    ///
    /// # Errors
    /// [`Cancelled`] if `cancel` says so.
    pub fn render_coarse(&mut self, divisor: u32, cancel: &Cancel) -> Result<Film, Cancelled> {
        let size = (self.size / divisor).max(UVec2::ONE);
        let camera = self.camera.with_size(size);
        let mut film = Film::new(size, self.plan.planned);
        let pass = Pass {
            scene: &self.scene,
            camera: &camera,
            plan: &self.plan,
            seed: self.settings.seed,
            index: 0,
            cancel,
        };
        self.previewed = self.integrator.needs_preview(&pass);
        if self.previewed {
            let entry = &crate::engine::integrators::path::ENTRY;
            let build = || (entry.build)(&Params::defaults(entry.params));
            let preview = self.preview.get_or_insert_with(build);
            preview.render_pass(&pass, &mut film)?;
        } else {
            self.integrator.render_pass(&pass, &mut film)?;
        }
        Ok(film)
    }

    /// Whether the last coarse picture was a preview: its time says nothing of a full pass.
    pub fn previewed(&self) -> bool {
        self.previewed
    }

    /// Seed of all random numbers.
    pub fn seed(&self) -> u64 {
        self.settings.seed
    }

    /// Pixels of the full picture.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// Completed passes.
    pub fn passes(&self) -> u64 {
        self.film.passes()
    }

    /// Estimated RMSE / image mean.
    pub fn relative_error(&self) -> Option<f64> {
        self.film.error_estimate()?.relative()
    }

    /// Estimated error with its interval.
    pub fn error_estimate(&self) -> Option<ErrorEstimate> {
        self.film.error_estimate()
    }

    /// What is computed.
    pub fn plan(&self) -> &Arc<RenderPlan> {
        &self.plan
    }

    /// Counts so far.
    pub fn stats(&self) -> RenderStats {
        self.stats
    }

    /// Time so far.
    pub fn clock(&mut self) -> &mut RenderClock {
        &mut self.clock
    }

    /// Memory of the sums in bytes.
    pub fn film_bytes(&self) -> usize {
        self.film.bytes()
    }

    /// Takes a picture of `coarse`, or of the sums, into `frame`, whose memory is used again.
    pub fn snapshot(&self, coarse: Option<&Film>, epoch: u64, frame: &mut Frame) {
        let film = coarse.unwrap_or(&self.film);
        film.resolve(&self.plan.labels, &mut frame.layers);
        frame.epoch = epoch;
        frame.size = film.size();
        frame.full_size = self.size;
        frame.passes = film.passes();
        frame.t_wall = self.clock.wall();
        frame.t_cpu = self.clock.cpu();
        frame.stats = self.stats;
        if coarse.is_none() {
            film.resolve_differences(&mut frame.differences);
        } else {
            frame.differences.clear();
        }
        frame.memory = Memory {
            film: self.film.bytes(),
            integrator: self.integrator.memory_bytes(),
        };
        frame.threads = rayon::current_num_threads();
        frame.error_estimate = match coarse {
            None => film.error_estimate(),
            Some(_) => None,
        };
        frame.relative_error = frame.error_estimate.and_then(|e| e.relative());
        frame.plan = Arc::clone(&self.plan);
        frame.preview = coarse.is_some() && self.previewed;
        frame.facts = self.integrator.facts();
        frame.photons = self.integrator.photons();
        frame.paused = false;
        frame.error = None;
    }

    /// A picture of the sums in a frame of its own.
    pub fn frame(&self) -> Frame {
        let mut frame = Frame::empty(Arc::clone(&self.plan));
        self.snapshot(None, 0, &mut frame);
        frame
    }
}
