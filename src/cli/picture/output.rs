//! Where a picture goes, checked before anything is rendered.

use std::path::{Path, PathBuf};

use crate::cli::error::CliError;
use crate::cli::suggest::did_you_mean;

/// Format of a picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR: 32-bit float, any number of layers.
    Exr,
    /// PNG: 8 bits, tone mapped.
    Png,
    /// Radiance HDR: shared exponent.
    Hdr,
}

const FORMATS: [(&str, Format); 3] = [
    ("exr", Format::Exr),
    ("png", Format::Png),
    ("hdr", Format::Hdr),
];

impl Format {
    /// By the end of the file's name.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        FORMATS
            .iter()
            .find(|(name, _)| *name == extension)
            .map(|(_, format)| *format)
    }
}

/// A picture file to be written.
#[derive(Clone, Debug)]
pub struct Output {
    /// Its path.
    pub path: PathBuf,
    /// Its format.
    pub format: Format,
}

impl Output {
    /// A file whose name says a format that can be written.
    pub fn new(path: &Path) -> Result<Self, CliError> {
        let Some(format) = Format::of(path) else {
            let extension = path
                .extension()
                .and_then(|e| e.to_str())
                .unwrap_or_default();
            let hint = did_you_mean(extension, FORMATS.map(|(name, _)| name));
            return Err(CliError::usage(format!(
                "\"{}\" says no format that can be written; its name must end in .exr, .png or \
                 .hdr{hint}",
                path.display()
            )));
        };
        Ok(Self {
            path: path.to_owned(),
            format,
        })
    }

    /// Fails now, not after an hour of rendering, if the file cannot be written.
    pub fn check_writable(&self) -> Result<(), CliError> {
        if self.path.is_dir() {
            return Err(CliError::usage(format!(
                "{} is a folder; -o names the file to write",
                self.path.display()
            )));
        }
        let old = std::fs::metadata(&self.path);
        if old.is_ok_and(|old| old.permissions().readonly()) {
            return Err(CliError::failed(format!(
                "{} must not be written (it is read-only)",
                self.path.display()
            )));
        }
        let folder = folder(&self.path);
        if !folder.is_dir() {
            return Err(CliError::usage(format!(
                "there is no folder {} to write {} into; create it first",
                folder.display(),
                self.path.display()
            )));
        }
        let probe = tempfile::tempfile_in(folder);
        probe.map(drop).map_err(|error| {
            CliError::failed(format!(
                "nothing can be written into {}: {error}",
                folder.display()
            ))
        })
    }
}

/// The folder that holds `path`.
pub fn folder(path: &Path) -> &Path {
    path.parent()
        .filter(|parent| !parent.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
}
