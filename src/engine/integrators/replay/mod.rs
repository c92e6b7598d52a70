//! One sample again, step by step.
//!
//! Random numbers depend on (seed, stream, index, dimension) alone, so that any sample of any
//! render can be computed again by itself. The walks are those of the renders: they tell what they
//! do to the sink that takes their light, and the sinks of renders do not listen.

mod recording;
mod sample_id;
mod step;

pub use recording::Recording;
pub use sample_id::SampleId;
pub use step::{RadianceSink, Step, VertexStep};

use super::Cancelled;

/// Why a sample was not followed again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReplayError {
    /// It cannot be: the reason in one sentence.
    Cannot(String),
    /// The job was replaced or stopped.
    Cancelled,
}

impl From<Cancelled> for ReplayError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl ReplayError {
    /// The integrator draws no numbers of the stream of `sample`; `right` says which it draws.
    pub(super) fn other_stream(sample: &SampleId, right: &str) -> Self {
        let stream = sample.stream_name();
        Self::Cannot(format!(
            "the algorithm has no samples of the stream \"{stream}\" with such an index; {right}"
        ))
    }
}
