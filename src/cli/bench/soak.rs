//! The window under a random hand.

use std::time::Duration;

use crate::cli::args::BenchSoakArgs;
use crate::cli::error::CliError;
use crate::cli::{print, scene};
use crate::viewer::opening::Opening;
use crate::viewer::source::SceneSource;
use crate::viewer::{self};

/// Runs the command.
pub fn run(args: &BenchSoakArgs) -> Result<(), CliError> {
    let source = SceneSource::named(scene::DEFAULT_SCENE);
    let read = source.read();
    let length = Duration::from_secs(args.seconds);
    let report = viewer::soak(Opening::scene(source), read, length, args.seed)
        .map_err(|error| CliError::failed(error.to_string()))?;
    print::line(&report.to_string())?;
    if report.is_good() {
        Ok(())
    } else {
        Err(CliError::failed("the soak found something"))
    }
}
