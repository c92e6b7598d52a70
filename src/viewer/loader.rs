//! Reading and preparing scenes beside the window.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use super::opening::Opening;
use super::source::Read;
use crate::engine::scene::Scene;

/// What became of a request.
pub struct Loaded {
    /// What was asked for.
    pub opening: Opening,
    /// Whether it is the scene shown, read again.
    pub again: bool,
    /// The scene, or a sentence.
    pub scene: Result<Arc<Scene>, String>,
    /// The files it is made of.
    pub files: Vec<PathBuf>,
    /// Hash of the scene file.
    pub hash: String,
}

/// Loads one scene at a time; the newest request wins.
pub struct Loader {
    sender: Sender<(u64, Loaded)>,
    receiver: Receiver<(u64, Loaded)>,
    newest: u64,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl Loader {
    /// Calls `wake` when a scene is there.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        let (sender, receiver) = channel();
        Self {
            sender,
            receiver,
            newest: 0,
            wake: Arc::new(wake),
        }
    }

    /// Starts to load the scene of `opening`, on a thread that nobody waits for; `read` is what
    /// was read of it already.
    ///
    /// # Errors
    /// A sentence if the system refuses to start a thread.
    pub fn start(
        &mut self,
        opening: Opening,
        read: Option<Read>,
        again: bool,
    ) -> Result<(), String> {
        self.newest += 1;
        let (number, sender) = (self.newest, self.sender.clone());
        let wake = Arc::clone(&self.wake);
        let work = move || {
            let source = &opening.source;
            let (scene, files, hash) = catch_unwind(AssertUnwindSafe(|| prepare(&opening, read)))
                .unwrap_or_else(|_| {
                    let sentence = format!("a bug stopped the reading of {source}");
                    (Err(sentence), Vec::new(), String::new())
                });
            let loaded = Loaded {
                opening,
                again,
                scene,
                files,
                hash,
            };
            // A receiver that is gone no longer waits.
            let _ = sender.send((number, loaded));
            wake();
        };
        std::thread::Builder::new()
            .name("load".to_owned())
            .spawn(work)
            .map(drop)
            .map_err(|error| format!("no thread can be started to read the scene: {error}"))
    }

    /// The answer to the newest request, once.
    pub fn finished(&self) -> Option<Loaded> {
        let newest = |(number, loaded)| (number == self.newest).then_some(loaded);
        self.receiver.try_iter().filter_map(newest).last()
    }
}

/// The scene, its files and its hash.
fn prepare(
    opening: &Opening,
    read: Option<Read>,
) -> (Result<Arc<Scene>, String>, Vec<PathBuf>, String) {
    let (source, read) = (&opening.source, read.unwrap_or_else(|| opening.read()));
    let build = |desc| Scene::build(&desc).map_err(|error| format!("{source}: {error}"));
    let scene = read.desc.and_then(build).map(Arc::new);
    (scene, read.files, read.hash)
}
