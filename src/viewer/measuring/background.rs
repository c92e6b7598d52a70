//! One piece of work at a time on a thread of its own.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Wakes the window.
#[derive(Clone)]
pub struct Waker(Arc<dyn Fn() + Send + Sync>);

impl Waker {
    /// Calls `wake`.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self(Arc::new(wake))
    }

    /// Wakes it.
    pub fn wake(&self) {
        (self.0)();
    }
}

impl Default for Waker {
    fn default() -> Self {
        Self::new(|| {})
    }
}

/// Work whose result is waited for by nobody.
pub struct Work<T>(Receiver<T>);

impl<T: Send + 'static> Work<T> {
    /// Starts it; none if the system refuses to start a thread.
    pub fn start(
        name: &str,
        wake: &Waker,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Option<Self> {
        let (sender, receiver) = channel();
        let wake = wake.clone();
        let run = move || {
            // A bug in there leaves no result, which the receiver sees.
            if let Ok(done) = catch_unwind(AssertUnwindSafe(work)) {
                let _ = sender.send(done);
            }
            wake.wake();
        };
        let thread = std::thread::Builder::new().name(name.to_owned());
        thread.spawn(run).ok().map(|_| Self(receiver))
    }

    /// The result, once; an error if there will be none.
    pub fn finished(&self) -> Option<Result<T, ()>> {
        match self.0.try_recv() {
            Ok(done) => Some(Ok(done)),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(())),
        }
    }
}
