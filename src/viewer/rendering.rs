//! The render session as the window drives it: a new job whenever something changed that makes
//! another picture.

use std::sync::Arc;

use glam::UVec2;

use super::model::Model;
use crate::engine::film::Frame;
use crate::engine::integrators::Hold;
use crate::engine::scene::Scene;
use crate::engine::scene::desc::CameraDesc;
use crate::engine::session::{RenderJob, RenderSession, Settings};

/// What the job under way was made of.
struct Submitted {
    scene: Arc<Scene>,
    view: CameraDesc,
    size: UVec2,
    settings: Settings,
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
            Arc::ptr_eq(&s.scene, scene)
                && s.view == model.view
                && s.size == size
                && s.settings == model.settings
        });
        if same {
            return Ok(());
        }
        let camera = model.camera(size)?;
        self.session.submit(RenderJob {
            scene: Arc::clone(scene),
            camera,
            size,
            settings: model.settings.clone(),
            navigating,
        });
        self.submitted = Some(Submitted {
            scene: Arc::clone(scene),
            view: model.view,
            size,
            settings: model.settings.clone(),
        });
        Ok(())
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
