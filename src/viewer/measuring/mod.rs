//! How wrong the picture is, as the window shows it: curves of error, a reference, error images
//! and the referee. What takes long is done beside the window.

pub mod background;
pub mod curves;
pub mod evaluation;
pub mod overlay;
pub mod referee;
pub mod reference;

use std::sync::Arc;

use glam::UVec2;

use crate::engine::film::Frame;
use crate::engine::measure::convergence::Prediction;
use crate::engine::measure::error_image::ErrorKind;
use crate::engine::scene::Scene;
use crate::engine::scene::desc::CameraDesc;
use crate::engine::session::Settings;
use crate::plot::Chart;
use background::Waker;
use curves::{Curves, Sample};
use evaluation::{Evaluated, Evaluator};
use overlay::Overlay;
use referee::Match;
use reference::{Making, Reference};

/// What a frame was rendered from.
#[derive(Clone)]
pub struct Made {
    /// The scene.
    pub scene: Arc<Scene>,
    /// The view.
    pub view: CameraDesc,
    /// Pixels.
    pub size: UVec2,
    /// Algorithm and the rest.
    pub settings: Settings,
}

impl Made {
    /// Whether both should converge to the same picture.
    pub fn same_picture(&self, other: &Self) -> bool {
        let depth = |m: &Self| m.settings.layers.max_depth;
        Arc::ptr_eq(&self.scene, &other.scene)
            && self.view == other.view
            && self.size == other.size
            && depth(self) == depth(other)
    }
}

/// What runs along the plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Along {
    /// Wall time.
    #[default]
    Seconds,
    /// Samples per pixel.
    Samples,
}

/// What is drawn over the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Over {
    /// Nothing.
    #[default]
    Nothing,
    /// Its error against the reference.
    Error,
    /// What the referee compares.
    Referee,
}

/// The state.
#[derive(Default)]
pub struct Measuring {
    /// Errors of this view, a curve for each algorithm.
    pub curves: Curves,
    /// What runs along the plot.
    pub along: Along,
    /// The plot is shown in a window of its own too.
    pub large: bool,
    /// What errors are measured against.
    pub reference: Option<Arc<Reference>>,
    /// A reference on its way.
    pub making: Option<Making>,
    /// Which error image.
    pub kind: ErrorKind,
    /// What is drawn over the picture.
    pub over: Over,
    /// The error image.
    pub error_image: Overlay,
    /// The referee.
    pub referee: Match,
    /// Index of the integrator of a reference to be made.
    pub maker: usize,
    /// Seconds that it may take.
    pub maker_seconds: f64,
    /// Wakes the window; set by the program around it.
    pub waker: Waker,
    evaluator: Evaluator,
    /// What the last full frame was rendered from, and that frame.
    newest: Option<(Made, Arc<Frame>)>,
    /// Frame and kind whose error image is shown.
    shown: Option<(usize, ErrorKind)>,
}

impl Measuring {
    /// Takes note of a frame.
    pub fn observe(&mut self, made: Made, frame: &Arc<Frame>) {
        if frame.is_coarse() || frame.error.is_some() || frame.passes == 0 {
            return;
        }
        if self
            .newest
            .as_ref()
            .is_some_and(|(old, _)| !old.same_picture(&made))
        {
            self.curves.clear();
        }
        self.newest = Some((made, Arc::clone(frame)));
        if self.usable_reference().is_none() {
            self.add(frame, None);
        }
        self.evaluate();
    }

    /// Scene, view and settings of what is measured.
    pub fn made(&self) -> Option<&Made> {
        self.newest.as_ref().map(|(made, _)| made)
    }

    /// The reference, if it is one of what is shown.
    pub fn usable_reference(&self) -> Option<&Arc<Reference>> {
        let (made, _) = self.newest.as_ref()?;
        self.reference.as_ref().filter(|r| r.suits(made))
    }

    fn add(&mut self, frame: &Frame, measured: Option<f64>) {
        let Some((made, _)) = &self.newest else {
            return;
        };
        let estimate = frame.error_estimate;
        let relative = estimate.and_then(|e| e.relative().zip(e.relative_interval()));
        if measured.is_none() && relative.is_none() {
            return;
        }
        let sample = Sample {
            passes: frame.passes,
            seconds: frame.t_wall,
            measured,
            estimated: relative,
        };
        self.curves.add(&made.settings, sample);
    }

    /// Compares the newest frame with the reference, beside the window and one frame at a time.
    fn evaluate(&mut self) {
        let Some(reference) = self.usable_reference().cloned() else {
            return;
        };
        let Some((_, frame)) = self.newest.clone() else {
            return;
        };
        let kind = (self.over == Over::Error).then_some(self.kind);
        self.evaluator.start(frame, reference, kind, &self.waker);
    }

    /// Takes over what was done beside the window.
    pub fn poll(&mut self) {
        if let Some(done) = self.evaluator.finished() {
            self.take(done);
        }
        if let Some(made) = self.making.as_mut().and_then(Making::finished) {
            self.making = None;
            match made {
                Ok(reference) => self.set_reference(reference),
                Err(sentence) => self.curves.complaint = Some(sentence),
            }
        }
        self.referee.poll();
        // Another kind was chosen, or the image was just switched on.
        let wanted = self
            .newest
            .as_ref()
            .map(|(_, f)| (Arc::as_ptr(f) as usize, self.kind));
        if self.over == Over::Error && self.shown != wanted && !self.evaluator.is_busy() {
            self.evaluate();
        }
    }

    /// Whether a frame is being compared with the reference.
    pub fn is_busy(&self) -> bool {
        self.evaluator.is_busy()
    }

    fn take(&mut self, done: Evaluated) {
        let current = self
            .newest
            .as_ref()
            .is_some_and(|(made, f)| done.reference.suits(made) && f.epoch == done.frame.epoch);
        let same = self
            .reference
            .as_ref()
            .is_some_and(|r| Arc::ptr_eq(r, &done.reference));
        if !current || !same {
            return;
        }
        if let Some(relative) = done.relative {
            self.add(&done.frame, Some(relative));
        }
        if let Some(image) = done.image {
            self.shown = Some((Arc::as_ptr(&done.frame) as usize, image.kind));
            self.error_image.set_error(&image);
        }
    }

    /// Measures against `reference` from now on.
    pub fn set_reference(&mut self, reference: Reference) {
        self.curves.complaint = None;
        self.reference = Some(Arc::new(reference));
        self.shown = None;
        self.evaluate();
    }

    /// Goes back to estimates.
    pub fn drop_reference(&mut self) {
        self.reference = None;
        self.shown = None;
        self.error_image.clear();
        if self.over == Over::Error {
            self.over = Over::Nothing;
        }
    }

    /// When the algorithm that renders reaches `target`.
    pub fn prediction(&self, target: f64) -> Option<Prediction> {
        let made = self.made()?;
        let measured = self.usable_reference().is_some();
        self.curves.prediction(&made.settings, measured, target)
    }

    /// The plot.
    pub fn chart(&self, target: f64) -> Chart {
        let measured = self.usable_reference().is_some();
        Chart {
            title: "Error against time".to_owned(),
            x_label: match self.along {
                Along::Seconds => "seconds".to_owned(),
                Along::Samples => "samples per pixel".to_owned(),
            },
            y_label: match measured {
                true => "RMSE / mean".to_owned(),
                false => "estimated RMSE / mean".to_owned(),
            },
            curves: self.curves.plotted(self.along, measured),
            target: Some(target),
            guided: true,
        }
    }

    /// The plot as a file that ends in `extension`: png, svg or csv.
    ///
    /// # Errors
    /// A sentence.
    pub fn plot_bytes(&self, extension: &str, target: f64) -> Result<Vec<u8>, String> {
        const SIZE: [u32; 2] = [1200, 760];
        let chart = self.chart(target);
        match extension {
            "svg" => crate::plot::svg(&chart, SIZE).map(String::into_bytes),
            "csv" => Ok(chart.csv().into_bytes()),
            _ => {
                let pixels = crate::plot::pixels(&chart, SIZE)?;
                crate::picture::png_file::encode(SIZE.into(), &pixels, &[])
                    .map_err(|error| error.to_string())
            }
        }
    }
}
