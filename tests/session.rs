//! The worker thread: newest job wins, nothing is lost, nothing starves.

mod support;

use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use glam::UVec2;
use lightscope::engine::film::Frame;
use lightscope::engine::session::RenderSession;
use support::render::{job, load, reference_dir, render};

const PATIENCE: Duration = Duration::from_secs(30);

fn session() -> (RenderSession, Receiver<()>) {
    let (sender, woken) = channel();
    let sender = Mutex::new(sender);
    let wake = move || {
        let _ = sender.lock().expect("one thread wakes").send(());
    };
    (RenderSession::new(2, wake).expect("threads"), woken)
}

/// The first frame that `wanted` accepts.
fn wait_for(
    s: &RenderSession,
    woken: &Receiver<()>,
    wanted: impl Fn(&Frame) -> bool,
) -> Arc<Frame> {
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        if let Some(frame) = s.latest().filter(|f| wanted(f)) {
            return frame;
        }
        let _ = woken.recv_timeout(Duration::from_millis(100));
    }
    panic!(
        "no such frame within {PATIENCE:?}; latest: {:?}",
        s.latest().map(|f| (f.epoch, f.passes))
    );
}

fn scene() -> Arc<lightscope::engine::scene::Scene> {
    load(&reference_dir("cornell-glass").join("scene.json"))
}

#[test]
fn a_session_converges_to_the_same_bits_as_passes_by_hand() {
    let (mut s, woken) = session();
    let job = job(&scene(), "path", &[]);
    let epoch = s.submit(job.clone());
    let frame = wait_for(&s, &woken, |f| f.epoch == epoch && f.passes >= 5);
    let by_hand = render(&job, frame.passes);
    for (a, b) in frame.layers.iter().zip(&by_hand.layers) {
        assert!(a.pixels == b.pixels, "layer {}", a.label);
    }
}

#[test]
fn pause_keeps_every_sample_and_resume_goes_on() {
    let (mut s, woken) = session();
    let epoch = s.submit(job(&scene(), "path", &[]));
    wait_for(&s, &woken, |f| f.passes >= 3);
    s.set_paused(true);
    let paused = wait_for(&s, &woken, |f| f.paused);
    std::thread::sleep(Duration::from_millis(100));
    assert_eq!(s.latest().expect("a frame").passes, paused.passes);
    s.set_paused(false);
    let later = wait_for(&s, &woken, |f| !f.paused && f.passes > paused.passes);
    assert_eq!(later.epoch, epoch);
    assert!(later.t_wall < paused.t_wall + 0.09 + later.t_wall - paused.t_wall);
}

#[test]
fn every_change_of_a_drag_is_shown_and_the_last_one_converges() {
    let (mut s, woken) = session();
    let scene = scene();
    let mut last = 0;
    for i in 0..40 {
        let mut job = job(&scene, "path", &[]);
        job.size = UVec2::new(640, 360);
        job.navigating = true;
        job.settings.seed = i;
        last = s.submit(job);
        let frame = wait_for(&s, &woken, |f| f.epoch == last);
        assert!(frame.is_coarse(), "the first frame of a drag is coarse");
    }
    let full = wait_for(&s, &woken, |f| f.epoch == last && !f.is_coarse());
    assert_eq!(full.size, UVec2::new(640, 360));
}

#[test]
fn jobs_in_quick_succession_end_with_the_newest() {
    let (mut s, woken) = session();
    let scene = scene();
    let mut last = 0;
    for seed in 0..200 {
        let mut job = job(&scene, "path", &[]);
        job.settings.seed = seed;
        last = s.submit(job);
    }
    wait_for(&s, &woken, |f| f.epoch == last && f.passes >= 2);
}

#[test]
fn a_picture_without_pixels_and_a_closing_session_do_not_hang() {
    let (mut s, _woken) = session();
    let mut empty = job(&scene(), "path", &[]);
    empty.size = UVec2::ZERO;
    s.submit(empty);
    std::thread::sleep(Duration::from_millis(20));
    let mut large = job(&scene(), "path", &[]);
    large.size = UVec2::splat(4096);
    s.submit(large);
    std::thread::sleep(Duration::from_millis(200));
    let start = Instant::now();
    drop(s);
    assert!(
        start.elapsed() < Duration::from_secs(2),
        "closing took {:?}",
        start.elapsed()
    );
}
