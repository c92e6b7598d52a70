//! What the render did so far.

use egui::{Grid, Ui};

use super::widgets::figure;
use crate::engine::film::Frame;
use crate::viewer::workspace::Workspace;

/// Draws the figures.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    let Some(frame) = &workspace.frame else {
        ui.weak("Nothing is rendered yet.");
        return;
    };
    Grid::new("figures").num_columns(2).show(ui, |ui| {
        figure(
            ui,
            "Samples a pixel",
            frame.passes.to_string(),
            "Complete passes.",
        );
        figure(
            ui,
            "Time",
            format!(
                "{} ({} of all cores)",
                seconds(frame.t_wall),
                seconds(frame.t_cpu)
            ),
            "Since the job was accepted, pauses left out: by the clock, and summed over cores.",
        );
        figure(
            ui,
            "Speed",
            speed(frame),
            "Millions of rays a second, shadow rays included.",
        );
        figure(
            ui,
            "Estimated error",
            error(frame),
            "Root mean square error over the mean of the picture, from two independent halves.",
        );
        figure(
            ui,
            "No numbers",
            frame.stats.non_finite.to_string(),
            "Samples whose radiance was NaN or infinite: counted, never averaged in.",
        );
        if let Some(first) = frame.stats.first_non_finite {
            let text = format!(
                "pixel {} {}, pass {}",
                first.pixel.x, first.pixel.y, first.pass
            );
            figure(ui, "First of them", text, "Where it can be computed again.");
        }
        figure(
            ui,
            "Cut paths",
            frame.stats.cut_paths.to_string(),
            "Paths that reached the largest number of events a path may have.",
        );
        figure(
            ui,
            "Picture memory",
            bytes(memory(frame)),
            "Of the frame that is shown, all layers; the graphics card holds those that are shown.",
        );
        walks(ui, frame);
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        figure(ui, "Threads", threads.to_string(), "Threads that render.");
    });
    for fact in &frame.facts {
        let text = format!("{}: {}", fact.label, fact.value);
        ui.label(text).on_hover_text("Prepared before the picture.");
    }
}

/// What the walks did: levels, lengths, roulette, mutations.
fn walks(ui: &mut Ui, frame: &Frame) {
    let stats = &frame.stats;
    let samples = stats.samples.max(1);
    let [eye, light] = stats.lengths();
    let none = Vec::new();
    for (name, counts, doc) in [
        (
            "Rays from the eye",
            stats.levels(),
            "Rays of walks from the eye a sample, after 0, 1, 2 … events; the last counts all \
             after it.",
        ),
        (
            "Rays from lights",
            stats.light_levels(),
            "The same of walks from the lights.",
        ),
        (
            "Walks from the eye",
            eye.as_ref().unwrap_or(&none).as_slice(),
            "Walks a sample that ended after 0, 1, 2 … events. Trees of rays have none.",
        ),
        (
            "Walks from lights",
            light.as_ref().unwrap_or(&none).as_slice(),
            "The same of walks from the lights.",
        ),
    ] {
        if !counts.is_empty() {
            figure(ui, name, shares(counts, samples), doc);
        }
    }
    if let Some(survival) = stats.survival() {
        figure(
            ui,
            "Roulette survived",
            format!("{:.1} %", survival * 100.0),
            "Share of the games of Russian roulette that walks survived.",
        );
    }
    if let Some(acceptance) = stats.acceptance() {
        figure(
            ui,
            "Accepted mutations",
            format!("{:.1} %", acceptance * 100.0),
            "Share of the proposals of the Markov chains that were accepted.",
        );
    }
}

/// Counts over `samples`, five in a line.
fn shares(counts: &[u64], samples: u64) -> String {
    let number = |n: &u64| format!("{:.3}", *n as f64 / samples as f64);
    let lines = counts.chunks(5).map(|line| {
        let line: Vec<String> = line.iter().map(number).collect();
        line.join("  ")
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn memory(frame: &Frame) -> usize {
    frame
        .layers
        .iter()
        .map(|l| size_of_val(l.pixels.as_slice()))
        .sum()
}

/// A time for people.
pub fn seconds(t: f64) -> String {
    if t < 60.0 {
        format!("{t:.1} s")
    } else if t < 3600.0 {
        format!("{}:{:02} min", t as u64 / 60, t as u64 % 60)
    } else {
        format!("{}:{:02} h", t as u64 / 3600, t as u64 / 60 % 60)
    }
}

/// Millions of rays a second.
pub fn speed(frame: &Frame) -> String {
    if frame.t_wall > 0.0 && frame.stats.rays > 0 {
        format!(
            "{:.2} Mrays/s",
            frame.stats.rays as f64 / frame.t_wall / 1e6
        )
    } else {
        "–".to_owned()
    }
}

/// The estimated error in percent.
pub fn error(frame: &Frame) -> String {
    match frame.relative_error {
        Some(error) if error.is_finite() => format!("{:.2} %", error * 100.0),
        _ => "not known yet".to_owned(),
    }
}

fn bytes(n: usize) -> String {
    format!("{:.1} MB", n as f64 / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_readable() {
        assert_eq!(seconds(0.04), "0.0 s");
        assert_eq!(seconds(59.94), "59.9 s");
        assert_eq!(seconds(61.0), "1:01 min");
        assert_eq!(seconds(3660.0), "1:01 h");
    }
}
