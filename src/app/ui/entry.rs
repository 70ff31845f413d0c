//! An entry of a list or of a menu. The list closes when the entry is chosen by a click, a key or a screen reader; egui
//! itself closes it only after a click.

use egui::{Button, IntoAtoms, Response, Ui, WidgetInfo};

/// An entry of a list to choose from.
pub(super) fn entry_ui<'a>(ui: &mut Ui, is_chosen: bool, text: impl IntoAtoms<'a>) -> Response {
    let entry = ui.selectable_label(is_chosen, text);
    close_after(ui, &entry);
    entry
}

/// An entry of a menu, with its key.
pub(super) fn menu_entry_ui(ui: &mut Ui, name: &str, key: &str, is_enabled: bool) -> Response {
    let entry = ui.add_enabled(is_enabled, Button::new(name).shortcut_text(key));
    entry.widget_info(|| WidgetInfo::labeled(egui::Role::Button, is_enabled, name));
    close_after(ui, &entry);
    entry
}

fn close_after(ui: &Ui, entry: &Response) {
    if entry.clicked() {
        ui.close();
    }
}
