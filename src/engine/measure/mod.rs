//! Figures that say how wrong a picture is.

pub mod bias;
pub mod blocks;
pub mod convergence;
pub mod duel;
pub mod error_image;
pub mod metrics;
pub mod referee;
pub mod region;
pub mod runs;

pub use bias::unseen;
pub use metrics::{Metrics, RELMSE_FLOOR, ReferenceNoise};
pub use region::Region;
