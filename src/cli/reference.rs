//! `lightscope reference`: a picture whose standard error is known pixel by pixel.
//!
//! It is the mean of independent runs. Each takes other seeds, and with them other scrambles of the
//! Sobol points, so that the spread of the runs is the error of their mean, whatever the samples
//! within a run have to do with each other.

use std::time::{Duration, Instant};

use glam::UVec2;
use indicatif::{ProgressBar, ProgressStyle};

use super::args::ReferenceArgs;
use super::error::CliError;
use super::picture::{Format, Output, error_image_path};
use super::print::{duration, figure};
use super::{render, scene};
use crate::cli::print::note;
use crate::engine::integrators::{Cancel, Cancelled};
use crate::engine::io::atomic;
use crate::engine::math::hash::combine;
use crate::engine::measure::runs::{KnownLayer, RunMeans};
use crate::engine::measure::unseen;
use crate::engine::plan::LayerSettings;
use crate::engine::session::{RenderJob, Renderer, Settings};
use crate::picture::origin::{self, PREFIX};

/// Fewest runs behind a standard error.
const MIN_RUNS: u64 = 16;
/// Seconds that a run takes at least, where the number of its samples is not given.
const RUN_SECONDS: f64 = 1.0;

/// Runs the command.
pub fn run(args: &ReferenceArgs) -> Result<(), CliError> {
    let output = Output::new(&args.output)?;
    if output.format != Format::Exr {
        return Err(CliError::usage(format!(
            "{} holds no layers; a reference is an .exr file",
            output.path.display()
        )));
    }
    output.check_writable()?;
    let job = job(args)?;
    let settings = &job.settings;
    if let Some(unseen) = unseen(settings.integrator.id, &settings.params) {
        note!("warning: the standard errors are those of noise alone; {unseen}");
    }
    if let Some(missing) = (settings.integrator.missing)(&job.scene.features, &settings.params) {
        let (id, words, why) = (settings.integrator.id, missing.words, missing.why);
        note!("warning: {id} cannot find {words} here, and the reference lacks it: {why}");
    }
    let cancel = render::cancel_on_interrupt()?;
    let pool = render::thread_pool(args.threads)?;
    let made = pool.install(|| make(args, &job, &cancel))?;
    write(args, &job, &made)?;
    finish(args, &made)
}

fn job(args: &ReferenceArgs) -> Result<RenderJob, CliError> {
    let (integrator, params) = scene::parameters(&args.integrator, &args.set)?;
    let layers = LayerSettings {
        expressions: render::expressions(&args.expression)?,
        components: true,
        no_whole: false,
        max_depth: args.max_depth,
    };
    let desc = scene::read(&args.scene)?;
    let own = UVec2::new(desc.camera.width, desc.camera.height);
    let size = args.size.unwrap_or(own);
    let (scene, camera) = scene::build(&desc, size)?;
    let seed = args.seed;
    let settings = Settings {
        integrator,
        params,
        layers,
        seed,
    };
    Ok(RenderJob {
        scene,
        camera,
        size,
        settings,
        navigating: false,
    })
}

/// What came of it.
struct Made {
    runs: RunMeans,
    passes: u64,
    seconds: f64,
    error: Option<f64>,
    interrupted: bool,
}

fn make(args: &ReferenceArgs, job: &RenderJob, cancel: &Cancel) -> Result<Made, CliError> {
    let (start, bar) = (Instant::now(), bar());
    let mut made = Made {
        runs: RunMeans::default(),
        passes: args.spp.unwrap_or(0),
        seconds: 0.0,
        error: None,
        interrupted: false,
    };
    loop {
        let mut job = job.clone();
        job.settings.seed = combine(args.seed, made.runs.runs());
        let Some(renderer) = one_run(&job, &mut made.passes, cancel)? else {
            made.interrupted = true;
            break;
        };
        made.runs.add(&renderer.frame().layers);
        made.seconds = start.elapsed().as_secs_f64();
        let runs = made.runs.runs();
        made.error = made.runs.relative_error();
        show(&bar, args, &made);
        let black = runs >= MIN_RUNS && made.error.is_none();
        let reached = runs >= MIN_RUNS && made.error.is_some_and(|e| e <= args.error);
        let late = args.seconds.is_some_and(|s| made.seconds >= s) && runs >= 2;
        if black || reached || late {
            break;
        }
    }
    bar.finish_and_clear();
    if made.runs.runs() < 2 {
        return Err(CliError::failed(
            "stopped before two runs were complete, without which there is no standard error; \
             nothing was written",
        ));
    }
    Ok(made)
}

/// One run; none if it was interrupted. The first one finds out how many passes it has, even ones.
fn one_run(
    job: &RenderJob,
    passes: &mut u64,
    cancel: &Cancel,
) -> Result<Option<Renderer>, CliError> {
    let plan = scene::plan(job)?;
    let mut renderer = Renderer::with_plan(job, plan, crate::engine::session::RenderClock::start());
    loop {
        if renderer.render_pass(cancel) == Err(Cancelled) {
            return Ok(None);
        }
        let (done, seconds) = (renderer.passes(), renderer.clock().wall());
        if *passes == 0 && seconds >= RUN_SECONDS && done.is_multiple_of(2) {
            *passes = done;
        }
        if *passes > 0 && done >= *passes {
            return Ok(Some(renderer));
        }
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::new(1000);
    if let Ok(style) = ProgressStyle::with_template("[{bar:30}] {msg}") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.enable_steady_tick(Duration::from_millis(500));
    bar
}

fn show(bar: &ProgressBar, args: &ReferenceArgs, made: &Made) {
    let runs = made.runs.runs() as f64;
    // Standard errors fall with the root of the runs.
    let by_error = made.error.map(|e| (args.error / e).powi(2));
    let share = by_error.unwrap_or(0.0).min(runs / MIN_RUNS as f64);
    let by_time = args.seconds.map_or(0.0, |s| made.seconds / s);
    let share = share.max(by_time).min(1.0);
    bar.set_position((share * 1000.0) as u64);
    let left = if share > 0.0 {
        duration(made.seconds / share - made.seconds)
    } else {
        "?".to_owned()
    };
    let error = made.error.map_or("?".to_owned(), figure);
    bar.set_message(format!("{runs} runs, standard error {error}, {left} left"));
}

fn write(args: &ReferenceArgs, job: &RenderJob, made: &Made) -> Result<(), CliError> {
    let known = made.runs.known();
    let error = made.error.map_or("unknown".to_owned(), |e| e.to_string());
    let mut frame = crate::engine::film::Frame::failed(String::new());
    frame.passes = made.passes * made.runs.runs();
    frame.t_wall = made.seconds;
    let name = |n: &str| format!("{PREFIX}{n}");
    let mut texts = origin::texts(&job.scene.name, &job.settings, &frame);
    // The error of a mean of runs is its own estimate, of so many runs.
    texts.retain(|(n, _)| *n != name("error") && *n != name("error-interval"));
    texts.push((name("error"), error));
    texts.push((name("runs"), made.runs.runs().to_string()));
    let file = |path: &std::path::Path, of: fn(&KnownLayer) -> &Vec<[f32; 3]>| {
        let layers: Vec<(&str, &[[f32; 3]])> = known
            .iter()
            .map(|layer| (layer.label.as_str(), of(layer).as_slice()))
            .collect();
        let failed = |why: String| CliError::failed(format!("{}: {why}", path.display()));
        let bytes = crate::picture::exr_file::encode(job.size, &layers, &texts)
            .map_err(|error| failed(error.to_string()))?;
        atomic::write(path, &bytes)
            .map_err(|error| failed(format!("cannot be written: {error}")))?;
        note!("wrote {}", path.display());
        Ok(())
    };
    file(&args.output, |layer| &layer.mean)?;
    file(&error_image_path(&args.output), |layer| {
        &layer.standard_error
    })
}

fn finish(args: &ReferenceArgs, made: &Made) -> Result<(), CliError> {
    let (runs, passes) = (made.runs.runs(), made.passes);
    let time = duration(made.seconds);
    let Some(error) = made.error else {
        note!("done: the picture is black, so there is no relative error to reach");
        return Ok(());
    };
    note!(
        "{runs} runs of {passes} spp in {time}: standard error {} of the image mean",
        figure(error)
    );
    if runs < MIN_RUNS {
        note!("warning: fewer than {MIN_RUNS} runs: the standard errors are rough");
    }
    if error > args.error || runs < MIN_RUNS {
        let why = if made.interrupted {
            "interrupted"
        } else {
            "out of time"
        };
        return Err(CliError::failed(format!(
            "{why} before the standard error fell to {}; what there is was written",
            figure(args.error)
        )));
    }
    Ok(())
}
