//! Shows how far the modes are that a body of the scene waits for: a card over the view, with a button that lets the body
//! move by its cells instead.

use std::sync::Arc;

use egui::{Rect, RichText, Ui};

use super::work::{JobRequest, PanelJob, Work};
use super::{card, theme, work};
use crate::session::wanted_modes::{FoundModes, WantedModes};
use crate::session::{Command, Status};

/// Width of the bar, points.
const BAR: f32 = 320.0;

/// The work on modes that a body waits for.
#[derive(Debug, Default)]
pub struct Finding {
    /// The work and its progress.
    pub job: PanelJob<FoundModes>,
    /// The modes being computed.
    of: Option<Arc<WantedModes>>,
}

impl Finding {
    /// Begins the work that a body waits for now, and stops work that none waits for any more.
    pub fn follow(&mut self, awaited: Option<&Arc<WantedModes>>) {
        match (awaited, &self.of) {
            (Some(now), Some(of)) if now.is_alike(of) => {}
            (Some(now), _) => (self.of, self.job.request) = (Some(Arc::clone(now)), Some(JobRequest::Begin)),
            (None, Some(_)) => (self.of, self.job.request) = (None, Some(JobRequest::Stop)),
            (None, None) => {}
        }
    }

    /// The modes being computed.
    pub fn of(&self) -> Option<&Arc<WantedModes>> {
        self.of.as_ref()
    }

    /// Takes the result, if the work has ended.
    pub fn take(&mut self) -> Option<Command> {
        let of = self.of.as_ref()?;
        let found = match std::mem::replace(&mut self.job.work, Work::Idle) {
            Work::Ready(found) => *found,
            Work::Failed(why) => of.refused(why),
            unfinished => {
                self.job.work = unfinished;
                return None;
            }
        };
        Some(Command::TakeModes(Box::new(found)))
    }
}

/// The card, while a body waits.
pub(super) fn finding_ui(ui: &Ui, status: &Status, finding: &Finding, free: &mut Rect, commands: &mut Vec<Command>) {
    let Some(wanted) = &status.awaited_modes else { return };
    card::card_over_view(ui, "finding modes", free, |ui| {
        theme::float_frame(ui).show(ui, |ui| {
            ui.set_max_width(BAR);
            let title = format!("Finding the modes of {}", wanted.name);
            ui.label(RichText::new(title).color(theme::of(ui).strong).strong());
            ui.label(RichText::new("Time stands still until they are there.").color(theme::of(ui).weak));
            if let Work::Running(progress) = &finding.job.work {
                work::progress_ui(ui, progress, BAR);
            }
            ui.add_space(2.0);
            if ui.button("Stop: move by its cells").clicked() {
                commands.push(Command::TakeModes(Box::new(wanted.stopped())));
            }
        });
    });
}
