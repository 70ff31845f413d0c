//! Long work beside a running sandbox, on the caller's thread: it reports its progress to [`Progress`], can be stopped
//! through it, and pauses now and then for other work.

use thiserror::Error;

use super::error::SessionError;
use super::progress::Progress;
use crate::geometry::Watch;
use crate::modal::ModalError;

/// Why work beside the sandbox gave no result.
#[derive(Debug, Error)]
pub enum BackgroundError {
    /// It was asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// There is nothing to measure.
    #[error("{0}")]
    NotPossible(&'static str),
    /// A body has no modes to show.
    #[error(transparent)]
    Modal(ModalError),
    /// The bodies cannot be made.
    #[error(transparent)]
    Session(SessionError),
}

impl From<SessionError> for BackgroundError {
    fn from(error: SessionError) -> Self {
        match error {
            SessionError::Stopped => Self::Cancelled,
            error => Self::Session(error),
        }
    }
}

/// Reports the progress of the work, and pauses between two pieces of it.
pub(super) struct PausingWatch<'a> {
    pub(super) progress: &'a Progress,
    pub(super) pause: &'a (dyn Fn() + Sync),
}

impl Watch for PausingWatch<'_> {
    fn progress(&self, fraction: f64) {
        self.progress.progress(fraction);
        if !self.progress.is_cancelled() {
            (self.pause)();
        }
    }

    fn cancelled(&self) -> bool {
        self.progress.is_cancelled()
    }
}
