//! What the user is told before and after a render, on standard error.

use serde::Serialize;

use crate::cli::print::figure;
use crate::cli::print::note;
use crate::cli::scene::parameter_text;
use crate::engine::film::Frame;
use crate::engine::measure::{Metrics, unseen};
use crate::engine::plan::RenderPlan;
use crate::engine::session::RenderJob;

/// The job, what its plan leaves out, and what it cannot find.
pub fn print_before(job: &RenderJob, plan: &RenderPlan, threads: usize) {
    let settings = &job.settings;
    let (id, params) = (settings.integrator.id, parameter_text(&settings.params));
    let (width, height) = (job.size.x, job.size.y);
    note!(
        "{}: {width}x{height}, {id} ({params}), seed {}, {threads} threads",
        job.scene.name,
        settings.seed
    );
    if let Some(unseen) = unseen(settings.integrator.id, &settings.params) {
        note!("note: the estimated error is noise alone; {unseen}");
    }
    for warning in &job.scene.warnings {
        note!("warning: {warning}");
    }
    for left_out in &plan.left_out {
        note!("left out: {} ({})", left_out.what, left_out.why);
    }
    if let Some(missing) = (settings.integrator.missing)(&job.scene.features, &settings.params) {
        note!(
            "warning: {id} cannot find {} here: {}",
            missing.words,
            missing.why
        );
    }
}

/// Final figures of a render.
#[derive(Serialize)]
pub struct Figures {
    t_wall: f64,
    t_cpu: f64,
    spp: u64,
    rays: u64,
    mrays_per_second: f64,
    samples_per_second: f64,
    /// Estimated RMSE / image mean.
    error: Option<f64>,
    /// Its 95 % interval.
    error_interval: Option<[f64; 2]>,
    /// Samples that were NaN or infinite and were left out.
    non_finite: u64,
    nan: u64,
    infinite: u64,
    /// Samples with a channel below 0; they count.
    negative: u64,
    /// Rays that met the surface that they left.
    self_hits: u64,
    /// Rays that left the scene from within a closed surface.
    missed_edges: u64,
    cut_paths: u64,
    /// Microfacet samples below the horizon: no error.
    below_horizon: u64,
    /// Commands that follow the first bad samples again.
    replay: Vec<String>,
    /// Trees of rays cut at their largest number.
    cut_trees: u64,
    /// Rays of walks from the eye by the number of events before them, up to the last that has any.
    rays_by_level: Vec<u64>,
    /// The same of walks from the lights.
    light_rays_by_level: Vec<u64>,
    /// Walks from the eye by the number of their events; absent for trees of rays.
    walk_lengths: Option<Vec<u64>>,
    /// Walks from the lights by the number of their events.
    light_walk_lengths: Option<Vec<u64>>,
    /// Share of the games of Russian roulette that walks survived.
    roulette_survival: Option<f64>,
    /// Share of the mutations of Markov chains that were accepted.
    acceptance: Option<f64>,
    /// Against the reference.
    #[serde(flatten)]
    reference: Option<Metrics>,
}

/// The figures of a finished frame.
pub fn figures(frame: &Frame, reference: Option<&Metrics>, replay: &[BadSampleNote]) -> Figures {
    let [walk_lengths, light_walk_lengths] = frame.stats.lengths();
    let per_second = 1.0 / frame.t_wall.max(f64::MIN_POSITIVE);
    Figures {
        t_wall: frame.t_wall,
        t_cpu: frame.t_cpu,
        spp: frame.passes,
        rays: frame.stats.rays,
        mrays_per_second: frame.stats.rays as f64 * per_second * 1e-6,
        samples_per_second: frame.stats.samples as f64 * per_second,
        error: frame.relative_error,
        error_interval: frame.error_estimate.and_then(|e| e.relative_interval()),
        non_finite: frame.stats.non_finite(),
        nan: frame.stats.faults.nan,
        infinite: frame.stats.faults.infinite,
        negative: frame.stats.faults.negative,
        self_hits: frame.stats.self_hits,
        missed_edges: frame.stats.missed_edges,
        below_horizon: frame.stats.below_horizon,
        replay: replay.iter().map(|note| note.command.clone()).collect(),
        cut_paths: frame.stats.cut_paths,
        cut_trees: frame.stats.cut_trees,
        rays_by_level: frame.stats.levels().to_vec(),
        light_rays_by_level: frame.stats.light_levels().to_vec(),
        walk_lengths,
        light_walk_lengths,
        roulette_survival: frame.stats.survival(),
        acceptance: frame.stats.acceptance(),
        reference: reference.copied(),
    }
}

/// The figures, and what went wrong on the way.
pub fn print_after(frame: &Frame, reference: Option<&Metrics>, bad: &[BadSampleNote]) {
    let f = figures(frame, reference, bad);
    let interval = f.error_interval.map(|i| i.map(figure));
    let error = f
        .error
        .zip(interval)
        .map_or("unknown".to_owned(), |(e, [low, high])| {
            format!("{} (95 %: {low} to {high})", figure(e))
        });
    note!(
        "t_wall {} s, t_cpu {} s, {} spp, {} rays, {} Mrays/s, {} samples/s, error {error}",
        figure(f.t_wall),
        figure(f.t_cpu),
        f.spp,
        f.rays,
        figure(f.mrays_per_second),
        figure(f.samples_per_second),
    );
    let none = Vec::new();
    for (what, counts) in [
        ("rays from the eye after", &f.rays_by_level),
        ("rays from the lights after", &f.light_rays_by_level),
        (
            "walks from the eye of",
            f.walk_lengths.as_ref().unwrap_or(&none),
        ),
        (
            "walks from the lights of",
            f.light_walk_lengths.as_ref().unwrap_or(&none),
        ),
    ] {
        if !counts.is_empty() {
            let counts: Vec<String> = counts.iter().map(u64::to_string).collect();
            note!("{what} 0, 1, 2 … events: {}", counts.join(" "));
        }
    }
    if let Some(survival) = f.roulette_survival {
        note!("roulette survived: {} %", figure(100.0 * survival));
    }
    if let Some(acceptance) = f.acceptance {
        note!("accepted mutations: {} %", figure(100.0 * acceptance));
    }
    if let Some(m) = reference {
        let nmse = m.nmse.map_or("undefined".to_owned(), figure);
        let (rmse, relmse) = (figure(m.rmse), figure(m.relmse));
        note!("against the reference: rmse {rmse}, relmse {relmse}, nmse {nmse}");
    }
    note!(
        "errors: {} not a number, {} infinite, {} negative, {} self-hits, {} missed edges, {} cut \
         paths; microfacet samples below the horizon, no errors: {}",
        f.nan,
        f.infinite,
        f.negative,
        f.self_hits,
        f.missed_edges,
        f.cut_paths,
        f.below_horizon
    );
    print_errors(&f, bad);
    if frame.stats.exceeded_majorants > 0 {
        note!(
            "warning: {} times a medium was denser than the bound on it, so that it is rendered \
             thinner than it is; raise majorant_scale",
            frame.stats.exceeded_majorants
        );
    }
    if frame.stats.dark_starts > 0 {
        note!(
            "warning: no independent sample found light, so that the Markov chains had nowhere to \
             start from and what they add is black; raise bootstrap"
        );
    }
    if f.cut_trees > 0 {
        note!(
            "warning: {} of {} trees of rays were cut at their largest number: the picture is too \
             dark; raise max-rays, or lower rays or depth",
            f.cut_trees,
            frame.stats.samples
        );
    }
}

/// A sample that went wrong, and the command that follows it again.
pub struct BadSampleNote {
    /// What went wrong.
    pub what: &'static str,
    /// The command.
    pub command: String,
}

/// What no sound render has, and how to look at it.
fn print_errors(f: &Figures, bad: &[BadSampleNote]) {
    for (count, what) in [
        (f.nan, "samples were not a number and were left out"),
        (f.infinite, "samples were infinite and were left out"),
        (f.negative, "samples were negative"),
        (f.self_hits, "rays met the surface that they left"),
        (f.missed_edges, "rays slipped out of a closed surface"),
        (
            f.cut_paths,
            "paths were cut at the largest number of events",
        ),
    ] {
        if count > 0 {
            note!("warning: {count} {what}");
        }
    }
    for sample in bad {
        note!("replay ({}): {}", sample.what, sample.command);
    }
}
