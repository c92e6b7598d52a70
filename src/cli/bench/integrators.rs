//! Equal time: the error of every integrator on every scene after so many seconds.

use std::path::Path;

use serde::Serialize;

use super::integrators_table as table;
use crate::cli::args::BenchIntegratorsArgs;
use crate::cli::error::CliError;
use crate::cli::picture::{self, Picture, WHOLE};
use crate::cli::print::note;
use crate::cli::{print, render, scene};
use crate::engine::integrators::photon::{self, PhotonSettings, noise_and_bias};
use crate::engine::integrators::{Cancel, Entry, Params, Pass, REGISTRY};
use crate::engine::measure::{Metrics, RELMSE_FLOOR};
use crate::engine::path::Expression;
use crate::engine::plan::LayerSettings;
use crate::engine::scene::SceneDesc;
use crate::engine::session::{RenderClock, RenderJob, Renderer, Settings};

/// One render after so many seconds.
#[derive(Serialize)]
pub struct Row {
    pub scene: String,
    pub integrator: &'static str,
    pub layer: String,
    pub seconds: f64,
    pub t_wall: f64,
    pub t_cpu: f64,
    pub spp: u64,
    pub relmse: f64,
    /// 1000 · relMSE · t_cpu: smaller is better.
    pub k: f64,
    /// Mean of the picture over that of the reference: what is far from 1 is missing or blurred.
    pub brightness: f64,
    /// relMSE that the bias alone would cause, as photon mapping reports it of itself: up to
    /// (5/4)² times too much where light is smooth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reported_bias: Option<f64>,
}

/// What is compared.
struct Layer {
    /// A label, or the text of the expression.
    key: String,
    settings: LayerSettings,
    /// Its place in a frame.
    index: usize,
}

/// Runs the command.
pub fn run(args: &BenchIntegratorsArgs) -> Result<(), CliError> {
    let runs = chosen(args)?;
    let layer = layer(args)?;
    let mut seconds = args.seconds.clone();
    seconds.sort_by(f64::total_cmp);
    let targets: Result<Vec<_>, CliError> = args
        .scenes
        .iter()
        .map(|s| Target::read(s, &layer))
        .collect();
    let pool = render::thread_pool(args.threads)?;
    let mut rows = Vec::new();
    for target in &targets? {
        for (entry, params) in &runs {
            let last = seconds.last().copied().unwrap_or_default();
            note!("{}: {}, {last} s", target.desc.name, entry.id);
            let job = (*entry, params, &layer, seconds.as_slice());
            rows.extend(pool.install(|| target.measure(job, args.bias_maps))?);
        }
    }
    if args.json {
        return print::json(&rows);
    }
    let ids: Vec<&str> = runs.iter().map(|(entry, _)| entry.id).collect();
    table::print(&rows, &ids, &seconds, args.efficiency)
}

/// The integrators of these ids, all of them without any, and their parameters.
fn chosen(args: &BenchIntegratorsArgs) -> Result<Vec<(&'static Entry, Params)>, CliError> {
    let mut ids: Vec<&str> = args.integrators.iter().map(String::as_str).collect();
    if ids.is_empty() {
        ids = REGISTRY.iter().map(|entry| entry.id).collect();
    }
    for set in &args.set {
        let owner = set.split_once('.').map_or("", |(id, _)| id);
        if !ids.contains(&owner) {
            return Err(CliError::usage(format!(
                "--set {set} belongs to none of {}; write --set ID.NAME=VALUE, such as --set \
                 photon.nearest=100",
                ids.join(", ")
            )));
        }
    }
    let of = |id: &&str| {
        let own = |set: &String| Some(set.strip_prefix(*id)?.strip_prefix('.')?.to_owned());
        let sets: Vec<String> = args.set.iter().filter_map(own).collect();
        scene::parameters(id, &sets)
    };
    ids.iter().map(of).collect()
}

fn layer(args: &BenchIntegratorsArgs) -> Result<Layer, CliError> {
    let mut settings = LayerSettings::default();
    let Some(text) = &args.expression else {
        let index = crate::picture::labels().position(|label| label == args.layer);
        let Some(index) = index else {
            let known: Vec<&str> = crate::picture::labels().collect();
            return Err(CliError::usage(format!(
                "there is no layer \"{}\"; there are {}",
                args.layer,
                known.join(", ")
            )));
        };
        settings.components = args.layer != WHOLE;
        return Ok(Layer {
            key: args.layer.clone(),
            settings,
            index,
        });
    };
    let expression: Expression = text
        .parse()
        .map_err(|error| CliError::usage(format!("--expression {text}: {error}")))?;
    settings.expressions = vec![expression];
    settings.components = false;
    settings.no_whole = true;
    // After the whole and the components.
    Ok(Layer {
        key: text.clone(),
        settings,
        index: crate::picture::labels().count(),
    })
}

/// A scene and what its picture should be.
struct Target {
    desc: SceneDesc,
    reference: Picture,
    /// Its layer that is compared.
    layer: usize,
}

/// An integrator, its parameters, what is compared, and when.
type Job<'a> = (&'static Entry, &'a Params, &'a Layer, &'a [f64]);

impl Target {
    /// `what` is SCENE=REFERENCE, or a folder that holds both.
    fn read(what: &str, layer: &Layer) -> Result<Self, CliError> {
        let (desc, reference) = match what.split_once('=') {
            Some((scene, reference)) => (scene::read(scene)?, Path::new(reference)),
            None => {
                let folder = Path::new(what);
                (scene::read_file(&folder.join("scene.json"))?, folder)
            }
        };
        let reference = picture::read_reference(reference)?;
        let found = reference.layers.iter().position(|l| l.key() == layer.key);
        let Some(layer) = found else {
            return Err(CliError::usage(format!(
                "{what}: the reference has no layer \"{}\"",
                layer.key
            )));
        };
        Ok(Self {
            desc,
            reference,
            layer,
        })
    }

    fn measure(
        &self,
        (entry, params, layer, seconds): Job<'_>,
        bias_maps: u32,
    ) -> Result<Vec<Row>, CliError> {
        let clock = RenderClock::start();
        let (scene, camera) = scene::build(&self.desc, self.reference.size)?;
        let job = RenderJob {
            scene,
            camera,
            size: self.reference.size,
            settings: Settings {
                integrator: entry,
                params: params.clone(),
                layers: layer.settings.clone(),
                seed: 0,
            },
            navigating: false,
        };
        let plan = scene::plan(&job)?;
        let mut renderer = Renderer::with_plan(&job, plan, clock);
        let mut rows = Vec::new();
        for &seconds in seconds {
            while renderer.clock().wall() < seconds {
                // Nobody cancels this render.
                let _ = renderer.render_pass(&Cancel::never());
            }
            renderer.clock().pause();
            rows.push(self.row(&renderer, entry, layer, seconds)?);
            renderer.clock().resume();
        }
        if bias_maps > 0 && entry.id == photon::ENTRY.id {
            let bias = self.reported_bias(&job, layer, bias_maps)?;
            rows.iter_mut().for_each(|r| r.reported_bias = Some(bias));
        }
        Ok(rows)
    }

    fn row(
        &self,
        renderer: &Renderer,
        entry: &Entry,
        layer: &Layer,
        seconds: f64,
    ) -> Result<Row, CliError> {
        let frame = renderer.frame();
        let exact = &self.reference.layers[self.layer].pixels;
        let own = frame.layers[layer.index].pixels.as_slice();
        let Some(metrics) = Metrics::new(own, exact) else {
            return Err(CliError::usage(format!(
                "{}: the reference has no finite pixels",
                self.desc.name
            )));
        };
        let sum = |pixels: &[[f32; 3]]| pixels.iter().flatten().map(|x| f64::from(*x)).sum::<f64>();
        Ok(Row {
            scene: self.desc.name.clone(),
            integrator: entry.id,
            layer: layer.key.clone(),
            seconds,
            t_wall: frame.t_wall,
            t_cpu: frame.t_cpu,
            spp: frame.passes,
            relmse: metrics.relmse,
            k: 1000.0 * metrics.relmse * frame.t_cpu,
            brightness: sum(own) / sum(exact),
            reported_bias: None,
        })
    }

    /// relMSE of a picture that errs by nothing but the bias that `maps` independent maps report.
    fn reported_bias(&self, job: &RenderJob, layer: &Layer, maps: u32) -> Result<f64, CliError> {
        let plan = scene::plan(job)?;
        let (camera, cancel) = (job.camera.with_size(job.size), Cancel::never());
        let pass = Pass {
            scene: &job.scene,
            camera: &camera,
            plan: &plan,
            seed: job.settings.seed,
            index: 0,
            cancel: &cancel,
        };
        let settings = PhotonSettings::new(&job.settings.params);
        let Ok((found, _)) = noise_and_bias(&pass, &settings, maps) else {
            return Err(CliError::failed("the measurement was cancelled".to_owned()));
        };
        let found = &found[layer.index];
        let exact = self.reference.layers[self.layer].pixels.iter().flatten();
        let (biases, errors) = (
            found.bias.iter().flatten(),
            found.bias_error.iter().flatten(),
        );
        let mut sum = 0.0;
        for ((bias, error), exact) in biases.zip(errors).zip(exact) {
            let [b, e, r] = [*bias, *error, *exact].map(f64::from);
            // What the report's own error adds is taken off.
            sum += (b * b - e * e) / (r * r + RELMSE_FLOOR);
        }
        Ok((sum / found.bias.len().max(1) as f64 / 3.0).max(0.0))
    }
}
