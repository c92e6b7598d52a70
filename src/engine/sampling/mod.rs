//! Random numbers, the distributions they are warped to, and the weights that combine strategies.
//!
//! Invariant: a number depends on (seed, stream, index, dimension) and nothing else, never on a
//! thread or a clock.

pub mod independent;
pub mod mis;
pub mod primary_space;
pub mod roulette;
pub mod sampler;
pub mod sobol;
pub mod warp;

pub use independent::IndependentSampler;
pub use primary_space::{PrimarySpace, StepKey};
pub use roulette::MAX_SURVIVAL;
pub use sampler::{Sampler, Stream};
pub use sobol::{Shift, SobolSampler, morton};
