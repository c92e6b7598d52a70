//! What every exported picture says about its origin.

use crate::engine::film::Frame;
use crate::engine::session::Settings;

/// Begins the names of all texts but those of expressions.
pub const PREFIX: &str = "lightscope:";

/// Names and texts: scene, algorithm and parameters, samples, seconds, seed, version, estimated
/// RMSE / image mean with its 95 % interval, and the typed expressions.
pub fn texts(scene: &str, settings: &Settings, frame: &Frame) -> Vec<(String, String)> {
    let parameters: Vec<String> = settings
        .params
        .iter()
        .map(|(name, value)| format!("{name}={value}"))
        .collect();
    let unknown = || "unknown".to_owned();
    let interval = frame.error_estimate.and_then(|e| e.relative_interval());
    let mut texts: Vec<(String, String)> = [
        ("scene", scene.to_owned()),
        ("integrator", settings.integrator.id.to_owned()),
        ("parameters", parameters.join(" ")),
        ("spp", frame.passes.to_string()),
        ("seconds", frame.t_wall.to_string()),
        ("seed", settings.seed.to_string()),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        (
            "error",
            frame.relative_error.map_or_else(unknown, |e| e.to_string()),
        ),
        (
            "error-interval",
            interval.map_or_else(unknown, |[low, high]| format!("{low} {high}")),
        ),
    ]
    .map(|(name, text)| (format!("{PREFIX}{name}"), text))
    .into();
    if let Some(depth) = settings.layers.max_depth {
        texts.push((format!("{PREFIX}max-depth"), depth.to_string()));
    }
    for (i, expression) in settings.layers.expressions.iter().enumerate() {
        texts.push((format!("expr{}", i + 1), expression.text().to_owned()));
    }
    texts
}
