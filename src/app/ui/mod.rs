//! The panels: what a status says, as words and widgets, and what a person does to them, as commands. Nothing here
//! knows a session, a window or a GPU; every function takes what is shown and returns intent.

mod color;
mod file_menu;
pub mod files;
mod icon;
mod keys;
mod message;
mod timeline;
mod top_bar;

use egui::{Align2, Area, Id, Order, Rect, RichText, Ui};

use super::theme;
use crate::scene::presets::Preset;
use crate::scene::{ColorBy, Scene, ViewSettings};
use crate::session::{Command, Status};
use crate::view::Colormap;

pub use color::color_command;
use files::FilesState;

/// What the panels show.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// The running sandbox; `None` until there is one.
    pub running: Option<Running<'a>>,
    /// A failure of the program itself, as a sentence; empty when all is well.
    pub failure: &'a str,
}

/// What the panels show of a running sandbox.
#[derive(Clone, Copy, Debug)]
pub struct Running<'a> {
    /// The state of the session.
    pub status: &'a Status,
    /// The document.
    pub scene: &'a Scene,
    /// The colours of the scalar shown and its values at their two ends; `None` where nothing is shown.
    pub color_key: Option<(Colormap, [f32; 2])>,
}

/// What the panels remember between frames and the session need not know.
#[derive(Debug)]
pub struct UiState {
    /// The scenes to choose from.
    pub presets: &'static [Preset],
    /// Whether the list of keys is open.
    pub keys_open: bool,
    /// The message a person has read and closed.
    pub dismissed: String,
    /// The part of the window that no panel covers, points.
    pub view_rect: Rect,
    /// A person asked for a new start after a failure.
    pub revive: bool,
    /// A person asked to see everything.
    pub frame: bool,
    /// The dialogs about files.
    pub files: FilesState,
}

impl UiState {
    /// The state of a fresh window.
    pub fn new(presets: &'static [Preset]) -> Self {
        Self {
            presets,
            keys_open: false,
            dismissed: String::new(),
            view_rect: Rect::NOTHING,
            revive: false,
            frame: false,
            files: FilesState::default(),
        }
    }
}

/// All panels, around and over the view.
pub fn panels_ui(ui: &mut Ui, shown: &Shown<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    let idle = Status::default();
    let status = shown.running.map_or(&idle, |running| running.status);
    egui::Panel::top("top bar").resizable(false).frame(theme::bar_frame()).show(ui, |ui| {
        top_bar::top_bar_ui(ui, status, state, commands);
    });
    egui::Panel::bottom("timeline").resizable(false).frame(theme::bar_frame()).show(ui, |ui| {
        timeline::timeline_ui(ui, status, state, commands);
    });
    state.view_rect = ui.available_rect_before_wrap();
    match shown.running {
        Some(running) => {
            over_view(ui, "color", state.view_rect, Align2::LEFT_BOTTOM, |ui| {
                theme::float_frame().show(ui, |ui| {
                    color::color_ui(ui, &running.scene.view, running.color_key, commands);
                });
            });
        }
        None if shown.failure.is_empty() => {
            over_view(ui, "preparing", state.view_rect, Align2::CENTER_CENTER, |ui| {
                ui.label(RichText::new("Preparing the scene…").color(theme::WEAK));
            });
        }
        None => (),
    }
    message::message_ui(ui, status, shown.failure, state);
    keys::keys_ui(ui, state);
    // After a failure nothing can be saved any more: what is unsaved is kept as a draft.
    let saved = if shown.failure.is_empty() { status } else { &idle };
    files::files_ui(ui, saved, shown.running.map(|running| running.scene), state, commands);
}

/// The view settings with another scalar for the colours.
fn colored(view: &ViewSettings, color: ColorBy) -> ViewSettings {
    // A fixed range belongs to the scalar it was chosen for.
    let color_range = if view.color == color { view.color_range } else { None };
    ViewSettings { color, color_range, ..view.clone() }
}

/// A text with a capital letter at its start.
fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Something that floats over the view, at one of its corners.
fn over_view(ui: &Ui, name: &str, view: Rect, corner: Align2, contents: impl FnOnce(&mut Ui)) {
    let inner = view.shrink(14.0);
    Area::new(Id::unique(name))
        .order(Order::Middle)
        .movable(false)
        .pivot(corner)
        .fixed_pos(corner.pos_in_rect(&inner))
        .constrain_to(view)
        .fade_in(false)
        .accessible_name(name)
        .show(ui.ctx(), contents);
}
