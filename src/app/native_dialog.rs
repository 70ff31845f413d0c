//! The system's own dialogs to choose a file in, on a thread of their own: the window goes on while one is open. Where
//! the system has none, the answer is that nothing was chosen, and the path field beside the button still works.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

use super::ui::files::PathUse;
use crate::scene::body::{MODEL_ENDINGS, MODEL_FORMATS};

/// Where the window kept the keyboard and nothing was chosen within this time, there was no dialog: one would have taken
/// the keyboard, and a person takes longer over one that does not.
const TOO_FAST: Duration = Duration::from_secs(5);

/// A dialog that is open.
#[derive(Debug)]
pub(super) struct NativeDialog {
    purpose: PathUse,
    answer: Receiver<Option<PathBuf>>,
    opened: Instant,
    /// Something has taken the keyboard from the window since.
    seen: bool,
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
                PathUse::OpenModel => {
                    dialog.set_title("Load model").add_filter(MODEL_FORMATS, &MODEL_ENDINGS).pick_file()
                }
                PathUse::OpenMesh => dialog.set_title("Add mesh").add_filter(MODEL_FORMATS, &MODEL_ENDINGS).pick_file(),
                PathUse::OpenState => {
                    dialog.set_title("Open state").add_filter("Gelatin state", &["state"]).pick_file()
                }
                PathUse::SaveState => {
                    dialog.set_title("Save state as").add_filter("Gelatin state", &["state"]).save_file()
                }
                PathUse::Collect => dialog.set_title("Collect the scene and its models").pick_folder(),
                PathUse::SaveScene => {
                    dialog.set_title("Save scene as").add_filter("Gelatin scene", &["ron"]).save_file()
                }
            };
            if send.send(chosen).is_err() {
                log::debug!("the window has gone: the answer of the dialog is dropped");
            }
            wake();
        });
        Self { purpose, answer, opened: Instant::now(), seen: false }
    }

    /// What the dialog is for.
    pub(super) fn purpose(&self) -> PathUse {
        self.purpose
    }

    /// The window has lost the keyboard: the dialog is there.
    pub(super) fn on_keyboard_lost(&mut self) {
        self.seen = true;
    }

    /// The answer, if there is one yet.
    pub(super) fn answer(&self) -> Answer {
        match self.answer.try_recv() {
            Ok(Some(path)) => Answer::Chosen(path),
            Err(TryRecvError::Empty) => Answer::Waiting,
            Ok(None) | Err(TryRecvError::Disconnected) if !self.seen && self.opened.elapsed() < TOO_FAST => {
                Answer::NoDialog
            }
            Ok(None) | Err(TryRecvError::Disconnected) => Answer::Nothing,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answered(with: Option<&str>, secs_ago: u64) -> NativeDialog {
        let (send, answer) = channel();
        send.send(with.map(PathBuf::from)).expect("the other end is there");
        let opened = Instant::now().checked_sub(Duration::from_secs(secs_ago)).expect("the clock runs for longer");
        NativeDialog { purpose: PathUse::OpenScene, answer, opened, seen: false }
    }

    #[test]
    fn a_dialog_that_nobody_has_seen_was_not_there() {
        assert_eq!(answered(None, 1).answer(), Answer::NoDialog, "slow, on a busy machine, but never seen");
        let mut seen = answered(None, 1);
        seen.on_keyboard_lost();
        assert_eq!(seen.answer(), Answer::Nothing, "put away");
        assert_eq!(answered(None, 9).answer(), Answer::Nothing, "a person took their time");
        assert_eq!(answered(Some("/a.ron"), 1).answer(), Answer::Chosen("/a.ron".into()));
    }
}
