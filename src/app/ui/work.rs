//! Long work that a panel asks for and shows: not begun, how far it is, what came of it. Done elsewhere.

use std::sync::Arc;
use std::time::Duration;

use egui::{Label, ProgressBar, RichText, Ui};

use super::theme;
use crate::session::progress::Progress;

/// How often the progress is looked at while the work goes on.
const LOOK: Duration = Duration::from_millis(250);
/// Height of the bar, points.
const BAR: f32 = 6.0;

/// Work that can be asked for, and how far it is.
#[derive(Debug)]
pub struct Asked<T> {
    /// How far it is.
    pub work: Work<T>,
    /// What a person asked for.
    pub wish: Option<Wish>,
}

impl<T> Default for Asked<T> {
    fn default() -> Self {
        Self { work: Work::Idle, wish: None }
    }
}

/// How far the work is.
#[derive(Debug)]
pub enum Work<T> {
    /// Nobody has asked for it.
    Idle,
    /// It goes on.
    Running(Arc<Progress>),
    /// It is done.
    Ready(Box<T>),
    /// It cannot be done; why, as a sentence.
    Failed(String),
}

/// What a person asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Begin on the present scene.
    Begin,
    /// Stop, and forget what came of it.
    Stop,
}

impl<T> Asked<T> {
    /// Another scene has taken the place of the old one.
    pub(super) fn forget(&mut self) {
        self.wish = (!matches!(self.work, Work::Idle)).then_some(Wish::Stop);
    }

    /// The title of the panel, and beside it the button that begins the work or stops it.
    pub(super) fn title_ui(&mut self, ui: &mut Ui, title: &str, begin: &str) {
        ui.horizontal(|ui| {
            ui.label(RichText::new(title).color(theme::of(ui).strong).strong());
            let (name, wish) = match self.work {
                Work::Idle => (begin.to_owned(), Wish::Begin),
                Work::Running(_) => ("Stop".to_owned(), Wish::Stop),
                Work::Ready(_) | Work::Failed(_) => (format!("{begin} again"), Wish::Begin),
            };
            if ui.button(name).clicked() {
                self.wish = Some(wish);
            }
        });
    }
}

/// How far work is that goes on, in figures and as a bar of some width, points.
pub(super) fn progress_ui(ui: &mut Ui, progress: &Progress, width: f32) {
    let fraction = progress.fraction();
    let text = format!("Computing: {:.0} %", 100.0 * fraction);
    ui.add(Label::new(RichText::new(text).color(theme::of(ui).weak)).wrap());
    ui.scope(|ui| {
        let colors = theme::of(ui);
        ui.visuals_mut().extreme_bg_color = colors.rail;
        let bar = ProgressBar::new(fraction).fill(colors.accent).corner_radius(0.5 * BAR);
        ui.add(bar.desired_width(width).desired_height(BAR));
    });
    ui.ctx().request_repaint_after(LOOK);
}
