//! Finds the modes that a body of the sandbox waits for, in the background.

use std::sync::Arc;

use super::Shell;
use crate::app::background_job::JobControl;
use crate::app::kept_file;
use crate::session::wanted_modes::{find_modes, folder};

impl Shell {
    /// Starts the work on the awaited modes. It takes no rests, since time stands still meanwhile.
    pub(super) fn find_awaited_modes(&mut self, wake: impl FnOnce() + Send + 'static) {
        let Some(snapshot) = &self.snapshot else { return };
        let (scene, base_dir) = (Arc::clone(&snapshot.scene), snapshot.status.base_dir.clone());
        let file = snapshot.status.file.clone();
        self.ui.finding.follow(snapshot.status.awaited_modes.as_ref());
        let of = self.ui.finding.of().map(Arc::clone);
        let work = || {
            let (of, folder) = (of?, folder(file.as_deref(), kept_file::cache_folder()));
            Some(move |control: JobControl<'_>| {
                find_modes(&scene, &base_dir, &of, folder.as_deref(), control.progress, &|| ())
            })
        };
        self.awaited_job.handle_request(&mut self.ui.finding.job, work, wake);
    }

    /// Passes the result on to the sandbox.
    pub(super) fn answer_awaited_modes(&mut self) {
        self.awaited_job.answer(&mut self.ui.finding.job);
        if let Some(command) = self.ui.finding.take() {
            self.send(command);
        }
    }
}
