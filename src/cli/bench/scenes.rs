//! Error against time on scenes with references, on one thread. Times are process time, so that
//! other work on the machine does not count.

use std::path::Path;

use serde::Serialize;

use crate::cli::args::BenchScenesArgs;
use crate::cli::error::CliError;
use crate::cli::print::note;
use crate::cli::print::{self, figure};
use crate::cli::{picture, render, scene};
use crate::engine::integrators::Cancel;
use crate::engine::measure::Metrics;
use crate::engine::plan::LayerSettings;
use crate::engine::session::{RenderClock, RenderJob, Renderer, Settings};

#[derive(Serialize)]
struct Row {
    scene: String,
    integrator: &'static str,
    t_wall: f64,
    t_cpu: f64,
    spp: u64,
    mrays_per_second: f64,
    samples_per_second: f64,
    relmse: f64,
    /// 1000 · relMSE · t_cpu: smaller is better.
    k: f64,
}

/// Runs the command.
pub fn run(args: &BenchScenesArgs) -> Result<(), CliError> {
    let (integrator, params) = scene::parameters(&args.integrator, &args.set)?;
    let settings = Settings {
        integrator,
        params,
        layers: LayerSettings::default(),
        seed: 0,
    };
    let pool = render::thread_pool(1)?;
    let mut rows = Vec::new();
    for folder in &args.folders {
        note!("{}: {} s of process time", folder.display(), args.seconds);
        rows.push(pool.install(|| measure(folder, &settings, args.seconds))?);
    }
    if args.json {
        print::json(&rows)
    } else {
        table(&rows)
    }
}

fn measure(folder: &Path, settings: &Settings, seconds: f64) -> Result<Row, CliError> {
    let reference = picture::read_reference(folder)?;
    let desc = scene::read_file(&folder.join("scene.json"))?;
    let clock = RenderClock::start();
    let (scene, camera) = scene::build(&desc, reference.size)?;
    let size = reference.size;
    let job = RenderJob {
        scene,
        camera,
        size,
        settings: settings.clone(),
        navigating: false,
    };
    let plan = scene::plan(&job)?;
    let mut renderer = Renderer::with_plan(&job, plan, clock);
    while renderer.clock().cpu() < seconds {
        // Nobody cancels this render.
        let _ = renderer.render_pass(&Cancel::never());
    }
    renderer.clock().pause();
    let frame = renderer.frame();
    let metrics = reference
        .whole()
        .and_then(|r| Metrics::new(&frame.layers[0].pixels, &r.pixels));
    let Some(metrics) = metrics else {
        let folder = folder.display();
        return Err(CliError::usage(format!(
            "{folder}: the reference has no finite pixels"
        )));
    };
    Ok(Row {
        scene: job.scene.name.clone(),
        integrator: settings.integrator.id,
        t_wall: frame.t_wall,
        t_cpu: frame.t_cpu,
        spp: frame.passes,
        mrays_per_second: frame.stats.rays as f64 / frame.t_cpu * 1e-6,
        samples_per_second: frame.stats.samples as f64 / frame.t_cpu,
        relmse: metrics.relmse,
        k: 1000.0 * metrics.relmse * frame.t_cpu,
    })
}

fn table(rows: &[Row]) -> Result<(), CliError> {
    let width = rows
        .iter()
        .map(|row| row.scene.chars().count())
        .max()
        .unwrap_or(0)
        .max(5);
    let line = |scene: &str, cells: [&str; 6]| {
        let cells = cells.map(|cell| format!("{cell:>10}")).join(" ");
        print::line(&format!("{scene:width$} {cells}"))
    };
    line(
        "scene",
        ["t_cpu", "spp", "Mrays/s", "samples/s", "relMSE", "K"],
    )?;
    for r in rows {
        let figures = [r.mrays_per_second, r.samples_per_second, r.relmse, r.k].map(figure);
        let [rays, samples, relmse, k] = &figures;
        line(
            &r.scene,
            [
                &figure(r.t_cpu),
                &r.spp.to_string(),
                rays,
                samples,
                relmse,
                k,
            ],
        )?;
    }
    Ok(())
}
