//! The box of a body that is marked in the view: the one whose corner values a person is editing.

use egui::{Rect, Ui};

use crate::session::BoxOfBody;

/// The marked box, determined anew in each frame of the panels.
#[derive(Debug, Default)]
pub struct MarkedBox {
    now: Option<(egui::Id, BoxOfBody)>,
    before: Option<egui::Id>,
}

impl MarkedBox {
    /// Begins a frame in which no box is marked yet.
    pub(super) fn begin(&mut self) {
        self.before = self.now.take().map(|(id, _)| id);
    }

    /// Marks a box while the pointer is over its values. During a drag of a value, the box stays marked wherever the pointer
    /// goes.
    pub(super) fn mark_under_pointer(&mut self, ui: &Ui, id: egui::Id, values: Rect, of: BoxOfBody) {
        let is_at_it = if ui.input(|input| input.pointer.any_down()) {
            self.before == Some(id)
        } else {
            ui.rect_contains_pointer(values)
        };
        if is_at_it {
            self.now = Some((id, of));
        }
    }

    /// The marked box.
    pub(super) fn marked(&self) -> Option<BoxOfBody> {
        self.now.map(|(_, marked)| marked)
    }
}
