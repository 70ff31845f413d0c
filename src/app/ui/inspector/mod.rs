//! The panel on the right: the values of the selected thing, or of the scene if nothing is selected. Every change is an edit
//! of one node; the panel itself has no state.

mod body;
mod brush;
mod inlays;
mod light;
mod material;
mod mesh;
mod model;
mod motion;
mod obstacle;
mod own_box;
mod own_weight;
mod parts;
mod pins;
mod safe;
mod section;
mod settings;
mod springs;

use egui::{RichText, ScrollArea, Ui};

use super::value::note_scrolling;
use super::{Running, UiState, theme, things};
use crate::app::hand::Target;
use crate::session::Command;
use section::section_ui;

/// The panel.
pub(super) fn inspector_ui(ui: &mut Ui, running: Running<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.set_max_width(ui.available_width() - theme::SCROLL_BAR);
        let chosen = state.selection.filter(|target| things::exists(running.scene, *target));
        own_weight::forget_unless(chosen, state);
        let title = chosen.map_or_else(|| "The scene".to_owned(), |target| things::name(running.scene, target));
        ui.label(RichText::new(title).color(theme::of(ui).strong).size(15.0).strong());
        ui.add_space(2.0);
        match chosen {
            Some(Target::Body(id)) => body::body_ui(ui, id, running, state, commands),
            Some(Target::Obstacle(id)) => obstacle::obstacle_ui(ui, id, running.scene, commands),
            None => settings::settings_ui(ui, running, commands),
        }
        ui.add_space(6.0);
        section_ui(ui, "Light and camera", false, |ui| light::light_ui(ui, running.scene, commands));
        note_scrolling(ui);
    });
}
