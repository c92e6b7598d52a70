//! Stiff and extreme cases, each against an answer that needs no second renderer.
//!
//! A [`Case`] builds its scenes in code, renders them as any other job or asks one part of the
//! engine, and yields [`Point`]s: what was measured at a parameter, what is right, how sure the
//! measurement is, and whether it holds. Which integrator is asked, and why another is not, is a
//! table of the case ([`Fit`]).
//!
//! A picture is judged by its mean over independent runs: it holds if the right value lies within
//! the confidence interval, and if the interval is narrower than the case's bound. A measurement
//! that is too noisy to show anything fails, too.

pub mod case;
mod closed;
pub mod estimate;
mod extremes;
mod fits;
pub mod oracles;
pub mod scenes;
pub mod stress;

pub use case::{Case, Depth, Fit, Outcome, Point, Variant, run};

/// Every case: those with a closed form first, then those that say what must hold at an extreme.
pub fn cases() -> Vec<&'static Case> {
    closed::CASES
        .iter()
        .chain(extremes::CASES)
        .copied()
        .collect()
}
