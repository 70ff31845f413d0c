//! When the window draws and what: the panels when something asks for them and they come out different, the picture
//! when it looks different, both at the pace that leaves the simulation its share. Most of the time of a window in
//! which nothing moves, nothing is drawn at all.

use std::time::{Duration, Instant};

use egui::epaint::ClippedShape;
use egui::{ClippedPrimitive, FullOutput, Rect, ViewportId};
use winit::event_loop::ActiveEventLoop;

use super::Shell;
use crate::app::canvas::{Detail, Frame, Panels, Shown};
use crate::app::damage::{self, damage};
use crate::app::frame_meter::{DrawingCost, FrameMeter};
use crate::app::pace::{Drawn, Pace, Reason};
use crate::app::processors::Processors;
use crate::app::shell::ShellError;
use crate::app::{hand, input::ViewRect};
use crate::extract;
use crate::view::axes::axes;
use crate::view::{Change, DrawList, Overlay};

/// Figures that run with the time are written this often: faster nobody reads them.
const FIGURES: Duration = Duration::from_millis(100);
/// A view in which nothing has moved for so long is drawn once more, finely.
const SETTLED: Duration = Duration::from_millis(300);
/// How long to wait before a frame that the surface refused is tried again.
const RETRY: Duration = Duration::from_millis(30);
/// So long after the last move of a person's hand nothing is drawn finely: that would keep the next one waiting.
const IN_USE: Duration = Duration::from_millis(700);
/// What moves by less than so many pixels a second creeps: it is drawn finely, and only every `CREEPING`.
const CREEP: f32 = 2.0;
const CREEPING: Duration = Duration::from_secs(1);
/// How often the worker hears what drawing costs.
const TELL: Duration = Duration::from_millis(500);

/// What was drawn last, and when something is to be drawn next.
pub(super) struct Drawing {
    pace: Pace,
    meter: FrameMeter,
    processors: Processors,
    panels_at: Option<Instant>,
    picture_at: Option<Instant>,
    /// The window has been asked for the frame that comes next.
    requested: bool,
    panels_ran: Instant,
    shapes: Vec<ClippedShape>,
    pixels_per_point: f32,
    /// The picture on the screen, and since when it is there.
    picture: Option<DrawList>,
    picture_since: Instant,
    /// When something was last seen to move, and when a person last moved the pointer or pressed something.
    moved: Option<Instant>,
    touched: Option<Instant>,
    told: Instant,
}

impl Drawing {
    /// Nothing was drawn yet; by `software` or by a graphics card.
    pub(super) fn new(software: bool) -> Self {
        let now = Instant::now();
        Self {
            pace: Pace::new(software),
            meter: FrameMeter::default(),
            processors: Processors::new(),
            panels_at: Some(now),
            picture_at: Some(now),
            requested: false,
            panels_ran: now,
            shapes: Vec::new(),
            pixels_per_point: 0.0,
            picture: None,
            picture_since: now,
            moved: None,
            touched: None,
            told: now,
        }
    }

    /// A person moved the pointer or pressed something.
    pub(super) fn note_touch(&mut self) {
        self.touched = Some(Instant::now());
        self.ask_panels();
    }

    /// When nothing has moved for long enough that a fine picture keeps nobody waiting; `None` where nothing ever has.
    fn settles(&self) -> Option<Instant> {
        self.moved.map(|at| at + SETTLED).max(self.touched.map(|at| at + IN_USE))
    }

    /// Asks for the panels to be run, for a person who waits.
    pub(super) fn ask_panels(&mut self) {
        let due = self.pace.due(Reason::Input, Instant::now());
        self.panels_at = Some(self.panels_at.map_or(due, |at| at.min(due)));
    }

    /// Asks for the panels to be run when figures have run on.
    pub(super) fn ask_figures(&mut self) {
        let due = self.panels_ran + FIGURES;
        self.panels_at = Some(self.panels_at.map_or(due, |at| at.min(due)));
    }

    /// Asks for a look at the picture.
    pub(super) fn ask_picture(&mut self, reason: Reason) {
        let due = self.pace.due(reason, Instant::now());
        self.picture_at = Some(self.picture_at.map_or(due, |at| at.min(due)));
    }

    /// What frames cost lately.
    pub(super) fn cost(&self) -> DrawingCost {
        self.meter.cost(Instant::now(), self.pace.scale())
    }

    fn due(&self) -> Option<Instant> {
        self.panels_at.into_iter().chain(self.picture_at).min()
    }

    /// Whether the panels came out different from those on the screen.
    #[expect(clippy::float_cmp, reason = "a scale that is not the very same is another one")]
    fn are_new(&self, output: &FullOutput) -> bool {
        !output.textures_delta.set.is_empty()
            || output.pixels_per_point != self.pixels_per_point
            || output.shapes != self.shapes
    }
}

/// Panels that differ from those on the screen.
struct NewPanels {
    primitives: Vec<ClippedPrimitive>,
    /// Where they differ; `None` everywhere.
    parts: Option<Vec<Rect>>,
}

/// A picture that is ready to be drawn.
struct Ready {
    /// Whether it is to be drawn: it looks different from the one on the screen, and has not just been drawn.
    is_new: bool,
    detail: Detail,
    moving: bool,
    /// When to look at it again, where it was left undrawn because it only creeps.
    again: Option<Instant>,
}

impl Shell {
    /// When the event loop must wake by itself, if at all. Asks for the frame that is due.
    pub(in crate::app) fn next_frame(&mut self) -> Option<Instant> {
        if !self.visible {
            return None;
        }
        if self.changed {
            self.drawing.ask_picture(if self.input.dragging() { Reason::Input } else { Reason::Motion });
        }
        let due = self.drawing.due()?;
        if due > Instant::now() {
            return Some(due);
        }
        if !self.drawing.requested {
            self.drawing.requested = true;
            self.window.request_redraw();
        }
        None
    }

    /// Draws what is due.
    pub(super) fn draw(&mut self, event_loop: &ActiveEventLoop) -> Result<(), ShellError> {
        let begin = Instant::now();
        // A frame that the system asks for by itself shows everything again.
        let exposed = !std::mem::take(&mut self.drawing.requested);
        let run = exposed || self.drawing.panels_at.is_some_and(|at| at <= begin) || self.canvas.needs_panels();
        let mut output = run.then(|| self.run_panels(event_loop));
        let panels = output.as_mut().and_then(|output| self.changed_panels(output));
        let view = self.view();
        let ready = self.prepare_picture(view, begin);
        let mut textures = output.map(|output| output.textures_delta).unwrap_or_default();
        self.canvas.update_textures(&mut textures);
        let is_new = ready.as_ref().is_some_and(|ready| ready.is_new);
        let again = ready.as_ref().and_then(|ready| ready.again);
        let shown = if exposed || panels.is_some() || is_new {
            let frame = Frame {
                draw_list: self.snapshot.as_ref().map(|snapshot| &snapshot.draw_list),
                changed: is_new,
                detail: ready.as_ref().map_or(Detail::Fine, |ready| ready.detail),
                view,
                panels: panels.as_ref().map(|NewPanels { primitives, parts }| Panels {
                    primitives,
                    pixels_per_point: self.drawing.pixels_per_point,
                    parts: parts.as_deref(),
                }),
            };
            self.canvas.show(&frame).map(Some)
        } else {
            Ok(None)
        };
        self.canvas.free_textures(&mut textures);
        match shown {
            Ok(Some(Shown::Presented)) => self.on_presented(begin, ready),
            Ok(None) => (self.changed, self.drawing.picture_at) = (false, again.or(self.settling(begin))),
            Ok(Some(Shown::Again)) => {
                (self.drawing.shapes, self.drawing.panels_at) = (Vec::new(), Some(begin + RETRY));
            }
            Ok(Some(Shown::Unseen)) => {
                (self.drawing.shapes, self.drawing.panels_at, self.drawing.picture_at) = (Vec::new(), None, None);
                self.changed = false;
            }
            Err(error) => self.recover(event_loop, error)?,
        }
        Ok(())
    }

    fn on_presented(&mut self, begin: Instant, ready: Option<Ready>) {
        let end = Instant::now();
        log::trace!("a frame is on the screen after {:?}", end - begin);
        self.changed = false;
        let work = self.drawing.processors.taken(self.worker.spent()).min(end - begin);
        let frame = Drawn { begin, end, work };
        self.drawing.meter.note(frame);
        let again = ready.as_ref().and_then(|ready| ready.again);
        if let Some(ready) = ready {
            let behind = self.snapshot.as_ref().is_some_and(|snapshot| snapshot.status.behind);
            self.drawing.pace.drawn(frame, ready.moving && ready.is_new, behind);
            if ready.is_new {
                self.drawing.picture = self.snapshot.as_ref().map(|snapshot| snapshot.draw_list.clone());
                self.drawing.picture_since = end;
            }
        }
        self.drawing.picture_at = again.or(self.settling(end));
        if end - self.drawing.told >= TELL {
            self.drawing.told = end;
            self.tell();
        }
    }

    /// Tells the worker what drawing costs.
    fn tell(&self) {
        let cost = self.drawing.cost();
        self.worker.set_drawing(self.drawing.pace.interval(), cost.share);
        if let Some(snapshot) = &self.snapshot {
            let DrawingCost { frames_per_sec, secs_per_frame, share, scale } = cost;
            let factor = snapshot.status.real_time_factor;
            log::debug!(
                "{factor:.3} x real time, {frames_per_sec} frames a second of {:.1} ms, {share:.3} of the processors, at \
                 {scale}",
                1e3 * secs_per_frame
            );
        }
    }

    /// When the view has settled and is to be drawn finely, if it is not yet.
    fn settling(&self, now: Instant) -> Option<Instant> {
        let at = self.drawing.settles()?;
        (!self.canvas.is_fine() && !self.input.dragging()).then(|| at.max(now))
    }

    /// Runs the panels and does what they ask for.
    fn run_panels(&mut self, event_loop: &ActiveEventLoop) -> FullOutput {
        let now = Instant::now();
        (self.drawing.panels_at, self.drawing.panels_ran) = (None, now);
        let mut output = self.lay_out_panels();
        self.grant_wishes(event_loop);
        let platform_output = std::mem::take(&mut output.platform_output);
        self.egui.handle_platform_output_with_event_loop(&self.window, event_loop, platform_output);
        let delay = output.viewport_output.get(&ViewportId::ROOT).map_or(Duration::MAX, |root| root.repaint_delay);
        if let Some(again) = now.checked_add(delay) {
            let paced = self.drawing.pace.due(Reason::Motion, now).max(again);
            self.drawing.panels_at = Some(self.drawing.panels_at.map_or(paced, |at| at.min(paced)));
        }
        output
    }

    /// What to draw of the panels where they differ from those on the screen.
    fn changed_panels(&mut self, output: &mut FullOutput) -> Option<NewPanels> {
        if !self.drawing.are_new(output) && !self.canvas.needs_panels() {
            return None;
        }
        let shapes = std::mem::take(&mut output.shapes);
        // Letters and pictures that came with other textures may look different though their shapes are the same.
        let all = self.canvas.needs_panels()
            || !output.textures_delta.set.is_empty()
            || self.drawing.shapes.is_empty()
            || self.drawing.pixels_per_point.to_bits() != output.pixels_per_point.to_bits();
        let parts = (!all).then(|| damage(&self.drawing.shapes, &shapes, output.pixels_per_point));
        self.drawing.pixels_per_point = output.pixels_per_point;
        let again = parts.as_ref().map_or_else(|| shapes.clone(), |parts| damage::within(&shapes, parts));
        self.drawing.shapes = shapes;
        Some(NewPanels { primitives: self.context.tessellate(again, output.pixels_per_point), parts })
    }

    /// Makes the picture ready and says how it differs from the one on the screen.
    fn prepare_picture(&mut self, view: ViewRect, now: Instant) -> Option<Ready> {
        let sight = self.sight(self.input.pointer());
        let points = self.pixels_per_point();
        let snapshot = self.snapshot.as_mut()?;
        let picture = &mut snapshot.draw_list;
        picture.camera = self.orbit.camera();
        picture.style = self.ui.theme.style();
        picture.selected = self.ui.selection.and_then(|target| hand::place(&snapshot.scene, target));
        // Strokes are as wide as they were in the last picture, until it is known how finely this one is drawn.
        let last = self.drawing.picture.as_ref().map_or(points, |picture| picture.overlay.scale);
        picture.overlay.scale = last;
        let cross = axes(&picture.camera, &picture.style.overlay);
        picture.tools = Overlay { lines: vec![cross], scale: last, ..Overlay::default() };
        if let Some([grabbed, target]) = self.hand.pulled(picture) {
            extract::overlay::add_grab(&mut picture.tools, grabbed, target);
        }
        let colors = picture.style.overlay;
        self.handles.add_to(&mut picture.tools, &snapshot.scene, self.ui.selection, &sight, &colors);

        let (software, fine) = (self.canvas.is_software(), self.canvas.is_fine());
        let old = self.drawing.picture.as_ref();
        let change = old.map_or(Change::Things, |old| picture.change_since(old, view.size.y));
        let turned = old.is_some_and(|old| old.camera != picture.camera);
        let age = now.saturating_duration_since(self.drawing.picture_since).min(CREEPING);
        let plain = match change {
            Change::Things => true,
            Change::Motion { pixels } => pixels.is_nan() || pixels > CREEP * age.as_secs_f32(),
            Change::Shade | Change::Nothing => false,
        };
        if plain && (snapshot.status.playing || turned) {
            self.drawing.moved = Some(now);
        }
        let unsettled = self.drawing.settles().is_some_and(|at| now < at);
        let moving = self.input.dragging() || unsettled && (plain || !fine);
        let detail = if moving && software { Detail::Quick { scale: self.drawing.pace.scale() } } else { Detail::Fine };
        let differs = change != Change::Nothing;
        let waits = software && !plain && fine && differs && age < CREEPING;
        let again = waits.then(|| self.drawing.picture_since + CREEPING);
        let pixels = if let Detail::Quick { scale } = detail { points * scale } else { points };
        (picture.overlay.scale, picture.tools.scale) = (pixels, pixels);
        Some(Ready { is_new: differs && !waits || detail == Detail::Fine && !fine, detail, moving, again })
    }

    /// Asks for what a new snapshot changes.
    pub(super) fn ask_for_snapshot(&mut self, answered: bool) {
        if answered {
            self.drawing.ask_panels();
        } else {
            self.drawing.ask_figures();
        }
        self.changed = true;
    }
}
