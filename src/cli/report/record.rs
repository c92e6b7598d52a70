//! One run: a render that is looked at now and then.

use serde::{Deserialize, Serialize};

use super::options::Subject;
use crate::cli::error::CliError;
use crate::cli::scene;
use crate::engine::film::Frame;
use crate::engine::integrators::{Cancel, Cancelled};
use crate::engine::measure::convergence::is_looked_at;
use crate::engine::measure::{Metrics, ReferenceNoise};
use crate::engine::session::{RenderClock, RenderJob, Renderer};

/// What was seen after a pass. Against a reference, nothing is taken off for its own noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Completed passes.
    pub pass: u64,
    /// Samples per pixel.
    pub spp: u64,
    /// Wall time in seconds since the job was accepted.
    pub t_wall: f64,
    /// Process time in seconds over the same span.
    pub t_cpu: f64,
    /// Rays so far.
    pub rays: u64,
    /// Estimated RMSE, in units of radiance.
    pub estimate: Option<f64>,
    /// Its 95 % interval.
    pub interval: Option<[f64; 2]>,
    /// Mean of the picture over pixels and channels.
    pub mean: Option<f64>,
    /// √ mean (x − r)², in units of radiance.
    pub rmse: Option<f64>,
    /// mean (x − r)² / (r² + 0.01).
    pub relmse: Option<f64>,
    /// mean (x − r)² / (mean r)².
    pub nmse: Option<f64>,
    /// The first without the worst thousandth of the pixels.
    pub rmse_without_worst: Option<f64>,
    /// The second without them.
    pub relmse_without_worst: Option<f64>,
}

/// Figures of one layer at the end of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayerFigures {
    /// `whole` or a component.
    pub layer: String,
    /// √ mean (x − r)².
    pub rmse: f64,
    /// mean (x − r).
    pub bias: f64,
    /// mean (x − r)² / (r² + 0.01).
    pub relmse: f64,
    /// What the reference's own noise would give.
    pub reference_rmse: Option<f64>,
}

/// A run from beginning to end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Seed of its random numbers.
    pub seed: u64,
    /// What was seen, in the order of the passes; the last one after the time was up.
    pub points: Vec<Point>,
    /// Layer by layer against the reference.
    pub layers: Vec<LayerFigures>,
}

/// Renders for `seconds` and looks after passes 1, 2, 3, 4, 6, 8, 11 …: a geometric series, so
/// that times are one too, and the same passes in every run, so that runs of the same seed have the
/// same errors. The clock stands still meanwhile.
pub fn record(
    subject: &Subject,
    job: &RenderJob,
    seconds: f64,
    cancel: &Cancel,
    mut tick: impl FnMut(f64),
) -> Result<Option<(Run, Frame)>, CliError> {
    let plan = scene::plan(job)?;
    let mut renderer = Renderer::with_plan(job, plan, RenderClock::start());
    let mut run = Run {
        seed: job.settings.seed,
        points: Vec::new(),
        layers: Vec::new(),
    };
    loop {
        if renderer.render_pass(cancel) == Err(Cancelled) {
            return Ok(None);
        }
        renderer.clock().pause();
        let t_wall = renderer.clock().wall();
        let done = t_wall >= seconds;
        tick(t_wall.min(seconds));
        if done || is_looked_at(renderer.passes()) {
            let frame = renderer.frame();
            run.points.push(point(subject, &frame));
            if done {
                run.layers = layers(subject, &frame);
                return Ok(Some((run, frame)));
            }
        }
        renderer.clock().resume();
    }
}

type Compare = fn(&[[f32; 3]], &[[f32; 3]]) -> Option<Metrics>;

fn point(subject: &Subject, frame: &Frame) -> Point {
    let pixels = &frame.layers[0].pixels;
    let against = |f: Compare| subject.whole().and_then(|r| f(pixels, &r.pixels));
    let (all, most) = (against(Metrics::new), against(Metrics::without_worst));
    let estimate = frame.error_estimate;
    Point {
        pass: frame.passes,
        spp: frame.passes,
        t_wall: frame.t_wall,
        t_cpu: frame.t_cpu,
        rays: frame.stats.rays,
        estimate: estimate.map(|e| e.rmse),
        interval: estimate.map(|e| e.interval),
        mean: estimate.map(|e| e.mean),
        rmse: all.map(|m| m.rmse),
        relmse: all.map(|m| m.relmse),
        nmse: all.and_then(|m| m.nmse),
        rmse_without_worst: most.map(|m| m.rmse),
        relmse_without_worst: most.map(|m| m.relmse),
    }
}

fn layers(subject: &Subject, frame: &Frame) -> Vec<LayerFigures> {
    let Some(reference) = &subject.reference else {
        return Vec::new();
    };
    let figures = |layer: &crate::engine::film::FrameLayer| {
        let partner = reference.layers.iter().find(|r| r.label == layer.label)?;
        let metrics = Metrics::new(&layer.pixels, &partner.pixels)?;
        let mut errors = reference.standard_errors.iter();
        let se = errors.find(|se| se.label == layer.label);
        let noise = se.and_then(|se| ReferenceNoise::new(&partner.pixels, &se.pixels));
        Some(LayerFigures {
            layer: layer.label.clone(),
            rmse: metrics.rmse,
            bias: metrics.bias,
            relmse: metrics.relmse,
            reference_rmse: noise.map(|n| n.rmse),
        })
    };
    // Components that were not asked for are zero in the frame and are not compared.
    let count = if reference.layers.len() > 1 {
        frame.layers.len()
    } else {
        1
    };
    frame.layers[..count].iter().filter_map(figures).collect()
}
