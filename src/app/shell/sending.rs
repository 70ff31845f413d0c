//! The commands to the sandbox: which may be sent now, and what the window notes of them.

use std::sync::Arc;

use super::Shell;
use crate::app::unanswered::Change;
use crate::extract;
use crate::scene::Scene;
use crate::session::Command;

impl Shell {
    /// Sends a command to the sandbox, unless another must be answered before it makes sense.
    pub(super) fn send(&mut self, command: Command) {
        self.send_all([command]);
    }

    /// Sends commands that belong together, without those that must wait for the answer to one before.
    pub(super) fn send_all(&mut self, commands: impl IntoIterator<Item = Command>) {
        let commands: Vec<_> = commands.into_iter().filter(|command| !self.unanswered.bars(command)).collect();
        for command in commands {
            self.dispatch(command);
        }
        self.ask_for_long_work();
    }

    fn dispatch(&mut self, command: Command) {
        let answered = self.snapshot.as_ref().map_or(0, |snapshot| snapshot.answered);
        let is_step = matches!(command, Command::StepOnce);
        if is_step && self.stepped > answered {
            // The next one would have the one before given up.
            return;
        }
        let writes_file = matches!(
            command,
            Command::Save { .. } | Command::SaveAs { .. } | Command::Collect { .. } | Command::SaveState { .. }
        );
        let (change, replaces_scene) = (Change::by(&command), command.replaces_scene());
        let recovers = matches!(command, Command::Recover { .. });
        let number = self.worker.send(command);
        if is_step {
            self.stepped = number;
        }
        if writes_file {
            self.saved = number;
        }
        if replaces_scene {
            self.files.note_scene_wanted(recovers.then_some(number), &mut self.ui.files);
        }
        if let (Some(change), Some(snapshot)) = (change, &mut self.snapshot) {
            self.unanswered.note(number, change, &snapshot.scene);
            snapshot.status.unsaved |= self.unanswered.is_unsaved();
            self.note_scene();
        }
    }

    /// The scene as it will be when the sandbox has answered.
    pub(super) fn expected_scene(&self) -> Option<&Arc<Scene>> {
        self.snapshot.as_ref().map(|snapshot| self.unanswered.scene(&snapshot.scene))
    }

    /// Gives the title its mark if there are unsaved changes, and keeps them as a draft.
    pub(super) fn note_scene(&mut self) {
        let Some(snapshot) = &self.snapshot else { return };
        let named = (snapshot.status.title.clone(), snapshot.status.unsaved);
        if self.titled.as_ref() != Some(&named) {
            let (title, unsaved) = &named;
            let mark = if *unsaved { "• " } else { "" };
            self.window.set_title(&format!("{mark}{title} — Gelatin"));
            self.titled = Some(named);
        }
        let camera = extract::view::camera_settings(&self.orbit);
        self.files.keep_draft(&snapshot.status, self.unanswered.draft(&snapshot.scene), camera);
    }
}
