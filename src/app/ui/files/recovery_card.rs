//! The offer after a crash: the scene as it was a few seconds before.

use egui::{Align2, RichText, Ui};

use super::dialog::main_button_ui;
use super::{FileAction, FileRequest, UiState};
use crate::app::ui::card::over_view;
use crate::app::ui::theme;

/// The offer, while there is a draft.
pub(super) fn recovery_card_ui(ui: &Ui, state: &mut UiState) {
    let Some(found) = state.files.found.clone() else { return };
    over_view(ui, "recovery", state.free_rect, Align2::RIGHT_TOP, |ui| {
        theme::float_frame(ui).show(ui, |ui| {
            ui.set_max_width(300.0);
            let question = format!("Recover unsaved changes of {} from {}?", found.title, found.when);
            ui.add(egui::Label::new(RichText::new(question).color(theme::of(ui).strong)).wrap());
            ui.horizontal(|ui| {
                if main_button_ui(ui, "Recover", true).clicked() {
                    state.files.ask(FileAction::Recover);
                }
                if ui.button("Discard").on_hover_text("Throw these changes away").clicked() {
                    state.files.requests.push(FileRequest::DiscardFound);
                }
            });
        });
    });
}
