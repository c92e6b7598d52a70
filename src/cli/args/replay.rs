//! Arguments of `replay`.

use clap::Args;
use glam::UVec2;

use super::{depth, seed, size};

/// Arguments of `replay`.
#[derive(Debug, Args)]
#[command(
    after_help = "It takes the settings of the render: scene, size, algorithm, parameters, seed, \
                  events and layers. Each names the same random numbers again, so that the sample \
                  is the same bit for bit."
)]
pub struct ReplayArgs {
    /// Scene: an id of `lightscope list scenes`, or a file (`./NAME` is always a file).
    pub scene: String,
    /// Algorithm: an id of `lightscope list integrators`.
    #[arg(long, value_name = "ID", default_value = "path")]
    pub integrator: String,
    /// Parameter of the algorithm; may be repeated.
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Stream of random numbers: camera, light or photon (light paths that are merged).
    #[arg(long, value_name = "STREAM", default_value = "camera")]
    pub stream: String,
    /// Which sample: X,Y,PASS of the camera; PATH,PASS of light paths; MAP,NUMBER,PASS of the
    /// photons of a map (caustic, global or volume).
    #[arg(long, value_name = "INDEX", allow_hyphen_values = true)]
    pub index: String,
    /// Seed of all random numbers.
    #[arg(
        long,
        value_name = "N",
        default_value = "0",
        value_parser = seed,
        allow_negative_numbers = true
    )]
    pub seed: u64,
    /// Pixels of the picture, such as 640x480 [default: what the scene says].
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<UVec2>,
    /// Most scattering events of a path [default: unlimited].
    #[arg(long, value_name = "N", value_parser = depth, allow_negative_numbers = true)]
    pub max_depth: Option<u32>,
    /// Path expression, a layer of its own; may be repeated.
    #[arg(long, value_name = "EXPR")]
    pub expression: Vec<String>,
    /// The render left out the whole picture and computed the layers alone.
    #[arg(long)]
    pub no_whole: bool,
    /// Frame of a sequence.
    #[arg(long, value_name = "N", default_value = "0", value_parser = depth, allow_negative_numbers = true)]
    pub frame: u32,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}
