//! The same bits however a picture came about.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use glam::UVec2;

use super::super::case::{Case, Run};
use super::super::estimate::frame;
use super::super::scenes::room;
use super::jobs;
use crate::engine::film::Frame;
use crate::engine::integrators::Cancel;
use crate::engine::session::{RenderClock, RenderJob, RenderSession, Renderer};

/// Any number of threads, and any interruption.
pub const THREADS: Case = Case {
    id: "threads",
    label: "Threads and interruptions",
    summary: "The room on 1, 2 and 16 threads; with passes that are cancelled on the way; paused \
              and resumed in a session; and built again from its description.",
    parameter: "threads",
    oracle: "the same bits in every layer",
    stiff: false,
    fit: jobs::all,
    run: threads,
};

/// How long a session may take for what takes milliseconds.
const PATIENCE: f64 = 60.0;

fn bits(frame: &Frame) -> Vec<u32> {
    let values = frame.layers.iter().flat_map(|l| l.pixels.iter().flatten());
    values.map(|v| v.to_bits()).collect()
}

fn threads(run: &mut Run) {
    let mut job = run.job(&room(1.0));
    job.settings.layers.components = true;
    job.size = UVec2::new(24, 16);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .ok()?;
        Some(bits(&pool.install(|| frame(&job, 0, 2))?))
    };
    let one = on(1);
    for threads in [2, 16] {
        let differ = u64::from(one.is_none() || on(threads) != one);
        let note = "compared with one thread";
        run.count(threads as f64, "threads", differ, 1, note);
    }
    let (found, cancelled) = cancelled(&job);
    let differ = u64::from(one.is_none() || found.map(|frame| bits(&frame)) != one);
    let note = format!("after {cancelled} passes that were cancelled on the way");
    run.count(2.0, "cancelled passes", differ, 1, &note);
    let found = paused(&job);
    let straight = found.as_ref().and_then(|f| frame(&job, 0, f.passes));
    let same = found.as_ref().map(|f| bits(f)) == straight.as_ref().map(bits);
    let note = match &found {
        Some(found) => format!("{} passes with a pause between", found.passes),
        None => "the session did not pause in a minute".to_owned(),
    };
    let differ = u64::from(found.is_none() || !same);
    run.count(2.0, "paused and resumed", differ, 1, &note);
    // A saved state holds what a scene is made of, not what was prepared.
    job.scene = run.job(&room(1.0)).scene;
    let again = frame(&job, 0, 2).map(|frame| bits(&frame));
    let differ = u64::from(one.is_none() || again != one);
    run.count(2.0, "built and rendered again", differ, 1, "");
}

/// Two passes, each after some attempts that end at any moment, and how many of these ended early.
fn cancelled(job: &RenderJob) -> (Option<Frame>, u64) {
    let Ok(mut renderer) = Renderer::new(job) else {
        return (None, 0);
    };
    let mut cancelled = 0;
    while renderer.passes() < 2 {
        let before = renderer.passes();
        for pause in [0, 30, 300, 3000] {
            let newest = Arc::new(AtomicU64::new(1));
            let cancel = Cancel::new(Arc::clone(&newest), 1);
            std::thread::scope(|scope| {
                scope.spawn(|| {
                    std::thread::sleep(Duration::from_micros(pause));
                    newest.store(2, Ordering::Relaxed);
                });
                // One that was quick enough is a pass as any other.
                cancelled += u64::from(renderer.render_pass(&cancel).is_err());
            });
            if renderer.passes() > before {
                break;
            }
        }
        if renderer.passes() == before {
            // Nobody cancels this one.
            let _ = renderer.render_pass(&Cancel::never());
        }
    }
    (Some(renderer.frame()), cancelled)
}

/// The frame of a session at its second pause.
fn paused(job: &RenderJob) -> Option<Arc<Frame>> {
    let mut session = RenderSession::new(2, || {}).ok()?;
    session.submit(job.clone());
    let clock = RenderClock::start();
    let wait = |session: &RenderSession, wanted: &dyn Fn(&Frame) -> bool| {
        while clock.wall() < PATIENCE {
            let frame = session.latest().filter(|frame| wanted(frame));
            if frame.is_some() {
                return frame;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        None
    };
    wait(&session, &|f| f.passes >= 1)?;
    session.set_paused(true);
    let first = wait(&session, &|f| f.paused)?.passes;
    session.set_paused(false);
    wait(&session, &|f| f.passes > first)?;
    session.set_paused(true);
    wait(&session, &|f| f.paused && f.passes > first)
}
