//! The menus beside File: undo and redo, actions on the selected thing, the view, and the keys.

use egui::containers::menu::{MenuButton, MenuConfig, menu_style};
use egui::{PopupCloseBehavior, RichText, Ui};

use super::entry::menu_entry_ui;
use super::words::capitalised;
use super::{BottomPanel, Framing, Running, Shown, UiState, actions, color, edits, file_menu, theme, things};
use crate::app::input::ChosenAction;
use crate::app::theme::Theme;
use crate::scene::edit::Edit;
use crate::scene::view_settings::Overlays;
use crate::scene::{ColorBy, ViewSettings, param};
use crate::session::{Command, Status};

/// Width of a menu, points.
const WIDTH: f32 = 220.0;

/// All menus, in a row.
pub(super) fn menus_ui(ui: &mut Ui, shown: &Shown<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    let idle = Status::default();
    let status = shown.running.map_or(&idle, |running| running.status);
    ui.scope(|ui| {
        menu_style(ui.style_mut());
        ui.spacing_mut().item_spacing.x = 0.0;
        ui.spacing_mut().button_padding.x = 7.0;
        file_menu::file_menu_ui(ui, state);
        ui.menu_button("Edit", |ui| {
            ui.set_min_width(WIDTH);
            history_ui(ui, status, commands);
            ui.separator();
            chosen_ui(ui, shown.running, state, commands);
        });
        // Toggles do not close the menu: several are often changed together.
        let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
        MenuButton::new("View").config(config).ui(ui, |ui| {
            ui.set_min_width(WIDTH);
            view_ui(ui, shown.running, state, commands);
        });
        ui.menu_button("Help", |ui| {
            ui.set_min_width(WIDTH);
            if menu_entry_ui(ui, "Keys", "F1", true).clicked() {
                state.keys_open = true;
            }
            ui.separator();
            ui.label(RichText::new(concat!("Gelatin ", env!("CARGO_PKG_VERSION"))).color(theme::of(ui).weak));
        });
    });
}

fn history_ui(ui: &mut Ui, status: &Status, commands: &mut Vec<Command>) {
    for (name, words, key, command) in
        [("Undo", &status.undo, "Ctrl+Z", Command::Undo), ("Redo", &status.redo, "Ctrl+Shift+Z", Command::Redo)]
    {
        let text = if words.is_empty() { name.to_owned() } else { format!("{name} {words}") };
        if menu_entry_ui(ui, &text, key, !words.is_empty()).clicked() {
            commands.push(command);
        }
    }
}

fn chosen_ui(ui: &mut Ui, running: Option<Running<'_>>, state: &mut UiState, commands: &mut Vec<Command>) {
    let chosen = running.and_then(|running| Some((running, state.selection?)));
    let name = chosen.map_or_else(String::new, |(running, target)| format!(" {}", things::name(running.scene, target)));
    let hidden = chosen.is_some_and(|(running, target)| things::is_hidden(running.scene, target));
    for (verb, key, action) in [
        ("Rename", "F2", ChosenAction::Rename),
        ("Duplicate", "Shift+D", ChosenAction::Duplicate),
        (if hidden { "Show" } else { "Hide" }, "H", ChosenAction::Hide),
        ("Delete", "X", ChosenAction::Delete),
    ] {
        if menu_entry_ui(ui, &format!("{verb}{name}"), key, chosen.is_some()).clicked()
            && let Some((running, target)) = chosen
        {
            actions::act(action, target, running, state, commands);
        }
    }
}

fn view_ui(ui: &mut Ui, running: Option<Running<'_>>, state: &mut UiState, commands: &mut Vec<Command>) {
    if menu_entry_ui(ui, "Show everything", "Home", running.is_some()).clicked() {
        state.frame = Some(Framing::Everything);
    }
    if menu_entry_ui(ui, "Show what is chosen", "F", state.selection.is_some()).clicked() {
        state.frame = Some(Framing::Chosen);
    }
    toggle_ui(ui, &mut state.follow_chosen, "Follow what is chosen", "Shift+F");
    ui.separator();
    toggle_ui(ui, &mut state.panels.tree, "List of things", "T");
    toggle_ui(ui, &mut state.panels.inspector, "Values", "N");
    for (below, words, key) in [
        (BottomPanel::Cost, "What a step costs", "C"),
        (BottomPanel::Error, "Error of the steps", "E"),
        (BottomPanel::Stability, "Map of stability", "M"),
        (BottomPanel::Modes, "Modes of a body", "V"),
    ] {
        let mut open = state.panels.below == Some(below);
        toggle_ui(ui, &mut open, words, key);
        if open != (state.panels.below == Some(below)) {
            state.panels.toggle(below);
        }
    }
    ui.separator();
    if let Some(running) = running {
        let view = &running.scene.view;
        ui.menu_button("Colour by", |ui| colors_ui(ui, view, commands));
        ui.menu_button("Draw over the jelly", |ui| overlays_ui(ui, view, commands));
        ui.separator();
    }
    for (theme, name) in [(Theme::Dark, "Dark"), (Theme::Light, "Light")] {
        if ui.radio(state.theme == theme, name).clicked() {
            state.theme = theme;
        }
    }
}

fn colors_ui(ui: &mut Ui, view: &ViewSettings, commands: &mut Vec<Command>) {
    for color in ColorBy::ALL {
        if ui.radio(view.color == color, capitalised(&color::words(color))).clicked() && view.color != color {
            commands.push(color::color_command(view, color));
        }
    }
}

/// One toggle for each overlay.
fn overlays_ui(ui: &mut Ui, view: &ViewSettings, commands: &mut Vec<Command>) {
    let mut overlays = view.overlays;
    let mut changed = false;
    for (field, name, flag) in flags(&mut overlays) {
        let help = param::find(&format!("view.overlays.{field}")).map_or("", |param| param.help);
        changed |= ui.checkbox(flag, name).on_hover_text(help).changed();
    }
    if changed {
        commands.extend(edits::alone(Edit::View(ViewSettings { overlays, ..view.clone() })));
    }
}

fn flags(overlays: &mut Overlays) -> [(&'static str, &'static str, &mut bool); 9] {
    [
        ("wireframe", "Wire frame", &mut overlays.wireframe),
        ("structural", "Structural links", &mut overlays.structural),
        ("shear", "Shear links", &mut overlays.shear),
        ("bending", "Bending links", &mut overlays.bending),
        ("particles", "Particles", &mut overlays.particles),
        ("pins", "Pins", &mut overlays.pins),
        ("cells", "Cells", &mut overlays.cells),
        ("contacts", "Contacts", &mut overlays.contacts),
        ("boxes", "Boxes of the broad phase", &mut overlays.boxes),
    ]
}

fn toggle_ui(ui: &mut Ui, flag: &mut bool, name: &str, key: &str) {
    ui.checkbox(flag, name).on_hover_text(key);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_overlay_has_its_toggle() {
        let mut overlays = Overlays::default();
        for (field, _, flag) in flags(&mut overlays) {
            *flag = true;
            assert!(param::find(&format!("view.overlays.{field}")).is_some(), "{field} is a parameter");
        }
        let all = serde_json::to_value(overlays).expect("overlays serialise");
        let on = all.as_object().expect("an object").values().all(|value| value == true);
        assert!(on, "a toggle is missing: {all}");
    }
}
