//! How long work reports its progress and learns that it is cancelled. Knows no progress bar and no thread.

/// Someone who waits for long work. `()` waits in silence.
pub trait Watch: Sync {
    /// Receives the progress of the work, 0..1, never falling. It is called between pieces of work, so that it may take its
    /// time and leave the processors to others.
    fn progress(&self, _fraction: f64) {}

    /// Receives the number of particles that there will be.
    fn expect_particles(&self, _count: usize) {}

    /// Whether the work should stop; the work then returns its `Cancelled` error soon. This answers at once.
    fn cancelled(&self) -> bool {
        false
    }

    /// Whether [`Watch::cancelled`] may ever be true.
    fn may_cancel(&self) -> bool {
        true
    }
}

impl Watch for () {
    fn may_cancel(&self) -> bool {
        false
    }
}

/// Watches a part of longer work and reports its progress as that of the whole.
#[derive(Clone, Copy)]
pub(crate) struct Portion<'a> {
    watch: &'a dyn Watch,
    span: [f64; 2],
}

impl<'a> Portion<'a> {
    /// The part that leads from the first fraction of `span` to the second.
    pub(crate) fn new(watch: &'a dyn Watch, span: [f64; 2]) -> Self {
        Self { watch, span }
    }
}

impl Watch for Portion<'_> {
    fn progress(&self, fraction: f64) {
        let [start, end] = self.span;
        self.watch.progress(start + (end - start) * fraction);
    }

    fn expect_particles(&self, count: usize) {
        self.watch.expect_particles(count);
    }

    fn cancelled(&self) -> bool {
        self.watch.cancelled()
    }

    fn may_cancel(&self) -> bool {
        self.watch.may_cancel()
    }
}

/// Passes progress on only where it rises: reading several files begins anew with each.
pub(crate) struct Rising<'a> {
    watch: &'a dyn Watch,
    most: std::sync::Mutex<f64>,
}

impl<'a> Rising<'a> {
    /// Passes progress on to `watch`.
    pub(crate) fn new(watch: &'a dyn Watch) -> Self {
        Self { watch, most: std::sync::Mutex::new(0.0) }
    }
}

impl Watch for Rising<'_> {
    fn progress(&self, fraction: f64) {
        let mut most = self.most.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if fraction > *most {
            *most = fraction;
            self.watch.progress(fraction);
        }
    }

    fn cancelled(&self) -> bool {
        self.watch.cancelled()
    }

    fn may_cancel(&self) -> bool {
        self.watch.may_cancel()
    }
}

/// Passes on only cancellation, not progress: for work beside other work that reports its own.
pub(crate) struct CancelOnly<'a>(pub(crate) &'a dyn Watch);

impl Watch for CancelOnly<'_> {
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }

    fn may_cancel(&self) -> bool {
        self.0.may_cancel()
    }
}

/// Work in equal pieces whose order does not matter: counts them and passes the count on.
pub(crate) struct CountedProgress<'a> {
    watch: &'a dyn Watch,
    done: std::sync::Mutex<usize>,
    total: usize,
    span: [f64; 2],
}

impl<'a> CountedProgress<'a> {
    /// `total` pieces that lead from the first fraction of `span` to the second.
    pub(crate) fn new(watch: &'a dyn Watch, total: usize, span: [f64; 2]) -> Self {
        Self { watch, done: std::sync::Mutex::new(0), total, span }
    }

    /// Counts one more piece as done. Returns whether to go on.
    pub(crate) fn advance(&self) -> bool {
        // A poisoned lock means that a watcher panicked elsewhere; the count is still good.
        let mut done = self.done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        *done += 1;
        let [start, end] = self.span;
        self.watch.progress(start + (end - start) * (*done as f64 / self.total.max(1) as f64));
        !self.watch.cancelled()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    struct Log(Mutex<Vec<f64>>);

    impl Watch for Log {
        fn progress(&self, fraction: f64) {
            self.0.lock().expect("no panic before").push(fraction);
        }
        fn cancelled(&self) -> bool {
            self.0.lock().expect("no panic before").len() >= 2
        }
    }

    #[test]
    fn what_falls_is_not_handed_on() {
        let log = Log(Mutex::new(Vec::new()));
        let rising = Rising::new(&log);
        for fraction in [0.1, 0.4, 0.2, 0.4, 0.6] {
            rising.progress(fraction);
        }
        assert_eq!(*log.0.lock().expect("no panic before"), [0.1, 0.4, 0.6]);
        assert!(rising.cancelled(), "and it hears that nobody waits");
    }

    #[test]
    fn pieces_report_their_share_and_pass_a_cancel_on() {
        let log = Log(Mutex::default());
        let pieces = CountedProgress::new(&log, 4, [0.5, 1.0]);
        assert_eq!([pieces.advance(), pieces.advance()], [true, false], "cancelled after the second");
        assert_eq!(*log.0.lock().expect("no panic before"), [0.625, 0.75], "a quarter of the span each");
        assert!(CountedProgress::new(&(), 1, [0.0, 1.0]).advance(), "nobody cancels in silence");
    }

    #[test]
    fn a_portion_reports_its_share_of_the_whole() {
        let log = Log(Mutex::default());
        let portion = Portion::new(&log, [0.2, 0.6]);
        portion.progress(0.5);
        CancelOnly(&portion).progress(0.75);
        assert!(!CancelOnly(&portion).cancelled(), "not yet");
        portion.progress(1.0);
        assert_eq!(*log.0.lock().expect("no panic before"), [0.4, 0.6], "and nothing of what runs beside it");
        assert!(CancelOnly(&portion).cancelled(), "a cancel is passed on");
    }
}
