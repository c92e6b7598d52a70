//! Scene files: TOML, JSON, and OBJ that opens alone.

use std::path::Path;

use super::error::InputError;
use super::fields::Fields;
use super::materials::Colors;
use super::source::{Disk, FileSource, OneFrame, reason};
use super::value::{Node, SyntaxError, Value};
use super::{camera, json, lights, materials, media, obj, shapes, toml};
use crate::engine::scene::desc::SceneDesc;

/// Reads the scene in a file of the disk.
///
/// # Errors
/// A sentence with file and line.
pub fn load(path: &Path) -> Result<SceneDesc, InputError> {
    load_from(&Disk, &path.to_string_lossy())
}

/// Reads the scene at `path` of `files`; what it refers to is read from there too.
///
/// # Errors
/// As [`load`].
pub fn load_from(files: &dyn FileSource, path: &str) -> Result<SceneDesc, InputError> {
    load_frame_from(files, path, 0)
}

/// Reads frame `frame` of the sequence in a file of the disk.
///
/// # Errors
/// As [`load`], and if it has no such frame.
pub fn load_frame(path: &Path, frame: u32) -> Result<SceneDesc, InputError> {
    load_frame_from(&Disk, &path.to_string_lossy(), frame)
}

/// Reads frame `frame` of the sequence at `path` of `files`: in names of files `{frame}` stands for
/// the number.
///
/// # Errors
/// As [`load_frame`].
pub fn load_frame_from(
    files: &dyn FileSource,
    path: &str,
    frame: u32,
) -> Result<SceneDesc, InputError> {
    let frames = OneFrame { files, frame };
    let scene = load_still(&frames, path)?;
    let count = scene.frames.unwrap_or(1);
    if frame >= count {
        let last = count - 1;
        let message = format!("there is no frame {frame}; the last of this scene is {last}");
        return Err(InputError::in_file(path, message));
    }
    Ok(scene)
}

fn load_still(files: &dyn FileSource, path: &str) -> Result<SceneDesc, InputError> {
    let extension = path
        .rsplit_once('.')
        .map_or("", |(_, e)| e)
        .to_ascii_lowercase();
    let parse: fn(&str) -> Result<Node, SyntaxError> = match extension.as_str() {
        "toml" => toml::parse,
        "json" => json::parse,
        "obj" => return obj::open_alone(files, path),
        _ => {
            let message = "a scene is a .toml, .json or .obj file; this name ends otherwise";
            return Err(InputError::in_file(path, message));
        }
    };
    let bytes = files
        .read(path)
        .map_err(|e| InputError::in_file(path, format!("it cannot be read: {}", reason(&e))))?;
    let text = std::str::from_utf8(&bytes).map_err(|e| {
        let line = bytes[..e.valid_up_to()]
            .iter()
            .filter(|b| **b == b'\n')
            .count()
            + 1;
        InputError::at(
            path,
            line,
            "these bytes are no UTF-8 text; a scene file is text",
        )
    })?;
    if text.trim().is_empty() {
        let message = "it is empty; a scene has at least a camera, see the README's example";
        return Err(InputError::in_file(path, message));
    }
    let root = parse(text).map_err(|e| {
        let format = extension.to_ascii_uppercase();
        InputError::at(path, e.line, format!("this is not {format}: {}", e.message))
    })?;
    read(files, path, &root)
}

/// Reads a scene from TOML text; files it names are on the disk, beside `name`.
///
/// # Errors
/// As [`load`].
pub fn from_toml(text: &str, name: &str) -> Result<SceneDesc, InputError> {
    let root = toml::parse(text).map_err(|e| InputError::at(name, e.line, e.message))?;
    read(&Disk, name, &root)
}

fn read(files: &dyn FileSource, file: &str, root: &Node) -> Result<SceneDesc, InputError> {
    let mut f = Fields::new(file, root, "scene")?;
    let mut scene = SceneDesc::default();
    if let Some(node) = f.take("format")
        && !matches!(node.value, Value::Number(1.0))
    {
        return Err(f.error_at(node.line, "format is 1, the only one there is"));
    }
    let stem = Path::new(file)
        .file_stem()
        .map_or(String::new(), |s| s.to_string_lossy().into_owned());
    scene.name = f.text("name")?.map_or(stem, |n| n.0.to_owned());
    scene.description = f
        .text("description")?
        .map_or_else(String::new, |d| d.0.to_owned());
    let whole = |x: f32| x.fract() == 0.0 && (1.0..=1e6).contains(&x);
    if let Some(node) = f.take("frames") {
        let right = "a whole number of frames from 1 to 1000000";
        scene.frames = Some(f.number_in(node, "frames", right, whole)? as u32);
    }
    let right = "a table with position and target";
    scene.camera = camera::read(file, f.required("camera", right)?)?;
    if let Some(node) = f.take("media") {
        scene.media.media = media::read_all(file, node, files)?;
    }
    let medium = f.take("medium");
    let mut colors = Colors::new(files);
    if let Some(node) = f.take("materials") {
        scene.materials = materials::read(file, node, &mut colors)?;
    }
    for node in f.list("meshes")? {
        shapes::read_mesh(file, node, files, &mut colors, &mut scene)?;
    }
    for node in f.list("spheres")? {
        shapes::read_sphere(file, node, &mut scene)?;
    }
    for node in f.list("lights")? {
        scene.lights.push(lights::read(file, node, &mut colors)?);
    }
    f.finish()?;
    if let Some(node) = medium {
        media::read_around(file, node, files, &mut scene)?;
    }
    media::warn_of_unused(&mut scene);
    Ok(scene)
}
