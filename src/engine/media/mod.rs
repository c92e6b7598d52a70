//! What is between the surfaces: participating media.
//!
//! A medium has per channel the extinction σ_t and the albedo σ_s/σ_t, a phase function, and may
//! emit. It fills a closed surface, or all that no closed surface fills. Boundaries are surfaces of
//! the scene: a ray keeps account of those that it is within ([`Inside`]) as it crosses them.
//!
//! Invariants: every `pdf` is the density of its `sample`; scattering integrates to 1, absorption
//! stands in the albedo alone; no weight of a tracked distance exceeds the sum of the throughput
//! that it began with.

mod glow;
mod grid;
mod inside;
mod majorant;
mod medium;
pub mod phase;
pub mod tracking;

pub use glow::Glow;
pub use inside::{Inside, Media, Region};
pub use medium::Medium;
pub use phase::Phase;
pub use tracking::{Draws, Tracked};
