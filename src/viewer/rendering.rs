//! The render session as the window drives it: a new job whenever something changed that makes
//! another picture.

use std::sync::Arc;

use glam::UVec2;

use super::measuring::Made;
use super::model::Model;
use crate::engine::film::Frame;
use crate::engine::integrators::Hold;
use crate::engine::scene::Scene;
use crate::engine::session::{RenderJob, RenderSession};

/// What the job under way was made of.
struct Submitted {
    made: Made,
    epoch: u64,
}

/// A session and its job.
pub struct Rendering {
    session: RenderSession,
    submitted: Option<Submitted>,
    frame: Option<Arc<Frame>>,
}

impl Rendering {
    /// Starts a session that calls `wake` after each frame.
    ///
    /// # Errors
    /// A sentence if the system refuses to start threads.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Result<Self, String> {
        let session = RenderSession::new(0, wake)
            .map_err(|error| format!("the render cannot start: {error}"))?;
        Ok(Self {
            session,
            submitted: None,
            frame: None,
        })
    }

    /// Submits a job if `model` makes another picture of `size` pixels than the one under way.
    ///
    /// # Errors
    /// A sentence if the view makes no sense; the job under way goes on.
    pub fn follow(
        &mut self,
        scene: &Arc<Scene>,
        model: &Model,
        size: UVec2,
        navigating: bool,
    ) -> Result<(), String> {
        let same = self.submitted.as_ref().is_some_and(|s| {
            let s = &s.made;
            Arc::ptr_eq(&s.scene, scene)
                && s.view == model.view
                && s.size == size
                && s.settings == model.settings
        });
        if same {
            return Ok(());
        }
        let camera = model.camera(size)?;
        let epoch = self.session.submit(RenderJob {
            scene: Arc::clone(scene),
            camera,
            size,
            settings: model.settings.clone(),
            navigating,
        });
        let made = Made {
            scene: Arc::clone(scene),
            view: model.view,
            size,
            settings: model.settings.clone(),
        };
        self.submitted = Some(Submitted { made, epoch });
        Ok(())
    }

    /// What a frame was rendered from, if its job is the one under way.
    pub fn made(&self, frame: &Frame) -> Option<Made> {
        let submitted = self.submitted.as_ref()?;
        (submitted.epoch == frame.epoch).then(|| submitted.made.clone())
    }

    /// The newest frame, if it is another one than last time.
    pub fn new_frame(&mut self) -> Option<Arc<Frame>> {
        let latest = self.session.latest()?;
        let known = self.frame.as_ref();
        if known.is_some_and(|known| Arc::ptr_eq(known, &latest)) {
            return None;
        }
        self.frame = Some(Arc::clone(&latest));
        Some(latest)
    }

    /// Makes the render stand still until the result is dropped.
    pub fn hold(&self) -> Hold {
        self.session.hold()
    }

    /// Pauses or goes on.
    pub fn set_paused(&self, paused: bool) {
        self.session.set_paused(paused);
    }
}
