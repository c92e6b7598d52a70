//! The command line: raw arguments, then validated values, then the run.
//!
//! Results go to standard output, progress and messages to standard error. Exit codes: 0 done,
//! 1 failed while running, 2 wrong input or usage.

mod args;
mod bench;
pub mod bench_photons;
pub mod bench_rays;
mod compare;
mod error;
mod info;
mod list;
mod picture;
mod print;
mod reference;
mod render;
mod replay;
mod report;
mod scene;
mod stability;
mod suggest;

use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use args::{Cli, Command};
use error::CliError;

use crate::cli::print::note;
#[cfg(feature = "viewer")]
use crate::viewer::opening::Opening;

/// Runs the program on the process's arguments.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            if let Some(mistyped) = mistyped_command(&error) {
                note!("error: {mistyped}");
                return ExitCode::from(mistyped.exit_code());
            }
            // Nothing is left to be done where even the message cannot be written.
            let _ = error.print();
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    match run(cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            note!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}

fn run(cli: Cli) -> Result<(), CliError> {
    match cli.command {
        Some(Command::Render(args)) => render::run(args),
        Some(Command::Compare(args)) => compare::run(&args),
        Some(Command::Report(args)) => report::run(&args),
        Some(Command::Reference(args)) => reference::run(&args),
        Some(Command::Replay(args)) => replay::run(&args),
        Some(Command::Stability(args)) => stability::run(&args),
        Some(Command::List(args)) => list::run(&args),
        Some(Command::Info(args)) => info::run(&args),
        Some(Command::Bench(args)) => bench::run(&args.what),
        None => {
            let name = cli.scene.as_deref();
            window(name.map(check_name).transpose()?)
        }
    }
}

/// Whether a command line can be understood, `arguments` being what follows the program's name.
/// Nothing is read, rendered or written.
///
/// # Errors
/// What would be printed.
pub fn check(arguments: &[String]) -> Result<(), String> {
    let words = std::iter::once("lightscope").chain(arguments.iter().map(String::as_str));
    let cli = Cli::try_parse_from(words).map_err(|error| error.to_string())?;
    let of = |id: &str, sets: &[String], texts: &[String]| {
        scene::parameters(id, sets)?;
        render::expressions(texts).map(|_| ())
    };
    match &cli.command {
        Some(Command::Render(args)) => of(&args.integrator, &args.set, &args.expression),
        Some(Command::Replay(args)) => of(&args.integrator, &args.set, &args.expression)
            .and_then(|()| replay::sample(args).map(|_| ())),
        _ => Ok(()),
    }
    .map_err(|error| error.to_string())
}

/// What is wrong with a first word that is neither a command nor a scene; clap would complain of
/// what follows it.
fn mistyped_command(error: &clap::Error) -> Option<CliError> {
    if !error.use_stderr() {
        return None;
    }
    let first = std::env::args().nth(1).filter(|a| !a.starts_with('-'))?;
    let command = Cli::command();
    let is_command = command.get_subcommands().any(|c| c.get_name() == first);
    if is_command || first == "help" {
        return None;
    }
    check_name(&first).err()
}

/// A word that stands alone is a scene; a mistyped command ends here too.
fn check_name(name: &str) -> Result<&str, CliError> {
    let commands = Cli::command();
    let commands: Vec<&str> = commands
        .get_subcommands()
        .map(clap::Command::get_name)
        .collect();
    scene::check_exists(name, &commands).map(|()| name)
}

/// Opens the window.
#[cfg(not(feature = "viewer"))]
fn window(_scene: Option<&str>) -> Result<(), CliError> {
    Err(CliError::Failed(
        "this program was built without the window; `lightscope render SCENE -o OUT.png` renders \
         without one"
            .to_owned(),
    ))
}

/// Opens the window.
#[cfg(feature = "viewer")]
fn window(scene: Option<&str>) -> Result<(), CliError> {
    let name = scene.unwrap_or(scene::DEFAULT_SCENE);
    let opening = Opening::named(name).map_err(CliError::Usage)?;
    let mut read = opening.read();
    if let Err(sentence) = &mut read.desc {
        return Err(CliError::Usage(std::mem::take(sentence)));
    }
    crate::viewer::run(opening, read).map_err(|error| CliError::Failed(error.to_string()))
}
