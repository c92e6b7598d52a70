//! `lightscope stability`: stiff and extreme cases against closed forms, on this machine.

mod page;
mod record;
mod table;

use std::path::Path;

use super::args::StabilityArgs;
use super::error::CliError;
use super::print::{self, note};
use super::report::machine::Machine;
use super::suggest::did_you_mean;
use crate::engine::integrators::REGISTRY;
use crate::engine::io::atomic;
use crate::engine::session::RenderClock;
use crate::engine::stability::{self, Case, Depth, Outcome};
use record::Record;

/// A case and what it found.
pub struct Row {
    /// The case.
    pub case: &'static Case,
    /// One outcome an integrator and variant.
    pub outcomes: Vec<Outcome>,
}

impl Row {
    fn holds(&self) -> bool {
        self.outcomes.iter().all(Outcome::holds)
    }
}

/// Runs the command.
pub fn run(args: &StabilityArgs) -> Result<(), CliError> {
    let cases = chosen(&args.case)?;
    for id in &args.integrator {
        let ids = REGISTRY.iter().map(|e| e.id);
        known("integrator", id, &ids.collect::<Vec<_>>())?;
    }
    if let Some(folder) = &args.output {
        prepare(folder)?;
    }
    let depth = if args.full { Depth::Full } else { Depth::Quick };
    let clock = RenderClock::start();
    let mut rows = Vec::new();
    for (i, case) in cases.iter().enumerate() {
        note!("{} of {}: {}", i + 1, cases.len(), case.id);
        if !args.json {
            table::heading(case)?;
        }
        let mut outcomes: Vec<Outcome> = Vec::new();
        let mut printed = Ok(());
        stability::run(case, &args.integrator, depth, &mut |outcome| {
            if !args.json && printed.is_ok() {
                printed = table::print(case, &outcome);
            }
            outcomes.push(outcome);
        });
        printed?;
        rows.push(Row { case, outcomes });
        if let (false, Some(row)) = (args.json, rows.last()) {
            table::left_out(row)?;
        }
    }
    let record = Record::new(&rows, depth, clock.wall(), Machine::this());
    if let Some(folder) = &args.output {
        write(folder, &rows, &record)?;
    }
    if args.json {
        print::json(&record)?;
    } else {
        table::summary(&rows, clock.wall())?;
    }
    let failed: Vec<&str> = rows
        .iter()
        .filter(|r| !r.holds())
        .map(|r| r.case.id)
        .collect();
    if failed.is_empty() {
        Ok(())
    } else {
        let cases = failed.join(", ");
        Err(CliError::failed(format!(
            "these cases do not hold: {cases}"
        )))
    }
}

/// The cases of these ids; all without any.
fn chosen(ids: &[String]) -> Result<Vec<&'static Case>, CliError> {
    let all = stability::cases();
    if ids.is_empty() {
        return Ok(all);
    }
    let names: Vec<&str> = all.iter().map(|c| c.id).collect();
    for id in ids {
        known("case", id, &names)?;
    }
    Ok(all
        .into_iter()
        .filter(|c| ids.iter().any(|id| id == c.id))
        .collect())
}

fn known(what: &str, id: &str, names: &[&str]) -> Result<(), CliError> {
    if names.contains(&id) {
        return Ok(());
    }
    Err(CliError::usage(format!(
        "there is no {what} \"{id}\"{}; `lightscope list {what}s` lists them",
        did_you_mean(id, names.iter().copied())
    )))
}

fn prepare(folder: &Path) -> Result<(), CliError> {
    let shown = folder.display();
    if folder.exists() && !folder.is_dir() {
        return Err(CliError::usage(format!(
            "{shown} is a file; -o names the folder to write into"
        )));
    }
    std::fs::create_dir_all(folder)
        .map_err(|error| CliError::failed(format!("{shown} cannot be made: {error}")))
}

fn write(folder: &Path, rows: &[Row], record: &Record<'_>) -> Result<(), CliError> {
    let json = serde_json::to_string_pretty(record)
        .map_err(|error| CliError::failed(format!("the result is no JSON: {error}")))?;
    let page = page::html(rows, record)?;
    for (name, text) in [("stability.json", json), ("index.html", page)] {
        let path = folder.join(name);
        atomic::write(&path, text.as_bytes()).map_err(|error| {
            CliError::failed(format!("{} cannot be written: {error}", path.display()))
        })?;
    }
    Ok(())
}
