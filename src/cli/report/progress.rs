//! What is done and what remains, on standard error.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::record::Run;
use crate::cli::print::note;
use crate::cli::print::{duration, figure};

/// A bar over all runs; without a terminal, a line a run.
pub struct Progress {
    bar: ProgressBar,
    runs: usize,
    done: usize,
    seconds: f64,
    name: String,
    shown: Option<Instant>,
}

impl Progress {
    /// `missing` runs of `all`, of `seconds` each.
    pub fn new(missing: usize, all: usize, seconds: f64) -> Self {
        let bar = ProgressBar::new(1000);
        if let Ok(style) = ProgressStyle::with_template("[{bar:30}] {msg}") {
            bar.set_style(style.progress_chars("=> "));
        }
        let (kept, time) = (all - missing, duration(missing as f64 * seconds));
        let again = match kept {
            0 => String::new(),
            _ => format!(" ({kept} of {all} are there already)"),
        };
        note!("{missing} runs of {seconds} s: about {time}{again}");
        Self {
            bar,
            runs: missing,
            done: 0,
            seconds,
            name: String::new(),
            shown: None,
        }
    }

    /// A run begins.
    pub fn begin(&mut self, scene: &str, integrator: &str, seed: u64) {
        self.name = format!("{scene} {integrator} seed {seed}");
        self.shown = None;
        self.tick(0.0);
    }

    /// It has rendered for `seconds`.
    pub fn tick(&mut self, seconds: f64) {
        let due = Duration::from_millis(200);
        if self.bar.is_hidden() || self.shown.is_some_and(|s| s.elapsed() < due) {
            return;
        }
        self.shown = Some(Instant::now());
        let all = self.runs as f64 * self.seconds;
        let past = self.done as f64 * self.seconds + seconds;
        self.bar.set_position((1000.0 * past / all) as u64);
        let (run, left) = (self.done + 1, duration(all - past));
        self.bar.set_message(format!(
            "run {run} of {}, {}, {left} left",
            self.runs, self.name
        ));
    }

    /// It is done.
    pub fn end(&mut self, run: &Run) {
        self.done += 1;
        let Some(last) = run.points.last() else {
            return;
        };
        let error = match (last.rmse, last.estimate) {
            (Some(rmse), _) => format!("rmse {}", figure(rmse)),
            (None, Some(estimate)) => format!("estimated rmse {}", figure(estimate)),
            (None, None) => "no error known".to_owned(),
        };
        let (done, all, name) = (self.done, self.runs, &self.name);
        let left = duration((all - done) as f64 * self.seconds);
        let line = format!(
            "{done} of {all}: {name}: {} passes, {error}; {left} left",
            last.pass
        );
        self.bar.suspend(|| note!("{line}"));
    }

    /// Removes the bar.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}
