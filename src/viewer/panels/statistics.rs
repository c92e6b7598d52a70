//! What the render did so far.

use egui::{DragValue, Grid, RichText, Ui};

use super::widgets::figure;
use crate::engine::film::Frame;
use crate::engine::session::replay_command;
use crate::viewer::workspace::Workspace;

/// Draws the figures.
pub fn show(ui: &mut Ui, workspace: &mut Workspace) {
    let Some(frame) = workspace.frame.clone() else {
        ui.weak("Nothing is rendered yet.");
        return;
    };
    Grid::new("figures").num_columns(2).show(ui, |ui| {
        progress(ui, &frame);
        target(ui, &frame, &mut workspace.preferences.target_error);
        faults(ui, &frame, workspace);
        walks(ui, &frame);
        for fact in &frame.facts {
            figure(ui, fact.label, &fact.value, "What the algorithm prepared.");
        }
    });
    ui.label("Memory");
    Grid::new("memory")
        .num_columns(2)
        .show(ui, |ui| memory(ui, &frame, workspace));
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

fn progress(ui: &mut Ui, frame: &Frame) {
    let passes = frame.passes.to_string();
    figure(ui, "Samples a pixel", passes, "Complete passes.");
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
    let doc = "Millions of rays a second, shadow rays included.";
    figure(ui, "Speed", speed(frame), doc);
    let threads = frame.threads.to_string();
    figure(ui, "Threads", threads, "Threads that render.");
    let doc = "Root mean square error over the mean of the picture, from two independent halves.";
    figure(ui, "Estimated error", error(frame), doc);
}

/// The error that is good enough, and when it is reached.
fn target(ui: &mut Ui, frame: &Frame, target: &mut f64) {
    let doc = "The error that is good enough, in percent of the mean of the picture. From 0.001 to \
               100, default 1. Nothing stops when it is reached.";
    let label = ui.label(RichText::new("Target error").weak());
    let mut percent = *target * 100.0;
    let speed = percent * 0.01;
    let drag = DragValue::new(&mut percent)
        .range(0.001..=100.0)
        .speed(speed)
        .max_decimals(3)
        .suffix(" %");
    let drag = ui.add(drag).labelled_by(label.id).on_hover_text(doc);
    if drag.changed() {
        *target = percent / 100.0;
    }
    ui.end_row();
    let doc = "If the error goes on to fall with the square root of time. What an algorithm cannot \
               find, and bias, are not in the estimate.";
    figure(ui, "Reached", time_to(frame, *target), doc);
}

/// When an error is reached, in words.
fn time_to(frame: &Frame, target: f64) -> String {
    match frame.relative_error {
        Some(error) if error.is_finite() && error <= target => "yes".to_owned(),
        Some(error) if error.is_finite() && frame.t_wall > 0.0 => {
            let more = frame.t_wall * ((error / target).powi(2) - 1.0);
            format!("in about {}", seconds(more))
        }
        _ => "not known yet".to_owned(),
    }
}

/// Counts of what is wrong.
pub fn faults(ui: &mut Ui, frame: &Frame, workspace: &Workspace) {
    let stats = &frame.stats;
    for (name, count, doc) in [
        (
            "Not a number",
            stats.faults.nan,
            "Samples whose radiance was NaN: counted, never averaged in.",
        ),
        (
            "Infinite",
            stats.faults.infinite,
            "Samples whose radiance was infinite: counted, never averaged in.",
        ),
        (
            "Negative",
            stats.faults.negative,
            "Samples with a channel below zero, which no light has. They count.",
        ),
        (
            "Self-hits",
            stats.self_hits,
            "Rays that met the very surface that they left.",
        ),
        (
            "Missed edges",
            stats.missed_edges,
            "Rays that left the scene from within a sphere or a closed mesh (of scenes up to 65 536 \
             triangles): they slipped through an edge.",
        ),
        (
            "Cut paths",
            stats.cut_paths,
            "Paths that reached the largest number of events a path may have.",
        ),
        (
            "Below the horizon",
            stats.below_horizon,
            "Microfacet samples that point into the surface: no error, they carry no light.",
        ),
    ] {
        figure(ui, name, count.to_string(), doc);
    }
    let model = &workspace.model;
    for sample in stats.bad_samples().take(1) {
        if model.view != model.home {
            let doc = "The command that replays a sample takes the scene's own view.";
            figure(ui, "First error", sample.what, doc);
            continue;
        }
        let (scene, at) = (model.source.to_string(), workspace.sequence.at);
        let size = frame.full_size;
        let command = replay_command(&scene, at, size, &model.settings, &sample.id);
        let doc = format!("{}. Click to copy: {command}", sample.what);
        ui.label("First error");
        if ui
            .button("Copy replay command")
            .on_hover_text(doc)
            .clicked()
        {
            ui.ctx().copy_text(command);
        }
        ui.end_row();
    }
}

/// Memory by purpose; what takes none is left out.
fn memory(ui: &mut Ui, frame: &Frame, workspace: &Workspace) {
    let geometry = workspace.scene.as_ref().map(|scene| &scene.geometry);
    let tree = geometry.map_or(0, |g| g.tree_bytes());
    let all = geometry.map_or(0, |g| g.memory_bytes());
    let layers = frame
        .layers
        .iter()
        .map(|l| size_of_val(l.pixels.as_slice()));
    let shown = layers.sum::<usize>() + size_of_val(frame.differences.as_slice());
    for (name, size, doc) in [
        (
            "Surfaces",
            all - tree,
            "Corners, normals and lists of the scene.",
        ),
        (
            "Tree",
            tree,
            "The hierarchy of boxes that rays walk, with its triangles.",
        ),
        (
            "Sums",
            frame.memory.film,
            "Of all layers, in double precision.",
        ),
        (
            "Algorithm",
            frame.memory.integrator,
            "The pass under way, photon maps, caches.",
        ),
        (
            "Frame",
            shown,
            "The picture that is shown, all layers; there are up to three.",
        ),
        (
            "Graphics card",
            workspace.gpu_bytes as usize,
            "The layers that are shown and the picture made of them.",
        ),
    ] {
        if size > 0 {
            figure(ui, name, bytes(size), doc);
        }
    }
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
    match n {
        0..10_000 => format!("{n} bytes"),
        10_000..1_000_000 => format!("{:.0} kB", n as f64 / 1e3),
        _ => format!("{:.1} MB", n as f64 / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::plan::RenderPlan;

    #[test]
    fn times_are_readable() {
        assert_eq!(seconds(0.04), "0.0 s");
        assert_eq!(seconds(59.94), "59.9 s");
        assert_eq!(seconds(61.0), "1:01 min");
        assert_eq!(seconds(3660.0), "1:01 h");
    }

    #[test]
    fn half_the_error_takes_four_times_as_long() {
        let mut frame = Frame::empty(std::sync::Arc::new(RenderPlan::nothing()));
        assert_eq!(time_to(&frame, 0.01), "not known yet");
        frame.t_wall = 10.0;
        frame.relative_error = Some(0.02);
        assert_eq!(time_to(&frame, 0.01), "in about 30.0 s");
        assert_eq!(time_to(&frame, 0.02), "yes");
    }
}
