//! lightscope: orbit a scene while global illumination converges, switch the algorithm that
//! computes it, take the light apart into its components, and read how wrong the picture still is.
#![deny(unsafe_code)]
#![warn(missing_docs)]

pub mod cli;
pub mod engine;
