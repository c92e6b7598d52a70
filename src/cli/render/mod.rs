//! `lightscope render`: a scene into a file.

mod log;
mod notes;
mod options;
mod progress;
mod pyramid;
mod sequence;
mod stop;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::UVec2;

use super::args::RenderArgs;
use super::error::CliError;
use super::picture::{self, Attributes};
use super::scene;
use crate::cli::print::note;
use crate::engine::film::Frame;
use crate::engine::integrators::{BadSample, Cancel, Cancelled};
use crate::engine::measure::Metrics;
use crate::engine::scene::SceneDesc;
use crate::engine::session::{RenderClock, RenderJob, Renderer, replay_command};
use log::Log;
use notes::BadSampleNote;
pub use options::{RenderOptions, expressions};
use progress::Progress;
use stop::State;

/// Runs the command.
pub fn run(args: RenderArgs) -> Result<(), CliError> {
    match &args.frames {
        Some(frames) => sequence::run(&args, frames),
        None => picture_of(&args, 0, &cancel_on_interrupt()?),
    }
}

/// Renders one frame; a still has one.
fn picture_of(args: &RenderArgs, frame: u32, cancel: &Cancel) -> Result<(), CliError> {
    let options = RenderOptions::new(args)?;
    refuse_to_overwrite_inputs(args)?;
    if let Some(most) = args.pyramid {
        return pyramid::run(args, &options, (frame, most), cancel);
    }
    let desc = scene::read_frame(&args.scene, frame)?;
    let size = options
        .size
        .unwrap_or(UVec2::new(desc.camera.width, desc.camera.height));
    let log = Log::open(args.log.as_deref(), args.reference.as_deref(), size)?;
    let pool = thread_pool(options.threads)?;
    let mut rendered = pool.install(|| render(&options, desc, size, log, cancel))?;
    rendered.number = frame;
    finish(args, &options, &rendered)
}

/// A render that is done.
struct Rendered {
    frame: Frame,
    scene: String,
    /// Number of the frame in a sequence.
    number: u32,
    interrupted: bool,
    errors: Option<Metrics>,
}

fn render(
    options: &RenderOptions,
    desc: SceneDesc,
    size: UVec2,
    mut log: Log,
    cancel: &Cancel,
) -> Result<Rendered, CliError> {
    let clock = RenderClock::start();
    let (scene, camera) = scene::build(&desc, size)?;
    let job = RenderJob {
        scene,
        camera,
        size,
        settings: options.settings.clone(),
        navigating: false,
    };
    let plan = scene::plan(&job)?;
    notes::print_before(&job, &plan, rayon::current_num_threads());
    let mut renderer = Renderer::with_plan(&job, plan, clock);
    let mut progress = Progress::new(&options.stop);
    let mut interrupted = false;
    loop {
        if renderer.render_pass(cancel) == Err(Cancelled) {
            interrupted = true;
            break;
        }
        log.pass(&mut renderer)?;
        let look = options.stop.looks_at(renderer.passes()) || progress.is_due();
        let state = State::of(&mut renderer, look);
        progress.update(&state);
        if let Some(note) = options.stop.reached(&state) {
            progress.clear();
            note!("done: {note}");
            break;
        }
    }
    progress.clear();
    if renderer.passes() == 0 {
        return Err(CliError::failed(
            "stopped before the first pass was complete; nothing was written",
        ));
    }
    renderer.clock().pause();
    let (frame, errors) = (renderer.frame(), log.finish(&renderer));
    Ok(Rendered {
        frame,
        scene: job.scene.name.clone(),
        number: 0,
        interrupted,
        errors,
    })
}

fn finish(args: &RenderArgs, options: &RenderOptions, rendered: &Rendered) -> Result<(), CliError> {
    let frame = &rendered.frame;
    if rendered.interrupted {
        note!(
            "note: interrupted; the picture holds the {} passes that were complete",
            frame.passes
        );
    }
    let attributes = Attributes::of(&rendered.scene, options, frame);
    picture::write(options, frame, &attributes)?;
    for fact in &rendered.frame.facts {
        note!("{}: {}", fact.label, fact.value);
    }
    note!("wrote {}", options.output.path.display());
    let bad = bad_samples(args, options, rendered);
    notes::print_after(frame, rendered.errors.as_ref(), &bad);
    if args.json {
        super::print::json(&notes::figures(frame, rendered.errors.as_ref(), &bad))?;
    }
    Ok(())
}

/// The first samples that went wrong, each with the command that follows it again.
fn bad_samples(
    args: &RenderArgs,
    options: &RenderOptions,
    rendered: &Rendered,
) -> Vec<BadSampleNote> {
    let frame = &rendered.frame;
    let settings = &options.settings;
    let note = |sample: BadSample| BadSampleNote {
        what: sample.what,
        command: replay_command(
            &args.scene,
            rendered.number,
            frame.full_size,
            settings,
            &sample.id,
        ),
    };
    frame.stats.bad_samples().map(note).collect()
}

/// A log or a picture must not replace what the render reads, nor each other.
fn refuse_to_overwrite_inputs(args: &RenderArgs) -> Result<(), CliError> {
    let real = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let scene = Path::new(&args.scene);
    let mut taken = vec![(real(scene), "the scene")];
    taken.extend(
        args.reference
            .as_deref()
            .map(|r| (real(r), "the reference")),
    );
    let outputs = [
        (Some(&args.output), "the picture"),
        (args.log.as_ref(), "the log"),
    ];
    for (path, what) in outputs {
        let Some(path) = path else { continue };
        if let Some((_, other)) = taken.iter().find(|(t, _)| *t == real(path)) {
            let path = path.display();
            let message = format!("{what} would overwrite {other}, {path}; give it another name");
            return Err(CliError::usage(message));
        }
        taken.push((real(path), what));
    }
    Ok(())
}

/// Threads of our own, so that their number is the user's.
pub(super) fn thread_pool(threads: usize) -> Result<rayon::ThreadPool, CliError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|i| format!("render-{i}"))
        .build()
        .map_err(|error| CliError::failed(format!("threads cannot be started: {error}")))
}

/// A token that Ctrl-C cancels. A second Ctrl-C ends the program at once.
pub(super) fn cancel_on_interrupt() -> Result<Cancel, CliError> {
    let newest = Arc::new(AtomicU64::new(0));
    let cancel = Cancel::new(Arc::clone(&newest), 0);
    let handler = move || {
        if newest.fetch_add(1, Ordering::Relaxed) > 0 {
            // The customary code of a program that SIGINT ended.
            std::process::exit(130);
        }
    };
    ctrlc::set_handler(handler)
        .map_err(|error| CliError::failed(format!("Ctrl-C cannot be caught: {error}")))?;
    Ok(cancel)
}
