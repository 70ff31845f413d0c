//! Pauses a simulation for a moment, so that another thread has the processors: on a software driver a picture that a person
//! waits for is drawn in half the time if no step runs beside it.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The longest hold of a simulation at a time, whatever becomes of the holder.
const LONGEST: Duration = Duration::from_millis(50);

/// Holds a simulation between two substeps, from another thread.
#[derive(Debug, Default)]
pub struct Hold {
    held: Mutex<bool>,
    let_go: Condvar,
}

impl Hold {
    /// Makes the simulation wait before its next substep, until it is let go.
    pub fn hold(&self) {
        *self.lock() = true;
    }

    /// Lets the simulation go on.
    pub fn let_go(&self) {
        *self.lock() = false;
        self.let_go.notify_all();
    }

    /// Waits as long as this is held, [`LONGEST`] at most.
    pub(super) fn wait(&self) {
        let held = self.lock();
        if *held {
            // A thread that has panicked leaves nothing half done here.
            let waited = self.let_go.wait_timeout_while(held, LONGEST, |held| *held);
            drop(waited.unwrap_or_else(PoisonError::into_inner));
        }
    }

    fn lock(&self) -> MutexGuard<'_, bool> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};

    use super::*;

    #[test]
    fn what_is_held_waits_until_it_is_let_go_or_forgotten() {
        let (hold, passed) = (Arc::new(Hold::default()), Arc::new(AtomicBool::new(false)));
        hold.wait();
        hold.hold();
        let waiting = std::thread::spawn({
            let (hold, passed) = (Arc::clone(&hold), Arc::clone(&passed));
            move || {
                hold.wait();
                passed.store(true, Ordering::SeqCst);
            }
        });
        hold.let_go();
        waiting.join().expect("it ends");
        assert!(passed.load(Ordering::SeqCst));
        hold.hold();
        hold.wait();
        assert!(*hold.lock(), "nobody has let go, and nobody waits for ever");
    }
}
