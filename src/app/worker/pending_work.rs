//! Long work that was requested, a scene or a change of one: its progress, and whether it is still wanted.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::session::cancellation::run_until_cancelled;
use crate::session::document::Opened;
use crate::session::progress::Progress;
use crate::session::{Session, SessionError};

/// Work that ends sooner than this is not reported.
const REPORT_DELAY: Duration = Duration::from_millis(300);

/// Opens a session, and gives up when it is no longer wanted, even in parts that do not look for that themselves.
pub(super) fn open(opened: Opened, progress: &Arc<Progress>) -> Result<Session, SessionError> {
    let watch = Arc::clone(progress);
    run_until_cancelled(&**progress, move || Session::open(opened, &*watch)).unwrap_or(Err(SessionError::Stopped))
}

/// The newest request of its kind, while it is not done.
#[derive(Debug, Default)]
pub(super) struct PendingWork {
    pending: Mutex<Option<(Instant, Arc<Progress>)>>,
}

impl PendingWork {
    /// Notes a new request and returns its progress.
    pub(super) fn begin(&self) -> Arc<Progress> {
        let progress = Arc::new(Progress::default());
        *self.lock() = Some((Instant::now(), Arc::clone(&progress)));
        progress
    }

    /// Notes that a request is done or has failed.
    pub(super) fn end(&self, progress: &Arc<Progress>) {
        let mut pending = self.lock();
        if pending.as_ref().is_some_and(|(_, newest)| Arc::ptr_eq(newest, progress)) {
            *pending = None;
        }
    }

    /// The progress of the request, once it takes long.
    pub(super) fn reported(&self) -> Option<Arc<Progress>> {
        let pending = self.lock();
        let (since, progress) = pending.as_ref()?;
        (since.elapsed() >= REPORT_DELAY).then(|| Arc::clone(progress))
    }

    /// When the request will begin to be reported, unless it is done by then; `None` if it is reported already.
    pub(super) fn report_time(&self) -> Option<Instant> {
        let at = self.lock().as_ref().map(|(since, _)| *since + REPORT_DELAY);
        at.filter(|at| *at > Instant::now())
    }

    /// Cancels the request.
    pub(super) fn cancel(&self) {
        if let Some((_, progress)) = &*self.lock() {
            progress.cancel();
        }
    }

    fn lock(&self) -> MutexGuard<'_, Option<(Instant, Arc<Progress>)>> {
        // The value is written in one piece.
        self.pending.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
