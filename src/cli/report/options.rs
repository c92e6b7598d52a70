//! Arguments of `report`, checked.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::UVec2;

use crate::cli::args::ReportArgs;
use crate::cli::error::CliError;
use crate::cli::picture::{self, Layer, Picture};
use crate::cli::scene::{self, parameters};
use crate::engine::camera::Camera;
use crate::engine::integrators::{Entry, Params, REGISTRY};
use crate::engine::plan::LayerSettings;
use crate::engine::scene::Scene;
use crate::engine::session::{RenderJob, Settings};

/// All that is measured.
pub struct ReportOptions {
    /// What is compared on each scene.
    pub contestants: Vec<(&'static Entry, Params)>,
    /// Scenes.
    pub scenes: Vec<Subject>,
    /// Seconds of a run.
    pub seconds: f64,
    /// Runs of each contestant.
    pub seeds: u64,
    /// Relative error whose time is predicted.
    pub target: f64,
    /// Threads; 0 is one a core.
    pub threads: usize,
    /// Most events of a path.
    pub max_depth: Option<u32>,
    /// Where everything goes.
    pub folder: PathBuf,
}

/// A scene with its reference.
pub struct Subject {
    /// Name for files and headings.
    pub id: String,
    /// The scene.
    pub scene: Arc<Scene>,
    /// The view.
    pub camera: Camera,
    /// Pixels.
    pub size: UVec2,
    /// What errors are measured against.
    pub reference: Option<Picture>,
    /// Where that was read from.
    pub reference_path: Option<PathBuf>,
}

impl Subject {
    /// The reference of the whole.
    pub fn whole(&self) -> Option<&Layer> {
        self.reference.as_ref()?.whole()
    }

    /// A job of a contestant.
    pub fn job(
        &self,
        (integrator, params): &(&'static Entry, Params),
        seed: u64,
        max_depth: Option<u32>,
    ) -> RenderJob {
        let components = self.reference.as_ref().is_some_and(|r| r.layers.len() > 1);
        RenderJob {
            scene: Arc::clone(&self.scene),
            camera: self.camera,
            size: self.size,
            settings: Settings {
                integrator,
                params: params.clone(),
                layers: LayerSettings {
                    components,
                    max_depth,
                    ..LayerSettings::default()
                },
                seed,
            },
            navigating: false,
        }
    }
}

impl ReportOptions {
    /// Checks the arguments and reads scenes and references.
    pub fn new(args: &ReportArgs) -> Result<Self, CliError> {
        let contestants = contestants(args)?;
        if args.output.exists() && !args.output.is_dir() {
            return Err(CliError::usage(format!(
                "{} is a file; -o names the folder to write into",
                args.output.display()
            )));
        }
        let default = [scene::DEFAULT_SCENE.to_owned()];
        let names = if args.scenes.is_empty() {
            &default[..]
        } else {
            &args.scenes
        };
        let mut scenes: Vec<Subject> = Vec::new();
        for name in names {
            let subject = subject(args, name, names.len())?;
            if scenes.iter().any(|s| s.id == subject.id) {
                let id = &subject.id;
                return Err(CliError::usage(format!(
                    "two scenes are called {id}; drop one"
                )));
            }
            scenes.push(subject);
        }
        Ok(Self {
            contestants,
            scenes,
            seconds: args.seconds,
            seeds: args.seeds,
            target: args.target,
            threads: args.threads,
            max_depth: args.max_depth,
            folder: args.output.clone(),
        })
    }

    /// Runs in the order in which they are made: seed after seed, so that a report that was cut
    /// off has something of everything.
    pub fn runs(&self) -> impl Iterator<Item = (usize, usize, u64)> {
        let (scenes, contestants) = (self.scenes.len(), self.contestants.len());
        (0..self.seeds).flat_map(move |seed| {
            (0..scenes).flat_map(move |s| (0..contestants).map(move |c| (s, c, seed)))
        })
    }
}

fn contestants(args: &ReportArgs) -> Result<Vec<(&'static Entry, Params)>, CliError> {
    let all: Vec<String> = REGISTRY.iter().map(|e| e.id.to_owned()).collect();
    let ids = if args.integrators.is_empty() {
        &all
    } else {
        &args.integrators
    };
    let mut contestants: Vec<(&'static Entry, Params)> = Vec::new();
    let mut used = vec![false; args.set.len()];
    for id in ids {
        let mut sets = Vec::new();
        for (set, used) in args.set.iter().zip(&mut used) {
            let Some((of, set)) = set.split_once(':') else {
                return Err(CliError::usage(format!(
                    "--set {set} names no algorithm; write --set ID:NAME=VALUE, such as --set \
                     path:sampler=independent"
                )));
            };
            if of == id {
                sets.push(set.to_owned());
                *used = true;
            }
        }
        let contestant = parameters(id, &sets)?;
        if contestants.iter().any(|c| c.0.id == contestant.0.id) {
            return Err(CliError::usage(format!(
                "{id} stands twice in --integrators"
            )));
        }
        contestants.push(contestant);
    }
    match used.iter().position(|used| !used) {
        None => Ok(contestants),
        Some(i) => Err(CliError::usage(format!(
            "--set {} is for an algorithm that is not measured; there are {}",
            args.set[i],
            ids.join(", ")
        ))),
    }
}

/// The last part of a scene's name: its id, its file's name, or the folder of a `scene.json`.
fn short_name(name: &str) -> String {
    if scene::is_embedded(name) {
        return name.to_owned();
    }
    let path = Path::new(name);
    let stem = |p: &Path| p.file_stem().map(|s| s.to_string_lossy().into_owned());
    let own = stem(path).unwrap_or_else(|| "scene".to_owned());
    match path.parent().and_then(stem).filter(|_| own == "scene") {
        Some(folder) => folder,
        None => own,
    }
}

fn subject(args: &ReportArgs, name: &str, scenes: usize) -> Result<Subject, CliError> {
    let desc = scene::read(name)?;
    let id = short_name(name);
    let path = args
        .reference
        .as_ref()
        .map(|path| reference_of(path, &id, scenes))
        .transpose()?;
    let reference = path.as_deref().map(picture::read_reference).transpose()?;
    let own = UVec2::new(desc.camera.width, desc.camera.height);
    let known = reference.as_ref().map(|r| r.size);
    if let (Some(known), Some(asked)) = (known, args.size)
        && known != asked
    {
        return Err(CliError::usage(format!(
            "the reference of {id} has {}x{} pixels and not the {}x{} of --size; drop --size",
            known.x, known.y, asked.x, asked.y
        )));
    }
    let size = known.or(args.size).unwrap_or(own);
    let (scene, camera) = scene::build(&desc, size)?;
    if reference.as_ref().is_some_and(|r| r.whole().is_none()) {
        return Err(CliError::usage(format!(
            "the reference of {id} has no channels R, G and B"
        )));
    }
    Ok(Subject {
        id,
        scene,
        camera,
        size,
        reference,
        reference_path: path,
    })
}

/// The reference of one scene: `path` itself, or what it holds for the scene.
fn reference_of(path: &Path, id: &str, scenes: usize) -> Result<PathBuf, CliError> {
    let shown = path.display();
    let inside = [path.join(format!("{id}.exr")), path.join(id)];
    if let Some(found) = inside.into_iter().find(|p| p.exists()) {
        return Ok(found);
    }
    let own = path.is_file() || path.join("ref.exr").exists();
    if own && scenes == 1 {
        return Ok(path.to_owned());
    }
    let sentence = match own {
        true => format!(
            "{shown} is one reference and there are {scenes} scenes; name a folder with SCENE.exr for each"
        ),
        false if path.exists() => format!(
            "{shown} holds no reference of {id}; make one by `lightscope reference {id} -o \
             {shown}/{id}.exr --error 0.002`"
        ),
        false => format!("there is no file or folder {shown}"),
    };
    Err(CliError::usage(sentence))
}
