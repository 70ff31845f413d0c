//! The box of a body that is marked in the view: the one whose corners a person is at.

use egui::{Rect, Ui};

use crate::session::BoxOfBody;

/// What is marked, anew in each frame of the panels.
#[derive(Debug, Default)]
pub struct MarkedBox {
    now: Option<(egui::Id, BoxOfBody)>,
    before: Option<egui::Id>,
}

impl MarkedBox {
    /// Begins a frame, in which nothing is marked yet.
    pub(super) fn begin(&mut self) {
        self.before = self.now.take().map(|(id, _)| id);
    }

    /// Marks a box while the pointer is over its values, or drags one of them: it stays in the hand wherever the pointer goes.
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

    /// The box that is marked.
    pub(super) fn marked(&self) -> Option<BoxOfBody> {
        self.now.map(|(_, marked)| marked)
    }
}
