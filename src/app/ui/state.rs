//! The state of the panels between frames, unknown to the session.

use egui::{Pos2, Rect};

use super::chosen_size::ChosenSize;
use super::files::FilesState;
use super::finding::Finding;
use super::marked_box::MarkedBox;
use super::modes_panel::{self, ModesPanel};
use super::moved_places::KnownThings;
use super::panels::Panels;
use super::things;
use super::widths::Widths;
use super::work::PanelJob;
use crate::app::hand::Target;
use crate::app::preferences::Preferences;
use crate::app::theme::Theme;
use crate::scene::Scene;
use crate::scene::cell_brush::CellChange;
use crate::scene::edit::BodyId;
use crate::scene::material::MaterialPreset;
use crate::scene::placement::Look;
use crate::scene::presets::Preset;
use crate::session::Command;
use crate::session::error_curve::ErrorCurve;
use crate::session::stability_map::StabilityMap;
use crate::view::SafeArea;

/// The least fraction of the view's width and height that cards must leave to count as free.
const MIN_FREE_SHARE: f32 = 0.25;

/// The state of the panels between frames, unknown to the session.
#[derive(Debug)]
pub struct UiState {
    /// The scenes to choose from.
    pub presets: &'static [Preset],
    /// Whether the list of keys is open.
    pub keys_open: bool,
    /// The last message that a person has closed.
    pub dismissed: String,
    /// The part of the window that no panel covers, points.
    pub view_rect: Rect,
    /// The part of the view that no card covers, points.
    pub free_rect: Rect,
    /// Where a person looks, which is where new things are placed.
    pub look: Look,
    /// Whether the eye moves with the selected thing.
    pub follow_chosen: bool,
    /// Whether a person asked for a new start after a failure.
    pub revive: bool,
    /// What a person asked to see whole.
    pub frame: Option<Framing>,
    /// The colours of the interface and the view.
    pub theme: Theme,
    /// The selected thing.
    pub selection: Option<Target>,
    /// The things that could be selected last.
    pub known_things: KnownThings,
    /// The size of the selected thing, for the camera to follow.
    pub chosen_size: ChosenSize,
    /// The thing to be selected as soon as it exists: the sandbox answers a few frames later.
    pub awaited: Option<Target>,
    /// The thing to be selected in the new scene that was requested.
    pub next_scene_target: Option<Target>,
    /// The brush in use.
    pub brush: Option<Brush>,
    /// The box of a body to be marked in the view.
    pub marked_box: MarkedBox,
    /// The thing being renamed, and its new name so far.
    pub renaming: Option<(Target, String)>,
    /// The target of the next teleport, m.
    pub origin: [f64; 3],
    /// A material chosen for a body that is too large for it.
    pub too_heavy: Option<TooHeavy>,
    /// Which panels are open.
    pub panels: Panels,
    /// How wide the panels beside the view are.
    pub widths: Widths,
    /// The dialogs about files.
    pub files: FilesState,
    /// The error curve.
    pub error_panel: PanelJob<ErrorCurve>,
    /// The map of stability.
    pub stability_panel: PanelJob<StabilityMap>,
    /// The modes of a body.
    pub modes_panel: ModesPanel,
    /// The modes that a body of the scene waits for.
    pub finding: Finding,
}

/// A material chosen for a body that is too large for it.
#[derive(Clone, Copy, Debug)]
pub struct TooHeavy {
    pub(super) body: BodyId,
    pub(super) preset: &'static MaterialPreset,
}

/// A brush over the cells of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Brush {
    /// The body that it paints.
    pub body: BodyId,
    /// The change that it makes.
    pub change: CellChange,
}

/// What the camera is to show whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Framing {
    /// All bodies and obstacles.
    Everything,
    /// The selected thing, or everything if nothing is selected.
    Chosen,
    /// Everything in a scene just opened, seen from its own camera, or from farther away if necessary.
    Opened,
    /// The selected thing, just added, if it is out of sight.
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
            known_things: KnownThings::default(),
            chosen_size: ChosenSize::default(),
            awaited: None,
            next_scene_target: None,
            brush: None,
            marked_box: MarkedBox::default(),
            renaming: None,
            origin: [0.0, 1.0, 0.0],
            too_heavy: None,
            panels: Panels::default(),
            widths: Widths::default(),
            files: FilesState::default(),
            error_panel: PanelJob::default(),
            stability_panel: PanelJob::default(),
            modes_panel: ModesPanel::default(),
            finding: Finding::default(),
        }
    }

    /// Takes over the arrangement of the last window.
    pub fn apply_preferences(&mut self, preferences: &Preferences) {
        let Preferences { theme, panels, widths, zoom: _, folders } = preferences.clone();
        (self.theme, self.panels, self.widths, self.files.folders) = (theme, panels, widths, folders);
    }

    /// The present arrangement, with text of this size.
    pub fn preferences(&self, zoom: f32) -> Preferences {
        let Self { theme, panels, widths, .. } = *self;
        Preferences { theme, panels, widths, zoom, folders: self.files.folders.clone() }
    }

    /// Closes the uppermost thing over the view that Escape closes: the list of keys, then the message. Returns whether
    /// there was one.
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

    /// The body whose modes are computed: the selected one, otherwise the first.
    pub fn body_of_modes(&self) -> BodyId {
        modes_panel::body_of(self.selection)
    }

    /// The part of the view that no card covers; the whole view if cards leave hardly anything.
    pub fn safe_area(&self) -> SafeArea {
        let (view, free) = (self.view_rect, self.free_rect);
        if !view.is_positive() {
            return SafeArea::whole(1.0);
        }
        let whole = SafeArea::whole(view.aspect_ratio());
        if free.width() < MIN_FREE_SHARE * view.width() || free.height() < MIN_FREE_SHARE * view.height() {
            return whole;
        }
        let place = |at: Pos2| {
            let half = view.size() * 0.5;
            glam::Vec2::new((at.x - view.center().x) / half.x, (view.center().y - at.y) / half.y)
        };
        SafeArea { min: place(free.left_bottom()), max: place(free.right_top()), ..whole }
    }

    /// Resets the state for another scene, and awaits the thing that comes with it.
    pub fn on_new_scene(&mut self) {
        (self.selection, self.awaited) = (None, self.next_scene_target.take());
        (self.brush, self.renaming, self.known_things) = (None, None, KnownThings::default());
        self.chosen_size = ChosenSize::default();
        self.error_panel.forget();
        self.stability_panel.forget();
        self.modes_panel.forget();
    }

    /// Notes the thing that will come with a new scene.
    pub(super) fn note_next_scene(&mut self, commands: &[Command]) {
        if commands.iter().any(Command::replaces_scene) {
            let brings_body = commands.iter().any(|command| matches!(command, Command::AddBody { .. }));
            self.next_scene_target = brings_body.then_some(Target::Body(BodyId(0)));
        }
    }

    /// Selects the awaited thing when it has come, follows the chosen ones to other places in their lists, and deselects things
    /// that are gone.
    pub(super) fn follow(&mut self, scene: &Scene) {
        if !self.known_things.are_of(scene) {
            let things = KnownThings::of(scene);
            let moved = |target: Target| self.known_things.moved(&things, target);
            self.selection = self.selection.and_then(moved);
            self.brush = self.brush.and_then(|brush| match moved(Target::Body(brush.body)) {
                Some(Target::Body(body)) => Some(Brush { body, ..brush }),
                _ => None,
            });
            self.renaming = self.renaming.take().and_then(|(target, text)| Some((moved(target)?, text)));
            self.known_things = things;
        }
        let there = |target: &Target| things::exists(scene, *target);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Body;

    #[test]
    fn what_is_chosen_brushed_and_renamed_stays_so_at_another_place_and_goes_with_its_thing() {
        let body = |x: f64| {
            let mut body = Body::default();
            body.pose.position[0] = x;
            body
        };
        let scene = |places: &[f64]| Scene { bodies: places.iter().copied().map(body).collect(), ..Scene::default() };
        let mut state = UiState::new(&[]);
        state.follow(&scene(&[2.0, 3.0]));
        let choose = |state: &mut UiState, id: BodyId| {
            state.selection = Some(Target::Body(id));
            state.brush = Some(Brush { body: id, change: CellChange::Erase });
            state.renaming = Some((Target::Body(id), "Pudding".to_owned()));
        };
        let chosen = |state: &UiState| {
            let renamed = state.renaming.as_ref().map(|(target, _)| *target);
            (state.selection, state.brush.map(|brush| Target::Body(brush.body)), renamed)
        };
        choose(&mut state, BodyId(1));
        state.follow(&scene(&[1.0, 2.0, 3.0]));
        let third = Some(Target::Body(BodyId(2)));
        assert_eq!(chosen(&state), (third, third, third), "another comes back before it");
        state.follow(&scene(&[1.0, 2.0]));
        assert_eq!(chosen(&state), (None, None, None), "it is gone");
        choose(&mut state, BodyId(0));
        state.on_new_scene();
        assert_eq!(chosen(&state), (None, None, None), "nothing is chosen in another scene");
    }
}
