//! The system's own dialogs to choose a file in, on a thread of their own: the window goes on while one is open. Where
//! the system has none, the answer is that nothing was chosen, and the path field beside the button still works.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

use super::ui::files::PathUse;

/// Nobody puts a dialog away as fast as this: the system has none.
const TOO_FAST: Duration = Duration::from_millis(400);

/// A dialog that is open.
#[derive(Debug)]
pub(super) struct NativeDialog {
    purpose: PathUse,
    answer: Receiver<Option<PathBuf>>,
    opened: Instant,
}

/// What a dialog was answered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    /// It is still open.
    Waiting,
    /// A path was chosen.
    Chosen(PathBuf),
    /// It was put away.
    Nothing,
    /// It was never there.
    NoDialog,
}

impl NativeDialog {
    /// Opens a dialog that starts in a folder. `wake` is called when it is answered.
    pub(super) fn open(purpose: PathUse, folder: &Path, wake: impl FnOnce() + Send + 'static) -> Self {
        let (send, answer) = channel();
        let folder = folder.to_owned();
        std::thread::spawn(move || {
            let dialog = rfd::FileDialog::new().set_directory(folder);
            let chosen = match purpose {
                PathUse::OpenScene => dialog.set_title("Open scene").add_filter("Gelatin scene", &["ron"]).pick_file(),
                PathUse::OpenModel => dialog.set_title("Load model").add_filter("OBJ model", &["obj"]).pick_file(),
                PathUse::SaveScene => {
                    dialog.set_title("Save scene as").add_filter("Gelatin scene", &["ron"]).save_file()
                }
            };
            if send.send(chosen).is_err() {
                log::debug!("the window has gone: the answer of the dialog is dropped");
            }
            wake();
        });
        Self { purpose, answer, opened: Instant::now() }
    }

    /// What the dialog is for.
    pub(super) fn purpose(&self) -> PathUse {
        self.purpose
    }

    /// The answer, if there is one yet.
    pub(super) fn answer(&self) -> Answer {
        match self.answer.try_recv() {
            Ok(Some(path)) => Answer::Chosen(path),
            Err(TryRecvError::Empty) => Answer::Waiting,
            Ok(None) | Err(TryRecvError::Disconnected) if self.opened.elapsed() < TOO_FAST => Answer::NoDialog,
            Ok(None) | Err(TryRecvError::Disconnected) => Answer::Nothing,
        }
    }
}
