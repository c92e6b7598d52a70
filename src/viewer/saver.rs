//! Writing files beside the window, which waits for no disk.

use std::path::{Path, PathBuf};

use crate::engine::io::atomic;

/// The first name in `folder` that no file has: `stem.ext`, `stem-2.ext` ….
pub fn fresh_name(folder: &Path, stem: &str, extension: &str) -> PathBuf {
    let name = |n: u32| match n {
        1 => folder.join(format!("{stem}.{extension}")),
        _ => folder.join(format!("{stem}-{n}.{extension}")),
    };
    (1..)
        .map(name)
        .find(|path| !path.exists())
        .unwrap_or_else(|| name(1))
}

/// Makes the bytes and writes them to `path` on another thread; `done` gets the sentence to show.
pub fn save(
    path: PathBuf,
    bytes: impl FnOnce() -> Result<Vec<u8>, String> + Send + 'static,
    done: impl FnOnce(Result<String, String>) + Send + 'static,
) {
    let work = move || {
        let written = bytes().and_then(|bytes| {
            atomic::write(&path, &bytes)
                .map_err(|error| format!("{} cannot be written: {error}", path.display()))
        });
        done(written.map(|()| format!("Saved {}", path.display())));
    };
    // Where no thread can be started, nothing is saved; the window says nothing of it then, as
    // the render could not start either.
    let _ = std::thread::Builder::new()
        .name("save".to_owned())
        .spawn(work);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_are_taken_are_not_used() {
        let folder = tempfile::tempdir().expect("a folder");
        let fresh = || fresh_name(folder.path(), "box", "png");
        assert_eq!(fresh(), folder.path().join("box.png"));
        std::fs::write(fresh(), "").expect("a file");
        std::fs::write(fresh(), "").expect("a file");
        assert_eq!(fresh(), folder.path().join("box-3.png"));
    }
}
