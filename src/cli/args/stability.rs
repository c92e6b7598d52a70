//! Arguments of `stability`.

use std::path::PathBuf;

use clap::Args;

/// Arguments of `stability`.
#[derive(Debug, Args)]
#[command(
    after_help = "The exit code is 1 if a case fails. --quick is the default and takes minutes, \
                  --full a quarter of an hour."
)]
pub struct StabilityArgs {
    /// Cases, separated by commas; ids of `lightscope list cases` [default: all].
    #[arg(long, value_name = "ID,ID…", value_delimiter = ',', num_args = 1..)]
    pub case: Vec<String>,
    /// Algorithms, separated by commas [default: all].
    #[arg(long, value_name = "ID,ID…", value_delimiter = ',', num_args = 1..)]
    pub integrator: Vec<String>,
    /// Narrow ranges and wide bounds.
    #[arg(long)]
    pub quick: bool,
    /// Wide ranges and narrow bounds.
    #[arg(long, conflicts_with = "quick")]
    pub full: bool,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
    /// Folder to write index.html and stability.json into.
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}
