//! Reading pictures and references.

use std::io::BufReader;
use std::path::{Path, PathBuf};

use glam::UVec2;

use super::output::{Format, folder};
use super::{Layer, Picture, WHOLE};
use crate::cli::error::CliError;
use crate::engine::io::image::{self, Encoding};
use crate::picture::{exr_file, hdr_file, labels, png_file};

/// Reads a picture file.
pub fn read(path: &Path) -> Result<Picture, CliError> {
    let shown = path.display();
    if !path.exists() {
        return Err(CliError::usage(format!("there is no file {shown}")));
    }
    match Format::of(path) {
        Some(Format::Exr) => exr_file::read(path)
            .map_err(|error| CliError::usage(format!("{shown} cannot be read: {error}"))),
        Some(Format::Png) => flat(path, Encoding::Srgb),
        Some(Format::Hdr) => flat(path, Encoding::Linear),
        None => Err(CliError::usage(format!(
            "{shown} is no picture that can be read; its name must end in .exr, .png or .hdr"
        ))),
    }
}

fn flat(path: &Path, encoding: Encoding) -> Result<Picture, CliError> {
    let image = image::read(path, encoding).map_err(|error| CliError::usage(error.to_string()))?;
    Ok(Picture {
        size: UVec2::new(image.width as u32, image.height as u32),
        layers: vec![Layer {
            label: WHOLE.to_owned(),
            expression: None,
            pixels: image.pixels,
        }],
        standard_errors: Vec::new(),
        attributes: texts(path),
    })
}

/// What the file says about its origin.
fn texts(path: &Path) -> Vec<(String, String)> {
    // The file was read a moment ago; what has gone since then says nothing.
    let Ok(file) = std::fs::File::open(path).map(BufReader::new) else {
        return Vec::new();
    };
    let mut texts = match Format::of(path) {
        Some(Format::Png) => png_file::read_texts(file),
        Some(Format::Hdr) => hdr_file::read_texts(file),
        _ => Vec::new(),
    };
    texts.sort();
    texts
}

/// Reads a reference: a picture, or `ref.exr` in a folder together with what lies beside it. Standard errors are in files of their own (`ref_se.exr`, `direct_se.exr` …) or all in one.
pub fn read_reference(path: &Path) -> Result<Picture, CliError> {
    let main = if path.is_dir() {
        path.join("ref.exr")
    } else {
        path.to_owned()
    };
    let mut picture = read(&main)?;
    if main.file_name().is_some_and(|name| name == "ref.exr") {
        read_beside(folder(&main), &mut picture)?;
    }
    let beside = error_image_path(&main);
    if picture.standard_errors.is_empty() && beside.exists() {
        let errors = read(&beside)?;
        if errors.size == picture.size {
            picture.standard_errors = errors.layers;
        }
    }
    Ok(picture)
}

/// The file of standard errors beside a reference: `NAME_se.exr` beside `NAME.exr`.
pub fn error_image_path(reference: &Path) -> PathBuf {
    let stem = reference.file_stem().unwrap_or_default().to_string_lossy();
    reference.with_file_name(format!("{stem}_se.exr"))
}

/// Adds the components and the standard errors that lie in the folder as files of their own.
fn read_beside(folder: &Path, picture: &mut Picture) -> Result<(), CliError> {
    for label in labels() {
        let stem = if label == WHOLE { "ref" } else { label };
        if label != WHOLE {
            let layer = one_layer(&folder.join(format!("{stem}.exr")), label, picture.size)?;
            picture.layers.extend(layer);
        }
        let se = one_layer(&folder.join(format!("{stem}_se.exr")), label, picture.size)?;
        picture.standard_errors.extend(se);
    }
    Ok(())
}

/// The whole of a file under another label; nothing if there is no such file.
fn one_layer(path: &Path, label: &str, size: UVec2) -> Result<Option<Layer>, CliError> {
    if !path.exists() {
        return Ok(None);
    }
    let picture = read(path)?;
    if picture.size != size {
        return Err(CliError::usage(format!(
            "{} has another size than the ref.exr beside it",
            path.display()
        )));
    }
    let whole = picture
        .layers
        .into_iter()
        .find(|layer| layer.label == WHOLE);
    Ok(whole.map(|layer| Layer {
        label: label.to_owned(),
        ..layer
    }))
}
