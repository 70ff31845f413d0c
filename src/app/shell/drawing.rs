//! What the window has drawn last, and when it is to draw next.

use std::time::{Duration, Instant};

use egui::FullOutput;
use egui::epaint::ClippedShape;

use crate::app::frame_meter::{DrawingCost, FrameMeter};
use crate::app::frame_pacer::{FramePacer, Reason};
use crate::app::processor_meter::ProcessorMeter;
use crate::app::redraw_policy::RedrawPolicy;
use crate::view::DrawList;

/// The time between two updates of numbers that run with the time: nobody reads them faster.
const NUMBERS_INTERVAL: Duration = Duration::from_millis(100);
/// When something is to be looked at next.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Due {
    pub(super) at: Option<Instant>,
    /// A person waits for it.
    pub(super) is_urgent: bool,
}

impl Due {
    pub(super) fn ask(&mut self, at: Instant, reason: Reason) {
        self.at = Some(self.at.map_or(at, |earlier| earlier.min(at)));
        self.is_urgent |= reason == Reason::Input;
    }
}

/// What the window has drawn last, and when it is to draw next.
pub(super) struct Drawing {
    pub(super) pacer: FramePacer,
    pub(super) meter: FrameMeter,
    pub(super) processor_meter: ProcessorMeter,
    pub(super) panels_due: Due,
    pub(super) picture_due: Due,
    /// The panels were drawn alone although the picture was due: the next frame draws it.
    pub(super) put_off: bool,
    /// The next frame has been requested from the window.
    pub(super) frame_requested: bool,
    /// The system has forgotten what the window shows.
    pub(super) uncovered: bool,
    pub(super) panels_ran: Instant,
    pub(super) shapes: Vec<ClippedShape>,
    pub(super) pixels_per_point: f32,
    /// The picture on the screen.
    pub(super) picture: Option<DrawList>,
    pub(super) redraw_policy: RedrawPolicy,
    pub(super) last_report: Instant,
}

impl Drawing {
    /// The state before anything is drawn, by `software` or by a graphics card.
    pub(super) fn new(software: bool) -> Self {
        let now = Instant::now();
        Self {
            pacer: FramePacer::new(software),
            meter: FrameMeter::default(),
            processor_meter: ProcessorMeter::new(),
            panels_due: Due { at: Some(now), is_urgent: false },
            picture_due: Due { at: Some(now), is_urgent: false },
            put_off: false,
            frame_requested: false,
            uncovered: false,
            panels_ran: now,
            shapes: Vec::new(),
            pixels_per_point: 0.0,
            picture: None,
            redraw_policy: RedrawPolicy::new(software, now),
            last_report: now,
        }
    }

    /// Notes that a person moved the pointer or pressed something.
    pub(super) fn note_touch(&mut self) {
        self.redraw_policy.note_touch(Instant::now());
        self.ask_panels();
    }

    /// Asks for everything to be shown again, as the window has come into sight. The system requests a frame for that, but winit
    /// makes one request of that and of one of our own.
    pub(super) fn note_uncovered(&mut self) {
        self.uncovered = true;
        self.ask_panels();
    }

    /// Asks for the panels to be run, for a person who waits.
    pub(super) fn ask_panels(&mut self) {
        let at = self.pacer.due(Reason::Input, Instant::now());
        self.panels_due.ask(at, Reason::Input);
    }

    /// Asks for the panels to be run when it is time to update running numbers.
    pub(super) fn ask_figures(&mut self) {
        self.panels_due.ask(self.panels_ran + NUMBERS_INTERVAL, Reason::Motion);
    }

    /// Asks for a decision on the picture.
    pub(super) fn ask_picture(&mut self, reason: Reason) {
        let at = self.pacer.due(reason, Instant::now());
        self.picture_due.ask(at, reason);
    }

    /// The recent cost of frames.
    pub(super) fn cost(&self) -> DrawingCost {
        self.meter.cost(Instant::now(), self.pacer.scale())
    }

    pub(super) fn due(&self) -> Option<Instant> {
        self.panels_due.at.into_iter().chain(self.picture_due.at).min()
    }

    /// Whether the panels differ from those on the screen.
    #[expect(clippy::float_cmp, reason = "a scale that is not the very same is another one")]
    pub(super) fn panels_differ(&self, output: &FullOutput) -> bool {
        !output.textures_delta.set.is_empty()
            || output.pixels_per_point != self.pixels_per_point
            || output.shapes != self.shapes
    }
}
