//! The folder of a report: runs that are done stay, so that a report goes on where it was cut off.

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::options::{ReportOptions, Subject};
use super::record::Run;
use crate::cli::error::CliError;
use crate::cli::scene::parameter_text;
use crate::engine::integrators::{Entry, Params};
use crate::engine::io::atomic;

/// Folder of the runs.
const RUNS: &str = "runs";
/// Folder of the pictures.
const IMAGES: &str = "images";

/// All that a run depends on; another key makes it another run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Key {
    scene: String,
    size: [u32; 2],
    integrator: String,
    parameters: String,
    max_depth: Option<u32>,
    seconds: f64,
    threads: usize,
    reference: Option<String>,
    version: String,
}

#[derive(Serialize, Deserialize)]
struct Kept {
    key: Key,
    run: Run,
}

impl Key {
    /// Of a contestant on a scene.
    pub fn new(o: &ReportOptions, subject: &Subject, (entry, params): &(&Entry, Params)) -> Self {
        let path = subject.reference_path.as_ref();
        Self {
            scene: subject.id.clone(),
            size: subject.size.to_array(),
            integrator: entry.id.to_owned(),
            parameters: parameter_text(params),
            max_depth: o.max_depth,
            seconds: o.seconds,
            threads: rayon::current_num_threads(),
            reference: path.map(|p| p.display().to_string()),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }

    fn stem(&self) -> String {
        let safe = |c: char| {
            if c.is_alphanumeric() || c == '-' {
                c
            } else {
                '_'
            }
        };
        let scene: String = self.scene.chars().map(safe).collect();
        format!("{scene}--{}", self.integrator)
    }
}

/// The folder.
pub struct Store {
    folder: PathBuf,
}

impl Store {
    /// Makes the folder, if it is not there.
    pub fn open(folder: &Path) -> Result<Self, CliError> {
        for part in [RUNS, IMAGES] {
            let path = folder.join(part);
            fs::create_dir_all(&path).map_err(|error| cannot_write(&path, &error))?;
        }
        Ok(Self {
            folder: folder.to_owned(),
        })
    }

    fn run_path(&self, key: &Key, seed: u64) -> PathBuf {
        self.folder
            .join(RUNS)
            .join(format!("{}--{seed}.json", key.stem()))
    }

    /// A run of that key that is done.
    pub fn run(&self, key: &Key, seed: u64) -> Option<Run> {
        let bytes = fs::read(self.run_path(key, seed)).ok()?;
        let kept: Kept = serde_json::from_slice(&bytes).ok()?;
        let pictures = self.image_path(key, "picture").exists();
        (kept.key == *key && kept.run.seed == seed && pictures).then_some(kept.run)
    }

    /// Keeps a run.
    pub fn keep(&self, key: &Key, run: &Run) -> Result<(), CliError> {
        let kept = Kept {
            key: key.clone(),
            run: run.clone(),
        };
        let bytes = json_bytes(&kept)?;
        self.write(&self.run_path(key, run.seed), &bytes)
    }

    /// Path of a picture of a contestant.
    pub fn image_path(&self, key: &Key, kind: &str) -> PathBuf {
        self.folder
            .join(IMAGES)
            .join(format!("{}--{kind}.png", key.stem()))
    }

    /// Path of the picture of a scene's reference.
    pub fn reference_path(&self, subject: &Subject) -> PathBuf {
        self.folder
            .join(IMAGES)
            .join(format!("{}--reference.png", subject.id))
    }

    /// Path of a file of the report itself.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Writes a file in place of what was there.
    pub fn write(&self, path: &Path, bytes: &[u8]) -> Result<(), CliError> {
        atomic::write(path, bytes).map_err(|error| cannot_write(path, &error))
    }

    /// A file's bytes, if it is there.
    pub fn read(&self, path: &Path) -> Option<Vec<u8>> {
        fs::read(path).ok()
    }
}

/// JSON of a value.
pub fn json_bytes(value: &impl Serialize) -> Result<Vec<u8>, CliError> {
    serde_json::to_vec_pretty(value)
        .map_err(|error| CliError::failed(format!("the result is no JSON: {error}")))
}

fn cannot_write(path: &Path, error: &std::io::Error) -> CliError {
    CliError::failed(format!("{} cannot be written: {error}", path.display()))
}
