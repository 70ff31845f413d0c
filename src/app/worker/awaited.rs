//! What was asked for and takes long, a scene or a change of one: how far it is, and that nobody wants it any more.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::session::beside::while_awaited;
use crate::session::document::Opened;
use crate::session::progress::Progress;
use crate::session::{Session, SessionError};

/// Nobody is told of what is over so soon.
const TOLD_AFTER: Duration = Duration::from_millis(300);

/// Makes a sandbox unless nobody waits for it any more: not all of the way hears that it is to stop.
pub(super) fn open(opened: Opened, progress: &Arc<Progress>) -> Result<Session, SessionError> {
    let watch = Arc::clone(progress);
    while_awaited(&**progress, move || Session::open(opened, &*watch)).unwrap_or(Err(SessionError::Stopped))
}

/// The newest of its kind that was asked for, from when until it is there.
#[derive(Debug, Default)]
pub(super) struct Awaited {
    asked: Mutex<Option<(Instant, Arc<Progress>)>>,
}

impl Awaited {
    /// Another one is asked for.
    pub(super) fn begin(&self) -> Arc<Progress> {
        let progress = Arc::new(Progress::default());
        *self.lock() = Some((Instant::now(), Arc::clone(&progress)));
        progress
    }

    /// It is there, or will never be.
    pub(super) fn end(&self, progress: &Arc<Progress>) {
        let mut asked = self.lock();
        if asked.as_ref().is_some_and(|(_, newest)| Arc::ptr_eq(newest, progress)) {
            *asked = None;
        }
    }

    /// How far it is, once it takes long.
    pub(super) fn told(&self) -> Option<Arc<Progress>> {
        let asked = self.lock();
        let (since, progress) = asked.as_ref()?;
        (since.elapsed() >= TOLD_AFTER).then(|| Arc::clone(progress))
    }

    /// When it will be told of, if it is not there by then and is not told of yet.
    pub(super) fn told_at(&self) -> Option<Instant> {
        let at = self.lock().as_ref().map(|(since, _)| *since + TOLD_AFTER);
        at.filter(|at| *at > Instant::now())
    }

    /// Nobody waits for it any more.
    pub(super) fn cancel(&self) {
        if let Some((_, progress)) = &*self.lock() {
            progress.cancel();
        }
    }

    fn lock(&self) -> MutexGuard<'_, Option<(Instant, Arc<Progress>)>> {
        // It is written in one piece.
        self.asked.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
