//! The list of everything in the scene, selected or hidden, and the buttons that add things.

use egui::{Align, Button, Key, Layout, RichText, ScrollArea, Sense, TextEdit, Ui, WidgetInfo, vec2};

use super::adding::{self, Form, New};
use super::files::FileAction;
use super::icon::{Icon, small_button_ui};
use super::{Running, UiState, actions, edits, theme, things};
use crate::app::hand::Target;
use crate::app::input::ChosenAction;
use crate::scene::Scene;
use crate::scene::edit::{BodyId, ObstacleId};
use crate::session::Command;

/// The thing that a button adds.
#[derive(Clone, Copy)]
enum Adds {
    /// A cube or an obstacle of a simple form.
    Known(New),
    /// A model as a body, chosen in the assistant.
    Model,
    /// A model as an obstacle, chosen in a dialog.
    Mesh,
}

/// The buttons that add things.
const NEW: [(&str, Adds); 8] = [
    ("+ Cube", Adds::Known(New::Cube)),
    ("+ Model…", Adds::Model),
    ("+ Plane", Adds::Known(New::Obstacle(Form::Plane))),
    ("+ Sphere", Adds::Known(New::Obstacle(Form::Sphere))),
    ("+ Box", Adds::Known(New::Obstacle(Form::Box))),
    ("+ Capsule", Adds::Known(New::Obstacle(Form::Capsule))),
    ("+ Cylinder", Adds::Known(New::Obstacle(Form::Cylinder))),
    ("+ Mesh…", Adds::Mesh),
];
/// From this width on (points), four buttons fit in a row.
const FOUR_NEED: f32 = 290.0;
/// The gap between rows of buttons, points: small, so that a low window still shows a list above them.
const BETWEEN_ROWS: f32 = 2.0;

/// The list, with the buttons below it.
pub(super) fn tree_ui(ui: &mut Ui, running: Running<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    let scene = running.scene;
    let width = ui.available_width() - theme::SCROLL_BAR;
    let columns = if width < FOUR_NEED { 2 } else { 4 };
    let (rows, gap) = (NEW.len().div_ceil(columns) as f32, ui.spacing().item_spacing.x);
    let buttons = (ui.spacing().interact_size.y + BETWEEN_ROWS) * rows + 16.0;
    let room = (ui.available_height() - buttons).max(60.0);
    ScrollArea::vertical().max_height(room).auto_shrink([false, false]).show(ui, |ui| {
        ui.set_max_width(width);
        heading_ui(ui, "Bodies");
        for place in 0..scene.bodies.len() {
            row_ui(ui, running, Target::Body(BodyId(place)), state, commands);
        }
        ui.add_space(8.0);
        heading_ui(ui, "Obstacles");
        for place in 0..scene.obstacles.len() {
            row_ui(ui, running, Target::Obstacle(ObstacleId(place)), state, commands);
        }
    });
    ui.scope(|ui| {
        ui.set_max_width(width);
        ui.separator();
        ui.spacing_mut().item_spacing.y = BETWEEN_ROWS;
        let width = (width + gap) / columns as f32 - gap;
        let size = vec2(width.floor(), ui.spacing().interact_size.y);
        for row in NEW.chunks(columns) {
            ui.horizontal(|ui| {
                ui.spacing_mut().button_padding.x = 2.0;
                for (label, new) in row {
                    let clicked = ui.add_sized(size, Button::new(*label)).clicked();
                    match new {
                        Adds::Known(new) if clicked => adding::create(*new, running, state, commands),
                        Adds::Model if clicked => state.files.ask(FileAction::LoadModel),
                        Adds::Mesh if clicked => state.files.ask(FileAction::AddMesh),
                        _ => (),
                    }
                }
            });
        }
    });
}

fn heading_ui(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).small().color(theme::of(ui).weak));
}

fn row_ui(ui: &mut Ui, running: Running<'_>, target: Target, state: &mut UiState, commands: &mut Vec<Command>) {
    let scene = running.scene;
    if state.renaming.as_ref().is_some_and(|(renamed, _)| *renamed == target) {
        rename_ui(ui, scene, target, state, commands);
        return;
    }
    let (hidden, name) = (things::is_hidden(scene, target), things::name(scene, target));
    let gone = is_gone(running, target);
    let chosen = state.selection == Some(target);
    ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let (icon, word) = if hidden { (Icon::EyeClosed, "Show") } else { (Icon::Eye, "Hide") };
            let label = format!("{word} {name}");
            if small_button_ui(ui, icon, &label, &label).clicked() {
                actions::act(ChosenAction::Hide, target, running, state, commands);
            }
            if let (true, Target::Body(body)) = (gone, target) {
                gone_ui(ui, body, scene, &name, commands);
            }
            ui.with_layout(Layout::top_down_justified(Align::LEFT), |ui| {
                let color = if hidden || gone { theme::of(ui).weak } else { theme::of(ui).strong };
                let text = RichText::new(&name).color(color);
                let button = Button::selectable(chosen, text).truncate().sense(Sense::click());
                let row = ui.add(button);
                row.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, chosen, &name));
                if row.clicked() {
                    (state.selection, state.awaited) = (Some(target), None);
                }
                if row.double_clicked() {
                    actions::act(ChosenAction::Rename, target, running, state, commands);
                }
                row.context_menu(|ui| menu_ui(ui, running, target, state, commands));
            });
        });
    });
}

/// Whether it is a body that has fallen out of the scene.
fn is_gone(running: Running<'_>, target: Target) -> bool {
    let Target::Body(id) = target else { return false };
    running.status.bodies.get(id.0).is_some_and(|body| body.gone)
}

/// The mark of a body that has fallen out of the scene, which brings it back.
fn gone_ui(ui: &mut Ui, body: BodyId, scene: &Scene, name: &str, commands: &mut Vec<Command>) {
    let help = "It fell past everything in the scene and is left alone. A click brings it back to its start.";
    if small_button_ui(ui, Icon::Gone, &format!("Bring {name} back"), help).clicked() {
        commands.push(Command::Teleport(body, scene.bodies[body.0].pose.position));
    }
}

/// The context menu of a row.
fn menu_ui(ui: &mut Ui, running: Running<'_>, target: Target, state: &mut UiState, commands: &mut Vec<Command>) {
    let entries = [
        ("Rename", ChosenAction::Rename),
        ("Duplicate", ChosenAction::Duplicate),
        ("Hide or show", ChosenAction::Hide),
        ("Delete", ChosenAction::Delete),
    ];
    for (label, action) in entries {
        if ui.button(label).clicked() {
            actions::act(action, target, running, state, commands);
            ui.close();
        }
    }
}

fn rename_ui(ui: &mut Ui, scene: &Scene, target: Target, state: &mut UiState, commands: &mut Vec<Command>) {
    let Some((_, name)) = &mut state.renaming else { return };
    let response = ui.add(TextEdit::singleline(name).desired_width(f32::INFINITY).char_limit(60));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::TextInput, true, "New name"));
    if response.lost_focus() {
        let name = std::mem::take(name);
        state.renaming = None;
        let given_up = ui.input(|input| input.key_pressed(Key::Escape));
        if let Some(edit) = edits::rename(scene, target, name).filter(|_| !given_up) {
            commands.extend(edits::alone(edit));
        }
    } else {
        response.request_focus();
    }
}
