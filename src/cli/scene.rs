//! From what was typed to a scene that can be rendered.

use std::path::Path;
use std::sync::Arc;

use glam::UVec2;

use super::error::CliError;
use super::list::Row;
use super::suggest::did_you_mean;
use crate::engine::camera::Camera;
use crate::engine::integrators::{self, Entry, Params, REGISTRY};
use crate::engine::io::{InputError, embedded, scene_file};
use crate::engine::plan::RenderPlan;
use crate::engine::scene::desc::CameraDesc;
use crate::engine::scene::{Scene, SceneDesc};
use crate::engine::session::RenderJob;

/// The scene that is shown where none is named.
pub const DEFAULT_SCENE: &str = "jensen-box";

/// The scene called `name`: an embedded one, or else a file.
pub fn read(name: &str) -> Result<SceneDesc, CliError> {
    read_frame(name, 0)
}

/// A frame of the scene called `name`.
pub fn read_frame(name: &str, frame: u32) -> Result<SceneDesc, CliError> {
    let usage = |error: InputError| CliError::usage(error.to_string());
    if is_embedded(name) {
        return embedded::read_frame(name, frame).map_err(usage);
    }
    check_exists(name, &[])?;
    scene_file::load_frame(Path::new(name), frame).map_err(usage)
}

/// Fails with a sentence if `name` is neither a scene nor a file; the suggestion may be one of
/// `others` too.
pub fn check_exists(name: &str, others: &[&str]) -> Result<(), CliError> {
    if is_embedded(name) || Path::new(name).exists() {
        return Ok(());
    }
    let ids = embedded::all().iter().map(|scene| scene.id);
    let hint = did_you_mean(name, ids.chain(others.iter().copied()));
    Err(CliError::usage(format!(
        "there is no scene and no file \"{name}\"{hint}; `lightscope list scenes` names the scenes"
    )))
}

/// True if `name` is the id of an embedded scene.
pub fn is_embedded(name: &str) -> bool {
    embedded::contains(name)
}

/// The scene in a file.
pub fn read_file(path: &Path) -> Result<SceneDesc, CliError> {
    scene_file::load(path).map_err(|error| CliError::usage(error.to_string()))
}

/// The embedded scenes.
pub fn listed() -> Result<Vec<Row>, CliError> {
    let row = |scene: &embedded::EmbeddedScene| {
        let desc = read(scene.id)?;
        Ok(Row {
            id: scene.id.to_owned(),
            label: desc.name,
            summary: desc.description,
            params: None,
            missing: None,
            media: None,
            oracle: None,
            asked: None,
        })
    };
    embedded::all().iter().map(row).collect()
}

/// Prepares a scene, and its camera for a picture of `size` pixels.
pub fn build(desc: &SceneDesc, size: UVec2) -> Result<(Arc<Scene>, Camera), CliError> {
    let scene = Scene::build(desc).map_err(CliError::Usage)?;
    let camera = camera(&scene.camera, size)?;
    Ok((Arc::new(scene), camera))
}

/// A camera for a picture of `size` pixels.
pub fn camera(desc: &CameraDesc, size: UVec2) -> Result<Camera, CliError> {
    Ok(Camera::new(desc).map_err(CliError::Usage)?.with_size(size))
}

/// What a job needs computed.
pub fn plan(job: &RenderJob) -> Result<RenderPlan, CliError> {
    if let Some(why) = job.settings.integrator.refusal(&job.scene.features) {
        return Err(CliError::usage(why));
    }
    RenderPlan::new(&job.scene, job.camera.has_lens(), &job.settings.layers)
        .map_err(|error| CliError::usage(error.to_string()))
}

/// The integrator called `id` and its parameters, `sets` being `name=value`.
pub fn parameters(id: &str, sets: &[String]) -> Result<(&'static Entry, Params), CliError> {
    let Some(entry) = integrators::find(id) else {
        let ids: Vec<&str> = REGISTRY.iter().map(|entry| entry.id).collect();
        return Err(CliError::usage(format!(
            "there is no integrator \"{id}\"{}; there are {}",
            did_you_mean(id, ids.iter().copied()),
            ids.join(", ")
        )));
    };
    let mut params = Params::defaults(entry.params);
    for set in sets {
        let Some((name, value)) = set.split_once('=') else {
            return Err(CliError::usage(format!(
                "--set {set} has no value; write --set NAME=VALUE, such as --set {}",
                entry
                    .params
                    .first()
                    .map_or("mode=mis".to_owned(), |p| format!(
                        "{}={}",
                        p.name, p.default
                    ))
            )));
        };
        params.set(entry.params, name, value).map_err(|error| {
            let known = entry.params.iter().any(|p| p.name == name);
            let names = entry.params.iter().map(|p| p.name).filter(|_| !known);
            CliError::usage(format!("{id}: {error}{}", did_you_mean(name, names)))
        })?;
    }
    Ok((entry, params))
}

/// All parameters as they would be typed.
pub fn parameter_text(params: &Params) -> String {
    params
        .iter()
        .map(|(name, value)| format!("{name}={value}"))
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_set_or_refused_with_the_nearest_name() {
        let sets = ["mode=hits".to_owned(), "roulette=7".to_owned()];
        let (entry, params) = parameters("path", &sets).unwrap();
        assert_eq!(
            (entry.id, params.choice("mode"), params.integer("roulette")),
            ("path", "hits", 7)
        );
        assert_eq!(
            parameter_text(&params),
            "equiangular=on mode=hits roulette=7 sampler=sobol"
        );
        let message = |id: &str, set: &str| {
            parameters(id, &[set.to_owned()])
                .err()
                .map(|e| e.to_string())
                .unwrap_or_default()
        };
        assert!(message("pth", "").contains("did you mean \"path\"?"));
        assert!(message("path", "mdoe=mis").contains("did you mean \"mode\"?"));
        assert!(message("path", "mode=mist").contains("one of mis, kajiya, hits"));
        assert!(message("path", "mode").contains("NAME=VALUE"));
    }
}
