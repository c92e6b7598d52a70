//! `lightscope bench`: how fast this machine renders.

mod first_frame;
mod integrators;
mod integrators_table;
#[cfg(feature = "viewer")]
mod latency;
mod noise_bias;
mod photons;
mod rays;
mod scenes;
#[cfg(feature = "viewer")]
mod soak;

use super::args::Bench;
use super::error::CliError;

/// Runs the command.
pub fn run(what: &Bench) -> Result<(), CliError> {
    match what {
        Bench::FirstFrame(args) => first_frame::run(args),
        Bench::Integrators(args) => integrators::run(args),
        #[cfg(feature = "viewer")]
        Bench::Latency(args) => latency::run(args),
        Bench::NoiseBias(args) => noise_bias::run(args),
        Bench::Photons(args) => photons::run(args),
        Bench::Rays(args) => rays::run(args),
        Bench::Scenes(args) => scenes::run(args),
        #[cfg(feature = "viewer")]
        Bench::Soak(args) => soak::run(args),
    }
}
