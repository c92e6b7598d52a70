//! Time from a change of camera to the first complete picture, as a window would see it.

use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use glam::Quat;
use serde::Serialize;

use crate::cli::args::FirstFrameArgs;
use crate::cli::error::CliError;
use crate::cli::{print, scene};
use crate::engine::integrators::REGISTRY;
use crate::engine::scene::desc::CameraDesc;
use crate::engine::session::{RenderJob, RenderSession, Settings};

/// A picture every other refresh of a 60 Hz display.
const LIMIT_MS: f64 = 33.0;
/// A render that shows nothing for so long hangs.
const PATIENCE: Duration = Duration::from_secs(30);
/// Turn of the camera between two changes, in radians.
const STEP: f32 = 0.01;

#[derive(Serialize)]
struct Figures {
    changes: u64,
    width: u32,
    height: u32,
    threads: usize,
    p50_ms: f64,
    p90_ms: f64,
    p99_ms: f64,
    max_ms: f64,
    limit_ms: f64,
    p99_within_limit: bool,
}

/// Runs the command.
pub fn run(args: &FirstFrameArgs) -> Result<(), CliError> {
    let mut times = measure(args)?;
    times.sort_by(f64::total_cmp);
    let p99_ms = percentile(&times, 0.99);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let f = Figures {
        changes: args.changes,
        width: args.size.x,
        height: args.size.y,
        threads: if args.threads == 0 {
            cores
        } else {
            args.threads
        },
        p50_ms: percentile(&times, 0.5),
        p90_ms: percentile(&times, 0.9),
        p99_ms,
        max_ms: percentile(&times, 1.0),
        limit_ms: LIMIT_MS,
        p99_within_limit: p99_ms <= LIMIT_MS,
    };
    if args.json {
        return print::json(&f);
    }
    let verdict = if f.p99_within_limit { "met" } else { "missed" };
    print::line(&format!(
        "first frame after a change of camera, {}x{}, {} threads, {} changes:\n\
         p50 {:.1} ms, p90 {:.1} ms, p99 {:.1} ms, max {:.1} ms; limit {LIMIT_MS} ms for p99: \
         {verdict}",
        f.width, f.height, f.threads, f.changes, f.p50_ms, f.p90_ms, f.p99_ms, f.max_ms
    ))
}

/// Milliseconds of each change.
pub fn measure(args: &FirstFrameArgs) -> Result<Vec<f64>, CliError> {
    let desc = scene::read(&args.scene)?;
    let (scene, camera) = scene::build(&desc, args.size)?;
    let (wake, woken) = channel();
    let mut session = RenderSession::new(args.threads, move || {
        // A receiver that is gone no longer waits.
        let _ = wake.send(());
    })
    .map_err(|error| CliError::failed(format!("the render cannot start: {error}")))?;
    let settings = Settings::new(&REGISTRY[0]);
    let mut job = RenderJob {
        scene,
        camera,
        size: args.size,
        settings,
        navigating: true,
    };
    let mut times = Vec::new();
    // The first picture of all knows nothing of the machine's speed and is not counted.
    for change in 0..=args.changes {
        job.camera = scene::camera(&turned(&desc.camera, change as f32 * STEP), args.size)?;
        let start = Instant::now();
        let epoch = session.submit(job.clone());
        wait_for(&session, epoch, &woken)?;
        if change > 0 {
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        // Changes come at any moment of what follows the first picture.
        std::thread::sleep(Duration::from_millis(change * 7 % 20));
    }
    Ok(times)
}

fn wait_for(session: &RenderSession, epoch: u64, woken: &Receiver<()>) -> Result<(), CliError> {
    loop {
        if let Some(frame) = session.latest().filter(|frame| frame.epoch == epoch) {
            return match &frame.error {
                Some(error) => Err(CliError::failed(error.clone())),
                None => Ok(()),
            };
        }
        woken.recv_timeout(PATIENCE).map_err(|_| {
            CliError::failed(format!(
                "no picture was shown within {} s",
                PATIENCE.as_secs()
            ))
        })?;
    }
}

/// The view turned about its target by `angle`.
fn turned(camera: &CameraDesc, angle: f32) -> CameraDesc {
    let turn = Quat::from_axis_angle(camera.up.normalize(), angle);
    CameraDesc {
        position: camera.target + turn * (camera.position - camera.target),
        ..*camera
    }
}

/// Nearest-rank percentile of ascending values.
pub fn percentile(sorted: &[f64], share: f64) -> f64 {
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted
        .get(rank.clamp(1, sorted.len().max(1)) - 1)
        .copied()
        .unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_values_that_were_measured() {
        let values: Vec<f64> = (1..=200).map(f64::from).collect();
        assert_eq!(percentile(&values, 0.5), 100.0);
        assert_eq!(percentile(&values, 0.99), 198.0);
        assert_eq!(percentile(&values, 1.0), 200.0);
        assert_eq!(percentile(&[7.0], 0.5), 7.0);
        assert!(percentile(&[], 0.5).is_nan());
    }

    #[test]
    fn turning_keeps_the_distance() {
        let camera = CameraDesc::default();
        let turned = turned(&camera, 1.0);
        let distance = |c: &CameraDesc| (c.position - c.target).length();
        assert!((distance(&turned) - distance(&camera)).abs() < 1e-5);
        assert!((turned.position - camera.position).length() > 1.0);
    }
}
