//! What is remembered from one window to the next.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::engine::io::atomic;

/// Most recent files.
const RECENT: usize = 10;

/// Looks and habits; nothing that makes a picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Files opened last, the newest first.
    pub recent: Vec<PathBuf>,
    /// The dark theme is chosen.
    pub dark: bool,
    /// The panel is shown.
    pub panel: bool,
    /// Width of the panel in points.
    pub panel_width: f32,
    /// Sections of the panel that were folded or unfolded.
    pub sections: BTreeMap<String, bool>,
    /// The error that is good enough, as a share of the mean of the picture.
    pub target_error: f64,
    /// Size of the window in points.
    pub window: [f32; 2],
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            recent: Vec::new(),
            dark: true,
            panel: true,
            panel_width: 292.0,
            sections: BTreeMap::new(),
            target_error: 0.01,
            window: [1280.0, 800.0],
        }
    }
}

impl Preferences {
    /// What was remembered in `file`; the defaults where nothing can be read.
    pub fn load(file: &Path) -> Self {
        let text = std::fs::read_to_string(file).unwrap_or_default();
        let mut read: Self = serde_json::from_str(&text).unwrap_or_default();
        let usable = |x: f32, lo: f32, hi: f32| if x.is_finite() { x.clamp(lo, hi) } else { lo };
        read.panel_width = usable(read.panel_width, 240.0, 480.0);
        read.window = read.window.map(|side| usable(side, 320.0, 16_384.0));
        if !(1e-5..=1.0).contains(&read.target_error) {
            read.target_error = Self::default().target_error;
        }
        read.recent.truncate(RECENT);
        read
    }

    /// Remembers it. A home that cannot be written to is no reason to bother anyone.
    pub fn save(&self, file: &Path) {
        let Ok(text) = serde_json::to_string_pretty(self) else {
            return;
        };
        if let Some(folder) = file.parent() {
            let _ = std::fs::create_dir_all(folder);
        }
        let _ = atomic::write(file, text.as_bytes());
    }

    /// Puts a file first among the recent ones.
    pub fn opened(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.recent.retain(|recent| *recent != path);
        self.recent.insert(0, path);
        self.recent.truncate(RECENT);
    }
}

/// Where preferences are kept: in the folder that the system has for them.
pub fn file() -> Option<PathBuf> {
    let variable = |name| {
        std::env::var_os(name)
            .filter(|v| !v.is_empty())
            .map(PathBuf::from)
    };
    let folder = if cfg!(windows) {
        variable("APPDATA")
    } else if cfg!(target_os = "macos") {
        variable("HOME").map(|home| home.join("Library/Application Support"))
    } else {
        variable("XDG_CONFIG_HOME").or_else(|| variable("HOME").map(|home| home.join(".config")))
    };
    folder.map(|folder| folder.join("lightscope/window.json"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn preferences_come_back() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("new/window.json");
        let mut preferences = Preferences {
            dark: false,
            ..Preferences::default()
        };
        preferences.sections.insert("Camera".to_owned(), true);
        preferences.opened(Path::new("/a/b.toml"));
        preferences.save(&file);
        assert_eq!(Preferences::load(&file), preferences);
    }

    #[test]
    fn nonsense_is_replaced_by_defaults() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("window.json");
        assert_eq!(Preferences::load(&file), Preferences::default());
        std::fs::write(&file, "{\"panel_width\": 1e30, \"window\": [0, 1e9]}").expect("a file");
        let read = Preferences::load(&file);
        assert_eq!((read.panel_width, read.window), (480.0, [320.0, 16_384.0]));
    }

    #[test]
    fn the_newest_file_stands_first_and_once() {
        let mut preferences = Preferences::default();
        for i in 0..20 {
            preferences.opened(&PathBuf::from(format!("/{i}")));
        }
        preferences.opened(Path::new("/15"));
        assert_eq!(preferences.recent.len(), RECENT);
        assert_eq!(preferences.recent[0], PathBuf::from("/15"));
        let same = preferences
            .recent
            .iter()
            .filter(|p| p.as_path() == Path::new("/15"));
        assert_eq!(same.count(), 1);
    }
}
