//! What a user waits for: camera to picture, and input to answer of the panels, while all cores
//! render.

use serde::Serialize;

use super::first_frame::{self, percentile};
use crate::cli::args::FirstFrameArgs;
use crate::cli::error::CliError;
use crate::cli::{print, scene};
use crate::viewer::latency;
use crate::viewer::source::SceneSource;

/// A wait that nobody notices.
const LIMIT_MS: f64 = 50.0;

#[derive(Serialize)]
struct Figures {
    camera_to_picture: Times,
    input_to_answer: Times,
    input_to_drawn: Times,
    adapter: String,
    limit_ms: f64,
    drawn_p99_within_limit: bool,
}

#[derive(Serialize)]
struct Times {
    p50_ms: f64,
    p90_ms: f64,
    p99_ms: f64,
    max_ms: f64,
}

impl Times {
    fn of(mut times: Vec<f64>) -> Self {
        times.sort_by(f64::total_cmp);
        Self {
            p50_ms: percentile(&times, 0.5),
            p90_ms: percentile(&times, 0.9),
            p99_ms: percentile(&times, 0.99),
            max_ms: percentile(&times, 1.0),
        }
    }

    fn line(&self, what: &str) -> String {
        format!(
            "{what}: p50 {:.1} ms, p90 {:.1} ms, p99 {:.1} ms, max {:.1} ms",
            self.p50_ms, self.p90_ms, self.p99_ms, self.max_ms
        )
    }
}

/// Runs the command.
pub fn run(args: &FirstFrameArgs) -> Result<(), CliError> {
    let camera = Times::of(first_frame::measure(args)?);
    let (scene, _) = scene::build(&scene::read(&args.scene)?, args.size)?;
    let source = SceneSource::named(&args.scene);
    let inputs = args.changes as usize;
    let measured = latency::measure(source, scene, args.size, inputs)
        .map_err(|error| CliError::failed(error.to_string()))?;
    let drawn = Times::of(measured.drawn);
    let f = Figures {
        drawn_p99_within_limit: drawn.p99_ms <= LIMIT_MS,
        camera_to_picture: camera,
        input_to_answer: Times::of(measured.answered),
        input_to_drawn: drawn,
        adapter: measured.adapter,
        limit_ms: LIMIT_MS,
    };
    if args.json {
        return print::json(&f);
    }
    let verdict = if f.drawn_p99_within_limit {
        "met"
    } else {
        "missed"
    };
    print::line(&format!(
        "{}\n{}\n{} ({}); limit {LIMIT_MS} ms for p99: {verdict}",
        f.camera_to_picture.line("camera to picture"),
        f.input_to_answer.line("input to answer of the panels"),
        f.input_to_drawn.line("input to answer drawn"),
        f.adapter
    ))
}
