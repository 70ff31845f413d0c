//! Decides when the window draws and what: the panels when they are due and differ from before, the picture when it looks
//! different, both at the pace that leaves the simulation its share. Most of the time, a window without motion draws
//! nothing.

use std::time::{Duration, Instant};

use egui::{ClippedPrimitive, FullOutput, Rect, ViewportId};
use winit::event_loop::ActiveEventLoop;

use super::drawing::{Drawing, Due};
use super::{Shell, ShellError};
use crate::app::canvas::{CanvasError, Detail, Frame, FrameOutcome, Panels};
use crate::app::damage::{self, damage};
use crate::app::frame_meter::DrawingCost;
use crate::app::frame_pacer::{FrameTiming, Reason};
use crate::app::handles::Chosen;
use crate::app::redraw_policy::{self, Decision};
use crate::app::ui::files::InsetRequest;
use crate::app::{hand, input::ViewRect};
use crate::extract;
use crate::view::axes::axes;
use crate::view::{Change, Overlay};

/// The time before a frame that the surface refused is tried again.
const RETRY_DELAY: Duration = Duration::from_millis(30);
/// The time between two reports of the cost of drawing to the worker.
const REPORT_INTERVAL: Duration = Duration::from_millis(500);

/// Panels that differ from those on the screen.
struct NewPanels {
    primitives: Vec<ClippedPrimitive>,
    /// The parts that differ; `None` if all may.
    parts: Option<Vec<Rect>>,
}

/// The role of the view's picture in a frame.
#[derive(Clone, Copy, Debug)]
enum PictureAction {
    /// The next frame draws it alone.
    PutOff,
    /// The picture on the screen stays; the decision is made again at this time, if any.
    Keep(Option<Instant>),
    Draw(Detail),
}

impl Shell {
    /// The time when the event loop must wake by itself, if any. Requests the frame that is due.
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
        if !self.drawing.frame_requested {
            self.drawing.frame_requested = true;
            self.window.request_redraw();
        }
        None
    }

    /// Draws what is due. While a person waits for it and a processor draws, the worker takes no steps.
    pub(super) fn draw(&mut self, event_loop: &ActiveEventLoop) -> Result<(), ShellError> {
        let Drawing { panels_due, picture_due, .. } = &self.drawing;
        if self.canvas.is_software() && (panels_due.is_urgent || picture_due.is_urgent) {
            self.worker.hold();
        }
        let drawn = self.draw_frame(event_loop);
        self.worker.let_go();
        drawn
    }

    fn draw_frame(&mut self, event_loop: &ActiveEventLoop) -> Result<(), ShellError> {
        let begin = Instant::now();
        // A frame that the system requests shows everything again.
        let [requested, uncovered] =
            [&mut self.drawing.frame_requested, &mut self.drawing.uncovered].map(std::mem::take);
        let exposed = uncovered || !requested;
        let run = exposed || self.drawing.panels_due.at.is_some_and(|at| at <= begin) || self.canvas.needs_panels();
        let is_urgent = self.drawing.panels_due.is_urgent;
        if run && let Err(error) = self.draw_inset() {
            return self.recover(event_loop, error);
        }
        let mut output = run.then(|| self.run_panels(event_loop));
        let panels = output.as_mut().and_then(|output| self.changed_panels(output));
        let view = self.view();
        let whole = exposed || self.canvas.needs_picture(view);
        let picture = if panels.is_some() && is_urgent && !whole && self.picture_can_wait() {
            PictureAction::PutOff
        } else {
            self.prepare_picture(view, begin)
        };
        let mut textures = output.map(|output| output.textures_delta).unwrap_or_default();
        self.canvas.update_textures(&mut textures);
        let draw_list = self.snapshot.as_ref().map(|snapshot| &snapshot.draw_list);
        let shown = if exposed || panels.is_some() || matches!(picture, PictureAction::Draw(_)) {
            let frame = Frame {
                picture: if let PictureAction::Draw(detail) = picture { draw_list.zip(Some(detail)) } else { None },
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
            Ok(Some(FrameOutcome::Presented)) => self.on_presented(begin, picture),
            Ok(None) => self.on_picture(picture, begin),
            Ok(Some(FrameOutcome::Retry)) => {
                self.drawing.shapes = Vec::new();
                self.drawing.panels_due.ask(begin + RETRY_DELAY, Reason::Input);
            }
            Ok(Some(FrameOutcome::Unseen)) => {
                (self.drawing.panels_due, self.drawing.picture_due) = (Due::default(), Due::default());
                (self.drawing.shapes, self.changed) = (Vec::new(), false);
            }
            Err(error) => self.recover(event_loop, error)?,
        }
        Ok(())
    }

    /// Draws the picture that the panels want to contain.
    fn draw_inset(&mut self) -> Result<(), CanvasError> {
        if let Some(InsetRequest { draw_list, size }) = self.ui.files.take_inset() {
            let texture = self.canvas.draw_inset(&draw_list, size)?;
            self.ui.files.inset_drawn(Some(texture));
        }
        Ok(())
    }

    /// Whether panels that a person waits for are drawn without the picture, which takes longer and is drawn in the next
    /// frame.
    fn picture_can_wait(&self) -> bool {
        self.canvas.is_software() && !self.drawing.picture_due.is_urgent && !self.drawing.put_off
    }

    fn on_presented(&mut self, begin: Instant, picture: PictureAction) {
        let end = Instant::now();
        log::trace!("a frame is on the screen after {:?}: {picture:?}", end - begin);
        let work = self.drawing.processor_meter.used_since_last_call(self.worker.processor_time()).min(end - begin);
        let frame = FrameTiming { begin, end, work };
        self.drawing.meter.note(frame);
        let moving = matches!(picture, PictureAction::Draw(Detail::Quick { .. }));
        let behind = self.snapshot.as_ref().is_some_and(|snapshot| snapshot.status.behind);
        self.drawing.pacer.note_frame(frame, moving, behind);
        if let PictureAction::Draw(_) = picture {
            self.drawing.picture = self.snapshot.as_ref().map(|snapshot| snapshot.draw_list.clone());
            self.drawing.redraw_policy.note_drawn(end);
        }
        self.on_picture(picture, end);
        if end - self.drawing.last_report >= REPORT_INTERVAL {
            self.drawing.last_report = end;
            self.report_cost();
        }
    }

    /// Sets when to look at the picture again.
    fn on_picture(&mut self, picture: PictureAction, now: Instant) {
        self.drawing.put_off = matches!(picture, PictureAction::PutOff);
        let again = match picture {
            PictureAction::PutOff => return,
            PictureAction::Keep(again) => again,
            PictureAction::Draw(_) => {
                self.drawing.redraw_policy.refine_time(self.input.dragging(), self.canvas.is_fine(), now)
            }
        };
        self.drawing.picture_due = Due { at: again, is_urgent: false };
        self.changed = false;
    }

    /// Tells the worker the cost of drawing.
    fn report_cost(&self) {
        let cost = self.drawing.cost();
        self.worker.set_drawing(self.drawing.pacer.interval(), cost.share);
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

    /// Runs the panels and does what they ask for.
    fn run_panels(&mut self, event_loop: &ActiveEventLoop) -> FullOutput {
        let now = Instant::now();
        (self.drawing.panels_due, self.drawing.panels_ran) = (Due::default(), now);
        let mut output = self.lay_out_panels();
        self.handle_requests(event_loop);
        let platform_output = std::mem::take(&mut output.platform_output);
        self.egui.handle_platform_output_with_event_loop(&self.window, event_loop, platform_output);
        let delay = output.viewport_output.get(&ViewportId::ROOT).map_or(Duration::MAX, |root| root.repaint_delay);
        if let Some(again) = now.checked_add(delay) {
            let paced = self.drawing.pacer.due(Reason::Motion, now).max(again);
            self.drawing.panels_due.ask(paced, Reason::Motion);
        }
        self.ask_for_long_work();
        output
    }

    /// The panels to draw, if they differ from those on the screen.
    fn changed_panels(&mut self, output: &mut FullOutput) -> Option<NewPanels> {
        if !self.drawing.panels_differ(output) && !self.canvas.needs_panels() {
            return None;
        }
        let shapes = std::mem::take(&mut output.shapes);
        // With other textures, letters and pictures may look different although their shapes are the same.
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

    /// Completes the picture and decides whether and how it is drawn.
    fn prepare_picture(&mut self, view: ViewRect, now: Instant) -> PictureAction {
        let pointer_view = self.pointer_view(self.input.pointer());
        let points = self.pixels_per_point();
        let face = self.face_under_brush();
        let Some(snapshot) = &mut self.snapshot else { return PictureAction::Keep(None) };
        let picture = &mut snapshot.draw_list;
        picture.camera = self.orbit.camera();
        picture.style = self.ui.theme.style();
        picture.selected = self.ui.selection.and_then(|target| hand::selected(&snapshot.scene, target));
        // Strokes stay as wide as in the last picture until it is known how finely this one is drawn.
        let last = self.drawing.picture.as_ref().map_or(points, |picture| picture.overlay.scale);
        picture.overlay.scale = last;
        let cross = axes(&picture.camera, &picture.style.overlay);
        picture.tools = Overlay { lines: vec![cross], scale: last, ..Overlay::default() };
        if let Some([grabbed, target]) = self.hand.pulled(picture) {
            extract::overlay::add_grab(&mut picture.tools, grabbed, target);
        }
        if let Some(face) = face {
            extract::overlay::add_face(&mut picture.tools, face);
        }
        let colors = picture.style.overlay;
        let chosen = Chosen::of(self.unanswered.scene(&snapshot.scene), self.ui.selection, &snapshot.status);
        self.handles.add_to(&mut picture.tools, chosen, &pointer_view, &colors);

        let fits = !self.canvas.needs_picture(view);
        let old = self.drawing.picture.as_ref();
        let turned = old.is_some_and(|old| old.camera != picture.camera);
        let state = redraw_policy::PictureState {
            change: old.filter(|_| fits).map_or(Change::Things, |old| picture.change_since(old, view.size.y)),
            in_motion: snapshot.status.playing || turned,
            dragging: self.input.dragging(),
            fine: fits && self.canvas.is_fine(),
        };
        let (detail, pixels) = match self.drawing.redraw_policy.decide(&state, now) {
            Decision::Keep(again) => return PictureAction::Keep(again),
            Decision::Fine => (Detail::Fine, points),
            Decision::Quick => {
                let scale = self.drawing.pacer.scale();
                (Detail::Quick { scale }, points * scale)
            }
        };
        (picture.overlay.scale, picture.tools.scale) = (pixels, pixels);
        PictureAction::Draw(detail)
    }

    /// Asks for the drawing that a new snapshot needs.
    pub(super) fn ask_for_snapshot(&mut self, answered: bool) {
        if answered {
            self.drawing.ask_panels();
        } else {
            self.drawing.ask_figures();
        }
        self.changed = true;
    }
}
