//! The mean of a picture over independent runs.

use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::case::Point;
use crate::engine::film::Frame;
use crate::engine::integrators::stats::ERRORS;
use crate::engine::integrators::{Cancel, RenderStats};
use crate::engine::session::{RenderClock, RenderJob, Renderer};

/// Independent runs behind every standard error.
pub const RUNS: u64 = 32;
/// Rate at which a right answer is told to be wrong; a thousand answers are judged.
const RATE: f64 = 1e-6;
/// What none of n samples showed has a share of less than this over n of them, at [`RATE`]: −ln of
/// it.
const UNSEEN: f64 = 13.8;
/// Share of a right answer that sums of `f32` numbers and their rounding cost.
const ROUNDING: f64 = 2e-5;

/// How a picture is measured.
#[derive(Clone, Copy, Debug)]
pub struct Sampling {
    /// Passes of each run: first, and at most. They double in between until the bound is reached.
    pub passes: (u64, u64),
    /// Widest confidence interval, as a share of the right value (half the width).
    pub bound: f64,
    /// Share of the right value that rounding may cost.
    pub rounding: f64,
    /// Share by which a biased method may be off beside that.
    pub bias: f64,
    /// Layer: 0 is the whole.
    pub layer: usize,
    /// Judge every pixel and not the mean.
    pub every_pixel: bool,
}

impl Sampling {
    /// The mean of the whole to `bound`, within `passes` passes a run.
    pub fn new(first: u64, most: u64, bound: f64) -> Self {
        Self {
            passes: (first, most),
            bound,
            rounding: ROUNDING,
            bias: 0.0,
            layer: 0,
            every_pixel: false,
        }
    }

    /// Every pixel is right but for rounding of that share.
    pub fn every_pixel(passes: u64, rounding: f64) -> Self {
        Self {
            rounding,
            every_pixel: true,
            ..Self::new(passes, passes, rounding)
        }
    }
}

/// What is known of the mean of a picture.
pub struct Estimate {
    mean: f64,
    /// Half the confidence interval, and the share that samples so few may have left unseen.
    half: f64,
    unseen: f64,
    /// The pixel farthest from the right value.
    farthest: f64,
    least: f64,
    stats: RenderStats,
    t_cpu: f64,
    history: Vec<(f64, f64)>,
}

/// So many standard errors that a mean of [`RUNS`] runs is off by more at a rate of 10⁻⁶ only.
pub fn confidence_factor() -> f64 {
    // The degrees of freedom are a positive constant: the distribution exists.
    StudentsT::new(0.0, 1.0, (RUNS - 1) as f64)
        .map_or(f64::NAN, |t| t.inverse_cdf(1.0 - RATE / 2.0))
}

/// Mean and half width of the confidence interval of independent `values`, [`RUNS`] of them.
pub fn mean_of(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, confidence_factor() * (squares / (n - 1.0) / n).sqrt())
}

impl Estimate {
    /// Renders [`RUNS`] runs under other seeds until the mean of each, or the sum of the means of
    /// several pictures, is known to the bound.
    pub fn of(jobs: &[RenderJob], exact: f64, how: &Sampling) -> Self {
        let clock = RenderClock::start();
        let runs = if how.every_pixel { 1 } else { RUNS };
        let each = |seed| jobs.iter().filter_map(move |job| renderer(job, seed));
        let mut renderers: Vec<Renderer> = (0..runs).flat_map(each).collect();
        let mut found = Self {
            mean: f64::NAN,
            half: f64::NAN,
            unseen: 0.0,
            farthest: f64::NAN,
            least: f64::NAN,
            stats: RenderStats::default(),
            t_cpu: 0.0,
            history: Vec::new(),
        };
        let mut more = how.passes.0;
        let mut passes = 0;
        loop {
            renderers.par_iter_mut().for_each(|r| {
                for _ in 0..more {
                    // Nobody cancels this render.
                    let _ = r.render_pass(&Cancel::never());
                }
            });
            passes += more;
            more = passes.min(how.passes.1.saturating_sub(passes));
            found.look(&renderers, jobs.len(), exact, how);
            found.t_cpu = clock.cpu();
            let size = if exact == 0.0 { 1.0 } else { exact.abs() };
            found
                .history
                .push((found.t_cpu, found.half / confidence_factor() / size));
            let samples = passes * runs * u64::from(jobs[0].size.x * jobs[0].size.y);
            found.unseen = UNSEEN / samples as f64;
            let known = found.half / size + found.unseen + how.rounding;
            if more == 0 || known <= how.bound {
                break;
            }
        }
        found
    }

    fn look(&mut self, renderers: &[Renderer], each: usize, exact: f64, how: &Sampling) {
        self.stats = RenderStats::default();
        (self.farthest, self.least) = (exact, f64::INFINITY);
        let mut means = Vec::new();
        for renderer in renderers {
            let frame = renderer.frame();
            self.stats += frame.stats;
            let pixels = &frame.layers[how.layer].pixels;
            let values = pixels.iter().flatten().map(|x| f64::from(*x));
            for value in values.clone() {
                if value.is_nan() || (value - exact).abs() > (self.farthest - exact).abs() {
                    self.farthest = value;
                }
                self.least = self.least.min(value);
            }
            means.push(values.sum::<f64>() / (3 * pixels.len()) as f64);
        }
        let means: Vec<f64> = means.chunks(each).map(|run| run.iter().sum()).collect();
        (self.mean, self.half) = match means[..] {
            [one] => (one, 0.0),
            _ => mean_of(&means),
        };
    }

    /// Compares with `exact`.
    pub fn point(self, x: f64, curve: &str, exact: f64, how: &Sampling) -> Point {
        let measured = if how.every_pixel {
            self.farthest
        } else {
            self.mean
        };
        let size = if exact == 0.0 { 1.0 } else { exact.abs() };
        let deviation = (measured - exact).abs() / size;
        let unseen = if how.every_pixel { 0.0 } else { self.unseen };
        let confidence = self.half / size + unseen + how.rounding;
        let mut faults = complaints(&self.stats);
        if self.least < 0.0 {
            faults.push(format!("a pixel is {:e}", self.least));
        }
        // What is no number is wrong.
        if deviation.is_nan() || confidence.is_nan() || deviation > confidence + how.bias {
            faults.push(format!("{measured:e} is not {exact:e}"));
        } else if confidence > how.bound {
            let percent = 100.0 * confidence;
            faults.push(format!("known to {percent:.2} % only"));
        }
        Point {
            curve: curve.to_owned(),
            x,
            measured,
            exact,
            deviation,
            confidence,
            bound: how.bound + how.bias,
            holds: Some(faults.is_empty()),
            note: faults.join("; "),
            standard_error: self.half / size / confidence_factor(),
            t_cpu: self.t_cpu,
            history: if how.every_pixel {
                Vec::new()
            } else {
                self.history
            },
        }
    }
}

fn renderer(job: &RenderJob, seed: u64) -> Option<Renderer> {
    let mut job = job.clone();
    job.settings.seed = seed;
    // The cases ask for few layers: their table is never too large.
    Renderer::new(&job).ok()
}

/// What a render counts and no scene of the cases may bring about.
pub fn complaints(stats: &RenderStats) -> Vec<String> {
    let counts = [
        (
            stats.exceeded_majorants,
            "bounds of a medium that were exceeded",
        ),
        (stats.cut_trees, "trees of rays that were cut"),
    ];
    let some = counts.iter().filter(|(n, _)| *n > 0);
    let errors = stats.errors().into_iter().zip(ERRORS);
    some.map(|(n, what)| format!("{n} {what}"))
        .chain(
            errors
                .filter(|(n, _)| *n > 0)
                .map(|(n, what)| format!("{n} samples of which {what}")),
        )
        .collect()
}

/// One run of a job: its frame after `passes` passes; none if it cannot be rendered.
pub fn frame(job: &RenderJob, seed: u64, passes: u64) -> Option<Frame> {
    let mut renderer = renderer(job, seed)?;
    for _ in 0..passes {
        // Nobody cancels this render.
        let _ = renderer.render_pass(&Cancel::never());
    }
    Some(renderer.frame())
}

/// Means of the whole over the pictures of [`RUNS`] runs.
pub fn means(job: &RenderJob, passes: u64) -> Vec<f64> {
    let runs = (0..RUNS).into_par_iter();
    runs.filter_map(|seed| Some(mean_of_layer(&frame(job, seed, passes)?, 0)))
        .collect()
}

/// Mean of a layer over its pixels and channels.
pub fn mean_of_layer(frame: &Frame, layer: usize) -> f64 {
    let pixels = &frame.layers[layer].pixels;
    let sum: f64 = pixels.iter().flatten().map(|x| f64::from(*x)).sum();
    sum / (3 * pixels.len()) as f64
}
