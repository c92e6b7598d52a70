//! Arguments of the commands that measure.

use std::path::PathBuf;

use clap::Args;
use glam::UVec2;

use super::{at_least_one, positive, size, threads};

/// Arguments of `reference`.
#[derive(Debug, Args)]
#[command(
    after_help = "It renders independent runs under other seeds, at least sixteen, until the root \
                  mean square of the standard errors, divided by the image mean, is E or less."
)]
pub struct ReferenceArgs {
    /// Scene: an id of `lightscope list scenes`, or a file (`./NAME` is always a file).
    pub scene: String,
    /// Picture to write (.exr); its standard errors go into NAME_se.exr beside it.
    #[arg(short, long, value_name = "REF.exr")]
    pub output: PathBuf,
    /// Stop when the standard error divided by the image mean falls to this.
    #[arg(long, value_name = "E", value_parser = positive, allow_negative_numbers = true)]
    pub error: f64,
    /// Stop after this many seconds even so; the exit code is then 1.
    #[arg(long, value_name = "T", value_parser = positive, allow_negative_numbers = true)]
    pub seconds: Option<f64>,
    /// Algorithm: an id of `lightscope list integrators`.
    #[arg(long, value_name = "ID", default_value = "path")]
    pub integrator: String,
    /// Parameter of the algorithm; may be repeated.
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Path expression, a layer of its own; may be repeated.
    #[arg(long, value_name = "EXPR")]
    pub expression: Vec<String>,
    /// Samples per pixel of a run [default: as many as take about a second].
    #[arg(long, value_name = "N", value_parser = at_least_one, allow_negative_numbers = true)]
    pub spp: Option<u64>,
    /// Pixels, such as 640x480 [default: what the scene says].
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<UVec2>,
    /// Threads; 0 is one a core.
    #[arg(long, value_name = "N", default_value = "0", value_parser = threads, allow_negative_numbers = true)]
    pub threads: usize,
    /// Seed of all random numbers.
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        allow_negative_numbers = true
    )]
    pub seed: u64,
    /// Most scattering events of a path [default: unlimited].
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub max_depth: Option<u32>,
}

/// Arguments of `report`.
#[derive(Debug, Args)]
#[command(
    after_help = "The folder keeps each run: called again with the same arguments, the command \
                  goes on where it was cut off."
)]
pub struct ReportArgs {
    /// Scenes: ids of `lightscope list scenes`, or files [default: jensen-box].
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// Algorithms, separated by commas [default: all].
    #[arg(long, value_name = "ID,ID…", value_delimiter = ',')]
    pub integrators: Vec<String>,
    /// Parameter of one algorithm; may be repeated.
    #[arg(long, value_name = "ID:NAME=VALUE")]
    pub set: Vec<String>,
    /// Seconds of each run.
    #[arg(long, value_name = "T", value_parser = positive, allow_negative_numbers = true)]
    pub seconds: f64,
    /// Reference: a picture or folder as of `compare`, or a folder with SCENE.exr or
    /// SCENE/ref.exr for each scene. Without it errors are estimated, and marked so.
    #[arg(long, value_name = "R")]
    pub reference: Option<PathBuf>,
    /// Folder to write index.html, report.json, errors.csv and pictures into.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Runs of each algorithm, with the seeds 0, 1, …; their spread is shown as a band.
    #[arg(long, value_name = "N", default_value = "3", value_parser = at_least_one, allow_negative_numbers = true)]
    pub seeds: u64,
    /// Relative error whose time is predicted.
    #[arg(long, value_name = "E", default_value = "0.01", value_parser = positive, allow_negative_numbers = true)]
    pub target: f64,
    /// Pixels [default: those of the reference, or what the scene says].
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<UVec2>,
    /// Threads; 0 is one a core.
    #[arg(long, value_name = "N", default_value = "0", value_parser = threads, allow_negative_numbers = true)]
    pub threads: usize,
    /// Most scattering events of a path [default: unlimited].
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub max_depth: Option<u32>,
    /// Print report.json too.
    #[arg(long)]
    pub json: bool,
}
