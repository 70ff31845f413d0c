//! A scene that is about to take the place of the one shown: how far it is, and that nobody wants it any more.

use std::panic::resume_unwind;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::session::document::Opened;
use crate::session::progress::Progress;
use crate::session::{Session, SessionError};

/// Nobody is told of an opening that is over so soon.
pub const TOLD_AFTER: Duration = Duration::from_millis(300);

/// Whether anyone still waits is looked at this often.
const LOOK: Duration = Duration::from_millis(20);

/// Makes a sandbox on a thread of its own, which is left alone to end once nobody waits for it: not all of the way hears
/// that it is to stop.
pub(super) fn open(opened: Opened, progress: &Arc<Progress>) -> Result<Session, SessionError> {
    let (done, outcome) = channel();
    let watch = Arc::clone(progress);
    let thread = std::thread::spawn(move || {
        let abandoned = done.send(Session::open(opened, &*watch)).is_err();
        log::debug!("a scene is opened, and nobody waits for it: {abandoned}");
    });
    while !progress.is_cancelled() {
        match outcome.recv_timeout(LOOK) {
            Ok(session) => return session,
            Err(RecvTimeoutError::Timeout) => (),
            Err(RecvTimeoutError::Disconnected) => match thread.join() {
                Err(panic) => resume_unwind(panic),
                Ok(()) => break,
            },
        }
    }
    Err(SessionError::Stopped)
}

/// The newest scene that was asked for, from when until it is there.
#[derive(Debug, Default)]
pub(super) struct Opening {
    asked: Mutex<Option<(Instant, Arc<Progress>)>>,
}

impl Opening {
    /// Another scene is asked for: what was to be opened before is no longer wanted.
    pub(super) fn begin(&self) -> Arc<Progress> {
        let progress = Arc::new(Progress::default());
        if let Some((_, before)) = self.lock().replace((Instant::now(), Arc::clone(&progress))) {
            before.cancel();
        }
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
