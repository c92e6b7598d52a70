//! Arguments of `render`, checked.

use glam::UVec2;

use super::stop::Stop;
use crate::cli::args::RenderArgs;
use crate::cli::error::CliError;
use crate::cli::picture::{Format, Output};
use crate::cli::scene::parameters;
use crate::engine::film::ToneMap;
use crate::engine::path::{Expression, ExpressionError, PathClasses};
use crate::engine::plan::LayerSettings;
use crate::engine::session::Settings;

/// What to render and where to, as far as it does not depend on the scene.
pub struct RenderOptions {
    /// The file.
    pub output: Output,
    /// Algorithm, parameters, layers, seed.
    pub settings: Settings,
    /// When to stop.
    pub stop: Stop,
    /// Pixels, if not the scene's.
    pub size: Option<UVec2>,
    /// Threads; 0 is one a core.
    pub threads: usize,
    /// Stops.
    pub exposure: f32,
    /// Tone map.
    pub tonemap: ToneMap,
}

impl RenderOptions {
    /// Checks the arguments, and that the output can be written.
    pub fn new(args: &RenderArgs) -> Result<Self, CliError> {
        let (integrator, params) = parameters(&args.integrator, &args.set)?;
        let layers = layers(args)?;
        let output = Output::new(&args.output)?;
        let has_layers = layers.components || !layers.expressions.is_empty();
        if output.format != Format::Exr && (has_layers || layers.no_whole) {
            return Err(CliError::usage(format!(
                "{} holds one picture, but --components, --expression and --no-whole ask for \
                 layers; write an .exr file",
                output.path.display()
            )));
        }
        if layers.no_whole && !has_layers {
            return Err(CliError::usage(
                "--no-whole leaves nothing to render; add --components or --expression",
            ));
        }
        if layers.no_whole && args.reference.is_some() {
            return Err(CliError::usage(
                "--reference compares the whole picture, which --no-whole leaves out; drop one of \
                 them",
            ));
        }
        output.check_writable()?;
        Ok(Self {
            output,
            settings: Settings {
                integrator,
                params,
                layers,
                seed: args.seed,
            },
            stop: Stop::new(args.spp, args.seconds, args.error),
            size: args.size,
            threads: args.threads,
            exposure: args.exposure,
            tonemap: args.tonemap,
        })
    }
}

fn layers(args: &RenderArgs) -> Result<LayerSettings, CliError> {
    Ok(LayerSettings {
        expressions: expressions(&args.expression)?,
        components: args.components,
        no_whole: args.no_whole,
        max_depth: args.max_depth,
    })
}

/// Reads the expressions, alone and all together.
pub fn expressions(texts: &[String]) -> Result<Vec<Expression>, CliError> {
    let mut expressions = Vec::new();
    for text in texts {
        let expression: Expression = text
            .parse()
            .map_err(|error: ExpressionError| CliError::usage(error.to_string()))?;
        expressions.push(expression);
    }
    PathClasses::with_components(&expressions)
        .map_err(|error| CliError::usage(error.to_string()))?;
    Ok(expressions)
}
