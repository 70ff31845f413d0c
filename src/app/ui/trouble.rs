//! A simulation that broke: a card over the view that says why and offers what cures it.

use egui::{RichText, Ui};

use super::{UiState, card_over_view, theme};
use crate::session::{Command, Status};

/// Width of the card, points.
const WIDTH: f32 = 430.0;

/// The card, where there is trouble.
pub(super) fn trouble_ui(ui: &Ui, status: &Status, state: &mut UiState, commands: &mut Vec<Command>) {
    let Some(trouble) = &status.trouble else { return };
    let view = state.view_rect;
    card_over_view(ui, "trouble", &mut state.free_rect, |ui| {
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
            });
        });
    });
}
