//! Frames whose memory goes round.

use std::sync::Arc;

use crate::engine::film::Frame;
use crate::engine::plan::RenderPlan;

/// One frame is shown, one is on its way, one is being written.
const FRAMES: usize = 3;

/// A pool of frames: a picture of a million pixels with its layers is too large to allocate ten
/// times a second.
#[derive(Default)]
pub(super) struct FramePool(Vec<Arc<Frame>>);

impl FramePool {
    /// A frame nobody else holds.
    pub fn take(&mut self, plan: &Arc<RenderPlan>) -> Arc<Frame> {
        match self.0.iter().position(|f| Arc::strong_count(f) == 1) {
            Some(free) => self.0.swap_remove(free),
            None => Arc::new(Frame::empty(Arc::clone(plan))),
        }
    }

    /// Takes note of a frame that was published.
    pub fn published(&mut self, frame: Arc<Frame>) {
        if self.0.len() < FRAMES {
            self.0.push(frame);
        }
    }
}
