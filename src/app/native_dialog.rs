//! The system's own dialogs to choose a file, each on a thread of its own: the window keeps running while one is open. If
//! the system has none, the answer is [`Answer::NoDialog`], and the path field beside the button still works.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

use super::ui::files::PathUse;
use crate::scene::body::{MODEL_ENDINGS, MODEL_FORMATS};

/// If nothing was chosen within this time and the window kept the keyboard, there was no dialog. A dialog would have taken
/// the keyboard, and with one that does not, a person takes longer.
const TOO_FAST: Duration = Duration::from_secs(5);

/// An open dialog.
#[derive(Debug)]
pub(super) struct NativeDialog {
    purpose: PathUse,
    answer: Receiver<Option<PathBuf>>,
    opened: Instant,
    /// Whether the window has lost the keyboard since.
    seen: bool,
}

/// The answer of a dialog.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    /// It is still open.
    Waiting,
    /// A path was chosen.
    Chosen(PathBuf),
    /// It was closed without a choice.
    Nothing,
    /// There was no dialog.
    NoDialog,
}

impl NativeDialog {
    /// Opens a dialog that starts in a folder. `wake` is called when it closes.
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

    /// Notes that the window has lost the keyboard: the dialog is there.
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
