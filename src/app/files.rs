//! Files from the window's side: the system's dialogs, the list of recent files, drafts against crashes, and the panels'
//! requests. Remembers nothing of the scene itself.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use super::jellify_job::{JellifyJob, Outcome};
use super::native_dialog::{Answer, NativeDialog};
use super::recent::Recent;
use super::recovery::{self, Draft, Found, Keeper};
use super::ui::files::{FileRequest, FilesState, FoundDraft, Work};
use super::worker::Snapshot;
use crate::scene::Scene;
use crate::scene::view_settings::CameraSettings;
use crate::session::{Command, Status};

/// An unsaved change is kept as a draft after this time.
const DRAFT_DELAY: Duration = Duration::from_secs(1);

/// The window's state about files.
#[derive(Debug)]
pub(super) struct Files {
    recent: Recent,
    keeper: Option<Keeper>,
    found: Vec<Found>,
    native: Option<NativeDialog>,
    job: Option<JellifyJob>,
    /// The scene last kept as a draft.
    kept: Option<Arc<Scene>>,
    file: Option<PathBuf>,
    /// The recovery of the first found draft: the number of its command, and the scene's generation before.
    recovering: Option<(u64, u64)>,
    generation: u64,
}

/// The outcome of the panels' requests.
#[derive(Debug, Default)]
pub(super) struct RequestOutcome {
    /// Commands for the session.
    pub(super) commands: Vec<Command>,
    /// The window is to close.
    pub(super) quit: bool,
}

impl Files {
    /// Reads the state folder and tells the panels what is there.
    pub(super) fn new(folder: Option<&Path>, ui: &mut FilesState) -> Self {
        let drafts = folder.map(|folder| folder.join("drafts"));
        let found = drafts.as_deref().map(recovery::find).unwrap_or_default();
        let keeper = drafts.and_then(|drafts| {
            let started = Keeper::start(&drafts, DRAFT_DELAY);
            started.inspect_err(|error| log::error!("{}: no drafts can be kept: {error}", drafts.display())).ok()
        });
        let recent = Recent::new(folder);
        ui.recent = recent.paths();
        let files = Self {
            recent,
            keeper,
            found,
            native: None,
            job: None,
            kept: None,
            file: None,
            recovering: None,
            generation: 0,
        };
        files.offer(ui);
        files
    }

    /// Takes note of a new snapshot.
    pub(super) fn on_snapshot(&mut self, snapshot: &Snapshot, ui: &mut FilesState) {
        let status = &snapshot.status;
        if status.file != self.file {
            self.file.clone_from(&status.file);
            if let Some(file) = &self.file {
                ui.recent = self.recent.add(file);
                ui.folders.scene = file.parent().map(Path::to_owned);
            }
        }
        self.generation = snapshot.generation;
        if let Some((_, before)) = self.recovering.take_if(|(number, _)| *number <= snapshot.answered) {
            if snapshot.generation > before {
                self.adopt();
            }
            // If it failed, the draft stays on offer.
            self.offer(ui);
        }
    }

    /// Keeps a scene with unsaved changes, seen by `camera`, as a draft.
    pub(super) fn keep_draft(&mut self, status: &Status, scene: &Arc<Scene>, camera: CameraSettings) {
        let Some(keeper) = &self.keeper else { return };
        if !status.unsaved {
            if self.kept.take().is_some() {
                keeper.forget();
            }
        } else if self.kept.as_ref().is_none_or(|kept| !Arc::ptr_eq(kept, scene)) {
            self.kept = Some(Arc::clone(scene));
            keeper.keep(Draft {
                scene: Arc::clone(scene),
                camera,
                base_dir: status.base_dir.clone(),
                title: status.title.clone(),
                file: status.file.clone(),
                on_disk: status.on_disk,
            });
        }
    }

    /// Passes on the answer of a system dialog and the outcome of making a model.
    pub(super) fn answer(&mut self, ui: &mut FilesState) {
        self.poll_job(ui);
        let Some(native) = &self.native else { return };
        match native.answer() {
            Answer::Waiting => return,
            Answer::Chosen(path) => ui.browsed(native.purpose(), Some(&path)),
            Answer::Nothing => ui.browsed(native.purpose(), None),
            Answer::NoDialog => ui.has_no_browser(),
        }
        self.native = None;
    }

    /// Notes that the window has lost the keyboard, perhaps to a system dialog.
    pub(super) fn on_keyboard_lost(&mut self) {
        if let Some(native) = &mut self.native {
            native.on_keyboard_lost();
        }
    }

    /// Handles the panels' requests. `wake` is called when long work is done.
    pub(super) fn handle_requests(
        &mut self,
        ui: &mut FilesState,
        wake: impl Fn() + Clone + Send + 'static,
    ) -> RequestOutcome {
        let mut outcome = RequestOutcome::default();
        for request in std::mem::take(&mut ui.requests) {
            match request {
                FileRequest::Browse(purpose, folder) => {
                    if self.native.is_none() {
                        self.native = Some(NativeDialog::open(purpose, &folder, wake.clone()));
                    }
                }
                FileRequest::Jellify(wanted) => {
                    let job = JellifyJob::start(*wanted, wake.clone());
                    ui.set_work(Work::Running(job.progress()));
                    self.job = Some(job);
                }
                FileRequest::StopJellifying => {
                    ui.set_work(Work::Idle);
                    self.job = None;
                }
                FileRequest::Quit => outcome.quit = true,
                FileRequest::Recover => {
                    outcome.commands.extend(self.recover());
                    ui.found = None;
                }
                FileRequest::DiscardFound => {
                    self.take_found().into_iter().for_each(Found::discard);
                    self.offer(ui);
                }
                FileRequest::ForgetRecent => {
                    self.recent.forget();
                    ui.recent.clear();
                }
            }
        }
        outcome
    }

    fn poll_job(&mut self, ui: &mut FilesState) {
        let Some(job) = &self.job else { return };
        match job.outcome() {
            Outcome::Waiting => return,
            Outcome::Ready(body) => ui.set_work(Work::Ready(body)),
            Outcome::Cancelled => ui.set_work(Work::Idle),
            Outcome::Failed(why) => ui.set_work(Work::Failed(why)),
        }
        self.job = None;
    }

    /// Notes that the window closes. The draft stays if the program has failed.
    pub(super) fn close(&mut self, failed: bool) {
        if let Some(keeper) = self.keeper.take() {
            keeper.close(failed);
        }
    }

    fn recover(&self) -> Option<Command> {
        let found = self.found.first()?;
        Some(Command::Recover {
            scene: Box::new(found.scene.clone()),
            title: found.title.clone(),
            file: found.file.clone(),
            on_disk: found.on_disk,
        })
    }

    /// Notes that another scene was asked for: the first found draft, by the command of this number, or one that takes its
    /// place.
    pub(super) fn note_scene_wanted(&mut self, recovery: Option<u64>, ui: &mut FilesState) {
        let before = std::mem::replace(&mut self.recovering, recovery.map(|number| (number, self.generation)));
        if before.is_some() && recovery.is_none() {
            self.offer(ui);
        }
    }

    /// Notes that the found draft is now the scene.
    fn adopt(&mut self) {
        if let Some(found) = self.take_found()
            && let Some(keeper) = &self.keeper
        {
            keeper.adopt(found);
        }
    }

    fn take_found(&mut self) -> Option<Found> {
        (!self.found.is_empty()).then(|| self.found.remove(0))
    }

    fn offer(&self, ui: &mut FilesState) {
        ui.found = self.found.first().map(|found| FoundDraft { title: found.title.clone(), when: found.when() });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::presets;
    use crate::view::DrawList;

    fn drafts_in(folder: &Path) -> usize {
        let entries = std::fs::read_dir(folder).expect("a folder").filter_map(Result::ok);
        entries.filter(|entry| entry.path().extension().is_some_and(|ending| ending == "ron")).count()
    }

    /// Leaves a draft in the state folder as a program that fails does.
    fn leave_draft(state: &Path) {
        let drafts = state.join("drafts");
        let keeper = Keeper::start(&drafts, Duration::ZERO).expect("the folder can be written");
        keeper.keep(Draft {
            scene: Arc::new(presets::ground_only()),
            camera: CameraSettings::default(),
            base_dir: PathBuf::new(),
            title: "lost".to_owned(),
            file: None,
            on_disk: None,
        });
        while drafts_in(&drafts) == 0 {
            std::thread::sleep(Duration::from_millis(5));
        }
        keeper.close(true);
    }

    fn snapshot(answered: u64, generation: u64, failed: bool) -> Snapshot {
        let status = Status { failed, ..Status::default() };
        Snapshot { draw_list: DrawList::default(), status, scene: Arc::default(), generation, answered }
    }

    /// What is left of a draft after its recovery was asked for by command 1, and `then`, and the window closed.
    fn drafts_left(then: impl FnOnce(&mut Files, &mut FilesState)) -> usize {
        let folder = tempfile::tempdir().expect("a folder");
        leave_draft(folder.path());
        let mut ui = FilesState::default();
        let mut files = Files::new(Some(folder.path()), &mut ui);
        assert_eq!(ui.found.as_ref().map(|found| found.title.as_str()), Some("lost"), "it is on offer");
        ui.requests.push(FileRequest::Recover);
        let outcome = files.handle_requests(&mut ui, || ());
        assert!(matches!(outcome.commands[..], [Command::Recover { .. }]), "{outcome:?}");
        files.note_scene_wanted(Some(1), &mut ui);
        then(&mut files, &mut ui);
        files.close(false);
        drafts_in(&folder.path().join("drafts"))
    }

    #[test]
    fn a_draft_that_was_recovered_goes_and_one_that_was_not_stays() {
        let recovered = drafts_left(|files, ui| {
            files.on_snapshot(&snapshot(1, 1, false), ui);
            assert!(ui.found.is_none());
        });
        assert_eq!(recovered, 0);
        let failed = drafts_left(|files, ui| {
            files.on_snapshot(&snapshot(1, 0, true), ui);
            assert!(ui.found.is_some(), "it is on offer again");
            files.note_scene_wanted(None, ui);
            files.on_snapshot(&snapshot(2, 1, false), ui);
        });
        assert_eq!(failed, 1, "another scene was opened instead");
        let given_up = drafts_left(|files, ui| {
            files.note_scene_wanted(None, ui);
            assert!(ui.found.is_some(), "it is on offer again");
            files.on_snapshot(&snapshot(2, 1, false), ui);
        });
        assert_eq!(given_up, 1, "another scene was opened before it was there");
    }
}
