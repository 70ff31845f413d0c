//! The flag that stops a long substep for an order that a person waits for.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// A flag that is up as long as urgent orders wait.
#[derive(Debug, Default)]
pub(super) struct UrgentOrders {
    waiting: Mutex<usize>,
    flag: Arc<AtomicBool>,
}

impl UrgentOrders {
    /// The flag, for whoever takes substeps.
    pub(super) fn flag(&self) -> &Arc<AtomicBool> {
        &self.flag
    }

    /// Raises the flag for an order that is about to be sent: once it is sent it may already have been taken.
    pub(super) fn announce(&self) {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        *waiting += 1;
        self.flag.store(true, Ordering::Relaxed);
    }

    /// Notes that so many were taken. The flag goes down with the last that waits.
    pub(super) fn take(&self, count: usize) {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        *waiting = waiting.saturating_sub(count);
        if *waiting == 0 {
            self.flag.store(false, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flag_is_up_while_any_waits() {
        let urgent = UrgentOrders::default();
        let is_up = || urgent.flag().load(Ordering::Relaxed);
        assert!(!is_up(), "nothing waits");
        urgent.announce();
        urgent.take(0);
        assert!(is_up(), "other orders came before it");
        urgent.announce();
        urgent.take(1);
        assert!(is_up(), "the second still waits");
        urgent.take(1);
        assert!(!is_up(), "all are taken");
    }
}
