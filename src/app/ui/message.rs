//! Messages over the view: an error, as a sentence until it is read or no longer true, and the progress of a scene that
//! takes long to open or to change.

use egui::{RichText, Ui};

use super::icon::{Icon, icon_button_ui};
use super::words::{capitalised, grouped};
use super::{Shown, UiState, card, theme, work};
use crate::session::Status;

/// Width of the progress bar, points.
const BAR: f32 = 300.0;

/// The progress of opening a scene or making bodies, if that takes long, with a button that stops it.
pub(super) fn long_work_ui(ui: &Ui, shown: &Shown<'_>, state: &mut UiState) {
    let making = shown.making.map(|progress| (making_words(progress.particles()), progress));
    let opening = shown.opening.map(|progress| ("Opening the scene".to_owned(), progress));
    let Some((words, progress)) = opening.or(making) else { return };
    let mut free = state.free_rect;
    card::card_over_view(ui, "long work", &mut free, |ui| {
        theme::float_frame(ui).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.label(RichText::new(words).color(theme::of(ui).strong));
                let stopped = progress.is_cancelled();
                if ui.add_enabled(!stopped, egui::Button::new("Stop")).clicked() {
                    progress.cancel();
                }
            });
            work::progress_ui(ui, progress, BAR);
        });
    });
    state.free_rect = free;
}

/// The title of a change of the scene that takes long.
fn making_words(particles: usize) -> String {
    if particles == 0 { "Changing the scene".to_owned() } else { format!("Making {} particles", grouped(particles)) }
}

/// The message, unless a person has closed it: red for an error. After a `failure` of the program it offers a new start.
pub(super) fn message_ui(ui: &Ui, status: &Status, failure: &str, state: &mut UiState) {
    let failed = !failure.is_empty();
    let text = if failed { failure } else { &status.message };
    if text.is_empty() {
        state.dismissed.clear();
        return;
    }
    if state.dismissed == text {
        return;
    }
    let view = state.view_rect;
    let mut free = state.free_rect;
    card::card_over_view(ui, "message", &mut free, |ui| {
        theme::float_frame(ui).show(ui, |ui| {
            ui.set_max_width((view.width() - 80.0).clamp(200.0, 640.0));
            ui.horizontal(|ui| {
                let width = ui.available_width() - 44.0;
                let palette = theme::of(ui);
                theme::dot_ui(ui, if failed || status.failed { palette.error } else { palette.accent });
                ui.scope(|ui| {
                    ui.set_max_width(width - 20.0);
                    ui.add(egui::Label::new(RichText::new(capitalised(text)).color(theme::of(ui).strong)).wrap());
                });
                if icon_button_ui(ui, Icon::Close, "Close message", "Esc", true).clicked() {
                    text.clone_into(&mut state.dismissed);
                }
            });
            if failed && ui.button("Start the scene anew").clicked() {
                state.revive = true;
            }
        });
    });
    state.free_rect = free;
}
