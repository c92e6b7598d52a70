//! The progress bar on standard error; it hides itself where no terminal is.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::stop::{State, Stop};
use crate::cli::print::{duration, figure};

/// Steps of the bar.
const STEPS: u64 = 1000;

/// A bar for one render.
pub struct Progress {
    bar: ProgressBar,
    stop: Stop,
    shown: Option<Instant>,
}

/// Time between two updates.
const INTERVAL: Duration = Duration::from_millis(200);

impl Progress {
    /// An empty bar.
    pub fn new(stop: &Stop) -> Self {
        let bar = ProgressBar::new(STEPS);
        if let Ok(style) = ProgressStyle::with_template("[{bar:30}] {msg}") {
            bar.set_style(style.progress_chars("=> "));
        }
        Self {
            bar,
            stop: *stop,
            shown: None,
        }
    }

    /// Whether the next update will be shown.
    pub fn is_due(&self) -> bool {
        !self.bar.is_hidden() && self.shown.is_none_or(|shown| shown.elapsed() >= INTERVAL)
    }

    /// Shows a state, if it is time.
    pub fn update(&mut self, state: &State) {
        if !self.is_due() {
            return;
        }
        self.shown = Some(Instant::now());
        let share = self.stop.share(state);
        self.bar.set_position((share * STEPS as f64) as u64);
        let remaining = if share > 0.0 {
            duration(state.t_wall / share - state.t_wall)
        } else {
            "?".to_owned()
        };
        let error = state.error.map_or("?".to_owned(), figure);
        self.bar.set_message(format!(
            "{} spp, {}, {} Mrays/s, error {error}, {remaining} left",
            state.passes,
            duration(state.t_wall),
            figure(state.rays as f64 / state.t_wall.max(f64::MIN_POSITIVE) * 1e-6),
        ));
    }

    /// Removes the bar.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}
