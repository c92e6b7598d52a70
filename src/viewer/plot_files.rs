//! Saving the plot of errors.

use std::path::Path;

use super::app::App;
use super::saver::fresh_name;

impl App {
    /// Saves the plot under a new name in the current folder.
    pub(super) fn save_plot(&mut self, extension: &'static str) {
        let workspace = &self.workspace;
        let stem = format!("{}-error", workspace.model.source.short_name());
        let target = workspace.preferences.target_error;
        let bytes = workspace.measuring.plot_bytes(extension, target);
        self.write(fresh_name(Path::new(""), &stem, extension), move || bytes);
    }
}
