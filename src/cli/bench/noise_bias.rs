//! Noise and bias of photon mapping, layer by layer, without a reference.

use serde::Serialize;

use crate::cli::args::BenchNoiseBiasArgs;
use crate::cli::error::CliError;
use crate::cli::print::{self, figure};
use crate::cli::{render, scene};
use crate::engine::integrators::photon::{PhotonSettings, noise_and_bias};
use crate::engine::integrators::{Cancel, Pass};
use crate::engine::plan::{LayerSettings, RenderPlan};

#[derive(Serialize)]
struct Row {
    layer: String,
    mean: f64,
    /// Root mean square over pixels and channels of the spread between maps.
    rms_noise: f64,
    mean_bias: f64,
    rms_bias: f64,
}

/// Runs the command.
pub fn run(args: &BenchNoiseBiasArgs) -> Result<(), CliError> {
    let (_, params) = scene::parameters("photon", &args.set)?;
    let settings = PhotonSettings::new(&params);
    let desc = scene::read(&args.scene)?;
    let size = glam::UVec2::new(desc.camera.width, desc.camera.height);
    let (scene, camera) = scene::build(&desc, size)?;
    let layers = LayerSettings {
        components: true,
        ..LayerSettings::default()
    };
    let plan = RenderPlan::new(&scene, camera.has_lens(), &layers)
        .map_err(|error| CliError::usage(error.to_string()))?;
    let cancel = Cancel::never();
    let pass = Pass {
        scene: &scene,
        camera: &camera,
        plan: &plan,
        seed: 0,
        index: 0,
        cancel: &cancel,
    };
    let maps = u32::try_from(args.maps).unwrap_or(u32::MAX);
    let pool = render::thread_pool(args.threads)?;
    let measured = pool.install(|| noise_and_bias(&pass, &settings, maps));
    let Ok((found, _)) = measured else {
        return Err(CliError::failed("the measurement was cancelled".to_owned()));
    };
    let labels = std::iter::once("whole").chain(plan.labels.iter().map(String::as_str));
    let rows = labels.zip(&found).map(|(layer, n)| Row {
        layer: layer.to_owned(),
        mean: n.mean_radiance(),
        rms_noise: n.rms_noise(),
        mean_bias: n.mean_bias(),
        rms_bias: n.rms_bias(),
    });
    let rows: Vec<Row> = rows.collect();
    if args.json {
        return print::json(&rows);
    }
    print::line(&format!(
        "{}: {maps} independent maps, each read over two radii\n\
         layer            mean  rms noise  mean bias   rms bias",
        desc.name
    ))?;
    for r in &rows {
        let cells = [r.mean, r.rms_noise, r.mean_bias, r.rms_bias].map(figure);
        let cells = cells.map(|cell| format!("{cell:>10}")).join(" ");
        print::line(&format!("{:10} {cells}", r.layer))?;
    }
    Ok(())
}
