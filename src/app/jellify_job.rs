//! Makes a model into a body on a thread of its own, while window and sandbox keep running. Dropping a job stops it.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use super::sentence::sentence;
use crate::session::jellify::{Jellified, JellifyError, Wanted, jellify};
use crate::session::progress::Progress;

/// Work in progress.
#[derive(Debug)]
pub(super) struct JellifyJob {
    progress: Arc<Progress>,
    outcome: Receiver<Result<Jellified, JellifyError>>,
}

/// The outcome of the work.
#[derive(Debug)]
pub(super) enum Outcome {
    /// It is not finished.
    Waiting,
    /// The body is ready.
    Ready(Box<Jellified>),
    /// It was stopped.
    Cancelled,
    /// The body cannot be made; the reason as a sentence.
    Failed(String),
}

impl Drop for JellifyJob {
    fn drop(&mut self) {
        self.progress.cancel();
    }
}

impl JellifyJob {
    /// Begins the work. `wake` is called when it ends.
    pub(super) fn start(wanted: Wanted, wake: impl FnOnce() + Send + 'static) -> Self {
        let (send, outcome) = channel();
        let progress = Arc::new(Progress::default());
        let watched = Arc::clone(&progress);
        std::thread::spawn(move || {
            if send.send(jellify(&wanted, &watched)).is_err() {
                log::debug!("nobody waits for {} any more", wanted.model.path);
            }
            wake();
        });
        Self { progress, outcome }
    }

    /// How far the work is.
    pub(super) fn progress(&self) -> Arc<Progress> {
        Arc::clone(&self.progress)
    }

    /// The outcome of the work so far.
    pub(super) fn outcome(&self) -> Outcome {
        match self.outcome.try_recv() {
            Ok(Ok(body)) => Outcome::Ready(Box::new(body)),
            Ok(Err(JellifyError::Cancelled)) => Outcome::Cancelled,
            Ok(Err(error)) => Outcome::Failed(sentence(&error)),
            Err(TryRecvError::Empty) => Outcome::Waiting,
            Err(TryRecvError::Disconnected) => Outcome::Failed("an error in the program ended the work".to_owned()),
        }
    }
}
