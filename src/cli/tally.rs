//! Counts the pieces of work that several threads have done, for a progress bar.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::out::Progress;
use crate::geometry::Watch;

/// A progress bar that several threads advance.
#[derive(Debug)]
pub(super) struct Tally {
    bar: Progress,
    done: AtomicUsize,
    all: usize,
}

impl Tally {
    /// A bar for `all` pieces of work.
    pub(super) fn new(what: &str, all: usize) -> Self {
        Self { bar: Progress::new(what), done: AtomicUsize::new(0), all }
    }

    /// Counts one more piece as done.
    pub(super) fn increment(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        self.bar.progress(done as f64 / self.all.max(1) as f64);
    }
}
