//! A dialog in the middle of the window, with its row of buttons.

use egui::{Align, Color32, Id, Key, Layout, Modal, Modifiers, Response, RichText, ScrollArea, Ui, Vec2, vec2};

use crate::app::ui::theme;

/// The fill of the main button, which Enter presses; white text is legible on it.
pub const MAIN_FILL: Color32 = Color32::from_rgb(52, 95, 162);
/// The least size of the main button, points: room for the longest of its words, so that its neighbours do not move.
const MAIN_SIZE: Vec2 = vec2(112.0, 0.0);

/// A dialog in the middle of the window that blocks everything else. Returns whether Escape was pressed in it.
pub(super) fn dialog_ui(ui: &Ui, name: &str, width: f32, contents: impl FnOnce(&mut Ui)) -> bool {
    let room = ui.ctx().content_rect().size();
    let frame = egui::Frame::window(ui.style()).inner_margin(18);
    let modal = Modal::new(Id::unique(name)).frame(frame).show(ui.ctx(), |ui| {
        ui.set_width(width.min(room.x - 60.0));
        ui.label(RichText::new(name).heading().color(theme::of(ui).strong));
        ui.add_space(4.0);
        // In the smallest windows the dialog scrolls.
        let height = (room.y - 110.0).max(120.0);
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, contents);
    });
    let escaped = || ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape));
    modal.is_top_modal && !modal.any_popup_open && escaped()
}

/// The row of buttons at the end of a dialog, laid out from the right, and no higher than its buttons.
pub(super) fn buttons_ui(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    let row = vec2(ui.available_width(), ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(row, Layout::right_to_left(Align::Center), contents);
}

/// The main button, which Enter presses.
pub(super) fn main_button_ui(ui: &mut Ui, name: &str, enabled: bool) -> Response {
    let button = egui::Button::new(RichText::new(name).color(Color32::WHITE)).fill(MAIN_FILL).min_size(MAIN_SIZE);
    ui.add_enabled(enabled, button)
}
