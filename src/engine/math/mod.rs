//! Small numeric tools shared by all modules: colours, frames, float error bounds, hashes and
//! discrete distributions.

pub mod distribution;
pub mod faults;
pub mod float;
pub mod frame;
pub mod hash;
pub mod rgb;

pub use faults::{Fault, FaultCounts};
pub use frame::Frame;
pub use rgb::Rgb;
