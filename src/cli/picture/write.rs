//! Writing what was rendered.

use super::output::{Format, Output};
use crate::cli::error::CliError;
use crate::cli::render::RenderOptions;
use crate::engine::film::Frame;
use crate::engine::film::tonemap::{NAN_COLOR, tonemap};
use crate::engine::io::atomic;
use crate::picture::{exr_file, hdr_file, origin, png_file};

/// What a file says about its origin.
pub struct Attributes(Vec<(String, String)>);

impl Attributes {
    /// Of a render.
    pub fn of(scene: &str, options: &RenderOptions, frame: &Frame) -> Self {
        Self(origin::texts(scene, &options.settings, frame))
    }
}

/// Writes a frame in place of what was there.
pub fn write(
    options: &RenderOptions,
    frame: &Frame,
    attributes: &Attributes,
) -> Result<(), CliError> {
    let Output { path, format } = &options.output;
    let bytes = match format {
        Format::Exr => exr(options, frame, attributes),
        Format::Png => png(options, frame, attributes),
        Format::Hdr => hdr_file::encode(frame.size, &frame.layers[0].pixels, &attributes.0)
            .map_err(|error| error.to_string()),
    };
    let bytes = bytes.map_err(|error| CliError::failed(format!("{}: {error}", path.display())))?;
    atomic::write(path, &bytes)
        .map_err(|error| CliError::failed(format!("{} cannot be written: {error}", path.display())))
}

/// All layers asked for, those that are zero too.
fn exr(options: &RenderOptions, frame: &Frame, attributes: &Attributes) -> Result<Vec<u8>, String> {
    let settings = &options.settings.layers;
    let components = crate::engine::path::COMPONENTS.len();
    let mut layers = Vec::new();
    for (i, layer) in frame.layers.iter().enumerate() {
        let wanted = match i {
            0 => !settings.no_whole,
            _ if i <= components => settings.components,
            _ => true,
        };
        if wanted {
            layers.push((layer.label.as_str(), layer.pixels.as_slice()));
        }
    }
    exr_file::encode(frame.size, &layers, &attributes.0).map_err(|error| error.to_string())
}

fn png(options: &RenderOptions, frame: &Frame, attributes: &Attributes) -> Result<Vec<u8>, String> {
    let shown = |rgb: &[f32; 3]| {
        if rgb.iter().any(|x| x.is_nan()) {
            NAN_COLOR
        } else {
            tonemap(options.tonemap, options.exposure, *rgb)
        }
    };
    let pixels: Vec<[u8; 3]> = frame.layers[0].pixels.iter().map(shown).collect();
    png_file::encode(frame.size, &pixels, &attributes.0).map_err(|error| error.to_string())
}
