//! A frame against a reference, beside the window.

use std::sync::Arc;

use super::background::{Waker, Work};
use super::reference::Reference;
use crate::engine::film::Frame;
use crate::engine::measure::Metrics;
use crate::engine::measure::error_image::{ErrorImage, ErrorKind};

/// What came of it.
pub struct Evaluated {
    /// The frame.
    pub frame: Arc<Frame>,
    /// The reference.
    pub reference: Arc<Reference>,
    /// RMSE over the mean of the reference; none for a black one.
    pub relative: Option<f64>,
    /// Where the error is, if that was asked for.
    pub image: Option<ErrorImage>,
}

/// Evaluates one frame at a time; what comes meanwhile is left out.
#[derive(Default)]
pub struct Evaluator(Option<Work<Evaluated>>);

impl Evaluator {
    /// Starts, unless it is busy.
    pub fn start(
        &mut self,
        frame: Arc<Frame>,
        reference: Arc<Reference>,
        kind: Option<ErrorKind>,
        wake: &Waker,
    ) {
        if self.0.is_some() {
            return;
        }
        self.0 = Work::start("evaluate", wake, move || {
            let pixels = &frame.layers[0].pixels;
            let metrics = Metrics::new(pixels, &reference.pixels);
            let mean = reference.mean;
            let relative = metrics.filter(|_| mean > 0.0).map(|m| m.rmse / mean);
            let image =
                kind.and_then(|kind| ErrorImage::new(kind, frame.size, pixels, &reference.pixels));
            Evaluated {
                frame,
                reference,
                relative,
                image,
            }
        });
    }

    /// Whether it is at work.
    pub fn is_busy(&self) -> bool {
        self.0.is_some()
    }

    /// The result, once.
    pub fn finished(&mut self) -> Option<Evaluated> {
        let done = self.0.as_ref()?.finished()?;
        self.0 = None;
        done.ok()
    }
}
