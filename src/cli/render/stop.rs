//! When a render is done.

use crate::engine::session::Renderer;

/// Samples per pixel where no condition is given.
const DEFAULT_SPP: u64 = 64;
/// Passes after which a picture that is still black is given up on: without a mean there is no
/// relative error to wait for.
const BLACK_PASSES: u64 = 64;

/// The conditions; the first one reached ends the render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Samples per pixel.
    pub spp: Option<u64>,
    /// `t_wall` in seconds.
    pub seconds: Option<f64>,
    /// Estimated RMSE / image mean.
    pub error: Option<f64>,
}

/// How far a render is.
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// Completed passes.
    pub passes: u64,
    /// Seconds.
    pub t_wall: f64,
    /// Rays traced.
    pub rays: u64,
    /// Estimated RMSE / image mean, where it was asked for and exists.
    pub error: Option<f64>,
    /// Whether it was asked for.
    pub looked: bool,
}

impl State {
    /// The state after a pass. The error costs a walk over the picture, which is not counted as
    /// time of the render.
    pub fn of(renderer: &mut Renderer, with_error: bool) -> Self {
        renderer.clock().pause();
        let error = if with_error {
            renderer.relative_error()
        } else {
            None
        };
        let t_wall = renderer.clock().wall();
        let state = Self {
            passes: renderer.passes(),
            t_wall,
            rays: renderer.stats().rays,
            error,
            looked: with_error,
        };
        renderer.clock().resume();
        state
    }
}

impl Stop {
    /// The conditions given, or the default number of samples.
    pub fn new(spp: Option<u64>, seconds: Option<f64>, error: Option<f64>) -> Self {
        let none = seconds.is_none() && error.is_none();
        Self {
            spp: spp.or(none.then_some(DEFAULT_SPP)),
            seconds,
            error,
        }
    }

    /// Whether the error is looked at after pass `pass`: each look is one more chance to stop at
    /// an estimate that is low by luck, and takes time. Two of a hundred passes are enough.
    pub fn looks_at(&self, pass: u64) -> bool {
        self.error.is_some() && pass.is_multiple_of((pass / 50).max(1))
    }

    /// Why the render is done; none while it is not.
    pub fn reached(&self, state: &State) -> Option<&'static str> {
        if self.spp.is_some_and(|spp| state.passes >= spp) {
            return Some("samples reached");
        }
        if self.seconds.is_some_and(|seconds| state.t_wall >= seconds) {
            return Some("time reached");
        }
        match (self.error, state.error) {
            (Some(goal), Some(error)) if error <= goal => Some("error reached"),
            (Some(_), None) if state.looked && state.passes >= BLACK_PASSES => {
                Some("the picture stays black, so there is no relative error to reach")
            }
            _ => None,
        }
    }

    /// Share that is done, in [0, 1], of the condition that is nearest to its end; the error
    /// falls with the square root of the samples.
    pub fn share(&self, state: &State) -> f64 {
        let spp = self.spp.map(|spp| state.passes as f64 / spp as f64);
        let seconds = self.seconds.map(|seconds| state.t_wall / seconds);
        let error = self
            .error
            .zip(state.error)
            .map(|(goal, e)| (goal / e).powi(2));
        [spp, seconds, error]
            .into_iter()
            .flatten()
            .fold(0.0, f64::max)
            .min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(passes: u64, t_wall: f64, error: Option<f64>) -> State {
        State {
            passes,
            t_wall,
            rays: 0,
            error,
            looked: true,
        }
    }

    #[test]
    fn the_first_condition_reached_ends_the_render() {
        let stop = Stop::new(Some(10), Some(2.0), Some(0.1));
        assert_eq!(stop.reached(&state(9, 1.9, Some(0.11))), None);
        assert_eq!(stop.reached(&state(10, 0.0, None)), Some("samples reached"));
        assert_eq!(stop.reached(&state(1, 2.0, None)), Some("time reached"));
        assert_eq!(
            stop.reached(&state(2, 0.1, Some(0.1))),
            Some("error reached")
        );
    }

    #[test]
    fn samples_are_limited_only_where_nothing_else_is() {
        assert_eq!(Stop::new(None, None, None).spp, Some(DEFAULT_SPP));
        assert_eq!(Stop::new(None, Some(1.0), None).spp, None);
        assert_eq!(Stop::new(None, None, Some(1.0)).spp, None);
    }

    #[test]
    fn a_black_picture_does_not_wait_for_its_relative_error() {
        let stop = Stop::new(None, None, Some(0.01));
        assert_eq!(stop.reached(&state(BLACK_PASSES - 1, 1.0, None)), None);
        assert!(stop.reached(&state(BLACK_PASSES, 1.0, None)).is_some());
        let unseen = State {
            looked: false,
            ..state(BLACK_PASSES, 1.0, None)
        };
        assert_eq!(stop.reached(&unseen), None);
    }

    #[test]
    fn the_error_is_looked_at_rarely_enough_and_often_enough() {
        let stop = Stop::new(None, None, Some(0.1));
        assert!((1..100).all(|pass| stop.looks_at(pass)));
        let looks: Vec<u64> = (1..10_000).filter(|p| stop.looks_at(*p)).collect();
        let gaps = looks.windows(2).map(|w| w[1] as f64 / w[0] as f64);
        assert!(looks.len() < 500 && gaps.skip(100).fold(0.0, f64::max) < 1.03);
        assert!(!Stop::new(Some(9), None, None).looks_at(1));
    }

    #[test]
    fn progress_is_that_of_the_nearest_end() {
        let stop = Stop::new(Some(100), Some(10.0), Some(0.1));
        assert_eq!(stop.share(&state(10, 2.0, Some(0.4))), 0.2);
        assert_eq!(stop.share(&state(10, 0.0, Some(0.2))), 0.25);
        assert_eq!(stop.share(&state(200, 0.0, None)), 1.0);
    }
}
