//! The owner's side of a session.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use super::job::RenderJob;
use super::{priority, worker};
use crate::engine::film::Frame;
use crate::engine::integrators::{GiveWay, Hold};

/// What owner and worker share.
pub(super) struct Shared {
    mailbox: Mutex<Mailbox>,
    changed: Condvar,
    /// Epoch of the newest job; anything else is cancelled.
    pub newest: Arc<AtomicU64>,
    /// Held while the owner must not wait.
    pub give_way: Arc<GiveWay>,
    latest: Mutex<Option<Arc<Frame>>>,
    wake: Box<dyn Fn() + Send + Sync>,
}

/// One slot: the latest job wins.
#[derive(Default)]
struct Mailbox {
    job: Option<(u64, Box<RenderJob>)>,
    paused: bool,
    closing: bool,
}

/// What the worker finds when it looks.
pub(super) enum Mail {
    Job(u64, Box<RenderJob>),
    Paused,
    Nothing,
    Closing,
}

/// Epoch that no job has: it cancels whatever runs.
const CLOSING: u64 = u64::MAX;

impl Shared {
    fn mailbox(&self) -> MutexGuard<'_, Mailbox> {
        self.mailbox.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Looks into the mailbox; with `wait` it returns only when there is something to do.
    pub fn look(&self, wait: bool) -> Mail {
        let mut mailbox = self.mailbox();
        loop {
            if mailbox.closing {
                return Mail::Closing;
            }
            if let Some((epoch, job)) = mailbox.job.take() {
                return Mail::Job(epoch, job);
            }
            if !wait {
                return if mailbox.paused {
                    Mail::Paused
                } else {
                    Mail::Nothing
                };
            }
            mailbox = self
                .changed
                .wait(mailbox)
                .unwrap_or_else(PoisonError::into_inner);
            if !mailbox.paused && mailbox.job.is_none() && !mailbox.closing {
                return Mail::Nothing;
            }
        }
    }

    /// Shows a frame to the owner.
    pub fn publish(&self, frame: Arc<Frame>) {
        *self.latest.lock().unwrap_or_else(PoisonError::into_inner) = Some(frame);
        (self.wake)();
    }
}

/// A worker thread that renders the newest job until it is closed. Dropping the session cancels
/// the pass under way and ends the thread.
pub struct RenderSession {
    shared: Arc<Shared>,
    worker: Option<JoinHandle<()>>,
    epoch: u64,
}

impl RenderSession {
    /// Starts a worker with `threads` threads (0: one a core). It calls `wake` after each frame.
    ///
    /// # Errors
    /// If the system refuses to start threads.
    pub fn new(
        threads: usize,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> Result<Self, Box<dyn std::error::Error + Send + Sync>> {
        let shared = Arc::new(Shared {
            mailbox: Mutex::default(),
            changed: Condvar::new(),
            newest: Arc::new(AtomicU64::new(0)),
            give_way: Arc::default(),
            latest: Mutex::default(),
            wake: Box::new(wake),
        });
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|i| format!("render-{i}"))
            .start_handler(|_| priority::lower())
            .build()?;
        let for_worker = Arc::clone(&shared);
        let worker = std::thread::Builder::new()
            .name("render".to_owned())
            .spawn(move || worker::run(&for_worker, &pool))?;
        Ok(Self {
            shared,
            worker: Some(worker),
            epoch: 0,
        })
    }

    /// Replaces the current job and cancels its pass. Returns the epoch that the job's frames
    /// will carry.
    pub fn submit(&mut self, job: RenderJob) -> u64 {
        self.epoch += 1;
        self.shared.mailbox().job = Some((self.epoch, Box::new(job)));
        self.shared.newest.store(self.epoch, Ordering::Relaxed);
        self.shared.changed.notify_one();
        self.epoch
    }

    /// The newest frame, of the newest job or, until that has one, of the one before.
    pub fn latest(&self) -> Option<Arc<Frame>> {
        self.shared
            .latest
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// Makes all passes but the first one of a moving view stand still until the result is dropped:
    /// for moments in which the owner needs all cores.
    pub fn hold(&self) -> Hold {
        self.shared.give_way.hold()
    }

    /// Stops after the pass under way, keeping all samples; or goes on.
    pub fn set_paused(&self, paused: bool) {
        self.shared.mailbox().paused = paused;
        self.shared.changed.notify_one();
    }

    /// Whether the session is paused.
    pub fn is_paused(&self) -> bool {
        self.shared.mailbox().paused
    }
}

impl Drop for RenderSession {
    fn drop(&mut self) {
        self.shared.mailbox().closing = true;
        self.shared.newest.store(CLOSING, Ordering::Relaxed);
        self.shared.changed.notify_one();
        if let Some(worker) = self.worker.take() {
            // A panic of the worker was already shown as an error in a frame.
            let _ = worker.join();
        }
    }
}
