//! Whether files have changed: asked for twice a second, which works on every file system.

use std::path::PathBuf;
use std::time::{Duration, Instant, SystemTime};

/// Time between two looks.
pub const INTERVAL: Duration = Duration::from_millis(500);

/// Files and when they were last written.
pub struct Watch {
    files: Vec<(PathBuf, Option<SystemTime>)>,
    next: Instant,
}

impl Watch {
    /// Watches `files` from now on.
    pub fn new(files: Vec<PathBuf>) -> Self {
        let with_time = |path: PathBuf| {
            let time = written(&path);
            (path, time)
        };
        Self {
            files: files.into_iter().map(with_time).collect(),
            next: Instant::now() + INTERVAL,
        }
    }

    /// When to look next; `None` if there is nothing to watch.
    pub fn next_look(&self) -> Option<Instant> {
        (!self.files.is_empty()).then_some(self.next)
    }

    /// True once after one of the files has changed.
    pub fn changed(&mut self, now: Instant) -> bool {
        if now < self.next {
            return false;
        }
        self.next = now + INTERVAL;
        let mut changed = false;
        for (path, time) in &mut self.files {
            let now = written(path);
            changed |= now != *time;
            *time = now;
        }
        changed
    }
}

fn written(path: &PathBuf) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|m| m.modified()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_seen_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        std::fs::write(&path, "1").expect("a file");
        let mut watch = Watch::new(vec![path.clone()]);
        let later = Instant::now() + 10 * INTERVAL;
        assert!(!watch.changed(later));
        let past = SystemTime::UNIX_EPOCH + Duration::from_secs(1);
        let file = std::fs::File::options()
            .write(true)
            .open(&path)
            .expect("a file");
        file.set_modified(past).expect("a time");
        assert!(!watch.changed(later), "it is not yet time to look");
        assert!(watch.changed(later + INTERVAL));
        assert!(!watch.changed(later + 2 * INTERVAL));
        std::fs::remove_file(&path).expect("it goes");
        assert!(watch.changed(later + 3 * INTERVAL));
    }

    #[test]
    fn nothing_is_watched_without_files() {
        assert_eq!(Watch::new(Vec::new()).next_look(), None);
    }
}
