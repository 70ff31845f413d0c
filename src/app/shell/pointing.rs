//! The effect of pointer and keys in the open window: which thing is under a pixel, what is held, what an action changes.

use glam::{Vec2, Vec3};
use winit::window::Fullscreen;

use super::Shell;
use super::panels::running;
use crate::app::hand::{self, Target};
use crate::app::handles::{self, Chosen, PointerView};
use crate::app::input::{Action, ChosenAction, Event, Keyboard, Panel, Situation};
use crate::app::ui::{self, BottomPanel, Brush};
use crate::session::{CellTouch, Command};
use crate::view::legend::three_digits;
use crate::view::{Hit, Ray, Thing};

impl Shell {
    pub(super) fn situation(&self, event: Event) -> Situation {
        let pointer = self.input.pointer();
        let over_view = self.is_over_view(pointer);
        let is_press = matches!(event, Event::Button { pressed: true, .. });
        Situation {
            over_view,
            dialog_open: self.ui.files.is_open() || egui::Popup::is_any_open(&self.context),
            keyboard: self.keyboard(),
            holdable: over_view && is_press && self.is_holdable(pointer),
            brushable: over_view && is_press && self.brush_touch(pointer, false).is_some(),
            playing: self.snapshot.as_ref().is_some_and(|snapshot| snapshot.status.playing),
            scale: self.pixels_per_point(),
        }
    }

    fn keyboard(&self) -> Keyboard {
        // A field has the keyboard a frame after it appears.
        if self.context.text_edit_focused() || self.ui.renaming.is_some() {
            Keyboard::Text
        } else if self.context.egui_wants_keyboard_input() {
            Keyboard::Widget
        } else {
            Keyboard::View
        }
    }

    fn is_holdable(&self, pixel: Vec2) -> bool {
        let Some(snapshot) = &self.snapshot else { return false };
        if handles::is_on_handle(
            Chosen::of(self.unanswered.scene(&snapshot.scene), self.ui.selection, &snapshot.status),
            &self.pointer_view(pixel),
        ) {
            return true;
        }
        hand::target(&snapshot.scene, &snapshot.draw_list, &self.ray(pixel))
            .is_some_and(|(target, _)| hand::can_be_held(&snapshot.scene, target))
    }

    /// The point under a pixel, if it is on the body of the brush.
    fn under_brush(&self, pixel: Vec2) -> Option<(Brush, Hit)> {
        let (brush, snapshot) = (self.ui.brush?, self.snapshot.as_ref()?);
        let own = Target::Body(brush.body);
        if self.ui.selection != Some(own) || !self.is_over_view(pixel) {
            return None;
        }
        let (target, hit) = hand::target(&snapshot.scene, &snapshot.draw_list, &self.ray(pixel))?;
        (target == own).then_some((brush, hit))
    }

    /// The corners of the face under the brush, m.
    pub(super) fn face_under_brush(&self) -> Option<[Vec3; 4]> {
        let (_, hit) = self.under_brush(self.input.pointer())?;
        crate::view::pick::face(&self.snapshot.as_ref()?.draw_list, &hit)
    }

    /// What the brush does at a pixel; `None` if the pixel is not on the brush's body.
    fn brush_touch(&self, pixel: Vec2, inverted: bool) -> Option<CellTouch> {
        let (brush, hit) = self.under_brush(pixel)?;
        let Thing::Skin { weights, .. } = hit.what else { return None };
        let change = if inverted { brush.change.inverse() } else { brush.change };
        Some(CellTouch { body: brush.body, weights, change })
    }

    /// Draws the brush over the thing under a pixel. While the last touch is not answered nothing is sent: the picture shows
    /// the old cells, whose particles may have other numbers by now.
    fn brush(&mut self, pixel: Vec2, inverted: bool) {
        if let Some(touch) = self.brush_touch(pixel, inverted) {
            self.send(Command::Brush(touch));
            self.changed = true;
        }
    }

    /// The line of sight through a pixel of the window.
    fn ray(&self, pixel: Vec2) -> Ray {
        let view = self.view();
        self.orbit.camera().ray_through(pixel - view.origin, view.size)
    }

    /// The view as it is seen, with the pointer at a pixel of the window.
    pub(super) fn pointer_view(&self, pixel: Vec2) -> PointerView {
        let (view, scale) = (self.view(), self.pixels_per_point());
        PointerView { camera: self.orbit.camera(), size: view.size / scale, pointer: (pixel - view.origin) / scale }
    }

    /// The scalar shown at the point of the jelly under the pointer, with its unit; empty if there is none.
    pub(super) fn value_under_pointer(&self) -> String {
        let pointer = self.input.pointer();
        let Some(snapshot) = self.snapshot.as_ref().filter(|_| !self.input.dragging()) else { return String::new() };
        if snapshot.draw_list.scalars.is_none() || !self.is_over_view(pointer) {
            return String::new();
        }
        let hit = crate::view::pick::nearest(&snapshot.draw_list, &self.ray(pointer));
        let value = hit.and_then(|hit| hand::value_at(&snapshot.draw_list, &hit));
        let unit = snapshot.scene.view.color.unit();
        value.map_or_else(String::new, |value| format!("{} {unit}", three_digits(f64::from(value))))
    }

    fn is_over_view(&self, pixel: Vec2) -> bool {
        let points = egui::pos2(pixel.x, pixel.y) / self.pixels_per_point();
        let covered = self.context.layer_id_at(points).is_some_and(|layer| layer.order != egui::Order::Background);
        self.view().contains(pixel) && !covered && !self.context.egui_is_using_pointer()
    }

    /// Highlights the handle under the pointer, or the face under the brush.
    pub(super) fn hover(&mut self) {
        self.changed |= self.ui.brush.is_some();
        let pointer_view = self.pointer_view(self.input.pointer());
        if let Some(snapshot) = &self.snapshot
            && self.handles.hover(
                Chosen::of(self.unanswered.scene(&snapshot.scene), self.ui.selection, &snapshot.status),
                &pointer_view,
            )
        {
            self.changed = true;
        }
    }

    pub(super) fn act(&mut self, action: Action) {
        if matches!(action, Action::Chosen(_) | Action::Send(Command::Undo | Command::Redo)) {
            // What is held may be another thing afterwards.
            self.release();
        }
        match action {
            Action::Camera(camera_move) => self.move_camera(camera_move),
            Action::FollowChosen => {
                self.ui.follow_chosen ^= true;
                self.follow();
                self.drawing.ask_panels();
            }
            Action::Send(command) => self.send(command),
            Action::ColorBy(color) => self.color_by(color),
            Action::Files(action) => {
                self.ui.files.ask(action);
                self.drawing.ask_panels();
            }
            Action::TogglePanel(Panel::Tree) => self.ui.panels.tree ^= true,
            Action::TogglePanel(Panel::Inspector) => self.ui.panels.inspector ^= true,
            Action::TogglePanel(Panel::Cost) => self.ui.panels.toggle(BottomPanel::Cost),
            Action::TogglePanel(Panel::Error) => self.ui.panels.toggle(BottomPanel::Error),
            Action::TogglePanel(Panel::Stability) => self.ui.panels.toggle(BottomPanel::Stability),
            Action::TogglePanel(Panel::Modes) => self.ui.panels.toggle(BottomPanel::Modes),
            Action::ToggleKeys => self.ui.keys_open = !self.ui.keys_open,
            Action::ToggleFullScreen => self.toggle_full_screen(),
            Action::Close => self.close_one(),
            Action::Choose(pixel) => self.choose(pixel),
            Action::Take(pixel) => self.take(pixel),
            Action::Drag(pixel) => self.drag(pixel),
            Action::Release => self.release(),
            Action::Brush { pixel, inverted } => self.brush(pixel, inverted),
            Action::LiftBrush => self.send(Command::EndEdit),
            Action::Chosen(action) => self.act_on_chosen(action),
        }
    }

    fn close_one(&mut self) {
        if let Some(command) = self.handles.cancel() {
            self.send(command);
            self.changed = true;
            return;
        }
        if self.hand.holds() {
            return self.release();
        }
        if self.ui.brush.take().is_some() {
            self.drawing.ask_panels();
            return;
        }
        let message = self.snapshot.as_ref().map_or("", |snapshot| &snapshot.status.message);
        let message = if self.failure.is_empty() { message } else { &self.failure };
        if self.ui.close_uppermost(message) {
            return;
        }
        self.ui.selection = None;
        self.changed = true;
    }

    fn toggle_full_screen(&self) {
        let full = self.window.fullscreen().is_some();
        self.window.set_fullscreen((!full).then_some(Fullscreen::Borderless(None)));
    }

    fn choose(&mut self, pixel: Vec2) {
        let Some(snapshot) = &self.snapshot else { return };
        let found = hand::target(&snapshot.scene, &snapshot.draw_list, &self.ray(pixel));
        self.ui.selection = found.map(|(target, _)| target);
        let chosen = self.ui.selection;
        self.ui.brush = self.ui.brush.filter(|brush| chosen == Some(Target::Body(brush.body)));
        self.follow();
        self.changed = true;
    }

    fn take(&mut self, pixel: Vec2) {
        let pointer_view = self.pointer_view(pixel);
        let Some(snapshot) = &self.snapshot else { return };
        if self.handles.take(
            Chosen::of(self.unanswered.scene(&snapshot.scene), self.ui.selection, &snapshot.status),
            &pointer_view,
        ) {
            self.drag(self.input.pointer());
            return;
        }
        let (ray, forward) = (self.ray(pixel), self.orbit.camera().forward());
        if let Some(target) = self.hand.take(&snapshot.scene, &snapshot.draw_list, &ray, forward) {
            self.ui.selection = Some(target);
            self.drag(self.input.pointer());
        }
    }

    fn drag(&mut self, pixel: Vec2) {
        let Some(snapshot) = &self.snapshot else { return };
        let ray = self.ray(pixel);
        let command = if self.handles.holds() {
            self.handles.drag(self.pointer_view(pixel).pointer)
        } else {
            self.hand.drag(self.unanswered.scene(&snapshot.scene), &ray)
        };
        if let Some(command) = command {
            self.send(command);
        }
    }

    fn release(&mut self) {
        for command in self.hand.release().into_iter().chain(self.handles.release()) {
            self.send(command);
        }
        self.changed = true;
    }

    fn act_on_chosen(&mut self, action: ChosenAction) {
        let (Some(snapshot), Some(target)) = (&self.snapshot, self.ui.selection) else { return };
        let mut commands = Vec::new();
        ui::actions::act(
            action,
            target,
            running(snapshot, self.unanswered.scene(&snapshot.scene)),
            &mut self.ui,
            &mut commands,
        );
        self.send_all(commands);
    }
}
