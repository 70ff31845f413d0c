//! The bar along the top: the scene, the speed, and the state of the steps.

use std::path::PathBuf;

use egui::text::{LayoutJob, TextFormat};
use egui::{Align, ComboBox, FontId, Layout, Response, RichText, Ui, WidgetInfo, vec2};

use super::entry::entry_ui;
use super::icon::{Icon, icon_button_ui};
use super::meter;
use super::{Framing, Shown, UiState, menu, theme};
use crate::scene::presets::Preset;
use crate::session::step_words::step_text;
use crate::session::{Command, KEEPS_UP, Status};

/// Speeds to choose from, simulated seconds per wall second.
const SPEEDS: [f64; 8] = [0.01, 0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 5.0];

/// The width of the box with the scene's name, points.
const SCENE_WIDTH: f32 = 136.0;
/// The free height of the window outside the list of scenes, and the least height of the list, points.
const FREE_HEIGHT: f32 = 72.0;
const MIN_LIST_HEIGHT: f32 = 200.0;
/// The gap between rows of the list of presets, points: all of them must fit in a window 800 points high.
const BETWEEN_PRESETS: f32 = 0.0;
/// Where summaries begin in the list of presets, points from the names.
const SUMMARY_COLUMN: f32 = 124.0;
/// Widths of the bar (points) below which there is no room for the step error, for the step as a number, and for words
/// beside the boxes.
const ERROR_NEEDS: f32 = 1250.0;
const STEP_NEEDS: f32 = 1230.0;
const WORDS_NEED: f32 = 1000.0;

/// The bar along the top.
pub(super) fn top_bar_ui(ui: &mut Ui, shown: &Shown<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    let idle = Status::default();
    let status = shown.running.map_or(&idle, |running| running.status);
    let width = ui.available_width();
    let words = width >= WORDS_NEED;
    ui.horizontal(|ui| {
        menu::menus_ui(ui, shown, state, commands);
        ui.add_space(6.0);
        preset_ui(ui, words, status, state, commands);
        ui.add_space(6.0);
        history_ui(ui, status, commands);
        ui.add_space(6.0);
        speed_ui(ui, words, status, commands);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if words && icon_button_ui(ui, Icon::Help, "Keys", "F1", true).clicked() {
                state.keys_open = !state.keys_open;
            }
            if icon_button_ui(ui, Icon::Frame, "Show everything", "", true).clicked() {
                state.frame = Some(Framing::Everything);
            }
            ui.add_space(6.0);
            // Laid out from the right, so that the numbers keep their places whatever else is in the bar.
            if words {
                if width >= ERROR_NEEDS {
                    meter::error_ui(ui, status);
                }
                meter::meter_ui(ui, status);
                if width >= STEP_NEEDS {
                    ui.add_space(2.0);
                    step_ui(ui, status);
                }
                ui.add_space(10.0);
            }
            real_time_ui(ui, status);
        });
    });
}

/// The undo and redo buttons, with the affected change in the tooltip.
fn history_ui(ui: &mut Ui, status: &Status, commands: &mut Vec<Command>) {
    for (icon, name, words, key, command) in [
        (Icon::Undo, "Undo", &status.undo, "Ctrl+Z", Command::Undo),
        (Icon::Redo, "Redo", &status.redo, "Ctrl+Shift+Z", Command::Redo),
    ] {
        let response = icon_button_ui(ui, icon, name, key, !words.is_empty());
        let clicked = response.clicked();
        if !words.is_empty() {
            response.on_hover_text(words);
        }
        if clicked {
            commands.push(command);
        }
    }
}

fn preset_ui(ui: &mut Ui, words: bool, status: &Status, state: &UiState, commands: &mut Vec<Command>) {
    let word = word_ui(ui, words, "Scene");
    // As high as the window allows: nobody looks for entries below the end of a list.
    let height = (ui.ctx().content_rect().height() - FREE_HEIGHT).max(MIN_LIST_HEIGHT);
    let combo = ComboBox::from_id_salt("scene")
        .width(SCENE_WIDTH)
        .height(height)
        .truncate()
        .selected_text(RichText::new(&status.title).color(theme::of(ui).strong));
    // The box is no wider than this; otherwise a long name would push the rest of the bar away.
    let room = vec2(SCENE_WIDTH, ui.spacing().interact_size.y);
    let response = ui.allocate_ui(room, |ui| combo.show_ui(ui, |ui| presets_ui(ui, status, state, commands))).inner;
    named(ui, response.response, word, "Scene");
}

fn presets_ui(ui: &mut Ui, status: &Status, state: &UiState, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.y = BETWEEN_PRESETS;
    for preset in state.presets {
        let chosen = preset.name == status.title;
        let row = entry_ui(ui, chosen, preset_line(ui, preset));
        row.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, chosen, preset.name));
        if row.clicked() {
            commands.push(Command::Replace {
                scene: Box::new((preset.build)()),
                base_dir: PathBuf::new(),
                title: preset.name.to_owned(),
            });
        }
    }
}

/// The name of a preset, and in a column beside it what happens.
fn preset_line(ui: &Ui, preset: &Preset) -> LayoutJob {
    let font = FontId::proportional(theme::TEXT_SIZE);
    let name = ui.painter().layout_no_wrap(preset.name.to_owned(), font, theme::of(ui).strong).size().x;
    let format = |color| TextFormat { font_id: FontId::proportional(theme::TEXT_SIZE), color, ..TextFormat::default() };
    let mut line = LayoutJob::default();
    line.append(preset.name, 0.0, format(theme::of(ui).strong));
    line.append(preset.summary, (SUMMARY_COLUMN - name).max(12.0), format(theme::of(ui).weak));
    line
}

/// The name of a box beside it, if there is room.
fn word_ui(ui: &mut Ui, words: bool, name: &str) -> Option<Response> {
    words.then(|| ui.label(RichText::new(name).color(theme::of(ui).weak)))
}

/// Names a box for screen readers.
fn named(ui: &Ui, response: Response, word: Option<Response>, name: &str) -> Response {
    if let Some(word) = word {
        return response.labelled_by(word.id);
    }
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(name));
    response
}

fn speed_ui(ui: &mut Ui, words: bool, status: &Status, commands: &mut Vec<Command>) {
    let word = word_ui(ui, words, "Speed");
    let combo = ComboBox::from_id_salt("speed").width(72.0).selected_text(speed_text(status.speed));
    let response = combo.show_ui(ui, |ui| {
        for speed in SPEEDS {
            #[expect(clippy::float_cmp, reason = "the status repeats the very number that was chosen")]
            let chosen = speed == status.speed;
            if entry_ui(ui, chosen, speed_text(speed)).clicked() {
                commands.push(Command::SetSpeed(speed));
            }
        }
    });
    named(ui, response.response, word, "Speed").on_hover_text("Simulated seconds a second");
}

fn speed_text(speed: f64) -> String {
    format!("{speed}×")
}

/// Laid out from right to left.
fn real_time_ui(ui: &mut Ui, status: &Status) {
    let keeps_up = status.real_time_factor >= KEEPS_UP * status.speed;
    let moves = status.playing && !status.at_rest;
    let (color, words) = match (status.playing, status.at_rest, keeps_up) {
        (false, ..) => (theme::of(ui).weak, "Paused"),
        (true, true, _) => (theme::of(ui).good, "At rest"),
        (true, false, true) => (theme::of(ui).good, "As fast as asked"),
        (true, false, false) => (theme::of(ui).warning, "Slower than asked"),
    };
    theme::dot_ui(ui, color);
    let text = if moves { format!("{:.2}×", status.real_time_factor) } else { "–".to_owned() };
    theme::figures_ui(ui, &text, "10.00×", theme::of(ui).strong).on_hover_text(words);
    ui.label(RichText::new("real time").color(theme::of(ui).weak))
        .on_hover_text("Simulated seconds a second, measured");
}

/// Laid out from right to left.
fn step_ui(ui: &mut Ui, status: &Status) {
    theme::figures_ui(ui, &meter::limit_words(status), "0.000 ms", theme::of(ui).strong)
        .on_hover_text(format!("The largest step that is safe, limited by {}", limit_words(status)));
    ui.label(RichText::new("safe").color(theme::of(ui).weak));
    ui.label(RichText::new("/").color(theme::of(ui).weak));
    let color = if meter::is_unsafe(status) { theme::of(ui).warning } else { theme::of(ui).strong };
    theme::figures_ui(ui, &step_text(status.dt_secs), "0.000 ms", color).on_hover_text("The step in use");
    ui.label(RichText::new("step").color(theme::of(ui).weak));
}

fn limit_words(status: &Status) -> &str {
    if status.dt_limited_by.is_empty() { "nothing" } else { &status.dt_limited_by }
}
