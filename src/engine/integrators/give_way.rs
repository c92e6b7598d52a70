//! Lets work that somebody waits for go first.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Longest wait at one look: a holder that hangs must not stop the render.
const LONGEST: Duration = Duration::from_millis(60);

/// While it is held, passes stand still wherever they ask whether they are still wanted. Lower
/// priority alone is not enough where the graphics driver is software: its threads, one a core,
/// then share each core with one that renders, and the slowest of them decides.
#[derive(Debug, Default)]
pub struct GiveWay {
    holders: AtomicU32,
    lock: Mutex<()>,
    free: Condvar,
}

/// Renders stand still as long as this lives.
#[derive(Debug)]
pub struct Hold(Arc<GiveWay>);

impl GiveWay {
    /// Makes renders wait until the result is dropped.
    pub fn hold(self: &Arc<Self>) -> Hold {
        self.holders.fetch_add(1, Ordering::Relaxed);
        Hold(Arc::clone(self))
    }

    /// Waits as long as it is held, but not for ever.
    #[inline]
    pub fn wait(&self) {
        if self.holders.load(Ordering::Relaxed) > 0 {
            self.wait_until_free();
        }
    }

    #[cold]
    fn wait_until_free(&self) {
        let guard = self.lock.lock().unwrap_or_else(PoisonError::into_inner);
        let held = |(): &mut ()| self.holders.load(Ordering::Relaxed) > 0;
        // What is waited for is no data: a poisoned lock and a wait that is too long say nothing.
        let _ = self.free.wait_timeout_while(guard, LONGEST, held);
    }
}

impl Drop for Hold {
    fn drop(&mut self) {
        let Self(gate) = self;
        // Within the lock, so that nobody falls asleep between its look and this news.
        let _guard = gate.lock.lock().unwrap_or_else(PoisonError::into_inner);
        gate.holders.fetch_sub(1, Ordering::Relaxed);
        gate.free.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicBool;

    #[test]
    fn who_waits_goes_on_when_the_last_hold_ends() {
        let gate = Arc::new(GiveWay::default());
        gate.wait();
        let holds = [gate.hold(), gate.hold()];
        let passed = Arc::new(AtomicBool::new(false));
        let waiting = {
            let (gate, passed) = (Arc::clone(&gate), Arc::clone(&passed));
            std::thread::spawn(move || {
                while gate.holders.load(Ordering::Relaxed) > 0 {
                    gate.wait();
                }
                passed.store(true, Ordering::Relaxed);
            })
        };
        let [first, second] = holds;
        drop(first);
        std::thread::sleep(2 * LONGEST);
        assert!(!passed.load(Ordering::Relaxed), "one still holds");
        drop(second);
        waiting.join().expect("it goes on");
        assert!(passed.load(Ordering::Relaxed));
    }

    #[test]
    fn a_hold_that_never_ends_stops_nobody_for_ever() {
        let gate = Arc::new(GiveWay::default());
        let _hold = gate.hold();
        gate.wait();
    }
}
