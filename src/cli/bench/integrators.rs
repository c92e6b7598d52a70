//! Equal time: the error of every integrator on every scene after so many seconds.

use std::path::Path;

use serde::Serialize;

use crate::cli::args::BenchIntegratorsArgs;
use crate::cli::error::CliError;
use crate::cli::picture::{self, WHOLE};
use crate::cli::print::{self, figure};
use crate::cli::{render, scene};
use crate::engine::integrators::{Cancel, Entry, Params, REGISTRY};
use crate::engine::measure::Metrics;
use crate::engine::plan::LayerSettings;
use crate::engine::session::{RenderClock, RenderJob, Renderer, Settings};

#[derive(Serialize)]
struct Row {
    scene: String,
    integrator: &'static str,
    layer: String,
    seconds: f64,
    t_wall: f64,
    t_cpu: f64,
    spp: u64,
    relmse: f64,
    /// Mean of the picture over that of the reference: what is far from 1 is missing or blurred.
    brightness: f64,
}

/// A pass that takes longer than this share of the time is marked.
const LATE: f64 = 1.25;

/// Runs the command.
pub fn run(args: &BenchIntegratorsArgs) -> Result<(), CliError> {
    let entries = chosen(&args.integrators)?;
    let pool = render::thread_pool(args.threads)?;
    let mut rows = Vec::new();
    for scene in &args.scenes {
        for &entry in &entries {
            eprintln!("{scene}: {}, {} s", entry.id, args.seconds);
            rows.push(pool.install(|| measure(scene, entry, args))?);
        }
    }
    if args.json {
        return print::json(&rows);
    }
    table(args, &rows, &entries)
}

/// The integrators of these ids; all of them without any.
fn chosen(ids: &[String]) -> Result<Vec<&'static Entry>, CliError> {
    if ids.is_empty() {
        return Ok(REGISTRY.iter().collect());
    }
    let find = |id: &String| scene::parameters(id, &[]).map(|(entry, _)| entry);
    ids.iter().map(find).collect()
}

fn measure(
    what: &str,
    entry: &'static Entry,
    args: &BenchIntegratorsArgs,
) -> Result<Row, CliError> {
    // SCENE=REFERENCE, or a folder that holds both.
    let (desc, reference) = match what.split_once('=') {
        Some((scene, reference)) => (scene::read(scene)?, Path::new(reference)),
        None => {
            let folder = Path::new(what);
            (scene::read_file(&folder.join("scene.json"))?, folder)
        }
    };
    let reference = picture::read_reference(reference)?;
    let layer = reference.layers.iter().find(|l| l.label == args.layer);
    let Some(layer) = layer else {
        let (what, layer) = (what, &args.layer);
        return Err(CliError::usage(format!(
            "{what}: the reference has no layer \"{layer}\""
        )));
    };
    let clock = RenderClock::start();
    let (scene, camera) = scene::build(&desc, reference.size)?;
    let job = RenderJob {
        scene,
        camera,
        size: reference.size,
        settings: Settings {
            integrator: entry,
            params: Params::defaults(entry.params),
            layers: LayerSettings {
                components: args.layer != WHOLE,
                ..LayerSettings::default()
            },
            seed: 0,
        },
        navigating: false,
    };
    let plan = scene::plan(&job)?;
    let mut renderer = Renderer::with_plan(&job, plan, clock);
    while renderer.clock().wall() < args.seconds {
        // Nobody cancels this render.
        let _ = renderer.render_pass(&Cancel::never());
    }
    renderer.clock().pause();
    let frame = renderer.frame();
    let own = frame.layers.iter().find(|l| l.label == args.layer);
    let metrics = own.and_then(|own| Metrics::new(&own.pixels, &layer.pixels));
    let (Some(metrics), Some(own)) = (metrics, own) else {
        return Err(CliError::usage(format!(
            "{what}: the reference has no finite pixels"
        )));
    };
    let mean = |pixels: &[[f32; 3]]| pixels.iter().flatten().map(|x| f64::from(*x)).sum::<f64>();
    Ok(Row {
        scene: job.scene.name.clone(),
        integrator: entry.id,
        layer: args.layer.clone(),
        seconds: args.seconds,
        t_wall: frame.t_wall,
        t_cpu: frame.t_cpu,
        spp: frame.passes,
        relmse: metrics.relmse,
        brightness: mean(&own.pixels) / mean(&layer.pixels),
    })
}

/// A line an integrator, a column a scene.
fn table(
    args: &BenchIntegratorsArgs,
    rows: &[Row],
    entries: &[&'static Entry],
) -> Result<(), CliError> {
    let scenes: Vec<&[Row]> = rows.chunks(entries.len()).collect();
    print::line(&format!(
        "relMSE of the {} after {} s (in brackets: mean over the reference's)",
        args.layer, args.seconds
    ))?;
    let width = |rows: &[Row]| rows[0].scene.chars().count().max(16);
    let names = scenes.iter().map(|rows| {
        let (name, width) = (&rows[0].scene, width(rows));
        format!("{name:>width$}")
    });
    let names: Vec<String> = names.collect();
    print::line(&format!("{:12} {}", "", names.join("  ")))?;
    let mut late = false;
    for (i, entry) in entries.iter().enumerate() {
        let cells = scenes.iter().map(|rows| {
            let (r, width) = (&rows[i], width(rows));
            let is_late = r.t_wall > LATE * args.seconds;
            late |= is_late;
            let mark = if is_late { "*" } else { "" };
            let cell = format!("{} ({:.2}){mark}", figure(r.relmse), r.brightness);
            format!("{cell:>width$}")
        });
        let cells: Vec<String> = cells.collect();
        print::line(&format!("{:12} {}", entry.id, cells.join("  ")))?;
    }
    if late {
        print::line("* its last pass ended late; --json tells when")?;
    }
    Ok(())
}
