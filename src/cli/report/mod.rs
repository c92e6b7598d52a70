//! `lightscope report`: algorithms against each other, on a page of its own.

mod images;
pub(super) mod machine;
mod options;
mod page;
mod progress;
mod record;
mod store;
mod summary;

use std::fmt::Write;

use serde::Serialize;

use super::args::ReportArgs;
use super::error::CliError;
use super::{print, render};
use crate::cli::print::note;
use crate::engine::film::Frame;
use crate::engine::integrators::Cancel;
use crate::picture::origin;
use crate::plot::quoted;
use machine::Machine;
use options::{ReportOptions, Subject};
use progress::Progress;
use record::{Run, record};
use store::{Key, Store, json_bytes};
use summary::SceneSummary;

/// `report.json`.
#[derive(Serialize)]
struct Report {
    machine: Machine,
    /// Seconds of each run.
    seconds: f64,
    /// Runs of each algorithm.
    seeds: u64,
    /// Relative error whose time is predicted.
    target: f64,
    max_depth: Option<u32>,
    scenes: Vec<SceneSummary>,
}

/// Runs the command.
pub fn run(args: &ReportArgs) -> Result<(), CliError> {
    let options = ReportOptions::new(args)?;
    let store = Store::open(&options.folder)?;
    let cancel = render::cancel_on_interrupt()?;
    let pool = render::thread_pool(options.threads)?;
    let runs = pool.install(|| measure(&options, &store, &cancel))?;
    let report = pool.install(|| summarise(&options, runs));
    write(&options, &store, &report)?;
    if args.json {
        print::json(&report)?;
    }
    Ok(())
}

/// All runs: of each scene, of each contestant.
type Runs = Vec<Vec<Vec<Run>>>;

fn measure(options: &ReportOptions, store: &Store, cancel: &Cancel) -> Result<Runs, CliError> {
    let mut runs: Runs = vec![vec![Vec::new(); options.contestants.len()]; options.scenes.len()];
    for subject in &options.scenes {
        if let Some(reference) = subject.whole() {
            let png = images::picture(subject.size, &reference.pixels, &reference.pixels, &[])?;
            store.write(&store.reference_path(subject), &png)?;
        }
    }
    let all: Vec<(usize, usize, u64)> = options.runs().collect();
    let key = |s: usize, c: usize| Key::new(options, &options.scenes[s], &options.contestants[c]);
    let missing = all
        .iter()
        .filter(|(s, c, seed)| store.run(&key(*s, *c), *seed).is_none());
    let mut progress = Progress::new(missing.count(), all.len(), options.seconds);
    for (s, c, seed) in all {
        let (key, subject, contestant) = (key(s, c), &options.scenes[s], &options.contestants[c]);
        if let Some(run) = store.run(&key, seed) {
            runs[s][c].push(run);
            continue;
        }
        progress.begin(&subject.id, contestant.0.id, seed);
        let job = subject.job(contestant, seed, options.max_depth);
        let recorded = record(subject, &job, options.seconds, cancel, |t| progress.tick(t))?;
        let Some((run, frame)) = recorded else {
            progress.clear();
            return Err(CliError::failed(
                "interrupted; the same command goes on with the runs that are missing",
            ));
        };
        if seed == 0 {
            let texts = origin::texts(&job.scene.name, &job.settings, &frame);
            keep_images(store, &key, subject, &frame, &texts)?;
        }
        store.keep(&key, &run)?;
        progress.end(&run);
        runs[s][c].push(run);
    }
    progress.clear();
    Ok(runs)
}

fn keep_images(
    store: &Store,
    key: &Key,
    subject: &Subject,
    frame: &Frame,
    texts: &[(String, String)],
) -> Result<(), CliError> {
    let pixels = &frame.layers[0].pixels;
    let reference = subject.whole().map(|r| r.pixels.as_slice());
    if let Some(reference) = reference
        && let Some(png) = images::error(frame, reference, texts)?
    {
        store.write(&store.image_path(key, "error"), &png)?;
    }
    let png = images::picture(frame.size, pixels, reference.unwrap_or(pixels), texts)?;
    store.write(&store.image_path(key, "picture"), &png)
}

fn summarise(options: &ReportOptions, runs: Runs) -> Report {
    let scenes = options.scenes.iter().zip(runs);
    Report {
        machine: Machine::this(),
        seconds: options.seconds,
        seeds: options.seeds,
        target: options.target,
        max_depth: options.max_depth,
        scenes: scenes
            .map(|(subject, runs)| SceneSummary::new(options, subject, runs))
            .collect(),
    }
}

fn write(options: &ReportOptions, store: &Store, report: &Report) -> Result<(), CliError> {
    store.write(&store.path("report.json"), &json_bytes(report)?)?;
    store.write(&store.path("errors.csv"), csv(report).as_bytes())?;
    for scene in &report.scenes {
        let svg = page::plot(scene, report.target).map_err(CliError::failed)?;
        store.write(&store.path(&format!("{}.svg", scene.id)), svg.as_bytes())?;
    }
    let html = page::html(options, store, report)?;
    let path = store.path("index.html");
    store.write(&path, html.as_bytes())?;
    note!("wrote {}", path.display());
    Ok(())
}

/// All that was seen, a line a look.
fn csv(report: &Report) -> String {
    let mut text = "scene,integrator,seed,pass,spp,t_wall,t_cpu,rays,estimated_rmse,interval_low,\
                    interval_high,rmse,relmse,nmse,rmse_without_worst,relmse_without_worst\n"
        .to_owned();
    let cell = |x: Option<f64>| x.map_or_else(String::new, |x| x.to_string());
    for scene in &report.scenes {
        for contestant in &scene.integrators {
            for run in &contestant.runs {
                for p in &run.points {
                    let cells = [
                        p.estimate,
                        p.interval.map(|i| i[0]),
                        p.interval.map(|i| i[1]),
                        p.rmse,
                        p.relmse,
                        p.nmse,
                        p.rmse_without_worst,
                        p.relmse_without_worst,
                    ]
                    .map(cell)
                    .join(",");
                    // Writing to a string cannot fail.
                    let _ = writeln!(
                        text,
                        "{},{},{},{},{},{},{},{},{cells}",
                        quoted(&scene.id),
                        contestant.id,
                        run.seed,
                        p.pass,
                        p.spp,
                        p.t_wall,
                        p.t_cpu,
                        p.rays
                    );
                }
            }
        }
    }
    text
}
