//! What the worker does next: a pure function, so that it can be tested.

/// Time in which something must be on the screen after a change of view, in seconds.
pub const FIRST_FRAME_SECONDS: f64 = 0.030;
/// Share of that time a coarse pass is planned to fill; the rest covers its variation and the
/// making of the frame.
const PLANNED_SHARE: f64 = 0.4;
/// A pass at full resolution that takes no longer than this needs no coarser forerunner but the
/// first.
const PATIENCE_SECONDS: f64 = 0.15;
/// What a slow pass still counts after each later one.
const MEMORY: f64 = 0.9;
/// Coarsest picture: one sample for a square of 32 pixels.
const MAX_DIVISOR: u32 = 32;
/// Shortest time between two frames of a converging picture, in seconds.
const PUBLISH_SECONDS: f64 = 0.1;

/// What has been done for the current job.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Divisor of the last coarse pass, if there was one.
    pub last_divisor: Option<u32>,
    /// Completed passes at full resolution.
    pub passes: u64,
    /// Pixels of the full picture.
    pub pixels: u64,
    /// Measured seconds per pixel and pass of this or the last job.
    pub seconds_per_pixel: f64,
    /// The user is moving the camera.
    pub navigating: bool,
}

/// What to do next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// One sample per square of `divisor` pixels.
    Coarse {
        /// Side of the square.
        divisor: u32,
        /// Ignores cancellation, so that a drag never starves.
        must_finish: bool,
    },
    /// One more pass at full resolution.
    Full,
}

/// The seconds per pixel to plan with, after `measured` followed on `known`. A machine that does
/// other work beside has slow spells: the slowest pass of the last few is planned for, as a late
/// frame is felt and a coarse one hardly seen.
pub fn learn(known: f64, measured: f64) -> f64 {
    measured.max(MEMORY * known)
}

/// Chooses the next step.
pub fn next_step(p: &Progress) -> Step {
    let full_pass = p.pixels as f64 * p.seconds_per_pixel;
    match p.last_divisor {
        _ if p.passes > 0 => Step::Full,
        None => {
            let divisor = first_divisor(full_pass);
            // At divisor 1 the pass is a full one and is counted as such, but not by a user who
            // moves on: it must finish, and full passes can be cancelled.
            if divisor == 1 && !p.navigating {
                Step::Full
            } else {
                Step::Coarse {
                    divisor,
                    must_finish: true,
                }
            }
        }
        Some(d) if d <= 2 || full_pass <= PATIENCE_SECONDS => Step::Full,
        Some(d) => Step::Coarse {
            divisor: d / 2,
            must_finish: false,
        },
    }
}

/// The smallest power of two whose pass fits the time of a first frame.
fn first_divisor(full_pass: f64) -> u32 {
    let fits = |d: u32| full_pass / f64::from(d * d) <= PLANNED_SHARE * FIRST_FRAME_SECONDS;
    (0..)
        .map(|e| 1 << e)
        .find(|&d| d >= MAX_DIVISOR || fits(d))
        .unwrap_or(MAX_DIVISOR)
}

/// Whether a frame is due after pass number `passes`, `since` seconds after the last frame.
pub fn publish_now(passes: u64, since: f64) -> bool {
    passes <= 1 || since >= PUBLISH_SECONDS
}

#[cfg(test)]
mod tests {
    use super::*;

    fn progress(seconds_per_pixel: f64) -> Progress {
        Progress {
            last_divisor: None,
            passes: 0,
            pixels: 1280 * 720,
            seconds_per_pixel,
            navigating: true,
        }
    }

    #[test]
    fn first_frames_fit_their_time_at_any_speed() {
        for e in -90..=-60 {
            let p = progress(10f64.powf(f64::from(e) / 10.0));
            let Step::Coarse {
                divisor,
                must_finish,
            } = next_step(&p)
            else {
                panic!("{p:?}")
            };
            assert!(must_finish);
            let cells = p.pixels as f64 / f64::from(divisor * divisor);
            let seconds = cells * p.seconds_per_pixel;
            assert!(seconds <= PLANNED_SHARE * FIRST_FRAME_SECONDS || divisor == MAX_DIVISOR);
        }
    }

    #[test]
    fn refinement_ends_in_full_passes() {
        let mut p = progress(2e-6);
        let mut divisors = Vec::new();
        while let Step::Coarse { divisor, .. } = next_step(&p) {
            divisors.push(divisor);
            p.last_divisor = Some(divisor);
        }
        assert_eq!(divisors, [16, 8, 4, 2]);
        p.passes = 1;
        assert_eq!(next_step(&p), Step::Full);
    }

    #[test]
    fn a_still_view_that_is_quick_needs_no_coarse_frame() {
        let p = Progress {
            navigating: false,
            pixels: 64 * 64,
            ..progress(2e-6)
        };
        assert_eq!(next_step(&p), Step::Full);
    }

    #[test]
    fn slow_spells_are_remembered_for_some_frames() {
        let mut known = 1e-6;
        known = learn(known, 4e-6);
        assert_eq!(known, 4e-6);
        let frames = (0..).find(|_| {
            known = learn(known, 1e-6);
            known == 1e-6
        });
        assert!((5..30).contains(&frames.expect("it is forgotten")));
    }

    #[test]
    fn frames_are_not_made_faster_than_they_are_seen() {
        assert!(publish_now(1, 0.0));
        assert!(!publish_now(2, 0.05));
        assert!(publish_now(3, 0.2));
    }
}
