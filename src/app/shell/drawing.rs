//! What the window has drawn last, and when it is to draw next.

use std::time::{Duration, Instant};

use egui::FullOutput;
use egui::epaint::ClippedShape;

use crate::app::frame_meter::{DrawingCost, FrameMeter};
use crate::app::pace::{Pace, Reason};
use crate::app::picture_rule::PictureRule;
use crate::app::processors::Processors;
use crate::view::DrawList;

/// The time between two updates of numbers that run with the time: nobody reads them faster.
const FIGURES: Duration = Duration::from_millis(100);
/// When something is to be looked at next.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Due {
    pub(super) at: Option<Instant>,
    /// A person waits for it.
    pub(super) awaited: bool,
}

impl Due {
    pub(super) fn ask(&mut self, at: Instant, reason: Reason) {
        self.at = Some(self.at.map_or(at, |earlier| earlier.min(at)));
        self.awaited |= reason == Reason::Input;
    }
}

/// What the window has drawn last, and when it is to draw next.
pub(super) struct Drawing {
    pub(super) pace: Pace,
    pub(super) meter: FrameMeter,
    pub(super) processors: Processors,
    pub(super) panels_due: Due,
    pub(super) picture_due: Due,
    /// The panels were drawn alone although the picture was due: the next frame draws it.
    pub(super) put_off: bool,
    /// The next frame has been requested from the window.
    pub(super) requested: bool,
    pub(super) panels_ran: Instant,
    pub(super) shapes: Vec<ClippedShape>,
    pub(super) pixels_per_point: f32,
    /// The picture on the screen.
    pub(super) picture: Option<DrawList>,
    pub(super) rule: PictureRule,
    pub(super) told: Instant,
}

impl Drawing {
    /// The state before anything is drawn, by `software` or by a graphics card.
    pub(super) fn new(software: bool) -> Self {
        let now = Instant::now();
        Self {
            pace: Pace::new(software),
            meter: FrameMeter::default(),
            processors: Processors::new(),
            panels_due: Due { at: Some(now), awaited: false },
            picture_due: Due { at: Some(now), awaited: false },
            put_off: false,
            requested: false,
            panels_ran: now,
            shapes: Vec::new(),
            pixels_per_point: 0.0,
            picture: None,
            rule: PictureRule::new(software, now),
            told: now,
        }
    }

    /// Notes that a person moved the pointer or pressed something.
    pub(super) fn note_touch(&mut self) {
        self.rule.note_touch(Instant::now());
        self.ask_panels();
    }

    /// Asks for the panels to be run, for a person who waits.
    pub(super) fn ask_panels(&mut self) {
        let at = self.pace.due(Reason::Input, Instant::now());
        self.panels_due.ask(at, Reason::Input);
    }

    /// Asks for the panels to be run when it is time to update running numbers.
    pub(super) fn ask_figures(&mut self) {
        self.panels_due.ask(self.panels_ran + FIGURES, Reason::Motion);
    }

    /// Asks for a decision on the picture.
    pub(super) fn ask_picture(&mut self, reason: Reason) {
        let at = self.pace.due(reason, Instant::now());
        self.picture_due.ask(at, reason);
    }

    /// The recent cost of frames.
    pub(super) fn cost(&self) -> DrawingCost {
        self.meter.cost(Instant::now(), self.pace.scale())
    }

    pub(super) fn due(&self) -> Option<Instant> {
        self.panels_due.at.into_iter().chain(self.picture_due.at).min()
    }

    /// Whether the panels differ from those on the screen.
    #[expect(clippy::float_cmp, reason = "a scale that is not the very same is another one")]
    pub(super) fn are_new(&self, output: &FullOutput) -> bool {
        !output.textures_delta.set.is_empty()
            || output.pixels_per_point != self.pixels_per_point
            || output.shapes != self.shapes
    }
}
