//! Reading and preparing scenes beside the window.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use super::source::SceneSource;
use crate::engine::scene::Scene;

/// What became of a request.
pub struct Loaded {
    /// The scene asked for.
    pub source: SceneSource,
    /// Whether it is the scene shown, read again.
    pub again: bool,
    /// The scene, or a sentence.
    pub scene: Result<Arc<Scene>, String>,
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

    /// Starts to load `source`, on a thread that nobody waits for.
    ///
    /// # Errors
    /// A sentence if the system refuses to start a thread.
    pub fn start(&mut self, source: SceneSource, again: bool) -> Result<(), String> {
        self.newest += 1;
        let (number, sender) = (self.newest, self.sender.clone());
        let wake = Arc::clone(&self.wake);
        let work = move || {
            let scene = catch_unwind(AssertUnwindSafe(|| prepare(&source)))
                .unwrap_or_else(|_| Err(format!("a bug stopped the reading of {source}")));
            let loaded = Loaded {
                source,
                again,
                scene,
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

fn prepare(source: &SceneSource) -> Result<Arc<Scene>, String> {
    let desc = source.read()?;
    Scene::build(&desc)
        .map(Arc::new)
        .map_err(|error| format!("{source}: {error}"))
}
