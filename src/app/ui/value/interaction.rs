//! What a person did to a value, and what a widget keeps of it until the sandbox answers.

use egui::{Id, Ui};

use crate::scene::edit::Edit;
use crate::session::Command;

/// What a person did to one or more values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::app::ui) struct Interaction {
    /// A value has changed.
    pub(in crate::app::ui) changed: bool,
    /// A change is finished: a later one is another change.
    pub(in crate::app::ui) ended: bool,
}

impl Interaction {
    /// Adds the interaction with another widget.
    pub(in crate::app::ui) fn and(&mut self, other: Self) {
        self.changed |= other.changed;
        self.ended |= other.ended;
    }

    /// Sends the edit if a value has changed, and its end if the change is finished.
    pub(in crate::app::ui) fn send(self, edit: impl FnOnce() -> Edit, commands: &mut Vec<Command>) {
        if self.changed {
            commands.push(Command::Edit(edit()));
        }
        if self.ended {
            commands.push(Command::EndEdit);
        }
    }
}

/// The value during a drag: the sandbox answers a frame later, and must not pull the knob back.
pub(super) fn drag_value(ui: &Ui, id: Id) -> Option<f64> {
    ui.data(|data| data.get_temp(id.with("held")))
}

pub(super) fn set_drag_value(ui: &Ui, id: Id, value: Option<f64>) {
    ui.data_mut(|data| match value {
        Some(value) => _ = data.insert_temp(id.with("held"), value),
        None => data.remove::<f64>(id.with("held")),
    });
}

pub(super) fn differs(a: f64, b: f64) -> bool {
    a.to_bits() != b.to_bits()
}
