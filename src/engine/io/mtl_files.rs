//! The MTL files that an OBJ file names, and where their statements stand.
//!
//! tobj tells neither the file nor the line of a material: both are found by a scan of our own, so
//! that a message can point at them.

use std::collections::HashMap;
use std::path::Path;

use tobj::{LoadError, MTLLoadResult};

use super::error::InputError;
use super::mtl::MtlMaterial;
use super::source::{FileSource, beside, reason};

/// What was met while tobj asked for material files.
#[derive(Default)]
pub struct MtlFiles {
    /// Files that are not there: their materials are grey.
    pub warnings: Vec<String>,
    /// The first statement that cannot be understood.
    pub error: Option<InputError>,
    places: HashMap<String, Place>,
}

/// The file of a material and the lines of its statements, from 1, by keyword.
#[derive(Clone, Default)]
struct Place {
    file: String,
    lines: HashMap<String, usize>,
}

impl MtlFiles {
    /// Reads one file beside the OBJ file `obj`.
    pub fn load(&mut self, files: &dyn FileSource, obj: &str, name: &Path) -> MTLLoadResult {
        let path = beside(obj, &name.to_string_lossy());
        let bytes = files.read(&path).map_err(|e| {
            let missing = format!("{path}: {}; its materials are grey", reason(&e));
            self.warnings.push(missing);
            LoadError::OpenFileFailed
        })?;
        let text = String::from_utf8_lossy(&bytes);
        self.note_lines(&path, &text);
        if let Some(line) = short_color(&text) {
            let message = "this colour has fewer than three numbers";
            let error = InputError::at(&path, line, message);
            self.error.get_or_insert(error);
            return Err(LoadError::MaterialParseError);
        }
        tobj::load_mtl_buf(&mut &bytes[..]).inspect_err(|_| {
            let error = InputError {
                file: path,
                line: first_bad_line(&text),
                message: "this material statement lacks a name or a number".to_owned(),
            };
            self.error.get_or_insert(error);
        })
    }

    fn note_lines(&mut self, path: &str, text: &str) {
        let mut name = String::new();
        for (number, line) in text.lines().enumerate() {
            let line = line.trim();
            let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            if keyword == "newmtl" {
                name = rest.trim().to_owned();
            }
            let place = self.places.entry(name.clone()).or_default();
            place.file = path.to_owned();
            place.lines.insert(keyword.to_owned(), number + 1);
        }
    }

    /// A material with the place where it stands.
    pub fn placed(&self, m: &tobj::Material) -> MtlMaterial {
        let place = self.places.get(&m.name).cloned().unwrap_or_default();
        MtlMaterial {
            file: place.file,
            lines: place.lines,
            name: m.name.clone(),
            diffuse: m.diffuse,
            specular: m.specular,
            emissive: m.emissive,
            shininess: m.shininess,
            dissolve: m.dissolve,
            ior: m.optical_density,
            illum: m.illumination_model,
            diffuse_texture: m.diffuse_texture.clone(),
            unknown: m.unknown_param.clone().into_iter().collect(),
        }
    }
}

/// The first line, from 1, of a colour with fewer than three numbers: tobj panics there.
fn short_color(text: &str) -> Option<usize> {
    let short = |line: &str| {
        let mut words = line.split_whitespace();
        matches!(words.next(), Some("Ka" | "Kd" | "Ks" | "Ke")) && words.count() < 3
    };
    text.lines().position(short).map(|i| i + 1)
}

/// The first line that tobj refuses, from 1.
fn first_bad_line(text: &str) -> Option<usize> {
    let bad = |line: &str| {
        short_color(line).is_some() || tobj::load_mtl_buf(&mut line.as_bytes()).is_err()
    };
    text.lines().position(bad).map(|i| i + 1)
}
