//! Running the program and reading what it wrote.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use exr::prelude::{ReadChannels, ReadLayers};
use serde_json::Value;
use tempfile::TempDir;

/// A scene of the reference suite: diffuse only, so that specular and caustic are zero.
pub fn cornell() -> String {
    reference("cornell-diffuse/scene.json")
}

pub fn reference(path: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/reference")
        .join(path)
        .display()
        .to_string()
}

/// A folder to work in.
pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

pub fn lightscope(folder: &Path, args: &[&str]) -> Output {
    command(folder, args).output().expect("the program starts")
}

pub fn command(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lightscope"));
    command.current_dir(folder).args(args).stdin(Stdio::null());
    command
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("UTF-8")
}

pub fn succeeds(folder: &Path, args: &[&str]) -> Output {
    let output = lightscope(folder, args);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{args:?}: {}",
        stderr(&output)
    );
    output
}

/// Standard output as the one JSON value it must be.
pub fn json(folder: &Path, args: &[&str]) -> Value {
    let text = stdout(&succeeds(folder, args));
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{args:?}: {e} in {text}"))
}

/// Renders the Cornell box at 16×16.
pub fn render(folder: &Path, out: &str, more: &[&str]) -> Output {
    let scene = cornell();
    let mut args = vec!["render", &scene, "-o", out, "--size", "16x16"];
    args.extend(more);
    succeeds(folder, &args)
}

/// Channels by name, as bits, and text attributes by name.
pub struct Exr {
    pub size: (usize, usize),
    pub channels: Vec<(String, Vec<u32>)>,
    pub texts: Vec<(String, String)>,
}

impl Exr {
    pub fn read(path: PathBuf) -> Self {
        let image = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .from_file(&path)
            .unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        assert_eq!(image.layer_data.len(), 1, "one part");
        let part = &image.layer_data[0];
        let channels = part.channel_data.list.iter().map(|channel| {
            let bits = channel
                .sample_data
                .values_as_f32()
                .map(f32::to_bits)
                .collect();
            assert!(matches!(
                channel.sample_data,
                exr::prelude::FlatSamples::F32(_)
            ));
            (channel.name.to_string(), bits)
        });
        let texts = part
            .attributes
            .other
            .iter()
            .filter_map(|(name, value)| match value {
                exr::prelude::AttributeValue::Text(text) => {
                    Some((name.to_string(), text.to_string()))
                }
                _ => None,
            });
        let size = (part.size.x(), part.size.y());
        Self {
            size,
            channels: channels.collect(),
            texts: texts.collect(),
        }
    }

    pub fn names(&self) -> Vec<&str> {
        self.channels
            .iter()
            .map(|(name, _)| name.as_str())
            .collect()
    }

    pub fn channel(&self, name: &str) -> Vec<f32> {
        let channel = self.channels.iter().find(|(n, _)| n == name);
        let (_, bits) = channel.unwrap_or_else(|| panic!("no channel {name}"));
        bits.iter().map(|b| f32::from_bits(*b)).collect()
    }

    pub fn text(&self, name: &str) -> &str {
        let text = self.texts.iter().find(|(n, _)| n == name);
        text.map(|(_, t)| t.as_str())
            .unwrap_or_else(|| panic!("no attribute {name}"))
    }
}
