//! A heading of the inspector with contents that can be folded away.

use egui::{CollapsingHeader, RichText, Ui};

use crate::app::ui::theme;

/// A part of the panel that can be folded away.
pub(super) fn section_ui(ui: &mut Ui, title: &str, open: bool, contents: impl FnOnce(&mut Ui)) {
    ui.separator();
    CollapsingHeader::new(RichText::new(title).color(theme::of(ui).strong))
        .default_open(open)
        .show_unindented(ui, contents);
}
