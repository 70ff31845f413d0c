//! Long work that a panel requests and shows: its progress and its result. The work itself is done elsewhere.

use std::sync::Arc;
use std::time::Duration;

use egui::{Label, ProgressBar, RichText, Ui};

use super::theme;
use crate::session::progress::Progress;

/// The time between two looks at the progress.
const REFRESH_INTERVAL: Duration = Duration::from_millis(250);
/// Height of the bar, points.
const BAR_HEIGHT: f32 = 6.0;

/// Work that can be requested, and its state.
#[derive(Debug)]
pub struct PanelJob<T> {
    /// The state of the work.
    pub work: Work<T>,
    /// The request of a person, if any.
    pub request: Option<JobRequest>,
}

impl<T> Default for PanelJob<T> {
    fn default() -> Self {
        Self { work: Work::Idle, request: None }
    }
}

/// The state of the work.
#[derive(Debug)]
pub enum Work<T> {
    /// It was not requested.
    Idle,
    /// It is in progress.
    Running(Arc<Progress>),
    /// It is done.
    Ready(Box<T>),
    /// It has failed; the reason as a sentence.
    Failed(String),
}

/// The request of a person.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JobRequest {
    /// Begin on the present scene.
    Begin,
    /// Stop, and forget the result.
    Stop,
}

impl<T> PanelJob<T> {
    /// Forgets the result when another scene is opened.
    pub(super) fn forget(&mut self) {
        self.request = (!matches!(self.work, Work::Idle)).then_some(JobRequest::Stop);
    }

    /// The title of the panel, and beside it the button that begins the work or stops it.
    pub(super) fn title_ui(&mut self, ui: &mut Ui, title: &str, begin: &str) {
        ui.horizontal(|ui| {
            ui.label(RichText::new(title).color(theme::of(ui).strong).strong());
            let (name, request) = match self.work {
                Work::Idle => (begin.to_owned(), JobRequest::Begin),
                Work::Running(_) => ("Stop".to_owned(), JobRequest::Stop),
                Work::Ready(_) | Work::Failed(_) => (format!("{begin} again"), JobRequest::Begin),
            };
            if ui.button(name).clicked() {
                self.request = Some(request);
            }
        });
    }
}

/// The progress of work, as a percentage and as a bar of some width, points.
pub(super) fn progress_ui(ui: &mut Ui, progress: &Progress, width: f32) {
    let fraction = progress.fraction();
    let text = format!("Computing: {:.0} %", 100.0 * fraction);
    ui.add(Label::new(RichText::new(text).color(theme::of(ui).weak)).wrap());
    ui.scope(|ui| {
        let colors = theme::of(ui);
        ui.visuals_mut().extreme_bg_color = colors.rail;
        let bar = ProgressBar::new(fraction).fill(colors.accent).corner_radius(0.5 * BAR_HEIGHT);
        ui.add(bar.desired_width(width).desired_height(BAR_HEIGHT));
    });
    ui.ctx().request_repaint_after(REFRESH_INTERVAL);
}
