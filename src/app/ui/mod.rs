//! The panels: they turn a status into words and widgets, and a person's actions into commands. Nothing here knows a
//! session, a window or a GPU; every function takes what it shows and returns intent.

pub mod actions;
mod adding;
mod card;
mod chosen_size;
mod color;
mod cost;
mod edits;
mod entry;
mod error_panel;
mod figure;
mod file_menu;
pub mod files;
mod finding;
mod icon;
mod inspector;
mod keys;
mod log_axes;
mod marked_box;
mod menu;
mod message;
mod meter;
mod modes_panel;
mod moved_places;
mod panels;
mod plot_panel;
mod shown;
mod sides;
mod stability_panel;
mod state;
mod things;
mod timeline;
mod tip;
mod top_bar;
mod tree;
mod trouble;
mod typed_text;
mod value;
mod widths;
mod words;
pub mod work;

use egui::{Align2, Area, Id, Order, RichText, Ui};

use super::theme;
use crate::session::{Command, Status};
use card::{beside_corner_card, over_view};

pub use chosen_size::ChosenSize;
pub use color::color_command;
pub use finding::Finding;
pub use marked_box::MarkedBox;
pub use modes_panel::ModesPanel;
pub use moved_places::KnownThings;
pub use panels::{BottomPanel, Panels};
pub use shown::{Running, Shown};
pub use state::{Brush, Framing, TooHeavy, UiState};
pub use widths::Widths;

/// Height of a panel above the time line, points.
const BOTTOM_PANEL_HEIGHT: f32 = 226.0;
/// The largest fraction of the window's height for a panel above the time line: the view keeps the rest.
const MAX_BOTTOM_PANEL_SHARE: f32 = 0.4;

/// All panels, around and over the view.
pub fn panels_ui(ui: &mut Ui, shown: &Shown<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    theme::choose(ui, state.theme);
    let idle = Status::default();
    let status = shown.running.map_or(&idle, |running| running.status);
    egui::Panel::top("top bar").resizable(false).frame(theme::bar_frame(ui)).show(ui, |ui| {
        top_bar::top_bar_ui(ui, shown, state, commands);
    });
    egui::Panel::bottom("timeline").resizable(false).frame(theme::bar_frame(ui)).show(ui, |ui| {
        timeline::timeline_ui(ui, status, &mut state.panels, commands);
    });
    bottom_panel_ui(ui, shown, state, commands);
    if let Some(running) = shown.running {
        state.follow(running.scene);
        let a_hand_is_at_it = ui.input(|input| input.pointer.any_down());
        if state.chosen_size.follow(chosen_size::size_of_selected(running, state.selection), a_hand_is_at_it) {
            state.frame = Some(Framing::Chosen);
        }
        state.marked_box.begin();
        sides::side_panels_ui(ui, running, state, commands);
        let marked = state.marked_box.marked();
        if running.status.marked_box != marked {
            commands.push(Command::MarkBox(marked));
        }
    }
    state.view_rect = ui.available_rect_before_wrap();
    state.free_rect = state.view_rect;
    match shown.running {
        Some(running) => {
            trouble::trouble_ui(ui, status, state, commands);
            let card = over_view(ui, "color", state.view_rect, Align2::LEFT_BOTTOM, |ui| {
                theme::float_frame(ui).show(ui, |ui| {
                    color::color_ui(ui, &running.scene.view, running.color_key, running.is_painted, commands);
                });
            });
            state.free_rect = beside_corner_card(state.free_rect, card);
        }
        None if shown.failure.is_empty() => {
            over_view(ui, "preparing", state.view_rect, Align2::CENTER_CENTER, |ui| {
                ui.label(RichText::new("Preparing the scene…").color(theme::of(ui).weak));
            });
        }
        None => (),
    }
    value_under_pointer_ui(ui, shown.value);
    message::long_work_ui(ui, shown, state);
    finding::finding_ui(ui, status, &state.finding, &mut state.free_rect, commands);
    message::message_ui(ui, status, shown.failure, state);
    keys::keys_ui(ui, state);
    // Nothing can be saved after a failure; unsaved changes are kept as a draft.
    let saved = if shown.failure.is_empty() { status } else { &idle };
    files::files_ui(ui, saved, shown.running, state, commands);
    state.note_next_scene(commands);
}

/// The panel above the time line. Cost, stability and modes are watched only while they are shown.
fn bottom_panel_ui(ui: &mut Ui, shown: &Shown<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    let Some(running) = shown.running else { return };
    let below = state.panels.below;
    let counted = below == Some(BottomPanel::Cost);
    if running.status.cost.is_some() != counted {
        commands.push(Command::WatchCost(counted));
    }
    let stability = (below == Some(BottomPanel::Stability)).then(|| stability_panel::wanted(state.selection));
    if running.status.stability.as_ref().map(|shown| shown.of) != stability {
        commands.push(Command::WatchStability(stability));
    }
    let modes = &state.modes_panel;
    let swing = (below == Some(BottomPanel::Modes)).then(|| modes.shown(running.scene)).flatten();
    if running.status.swing != swing {
        commands.push(Command::ShowModes(swing));
    }
    let Some(below) = below else { return };
    let name = match below {
        BottomPanel::Cost => "cost",
        BottomPanel::Error => "error",
        BottomPanel::Stability => "stability",
        BottomPanel::Modes => "modes",
    };
    let height = BOTTOM_PANEL_HEIGHT.min(MAX_BOTTOM_PANEL_SHARE * ui.available_height());
    let panel = egui::Panel::bottom(name).resizable(false).exact_size(height);
    panel.frame(theme::bar_frame(ui)).show(ui, |ui| match below {
        BottomPanel::Cost => cost::cost_ui(ui, running.status, shown.drawing),
        BottomPanel::Error => error_panel::error_panel_ui(ui, running, &mut state.error_panel, commands),
        BottomPanel::Stability => {
            stability_panel::stability_panel_ui(ui, running, &mut state.stability_panel, commands);
        }
        BottomPanel::Modes => modes_panel::modes_panel_ui(ui, running, state.selection, &mut state.modes_panel),
    });
}

/// A small label beside the pointer with the value there.
fn value_under_pointer_ui(ui: &Ui, value: &str) {
    let pointer = ui.input(|input| input.pointer.hover_pos());
    let Some(pointer) = pointer.filter(|_| !value.is_empty()) else { return };
    Area::new(Id::unique("value under the pointer"))
        .order(Order::Middle)
        .interactable(false)
        .fade_in(false)
        .fixed_pos(pointer + egui::vec2(14.0, 12.0))
        .show(ui.ctx(), |ui| {
            theme::float_frame(ui).inner_margin(egui::Margin::symmetric(8, 4)).show(ui, |ui| {
                ui.add(egui::Label::new(RichText::new(value).color(theme::of(ui).strong)).extend());
            });
        });
}
