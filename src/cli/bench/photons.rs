//! Photon maps of several sizes.

use glam::UVec2;
use serde::Serialize;

use crate::cli::args::BenchPhotonsArgs;
use crate::cli::bench_photons::{self, MapFigures};
use crate::cli::error::CliError;
use crate::cli::print::note;
use crate::cli::print::{self, bytes, figure};
use crate::cli::scene;

#[derive(Serialize)]
struct Figures {
    scene: String,
    nearest: u64,
    queries: usize,
    maps: Vec<MapFigures>,
    /// Largest memory of the process so far, where the system tells.
    peak_bytes: Option<usize>,
}

/// Runs the command.
pub fn run(args: &BenchPhotonsArgs) -> Result<(), CliError> {
    let desc = scene::read(&args.scene)?;
    let size = UVec2::new(desc.camera.width, desc.camera.height);
    let (scene, camera) = scene::build(&desc, size)?;
    let points = bench_photons::eye_points(&scene, &camera, args.queries as usize);
    if points.is_empty() {
        return Err(CliError::usage(
            "no ray of the scene's own view lands on anything".to_owned(),
        ));
    }
    let mut maps = Vec::new();
    for photons in &args.photons {
        note!("{photons} photons");
        let timed = bench_photons::build(&scene, *photons as usize);
        maps.push(bench_photons::queries(
            &timed,
            &scene,
            &points,
            args.nearest as usize,
        ));
    }
    let f = Figures {
        scene: desc.name,
        nearest: args.nearest,
        queries: points.len(),
        maps,
        peak_bytes: peak_bytes(),
    };
    if args.json {
        return print::json(&f);
    }
    print::line(&format!(
        "{}: {} nearest photons at {} points where eye rays land, one thread",
        f.scene, f.nearest, f.queries
    ))?;
    for m in &f.maps {
        print::line(&format!(
            "{} photons, {}: traced in {} s, sorted in {} s, {} queries/s, filtered {} queries/s",
            m.photons,
            bytes(m.bytes),
            figure(m.trace_seconds),
            figure(m.build_seconds),
            figure(m.queries_per_second),
            figure(m.filtered_per_second)
        ))?;
    }
    match f.peak_bytes {
        Some(peak) => print::line(&format!("largest memory of the process: {}", bytes(peak))),
        None => Ok(()),
    }
}

/// Linux tells the largest resident set in /proc; other systems are not asked.
fn peak_bytes() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kibibytes: usize = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kibibytes)
}
