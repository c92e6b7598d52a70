//! Figures that say how wrong a picture is.

pub mod metrics;

pub use metrics::{Metrics, RELMSE_FLOOR, ReferenceNoise};
