//! Choosing a file: the state behind the window that shows folders.

use std::path::{Path, PathBuf};

/// Names that can be opened.
pub const OPENED: [&str; 5] = ["toml", "json", "obj", "png", "exr"];
/// Names that can be measured against.
pub const REFERENCES: [&str; 2] = ["exr", "hdr"];
/// Names that can be saved.
pub const SAVED: [&str; 3] = ["png", "exr", "json"];

/// What the file is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// To be read.
    Open,
    /// To be measured against.
    Reference,
    /// To be written.
    Save,
}

/// Something in a folder.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Entry {
    /// A folder.
    Folder(String),
    /// A file.
    File(String),
}

/// A choice under way.
#[derive(Clone, Debug)]
pub struct Browser {
    /// What the file is for.
    pub purpose: Purpose,
    /// The folder as it is typed.
    pub folder_text: String,
    /// The name as it is typed.
    pub name: String,
    /// Only names that hold this are shown.
    pub filter: String,
    /// A sentence about what cannot be done.
    pub error: Option<String>,
    /// A file that would be replaced, if the user agrees.
    pub replace: Option<PathBuf>,
    /// It was not drawn yet: the name gets the keyboard then.
    pub fresh: bool,
    folder: PathBuf,
    entries: Vec<Entry>,
}

impl Browser {
    /// Starts in `folder` with a proposed name.
    pub fn new(purpose: Purpose, folder: &Path, name: &str) -> Self {
        let mut browser = Self {
            purpose,
            folder_text: String::new(),
            name: name.to_owned(),
            filter: String::new(),
            error: None,
            replace: None,
            fresh: true,
            folder: PathBuf::new(),
            entries: Vec::new(),
        };
        let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
        browser.go_to(&folder);
        browser
    }

    /// The folder that is shown.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Shows another folder; if it cannot be read, says so and stays.
    pub fn go_to(&mut self, folder: &Path) {
        let listed = std::fs::read_dir(folder);
        let Ok(listed) = listed else {
            self.error = Some(format!(
                "There is no folder {} that can be read.",
                folder.display()
            ));
            return;
        };
        let extensions: &[&str] = match self.purpose {
            Purpose::Open => &OPENED,
            Purpose::Reference => &REFERENCES,
            Purpose::Save => &SAVED,
        };
        let entry = |entry: std::fs::DirEntry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            let known = |e: &std::ffi::OsStr| extensions.iter().any(|k| e.eq_ignore_ascii_case(k));
            if name.starts_with('.') {
                None
            } else if entry.path().is_dir() {
                Some(Entry::Folder(name))
            } else {
                entry
                    .path()
                    .extension()
                    .is_some_and(known)
                    .then_some(Entry::File(name))
            }
        };
        self.entries = listed.filter_map(|e| entry(e.ok()?)).collect();
        self.entries.sort();
        self.folder = folder.to_owned();
        self.folder_text = folder.display().to_string();
        self.error = None;
        self.replace = None;
    }

    /// Goes to the folder that is typed.
    pub fn go_to_typed(&mut self) {
        self.go_to(&PathBuf::from(self.folder_text.trim()));
    }

    /// Shows the folder that holds this one.
    pub fn up(&mut self) {
        if let Some(parent) = self.folder.parent().map(Path::to_owned) {
            self.go_to(&parent);
        }
    }

    /// The entries that the filter lets through, folders first.
    pub fn visible(&self) -> impl Iterator<Item = &Entry> {
        let filter = self.filter.to_lowercase();
        self.entries.iter().filter(move |entry| {
            let (Entry::Folder(name) | Entry::File(name)) = entry;
            name.to_lowercase().contains(&filter)
        })
    }

    /// The file that is chosen, if it can be: to be opened it must exist; to be saved, its name
    /// must say a format, and what exists is replaced only when the user agrees.
    pub fn accept(&mut self, agreed: bool) -> Option<PathBuf> {
        let path = self.folder.join(self.name.trim());
        self.error = None;
        match self.purpose {
            _ if self.name.trim().is_empty() => {
                self.error = Some("Choose or type a name.".to_owned())
            }
            _ if path.is_dir() => self.go_to(&path),
            Purpose::Open | Purpose::Reference if !path.is_file() => {
                self.error = Some(format!("There is no file {}.", path.display()));
            }
            Purpose::Save if !says_format(&path) => {
                self.error = Some("The name must end in .png, .exr or .json (a state).".to_owned());
            }
            Purpose::Save if path.exists() && !agreed => self.replace = Some(path),
            _ => return Some(path),
        }
        None
    }
}

fn says_format(path: &Path) -> bool {
    let extension = path.extension().map(|e| e.to_ascii_lowercase());
    extension.is_some_and(|e| SAVED.iter().any(|known| e == *known))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::create_dir(folder.path().join("inner")).expect("a folder");
        for name in ["b.toml", "a.OBJ", "c.txt", ".hidden.toml", "old.png"] {
            std::fs::write(folder.path().join(name), "").expect("a file");
        }
        folder
    }

    #[test]
    fn folders_stand_first_and_only_known_names_are_shown() {
        let folder = folder();
        let mut browser = Browser::new(Purpose::Open, folder.path(), "");
        let file = |name: &str| Entry::File(name.to_owned());
        let inner = Entry::Folder("inner".to_owned());
        let all = [inner, file("a.OBJ"), file("b.toml"), file("old.png")];
        assert_eq!(browser.visible().cloned().collect::<Vec<_>>(), all);
        browser.filter = "B".to_owned();
        assert_eq!(browser.visible().count(), 2);
        browser.filter.clear();
        browser.go_to(&folder.path().join("inner"));
        assert_eq!(browser.visible().count(), 0);
        browser.up();
        assert_eq!(browser.visible().count(), 4);
    }

    #[test]
    fn what_cannot_be_opened_is_said() {
        let folder = folder();
        let mut browser = Browser::new(Purpose::Open, folder.path(), "nothing.toml");
        assert_eq!(browser.accept(false), None);
        assert!(
            browser
                .error
                .as_ref()
                .is_some_and(|e| e.contains("nothing.toml"))
        );
        browser.name = "b.toml".to_owned();
        assert_eq!(browser.accept(false), Some(folder.path().join("b.toml")));
        browser.folder_text = "/no/such/folder".to_owned();
        browser.go_to_typed();
        assert!(browser.error.is_some());
        assert_eq!(browser.folder(), folder.path());
        browser.name = "inner".to_owned();
        assert_eq!(browser.accept(false), None);
        assert!(browser.folder().ends_with("inner"));
    }

    #[test]
    fn files_are_replaced_only_when_the_user_agrees() {
        let folder = folder();
        let mut browser = Browser::new(Purpose::Save, folder.path(), "old.png");
        assert_eq!(browser.accept(false), None);
        assert_eq!(browser.replace, Some(folder.path().join("old.png")));
        assert_eq!(browser.accept(true), Some(folder.path().join("old.png")));
        browser.name = "new.jpg".to_owned();
        assert_eq!(browser.accept(true), None);
        assert!(browser.error.is_some());
        browser.name = "new.exr".to_owned();
        assert_eq!(browser.accept(false), Some(folder.path().join("new.exr")));
    }
}
