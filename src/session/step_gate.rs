//! Pauses a simulation for a moment, so that another thread has the processors: on a software driver a picture that a person
//! waits for is drawn in half the time if no step runs beside it.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The longest hold of a simulation at a time, whatever becomes of the holder.
const MAX_WAIT: Duration = Duration::from_millis(50);

/// Holds a simulation between two substeps, from another thread.
#[derive(Debug, Default)]
pub struct StepGate {
    closed: Mutex<bool>,
    opened: Condvar,
}

impl StepGate {
    /// Makes the simulation wait before its next substep, until it is let go.
    pub fn close(&self) {
        *self.lock() = true;
    }

    /// Lets the simulation go on.
    pub fn open(&self) {
        *self.lock() = false;
        self.opened.notify_all();
    }

    /// Waits as long as this is closed, [`MAX_WAIT`] at most.
    pub(super) fn wait(&self) {
        let closed = self.lock();
        if *closed {
            // A thread that has panicked leaves nothing half done here.
            let waited = self.opened.wait_timeout_while(closed, MAX_WAIT, |closed| *closed);
            drop(waited.unwrap_or_else(PoisonError::into_inner));
        }
    }

    fn lock(&self) -> MutexGuard<'_, bool> {
        self.closed.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};

    use super::*;

    #[test]
    fn what_is_held_waits_until_it_is_let_go_or_forgotten() {
        let (gate, passed) = (Arc::new(StepGate::default()), Arc::new(AtomicBool::new(false)));
        gate.wait();
        gate.close();
        let waiting = std::thread::spawn({
            let (gate, passed) = (Arc::clone(&gate), Arc::clone(&passed));
            move || {
                gate.wait();
                passed.store(true, Ordering::SeqCst);
            }
        });
        gate.open();
        waiting.join().expect("it ends");
        assert!(passed.load(Ordering::SeqCst));
        gate.close();
        gate.wait();
        assert!(*gate.lock(), "nobody has let go, and nobody waits for ever");
    }
}
