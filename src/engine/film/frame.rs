//! An immutable snapshot of a render: all that the window and the exporters see.

use std::sync::Arc;

use glam::UVec2;

use super::halves::ErrorEstimate;
use crate::engine::integrators::{Fact, PhotonView, RenderStats};
use crate::engine::plan::RenderPlan;

/// A picture: mean radiance, row by row from the top left.
#[derive(Clone, Debug, Default)]
pub struct FrameLayer {
    /// `whole`, a component's name, or `expr1` ….
    pub label: String,
    /// `width * height` pixels; NaN where every sample was rejected.
    pub pixels: Vec<[f32; 3]>,
}

/// Memory of a render by purpose, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// Sums of all layers.
    pub film: usize,
    /// What the integrator holds from pass to pass: the pass under way, maps, caches.
    pub integrator: usize,
}

/// What a render looked like after its last published pass.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The job it belongs to; later jobs have larger numbers.
    pub epoch: u64,
    /// Pixels of the layers; smaller than `full_size` while it is coarse.
    pub size: UVec2,
    /// Pixels that were asked for.
    pub full_size: UVec2,
    /// Passes in the sums (1 for a coarse frame).
    pub passes: u64,
    /// Wall time in seconds since the job was accepted, pauses left out.
    pub t_wall: f64,
    /// Process time in seconds over the same span.
    pub t_cpu: f64,
    /// The whole, the four components in the order of [`crate::engine::path::COMPONENTS`], then
    /// typed expressions.
    pub layers: Vec<FrameLayer>,
    /// Estimated error of the whole, pixel by pixel and with its sign: halved differences of two
    /// independent halves. One of them says little; the root of the mean of the squares of many
    /// is their standard error. Empty where there are no two halves.
    pub differences: Vec<[f32; 3]>,
    /// Where memory went.
    pub memory: Memory,
    /// Threads that render.
    pub threads: usize,
    /// Counts since the job began.
    pub stats: RenderStats,
    /// Estimated RMSE / image mean, where two independent halves exist.
    pub relative_error: Option<f64>,
    /// The same with its interval, in units of radiance.
    pub error_estimate: Option<ErrorEstimate>,
    /// What is computed and what was left out.
    pub plan: Arc<RenderPlan>,
    /// A path-traced picture that stands in while the integrator cannot deliver one.
    pub preview: bool,
    /// What the integrator prepared.
    pub facts: Vec<Fact>,
    /// Its photons.
    pub photons: Option<PhotonView>,
    /// The job is paused.
    pub paused: bool,
    /// A sentence for the user when the render stopped with an error.
    pub error: Option<String>,
}

impl Frame {
    /// A frame without pixels.
    pub fn empty(plan: Arc<RenderPlan>) -> Self {
        Self {
            epoch: 0,
            size: UVec2::ZERO,
            full_size: UVec2::ZERO,
            passes: 0,
            t_wall: 0.0,
            t_cpu: 0.0,
            layers: Vec::new(),
            differences: Vec::new(),
            memory: Memory::default(),
            threads: 0,
            stats: RenderStats::default(),
            relative_error: None,
            error_estimate: None,
            plan,
            preview: false,
            facts: Vec::new(),
            photons: None,
            paused: false,
            error: None,
        }
    }

    /// A frame without pixels that says what went wrong.
    pub fn failed(error: String) -> Self {
        Self {
            error: Some(error),
            ..Self::empty(Arc::new(RenderPlan::nothing()))
        }
    }

    /// The standard error of the whole at `pixel`, from the differences of the pixels within
    /// `reach` of it; `None` where they are not known.
    pub fn standard_error(&self, pixel: UVec2, reach: u32) -> Option<[f32; 3]> {
        let from = pixel.saturating_sub(UVec2::splat(reach));
        let to = (pixel + reach + 1).min(self.size);
        let (mut squares, mut count) = ([0.0f64; 3], 0u32);
        for y in from.y..to.y {
            for x in from.x..to.x {
                let difference = self.differences.get((y * self.size.x + x) as usize)?;
                for (sum, d) in squares.iter_mut().zip(difference) {
                    *sum += f64::from(d * d);
                }
                count += 1;
            }
        }
        (count > 0).then(|| squares.map(|s| (s / f64::from(count)).sqrt() as f32))
    }

    /// True while a lower resolution stands in for the picture.
    pub fn is_coarse(&self) -> bool {
        self.size != self.full_size
    }
}
