//! `lightscope replay`: one sample again, step by step.

mod steps;

use glam::UVec2;
use serde_json::{Map, Value, json};

use super::args::ReplayArgs;
use super::error::CliError;
use super::print;
use super::render::expressions;
use super::scene;
use steps::Naming;

use crate::engine::integrators::{Cancel, Recording, ReplayError, SampleId};
use crate::engine::math::{Fault, Rgb};
use crate::engine::plan::LayerSettings;
use crate::engine::session::{RenderJob, Renderer, Settings};

/// Runs the command.
pub fn run(args: &ReplayArgs) -> Result<(), CliError> {
    let (integrator, params) = scene::parameters(&args.integrator, &args.set)?;
    let sample = sample(args)?;
    let layers = LayerSettings {
        expressions: expressions(&args.expression)?,
        components: true,
        no_whole: args.no_whole,
        max_depth: args.max_depth,
    };
    let desc = scene::read_frame(&args.scene, args.frame)?;
    let own = UVec2::new(desc.camera.width, desc.camera.height);
    let size = args.size.unwrap_or(own);
    let (prepared, camera) = scene::build(&desc, size)?;
    let job = RenderJob {
        scene: prepared,
        camera,
        size,
        settings: Settings {
            integrator,
            params,
            layers,
            seed: args.seed,
        },
        navigating: false,
    };
    scene::plan(&job)?;
    let mut renderer = Renderer::new(&job).map_err(|error| CliError::usage(error.to_string()))?;
    let mut recording = Recording::default();
    match renderer.replay(&sample, &Cancel::never(), &mut recording) {
        Err(ReplayError::Cannot(why)) => {
            let id = integrator.id;
            return Err(CliError::usage(format!("{id} cannot replay this: {why}")));
        }
        Err(ReplayError::Cancelled) => return Err(CliError::failed("it was stopped")),
        Ok(()) => {}
    }
    let naming = Naming {
        scene: &job.scene,
        plan: renderer.plan(),
    };
    if args.json {
        print::json(&as_json(&job, &sample, &recording, &naming))
    } else {
        print_text(&job, &sample, &recording, &naming)
    }
}

/// The sample that the arguments name.
pub fn sample(args: &ReplayArgs) -> Result<SampleId, CliError> {
    SampleId::parse(&args.stream, &args.index).map_err(CliError::Usage)
}

/// What is wrong with the light that the sample brought.
fn faults(recording: &Recording) -> Vec<&'static str> {
    let splats = recording.splats().map(|(_, radiance)| radiance);
    let all = std::iter::once(recording.radiance()).chain(splats);
    let mut names: Vec<&str> = all.filter_map(Fault::of).map(Fault::name).collect();
    names.dedup();
    names
}

fn as_json(
    job: &RenderJob,
    sample: &SampleId,
    recording: &Recording,
    naming: &Naming<'_>,
) -> Value {
    let steps: Vec<Value> = recording
        .steps
        .iter()
        .map(|step| {
            let (name, fields) = naming.row(step);
            let mut object = Map::new();
            object.insert("step".to_owned(), name.into());
            object.extend(
                fields
                    .into_iter()
                    .map(|(key, value)| (key.to_owned(), value)),
            );
            Value::Object(object)
        })
        .collect();
    json!({
        "scene": job.scene.name,
        "integrator": job.settings.integrator.id,
        "parameters": scene::parameter_text(&job.settings.params),
        "seed": job.settings.seed,
        "size": [job.size.x, job.size.y],
        "stream": sample.stream_name(),
        "index": sample.to_string(),
        "steps": steps,
        "radiance": steps::color(recording.radiance()),
        "faults": faults(recording),
    })
}

fn print_text(
    job: &RenderJob,
    sample: &SampleId,
    recording: &Recording,
    naming: &Naming<'_>,
) -> Result<(), CliError> {
    let settings = &job.settings;
    let mut text = format!(
        "{}: {}x{}, {} ({}), seed {}, {} {sample}\n",
        job.scene.name,
        job.size.x,
        job.size.y,
        settings.integrator.id,
        scene::parameter_text(&settings.params),
        settings.seed,
        sample.stream_name(),
    );
    for step in &recording.steps {
        let (name, fields) = naming.row(step);
        let fields = fields.iter().filter(|(_, value)| !value.is_null());
        let fields: Vec<String> = fields
            .map(|(key, value)| match *key {
                "why" => steps::plain(value),
                _ => format!("{key} {}", steps::plain(value)),
            })
            .collect();
        // What happens at a vertex stands under it.
        let indent = match name {
            "lens" | "emission" | "vertex" | "escaped" | "ended" => "",
            _ => "  ",
        };
        text += &format!("{indent}{name}: {}\n", fields.join(", "));
    }
    let own = recording.radiance();
    let splats: Rgb = recording.splats().map(|(_, radiance)| radiance).sum();
    text += &format!(
        "radiance of its pixel: {}",
        steps::plain(&steps::color(own))
    );
    if recording.splats().next().is_some() {
        let sum = steps::plain(&steps::color(splats));
        text += &format!("\nto places of its own choice: {sum}");
    }
    for fault in faults(recording) {
        text += &format!("\nfault: {fault}");
    }
    print::line(&text)
}
