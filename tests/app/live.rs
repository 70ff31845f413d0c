//! The panels around a sandbox that really runs: a click is carried out before the next frame.

use std::path::PathBuf;

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, Pos2, Rect, TouchPhase};
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, Node};
use gelatin::app::frame_meter::DrawingCost;
use gelatin::app::theme::{self, Theme};
use gelatin::app::ui::{Running, Shown, UiState, panels_ui};
use gelatin::scene::{Scene, presets};
use gelatin::session::{Command, Session};
use gelatin::view::Colormap;

/// Sizes of windows, points: the smallest one allowed up to a 4K screen at scale 2.
pub(crate) const SIZES: [[f32; 2]; 4] = [[760.0, 420.0], [900.0, 600.0], [1280.0, 800.0], [1920.0, 1080.0]];

/// The roles of controls that a hand or a key can use.
const CONTROLS: [Role; 8] = [
    Role::Button,
    Role::CheckBox,
    Role::RadioButton,
    Role::ComboBox,
    Role::Slider,
    Role::SpinButton,
    Role::TextInput,
    Role::ColorWell,
];

/// A paused sandbox with its panels.
pub(crate) struct Live {
    /// The sandbox.
    pub(crate) session: Session,
    /// The state that the panels remember.
    pub(crate) ui: UiState,
    /// All that the panels asked for, in order.
    pub(crate) sent: Vec<Command>,
    dressed: bool,
}

/// A window on a preset.
pub(crate) struct Window {
    /// The panels' own test harness.
    pub(crate) harness: Harness<'static, Live>,
}

impl Window {
    /// Opens a preset at 1280×800, paused.
    pub(crate) fn open(preset: &str) -> Self {
        Self::sized(preset, [1280.0, 800.0], Theme::Dark)
    }

    /// Opens a preset, paused.
    pub(crate) fn sized(preset: &str, size: [f32; 2], theme: Theme) -> Self {
        Self::on((presets::preset(preset).expect("a preset").build)(), preset, size, theme)
    }

    /// Opens a scene, paused.
    pub(crate) fn on(scene: Scene, title: &str, size: [f32; 2], theme: Theme) -> Self {
        let mut session = Session::new(scene, PathBuf::new(), title.into()).expect("it resolves");
        session.handle(Command::Pause).expect("it pauses");
        let ui = UiState { theme, ..UiState::new(presets::presets()) };
        let live = Live { session, ui, sent: Vec::new(), dressed: false };
        let mut window =
            Self { harness: Harness::builder().with_size(size).with_step_dt(1.0 / 60.0).build_ui_state(frame, live) };
        window.wait();
        window
    }

    /// Lets some frames pass.
    pub(crate) fn wait(&mut self) {
        self.harness.run_steps(4);
    }

    /// The document.
    pub(crate) fn scene(&self) -> &Scene {
        self.harness.state().session.scene()
    }

    /// The commands since the last call.
    pub(crate) fn sent(&mut self) -> Vec<Command> {
        std::mem::take(&mut self.harness.state_mut().sent)
    }

    /// Clicks on the control called `label`.
    pub(crate) fn click(&mut self, label: &str) {
        self.control(label).click();
        self.wait();
    }

    /// Clicks on the control called `label`, after scrolling to it.
    pub(crate) fn press(&mut self, label: &str) {
        self.control(label).scroll_to_me();
        self.wait();
        self.click(label);
    }

    /// Clicks twice on the control called `label`.
    pub(crate) fn double_click(&mut self, label: &str) {
        for _ in 0..2 {
            self.control(label).click();
            self.harness.run_steps(1);
        }
        self.wait();
    }

    /// The control called `label`; one that can be clicked comes before a text that names it.
    pub(crate) fn control<'a>(&'a self, label: &'a str) -> Node<'a> {
        let mut all = self.harness.query_all_by_label(label);
        let active = all.find(|node| CONTROLS.contains(&node.accesskit_node().role()));
        active.unwrap_or_else(|| self.harness.get_by_label(label))
    }

    /// Opens a menu and clicks on an entry.
    pub(crate) fn choose(&mut self, menu: &str, entry: &str) {
        self.click(menu);
        self.click(entry);
    }

    /// Whether anything is called `label`.
    pub(crate) fn has(&self, label: &str) -> bool {
        self.harness.query_all_by_label(label).next().is_some()
    }

    /// Where the first thing called `label` is, points.
    pub(crate) fn rect(&self, label: &str) -> Rect {
        self.control(label).rect()
    }

    /// Presses a key.
    pub(crate) fn key(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.wait();
    }

    /// Types a text into the widget with the keyboard focus, and Enter.
    pub(crate) fn enter(&mut self, text: &str) {
        self.harness.event(Event::Text(text.into()));
        self.wait();
        self.key(Modifiers::NONE, Key::Enter);
    }

    /// Turns the wheel over a place; up is positive.
    pub(crate) fn scroll(&mut self, at: Pos2, notches: f32) {
        self.harness.hover_at(at);
        self.harness.run_steps(1);
        let (unit, phase, source) = (MouseWheelUnit::Line, TouchPhase::Move, MouseWheelSource::Unknown);
        let (delta, modifiers) = (egui::vec2(0.0, notches), Modifiers::NONE);
        self.harness.event(Event::MouseWheel { unit, delta, phase, source, modifiers });
        self.harness.run_steps(30);
    }

    /// Presses, moves in steps, releases.
    pub(crate) fn drag(&mut self, from: Pos2, to: Pos2) {
        self.harness.hover_at(from);
        self.wait();
        self.harness.drag_at(from);
        self.harness.run_steps(2);
        for step in 1..=4_u8 {
            self.harness.hover_at(from.lerp(to, f32::from(step) / 4.0));
            self.harness.run_steps(2);
        }
        self.harness.drop_at(to);
        self.wait();
    }

    /// The name of the widget with the keyboard focus.
    pub(crate) fn focused(&self) -> Option<String> {
        let node = self.harness.root().children_recursive().find(Node::is_focused)?;
        node.accesskit_node().label()
    }

    /// All controls that a hand or a key can use: role, name, place.
    pub(crate) fn controls(&self) -> Vec<(Role, String, Rect)> {
        let nodes = self.harness.root().children_recursive();
        let active = nodes.filter(|node| {
            let inner = node.accesskit_node();
            CONTROLS.contains(&inner.role()) && inner.bounding_box().is_some() && !inner.is_disabled()
        });
        active
            .map(|node| (node.accesskit_node().role(), node.accesskit_node().label().unwrap_or_default(), node.rect()))
            .collect()
    }
}

fn frame(ui: &mut egui::Ui, live: &mut Live) {
    if !std::mem::replace(&mut live.dressed, true) {
        theme::apply(ui.ctx());
    }
    let mut commands = Vec::new();
    let (status, scene) = (live.session.status(), live.session.scene());
    let running =
        Running { status: &status, scene, color_key: Some((Colormap::default(), [0.0, 12.4])), is_painted: false };
    panels_ui(
        ui,
        &Shown {
            running: Some(running),
            failure: "",
            value: "",
            opening: None,
            making: None,
            drawing: DrawingCost::default(),
        },
        &mut live.ui,
        &mut commands,
    );
    for command in &commands {
        if let Err(error) = live.session.handle(command.clone()) {
            panic!("{command:?} was refused: {error}");
        }
        if command.replaces_scene() {
            live.ui.on_new_scene();
        }
    }
    live.sent.append(&mut commands);
}
