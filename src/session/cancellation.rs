//! Runs work that cannot be cancelled, so that whoever waits for it can leave.

use std::panic::resume_unwind;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use crate::geometry::Watch;

/// How often to look whether anyone still waits.
const CANCEL_CHECK_INTERVAL: Duration = Duration::from_millis(20);

/// Returns the result of some work; none once nobody waits for it. The work runs on a thread of its own, which is then left
/// to end by itself. It runs on the caller's thread where the wait cannot be cancelled.
pub fn run_until_cancelled<T: Send + 'static>(
    watch: &dyn Watch,
    work: impl FnOnce() -> T + Send + 'static,
) -> Option<T> {
    if !watch.may_cancel() {
        return Some(work());
    }
    if watch.cancelled() {
        return None;
    }
    let (done, outcome) = channel();
    let thread = thread::spawn(move || {
        let is_left = done.send(work()).is_err();
        log::debug!("long work is done, and nobody waits for it: {is_left}");
    });
    loop {
        match outcome.recv_timeout(CANCEL_CHECK_INTERVAL) {
            Ok(result) => return Some(result),
            Err(RecvTimeoutError::Timeout) if watch.cancelled() => return None,
            Err(RecvTimeoutError::Timeout) => (),
            Err(RecvTimeoutError::Disconnected) => match thread.join() {
                Err(panic) => resume_unwind(panic),
                Ok(()) => return None,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::session::progress::Progress;

    #[test]
    fn who_leaves_does_not_wait_for_what_goes_on() {
        let progress = Progress::default();
        assert_eq!(run_until_cancelled(&progress, || 3), Some(3), "it is waited for");
        let begin = Instant::now();
        let left = thread::scope(|scope| {
            let waits = scope.spawn(|| run_until_cancelled(&progress, || thread::sleep(Duration::from_secs(20))));
            progress.cancel();
            waits.join().expect("no panic")
        });
        assert!(left.is_none() && begin.elapsed() < Duration::from_secs(10), "after {:?}", begin.elapsed());
        assert_eq!(run_until_cancelled(&progress, || 3), None, "nor is anything begun");
    }

    #[test]
    fn who_never_leaves_does_the_work() {
        let here = thread::current().id();
        assert_eq!(run_until_cancelled(&(), move || thread::current().id() == here), Some(true), "on this thread");
    }
}
