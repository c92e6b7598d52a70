//! `render --pyramid N`: the pictures of all strategies of bidirectional path tracing.

use glam::UVec2;

use super::{RenderOptions, thread_pool};
use crate::cli::args::RenderArgs;
use crate::cli::error::CliError;
use crate::cli::picture::Format;
use crate::cli::print::note;
use crate::cli::scene;
use crate::engine::film::tonemap::{NAN_COLOR, tonemap};
use crate::engine::integrators::pyramid::{TechniqueImage, pyramid, sheet};
use crate::engine::integrators::{Cancel, Pass, bdpt};
use crate::engine::io::atomic;
use crate::engine::session::RenderJob;
use crate::picture::{exr_file, png_file};

/// Samples per pixel without --spp.
const PASSES: u64 = 64;

/// Runs the command; `most` is the number of vertices of the longest paths.
pub fn run(
    args: &RenderArgs,
    options: &RenderOptions,
    most: u64,
    cancel: &Cancel,
) -> Result<(), CliError> {
    if options.settings.integrator.id != bdpt::ENTRY.id {
        return Err(CliError::usage(
            "--pyramid shows the strategies of bidirectional path tracing; add --integrator bdpt",
        ));
    }
    let layers = &options.settings.layers;
    let has_layers = layers.components || layers.no_whole || !layers.expressions.is_empty();
    let stops = args.seconds.is_some() || args.error.is_some();
    if has_layers || stops || args.log.is_some() || args.reference.is_some() || args.json {
        return Err(CliError::usage(
            "--pyramid goes with --spp, --size, --set, --max-depth, --seed and --threads only",
        ));
    }
    let desc = scene::read(&args.scene)?;
    let size = options
        .size
        .unwrap_or(UVec2::new(desc.camera.width, desc.camera.height));
    let (scene, camera) = scene::build(&desc, size)?;
    let job = RenderJob {
        scene,
        camera,
        size,
        settings: options.settings.clone(),
        navigating: false,
    };
    let plan = scene::plan(&job)?;
    let pass = Pass {
        scene: &job.scene,
        camera: &job.camera,
        plan: &plan,
        seed: job.settings.seed,
        index: 0,
        cancel,
    };
    let passes = args.spp.unwrap_or(PASSES);
    let pool = thread_pool(options.threads)?;
    let made = pool.install(|| pyramid(&pass, &job.settings.params, passes, most as usize));
    let images = made.map_err(|_| CliError::failed("stopped; nothing was written"))?;
    write(options, size, &images)
}

fn write(options: &RenderOptions, size: UVec2, images: &[TechniqueImage]) -> Result<(), CliError> {
    let path = &options.output.path;
    let bytes = match options.output.format {
        Format::Exr => {
            let named: Vec<(String, &[[f32; 3]])> = images
                .iter()
                .flat_map(|i| {
                    let of = format!("s{}.t{}", i.technique.s, i.technique.t);
                    [
                        (format!("weighted.{of}"), i.weighted.as_slice()),
                        (format!("unweighted.{of}"), i.unweighted.as_slice()),
                    ]
                })
                .collect();
            let layers: Vec<_> = named.iter().map(|(n, p)| (n.as_str(), *p)).collect();
            exr_file::encode(size, &layers, &[]).map_err(|error| error.to_string())
        }
        Format::Png => {
            let (size, pixels) = sheet(images, size);
            let shown = |rgb: &[f32; 3]| {
                if rgb.iter().any(|x| x.is_nan()) {
                    NAN_COLOR
                } else {
                    tonemap(options.tonemap, options.exposure, *rgb)
                }
            };
            let pixels: Vec<[u8; 3]> = pixels.iter().map(shown).collect();
            png_file::encode(size, &pixels, &[]).map_err(|error| error.to_string())
        }
        Format::Hdr => Err("a pyramid is written as .exr or .png".to_owned()),
    };
    let bytes = bytes.map_err(|error| CliError::failed(format!("{}: {error}", path.display())))?;
    atomic::write(path, &bytes).map_err(|error| {
        CliError::failed(format!("{} cannot be written: {error}", path.display()))
    })?;
    note!("wrote {}", path.display());
    Ok(())
}
