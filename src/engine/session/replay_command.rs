//! The command that follows a sample of a render again.

use glam::UVec2;

use super::Settings;
use crate::engine::integrators::{Params, SampleId};

/// The command line that replays `sample` of a render of the scene called `scene`.
pub fn replay_command(
    scene: &str,
    frame: u32,
    size: UVec2,
    settings: &Settings,
    sample: &SampleId,
) -> String {
    let entry = settings.integrator;
    let mut words = vec![
        "lightscope replay".to_owned(),
        quoted(scene),
        format!("--integrator {}", entry.id),
    ];
    let defaults = Params::defaults(entry.params);
    let typed = |params: &Params| -> Vec<String> {
        params
            .iter()
            .map(|(name, value)| format!("{name}={value}"))
            .collect()
    };
    let usual = typed(&defaults);
    for set in typed(&settings.params) {
        if !usual.contains(&set) {
            words.push(format!("--set {}", quoted(&set)));
        }
    }
    words.push(format!("--size {}x{}", size.x, size.y));
    if frame > 0 {
        words.push(format!("--frame {frame}"));
    }
    if let Some(max) = settings.layers.max_depth {
        words.push(format!("--max-depth {max}"));
    }
    for expression in &settings.layers.expressions {
        words.push(format!("--expression {}", quoted(expression.text())));
    }
    if settings.layers.no_whole {
        words.push("--no-whole".to_owned());
    }
    words.push(format!("--seed {}", settings.seed));
    words.push(format!("--stream {}", sample.stream_name()));
    words.push(format!("--index {sample}"));
    words.join(" ")
}

/// A word as a shell reads it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+%@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_survive_a_shell() {
        assert_eq!(quoted("scenes/a-b.toml"), "scenes/a-b.toml");
        assert_eq!(quoted("L.*(D|G)E"), "'L.*(D|G)E'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted(""), "''");
    }
}
