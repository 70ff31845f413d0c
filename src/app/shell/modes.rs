//! Has the modes found that a body of the sandbox waits for, beside it.

use std::sync::Arc;

use super::Shell;
use crate::app::background_job::Beside;
use crate::app::kept_file;
use crate::session::wanted_modes::{find_modes, folder};

impl Shell {
    /// Looks for what a body waits for now. Nothing rests meanwhile, as time stands still.
    pub(super) fn find_awaited_modes(&mut self, wake: impl FnOnce() + Send + 'static) {
        let Some(snapshot) = &self.snapshot else { return };
        let (scene, base_dir) = (Arc::clone(&snapshot.scene), snapshot.status.base_dir.clone());
        let file = snapshot.status.file.clone();
        self.ui.finding.follow(snapshot.status.awaited_modes.as_ref());
        let of = self.ui.finding.of().map(Arc::clone);
        let work = || {
            let (of, folder) = (of?, folder(file.as_deref(), kept_file::cache_folder()));
            Some(move |beside: Beside<'_>| {
                find_modes(&scene, &base_dir, &of, folder.as_deref(), beside.progress, &|| ())
            })
        };
        self.awaited_job.grant(&mut self.ui.finding.asked, work, wake);
    }

    /// Tells the sandbox what came of it.
    pub(super) fn answer_awaited_modes(&mut self) {
        self.awaited_job.answer(&mut self.ui.finding.asked);
        if let Some(command) = self.ui.finding.take() {
            self.send(command);
        }
    }
}
