//! A card over the view for a simulation that broke: it names the cause and offers the cures that were found to help.

use egui::{RichText, Ui};

use super::{UiState, card, theme};
use crate::session::{Command, Status, Trouble};

/// Width of the card, points.
const WIDTH: f32 = 430.0;

/// The card, if there is trouble.
pub(super) fn trouble_ui(ui: &Ui, status: &Status, state: &mut UiState, commands: &mut Vec<Command>) {
    let Some(trouble) = &status.trouble else { return };
    let view = state.view_rect;
    card::card_over_view(ui, "trouble", &mut state.free_rect, |ui| {
        theme::float_frame(ui).stroke(egui::Stroke::new(1.0, theme::of(ui).warning)).show(ui, |ui| {
            ui.set_max_width(WIDTH.min(view.width() - 60.0));
            ui.label(RichText::new(&trouble.title).color(theme::of(ui).warning).size(15.0).strong());
            ui.label(RichText::new(&trouble.words).color(theme::of(ui).strong));
            ui.add_space(4.0);
            ui.horizontal_wrapped(|ui| {
                for cure in &trouble.cures {
                    if ui.button(&cure.words).clicked() {
                        commands.extend(cure.commands());
                    }
                }
                if ui.button("Start again").on_hover_text("From the beginning  (Space)").clicked() {
                    commands.extend(Trouble::start_again());
                }
            });
            if let Some(words) = looking(trouble) {
                ui.label(RichText::new(words).color(theme::of(ui).weak));
            }
        });
    });
}

/// The state of the search for cures; `None` once some are known.
fn looking(trouble: &Trouble) -> Option<&'static str> {
    match (trouble.looking, trouble.cures.is_empty()) {
        (true, _) => Some("Looking for what helps…"),
        (false, true) => Some("No single change was found that helps."),
        (false, false) => None,
    }
}
