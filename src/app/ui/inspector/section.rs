//! What every part of the inspector does alike: a heading that folds, and changes sent as edits.

use egui::{CollapsingHeader, RichText, Ui};

use crate::app::ui::theme;
use crate::app::ui::value::Touch;
use crate::scene::edit::Edit;
use crate::session::Command;

/// A part of the panel that can be folded away.
pub(super) fn section_ui(ui: &mut Ui, title: &str, open: bool, contents: impl FnOnce(&mut Ui)) {
    ui.separator();
    CollapsingHeader::new(RichText::new(title).color(theme::of(ui).strong))
        .default_open(open)
        .show_unindented(ui, contents);
}

/// Sends an edit where something has changed, and its end where that is finished.
pub(super) fn send(touch: Touch, edit: impl FnOnce() -> Edit, commands: &mut Vec<Command>) {
    if touch.changed {
        commands.push(Command::Edit(edit()));
    }
    if touch.ended {
        commands.push(Command::EndEdit);
    }
}
