//! The panels: what a status says, as words and widgets, and what a person does to them, as commands. Nothing here
//! knows a session, a window or a GPU; every function takes what is shown and returns intent.

pub mod actions;
mod adding;
mod color;
mod cost;
pub mod error_panel;
mod figure;
mod file_menu;
pub mod files;
mod icon;
mod inspector;
mod keys;
mod log_axes;
mod menu;
mod message;
mod meter;
mod panels;
mod sides;
pub mod stability_panel;
mod timeline;
mod tip;
mod top_bar;
mod tree;
mod trouble;
mod value;
mod widths;
pub mod work;

use egui::{Align2, Area, Id, Order, Rect, RichText, Ui};

use super::frame_meter::DrawingCost;
use super::hand::Target;
use super::preferences::Preferences;
use super::theme::{self, Theme};
use crate::scene::edit::BodyId;
use crate::scene::placement::Look;
use crate::scene::presets::Preset;
use crate::scene::{ColorBy, Scene, ViewSettings};
use crate::session::{Command, Status};
use crate::view::{Colormap, SafeArea};

pub use color::color_command;
use error_panel::ErrorPanel;
use files::FilesState;
pub use inspector::own_weight::TooHeavy;
pub use panels::{Below, Panels};
use stability_panel::StabilityPanel;
pub use widths::Widths;

/// Height of a panel above the time line, points.
const BELOW_HEIGHT: f32 = 226.0;
/// The most of the window's height that a panel above the time line takes: the view keeps the rest.
const BELOW_SHARE: f32 = 0.4;
/// The least share of the view's width and height that counts as free.
const LEAST_FREE: f32 = 0.25;

/// What the panels show.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// The running sandbox; `None` until there is one.
    pub running: Option<Running<'a>>,
    /// A failure of the program itself, as a sentence; empty when all is well.
    pub failure: &'a str,
    /// The value under the pointer with its unit; empty when there is none.
    pub value: &'a str,
    /// What drawing costs.
    pub drawing: DrawingCost,
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
#[expect(clippy::struct_excessive_bools, reason = "independent wishes and choices, each made or not")]
pub struct UiState {
    /// The scenes to choose from.
    pub presets: &'static [Preset],
    /// Whether the list of keys is open.
    pub keys_open: bool,
    /// The message a person has read and closed.
    pub dismissed: String,
    /// The part of the window that no panel covers, points.
    pub view_rect: Rect,
    /// The part of it that no card covers, points.
    pub free_rect: Rect,
    /// Where a person looks: where new things come.
    pub look: Look,
    /// The eye moves with what is chosen.
    pub follow_chosen: bool,
    /// A person asked for a new start after a failure.
    pub revive: bool,
    /// What a person asked to see whole.
    pub frame: Option<Framing>,
    /// The colours of the interface and the view.
    pub theme: Theme,
    /// What is chosen.
    pub selection: Option<Target>,
    /// What will be chosen as soon as it is there: the sandbox answers a few frames later.
    pub awaited: Option<Target>,
    /// What will be chosen in a new scene that was asked for.
    pub comes_along: Option<Target>,
    /// What is being renamed, and the name so far.
    pub renaming: Option<(Target, String)>,
    /// Where the next teleport goes, m.
    pub origin: [f64; 3],
    /// A material that was chosen for a body that is too large for it.
    pub too_heavy: Option<TooHeavy>,
    /// A person asked to load a model.
    pub load_model: bool,
    /// Which panels are open.
    pub panels: Panels,
    /// How wide the panels beside the view are.
    pub widths: Widths,
    /// The dialogs about files.
    pub files: FilesState,
    /// The error curve.
    pub error_panel: ErrorPanel,
    /// The map of stability.
    pub stability_panel: StabilityPanel,
}

/// What the camera is to show whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Framing {
    /// All bodies and obstacles.
    Everything,
    /// What is chosen; everything where nothing is.
    Chosen,
    /// Everything in a scene that has just been opened, from its own camera; farther away where it must be.
    Opened,
    /// What is chosen and has just been added, where it is out of sight.
    Arrived,
}

impl UiState {
    /// The state of a fresh window.
    pub fn new(presets: &'static [Preset]) -> Self {
        Self {
            presets,
            keys_open: false,
            dismissed: String::new(),
            view_rect: Rect::NOTHING,
            free_rect: Rect::NOTHING,
            look: Look::default(),
            follow_chosen: false,
            revive: false,
            frame: None,
            theme: Theme::default(),
            selection: None,
            awaited: None,
            comes_along: None,
            renaming: None,
            origin: [0.0, 1.0, 0.0],
            too_heavy: None,
            load_model: false,
            panels: Panels::default(),
            widths: Widths::default(),
            files: FilesState::default(),
            error_panel: ErrorPanel::default(),
            stability_panel: StabilityPanel::default(),
        }
    }

    /// Arranges everything as it was at the last start.
    pub fn arrange(&mut self, preferences: &Preferences) {
        let Preferences { theme, panels, widths, zoom: _, folders } = preferences.clone();
        (self.theme, self.panels, self.widths, self.files.folders) = (theme, panels, widths, folders);
    }

    /// How everything is arranged, with text of this size.
    pub fn arrangement(&self, zoom: f32) -> Preferences {
        let Self { theme, panels, widths, .. } = *self;
        Preferences { theme, panels, widths, zoom, folders: self.files.folders.clone() }
    }

    /// Closes the uppermost thing over the view that Escape closes: the list of keys, then the message there is. Says
    /// whether there was one.
    pub fn close_uppermost(&mut self, message: &str) -> bool {
        if self.keys_open {
            self.keys_open = false;
            return true;
        }
        let shown = !message.is_empty() && self.dismissed != message;
        if shown {
            message.clone_into(&mut self.dismissed);
        }
        shown
    }

    /// The part of the view that no card covers; all of it where cards leave hardly anything.
    pub fn safe_area(&self) -> SafeArea {
        let (view, free) = (self.view_rect, self.free_rect);
        if !view.is_positive() {
            return SafeArea::whole(1.0);
        }
        let whole = SafeArea::whole(view.aspect_ratio());
        if free.width() < LEAST_FREE * view.width() || free.height() < LEAST_FREE * view.height() {
            return whole;
        }
        let place = |at: egui::Pos2| {
            let half = view.size() * 0.5;
            glam::Vec2::new((at.x - view.center().x) / half.x, (view.center().y - at.y) / half.y)
        };
        SafeArea { min: place(free.left_bottom()), max: place(free.right_top()), ..whole }
    }

    /// Another scene has taken the place of the old one: what came along with it is chosen.
    pub fn on_new_scene(&mut self) {
        (self.selection, self.awaited) = (None, self.comes_along.take());
        self.error_panel.forget();
        self.stability_panel.forget();
    }

    /// Takes note of what comes along with a new scene.
    fn foresee(&mut self, commands: &[Command]) {
        if commands.iter().any(Command::replaces_scene) {
            let brings_body = commands.iter().any(|command| matches!(command, Command::AddBody { .. }));
            self.comes_along = brings_body.then_some(Target::Body(BodyId(0)));
        }
    }

    /// Chooses what has come, and nothing that is not there.
    fn follow(&mut self, scene: &Scene) {
        let there = |target: &Target| actions::exists(scene, *target);
        let arrived = self.awaited.take_if(|awaited| there(awaited));
        if arrived.is_some() {
            self.frame = Some(Framing::Arrived);
        }
        self.selection = arrived.or(self.selection.filter(there));
        if self.renaming.as_ref().is_some_and(|(target, _)| !there(target)) {
            self.renaming = None;
        }
    }
}

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
    below_panel_ui(ui, shown, state, commands);
    if let Some(running) = shown.running {
        state.follow(running.scene);
        sides::side_panels_ui(ui, running, state, commands);
    }
    state.view_rect = ui.available_rect_before_wrap();
    state.free_rect = state.view_rect;
    match shown.running {
        Some(running) => {
            trouble::trouble_ui(ui, status, state, commands);
            let card = over_view(ui, "color", state.view_rect, Align2::LEFT_BOTTOM, |ui| {
                theme::float_frame(ui).show(ui, |ui| {
                    color::color_ui(ui, &running.scene.view, running.color_key, commands);
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
    message::message_ui(ui, status, shown.failure, state);
    keys::keys_ui(ui, state);
    // After a failure nothing can be saved any more: what is unsaved is kept as a draft.
    let saved = if shown.failure.is_empty() { status } else { &idle };
    files::files_ui(ui, saved, shown.running, state, commands);
    state.foresee(commands);
}

/// The panel above the time line; costs and stability are looked at only while they are shown.
fn below_panel_ui(ui: &mut Ui, shown: &Shown<'_>, state: &mut UiState, commands: &mut Vec<Command>) {
    let Some(running) = shown.running else { return };
    let below = state.panels.below;
    let counted = below == Some(Below::Cost);
    if running.status.cost.is_some() != counted {
        commands.push(Command::WatchCost(counted));
    }
    let stability = (below == Some(Below::Stability)).then(|| stability_panel::wanted(state.selection));
    if running.status.stability.as_ref().map(|shown| shown.of) != stability {
        commands.push(Command::WatchStability(stability));
    }
    let Some(below) = below else { return };
    let name = match below {
        Below::Cost => "cost",
        Below::Error => "error",
        Below::Stability => "stability",
    };
    let height = BELOW_HEIGHT.min(BELOW_SHARE * ui.available_height());
    let panel = egui::Panel::bottom(name).resizable(false).exact_size(height);
    panel.frame(theme::bar_frame(ui)).show(ui, |ui| match below {
        Below::Cost => cost::cost_ui(ui, running.status, shown.drawing),
        Below::Error => error_panel::error_panel_ui(ui, running, &mut state.error_panel, commands),
        Below::Stability => {
            stability_panel::stability_panel_ui(ui, running, &mut state.stability_panel, commands);
        }
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

/// A card at the top of the view, below those that are there.
fn card_over_view(ui: &Ui, name: &str, free: &mut Rect, contents: impl FnOnce(&mut Ui)) {
    let card = over_view(ui, name, *free, Align2::CENTER_TOP, contents);
    free.min.y = card.max.y.clamp(free.min.y, free.max.y);
}

/// What a card in the lower left corner leaves free: what lies above it or what lies on its right, whichever is larger.
fn beside_corner_card(free: Rect, card: Rect) -> Rect {
    let mut above = free;
    above.max.y = card.min.y.clamp(free.min.y, free.max.y);
    let mut right = free;
    right.min.x = card.max.x.clamp(free.min.x, free.max.x);
    if above.area() >= right.area() { above } else { right }
}

/// Something that floats over the view, at one of its corners. Tells where.
fn over_view(ui: &Ui, name: &str, view: Rect, corner: Align2, contents: impl FnOnce(&mut Ui)) -> Rect {
    let inner = view.shrink(14.0);
    Area::new(Id::unique(name))
        .order(Order::Middle)
        .movable(false)
        .pivot(corner)
        .fixed_pos(corner.pos_in_rect(&inner))
        .constrain_to(view)
        .fade_in(false)
        .accessible_name(name)
        .show(ui.ctx(), contents)
        .response
        .rect
}
