//! Figures that say how wrong a picture is.

pub mod metrics;

pub use metrics::{Metrics, ReferenceNoise};
