//! The open window: its state and its answers to events. Holds the parts together; their work is in their own modules.

mod camera;
mod draw;
mod drawing;
mod modes;
mod panels;
mod pointing;
mod sending;

use std::sync::Arc;

use egui::ViewportId;
use egui_winit::accesskit_winit;
use glam::{Vec2, Vec3};
use thiserror::Error;
use winit::dpi::LogicalSize;
use winit::error::OsError;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, EventLoopProxy};
use winit::window::Window;

use self::drawing::Drawing;
use super::background_job::{BackgroundJob, JobControl};
use super::canvas::{Canvas, CanvasError};
use super::files::Files;
use super::frame_pacer::Reason;
use super::hand::{Hand, Target};
use super::handles::Handles;
use super::input::{self, Action, Input, ViewRect};
use super::preferences::PreferencesFile;
use super::sentence::sentence;
use super::ui::files::FileAction;
use super::ui::{self, Finding, Framing, UiState};
use super::unanswered::Unanswered;
use super::wake::Wake;
use super::worker::{Snapshot, Worker, WorkerError};
use super::{kept_file, theme};
use crate::extract;
use crate::scene::{ColorBy, Scene, presets};
use crate::session::Status;
use crate::session::document::Opened;
use crate::session::error_curve::{ErrorCurve, error_curve};
use crate::session::modes::{BodyModes, body_modes};
use crate::session::stability_map::{MapOf, PlaneShown, StabilityMap, stability_map};
use crate::session::wanted_modes::FoundModes;
use crate::view::Orbit;

/// The window's size at the start, points.
const SIZE: LogicalSize<f64> = LogicalSize::new(1280.0, 800.0);
/// The smallest window in which everything can be reached, points.
const MIN_SIZE: LogicalSize<f64> = LogicalSize::new(760.0, 420.0);

/// Why the window cannot go on.
#[derive(Debug, Error)]
pub enum ShellError {
    /// The system provides no window.
    #[error("the window could not be opened")]
    Window(#[from] OsError),
    /// Nothing can be drawn in it.
    #[error(transparent)]
    Canvas(#[from] CanvasError),
    /// The first scene cannot be simulated.
    #[error(transparent)]
    Start(WorkerError),
}

/// The open window.
pub(super) struct Shell {
    window: Arc<Window>,
    canvas: Canvas,
    context: egui::Context,
    egui: egui_winit::State,
    proxy: EventLoopProxy<Wake>,
    worker: Worker,
    files: Files,
    error_job: BackgroundJob<ErrorCurve>,
    stability_job: BackgroundJob<StabilityMap>,
    modes_job: BackgroundJob<Arc<BodyModes>>,
    awaited_job: BackgroundJob<FoundModes>,
    preferences: PreferencesFile,
    snapshot: Option<Snapshot>,
    unanswered: Unanswered,
    /// The title of the window: the name of the scene, and whether it has unsaved changes.
    titled: Option<(String, bool)>,
    orbit: Orbit,
    /// The thing that the eye follows, and the last place of its middle, m.
    followed: Option<(Target, Vec3)>,
    input: Input,
    /// The number of the last step asked for while time stands.
    stepped: u64,
    /// The number of the last command that writes a file.
    saved: u64,
    /// Closes the window once the file of this command is written.
    quit_after: Option<u64>,
    hand: Hand,
    handles: Handles,
    ui: UiState,
    failure: String,
    /// Whether the view's picture differs from the one on the screen.
    changed: bool,
    visible: bool,
    drawing: Drawing,
}

impl Shell {
    /// Opens the window on a running worker.
    pub(super) fn open(
        event_loop: &ActiveEventLoop,
        proxy: EventLoopProxy<Wake>,
        worker: Worker,
    ) -> Result<Self, ShellError> {
        // Hidden until the accessibility tree is connected, as its adapter demands.
        let attributes = Window::default_attributes()
            .with_title("Gelatin")
            .with_inner_size(SIZE)
            .with_min_inner_size(MIN_SIZE)
            .with_visible(false);
        let window = Arc::new(event_loop.create_window(attributes)?);
        let canvas = Canvas::new(event_loop, Arc::clone(&window))?;
        let folder = kept_file::state_folder();
        let preferences = PreferencesFile::open(folder.as_deref());
        let mut ui = UiState::new(presets::presets());
        ui.apply_preferences(preferences.preferences());
        let (context, egui) = interface(event_loop, &window, &canvas, proxy.clone());
        context.set_zoom_factor(preferences.preferences().zoom);
        window.set_visible(true);
        let drawing = Drawing::new(canvas.is_software());
        let files = Files::new(folder.as_deref(), &mut ui.files);
        Ok(Self {
            window,
            canvas,
            context,
            egui,
            proxy,
            worker,
            files,
            error_job: BackgroundJob::default(),
            stability_job: BackgroundJob::default(),
            modes_job: BackgroundJob::default(),
            awaited_job: BackgroundJob::default(),
            preferences,
            snapshot: None,
            unanswered: Unanswered::default(),
            titled: None,
            orbit: Orbit::default(),
            followed: None,
            input: Input::default(),
            stepped: 0,
            saved: 0,
            quit_after: None,
            hand: Hand::default(),
            handles: Handles::default(),
            ui,
            failure: String::new(),
            changed: true,
            drawing,
            visible: true,
        })
    }

    /// Answers an event of the window.
    pub(super) fn on_window_event(
        &mut self,
        event_loop: &ActiveEventLoop,
        event: &WindowEvent,
    ) -> Result<(), ShellError> {
        if matches!(event, WindowEvent::RedrawRequested) {
            return self.draw(event_loop);
        }
        // A change by motion is not the answer to this event.
        let moved = std::mem::take(&mut self.changed);
        match event {
            WindowEvent::CloseRequested => self.on_close_requested(event_loop),
            WindowEvent::Resized(_) | WindowEvent::ScaleFactorChanged { .. } => {
                self.canvas.resize();
                self.changed = true;
            }
            WindowEvent::Occluded(occluded) => {
                self.set_visible(!occluded);
                if !occluded {
                    self.drawing.note_uncovered();
                }
            }
            WindowEvent::Focused(false) => self.files.on_keyboard_lost(),
            _ => (),
        }
        let response = self.egui.on_window_event(&self.window, event);
        let action = input::from_winit(event).and_then(|event| {
            let situation = self.situation(event);
            self.input.on_event(event, situation)
        });
        if let Some(action) = action {
            self.act(action);
        }
        if matches!(event, WindowEvent::CursorMoved { .. }) {
            self.hover();
        }
        if response.repaint {
            self.drawing.note_touch();
        }
        if self.changed {
            self.drawing.ask_picture(Reason::Input);
        }
        self.changed |= moved;
        Ok(())
    }

    /// Answers a wake-up from another thread.
    pub(super) fn on_wake(&mut self, wake: Wake) -> Result<(), ShellError> {
        match wake {
            Wake::Worker => self.receive()?,
            Wake::Dialog => {
                self.files.answer(&mut self.ui.files);
                self.error_job.answer(&mut self.ui.error_panel);
                self.stability_job.answer(&mut self.ui.stability_panel);
                self.modes_job.answer(&mut self.ui.modes_panel.job);
                self.answer_awaited_modes();
                self.drawing.ask_panels();
            }
            Wake::Accessibility(event) => {
                match event.window_event {
                    accesskit_winit::WindowEvent::InitialTreeRequested => self.context.enable_accesskit(),
                    accesskit_winit::WindowEvent::ActionRequested(request) => {
                        self.egui.on_accesskit_action_request(request);
                    }
                    accesskit_winit::WindowEvent::AccessibilityDeactivated => self.context.disable_accesskit(),
                }
                self.drawing.ask_panels();
            }
        }
        Ok(())
    }

    fn receive(&mut self) -> Result<(), ShellError> {
        if let Some(mut snapshot) = self.worker.take() {
            self.unanswered.forget_answered(snapshot.answered, &snapshot.scene);
            snapshot.status.unsaved |= self.unanswered.is_unsaved();
            let old = self.snapshot.as_ref();
            if old.is_none_or(|old| old.generation != snapshot.generation) {
                self.orbit = extract::view::orbit(&snapshot.scene.view.camera);
                (self.hand, self.handles) = (Hand::default(), Handles::default());
                self.ui.on_new_scene();
                self.ui.frame = Some(Framing::Opened);
            }
            // The field of view belongs to the scene; the place of the eye belongs to the window.
            self.orbit.fov_rad = extract::view::orbit(&snapshot.scene.view.camera).fov_rad;
            self.files.on_snapshot(&snapshot, &mut self.ui.files);
            let answered = old.is_none_or(|old| old.answered != snapshot.answered);
            self.snapshot = Some(snapshot);
            self.note_scene();
            self.follow();
            self.ask_for_snapshot(answered);
        }
        self.ask_for_long_work();
        match self.worker.take_error() {
            Some(error @ WorkerError::NotStarted(_)) if self.snapshot.is_none() => Err(ShellError::Start(error)),
            Some(error) => {
                self.failure = sentence(&error);
                self.drawing.ask_panels();
                if let Some(snapshot) = &mut self.snapshot {
                    snapshot.status.playing = false;
                }
                Ok(())
            }
            None => Ok(()),
        }
    }

    fn color_by(&mut self, color: ColorBy) {
        if let Some(scene) = self.expected_scene() {
            let command = ui::color_command(&scene.view, color);
            self.send(command);
        }
    }

    fn set_visible(&mut self, visible: bool) {
        if self.visible != visible {
            self.visible = visible;
            self.worker.set_visible(visible);
        }
    }

    fn pixels_per_point(&self) -> f32 {
        egui_winit::pixels_per_point(&self.context, &self.window)
    }

    fn view(&self) -> ViewRect {
        let rect = self.ui.view_rect;
        if !rect.is_positive() {
            return ViewRect::default();
        }
        let scale = self.pixels_per_point();
        ViewRect {
            origin: Vec2::new(rect.left(), rect.top()) * scale,
            size: Vec2::new(rect.width(), rect.height()) * scale,
        }
    }

    /// Starts a new worker on the last scene, after the old one has failed.
    fn revive(&mut self) {
        if let Some(snapshot) = self.snapshot.take() {
            let Snapshot { scene, status, .. } = snapshot;
            let Status { title, base_dir, file, unsaved, on_disk, .. } = status;
            self.failure.clear();
            let opened = Opened { scene: Scene::clone(&scene), title, base_dir, file, unsaved, on_disk };
            self.worker = start_worker(&self.proxy, opened);
            (self.unanswered, self.ui.finding) = (Unanswered::default(), Finding::default());
            (self.stepped, self.saved, self.quit_after) = (0, 0, None);
        }
    }

    /// Closes the window, or asks first.
    fn on_close_requested(&mut self, event_loop: &ActiveEventLoop) {
        if self.snapshot.is_none() || !self.failure.is_empty() {
            // Nothing can be saved any more; unsaved changes are kept as a draft.
            self.close(event_loop);
        } else {
            // The question whether to save is asked in a picture, which a covered window does not draw.
            self.set_visible(true);
            self.window.focus_window();
            self.act(Action::Files(FileAction::Quit));
        }
    }

    fn handle_requests(&mut self, event_loop: &ActiveEventLoop) {
        let proxy = self.proxy.clone();
        let wake = move || {
            if proxy.send_event(Wake::Dialog).is_err() {
                log::debug!("the event loop has ended: nobody is woken");
            }
        };
        let open = || {
            let snapshot = self.snapshot.as_ref()?;
            Some((Arc::clone(&snapshot.scene), snapshot.status.base_dir.clone()))
        };
        let curve = || {
            let (scene, base_dir) = open()?;
            Some(move |control: JobControl<'_>| error_curve(&scene, &base_dir, control.progress, control.pause))
        };
        self.error_job.handle_request(&mut self.ui.error_panel, curve, wake.clone());
        let map = || {
            let (scene, base_dir) = open()?;
            let shown = self.snapshot.as_ref()?.status.stability.as_ref()?;
            let family = shown.plane.as_ref().and_then(PlaneShown::family);
            let of = MapOf { body: shown.of, family };
            Some(move |control: JobControl<'_>| stability_map(&scene, &base_dir, of, control.progress, control.pause))
        };
        self.stability_job.handle_request(&mut self.ui.stability_panel, map, wake.clone());
        let body = self.ui.body_of_modes();
        let modes = || {
            let (scene, base_dir) = open()?;
            let find =
                move |control: JobControl<'_>| body_modes(&scene, &base_dir, body, control.progress, control.pause);
            Some(move |control: JobControl<'_>| find(control).map(Arc::new))
        };
        self.modes_job.handle_request(&mut self.ui.modes_panel.job, modes, wake.clone());
        self.find_awaited_modes(wake.clone());
        let outcome = self.files.handle_requests(&mut self.ui.files, wake);
        self.send_all(outcome.commands);
        if outcome.quit {
            let answered = self.snapshot.as_ref().map_or(0, |snapshot| snapshot.answered);
            self.quit_after = Some(if self.saved > answered { self.saved } else { 0 });
        }
        self.quit_if_saved(event_loop);
    }

    /// Closes the window if a person asked for it and no file is being written. A file that cannot be written keeps it open.
    fn quit_if_saved(&mut self, event_loop: &ActiveEventLoop) {
        let Some(number) = self.quit_after else { return };
        let snapshot = self.snapshot.as_ref().filter(|_| self.failure.is_empty());
        match snapshot {
            Some(snapshot) if snapshot.answered < number => (),
            Some(snapshot) if number > 0 && snapshot.status.failed => {
                self.quit_after = None;
            }
            _ => self.close(event_loop),
        }
    }

    fn close(&mut self, event_loop: &ActiveEventLoop) {
        // Without a snapshot the last scene is still being started anew.
        self.files.close(!self.failure.is_empty() || self.snapshot.is_none());
        event_loop.exit();
    }

    /// Opens a lost graphics device anew, once: if that fails too, the error stands.
    fn recover(&mut self, event_loop: &ActiveEventLoop, error: CanvasError) -> Result<(), ShellError> {
        log::error!("{}: opening the graphics device anew", sentence(&error));
        if matches!(error, CanvasError::Render(_) | CanvasError::Surface { .. }) {
            return Err(error.into());
        }
        self.canvas = Canvas::new(event_loop, Arc::clone(&self.window))?;
        self.ui.files.inset_drawn(None);
        // The textures of the panels are lost with the device: a new context sends them again.
        let (context, egui) = interface(event_loop, &self.window, &self.canvas, self.proxy.clone());
        context.set_zoom_factor(self.context.zoom_factor());
        (self.context, self.egui, self.changed) = (context, egui, true);
        self.drawing = Drawing::new(self.canvas.is_software());
        Ok(())
    }
}

/// Runs a session on a worker that wakes the event loop.
pub(super) fn start_worker(proxy: &EventLoopProxy<Wake>, opened: Opened) -> Worker {
    let proxy = proxy.clone();
    Worker::session(opened, move || {
        if proxy.send_event(Wake::Worker).is_err() {
            log::debug!("the event loop has ended: nobody is woken");
        }
    })
}

fn interface(
    event_loop: &ActiveEventLoop,
    window: &Window,
    canvas: &Canvas,
    proxy: EventLoopProxy<Wake>,
) -> (egui::Context, egui_winit::State) {
    let context = egui::Context::default();
    theme::apply(&context);
    let scale = window.scale_factor();
    #[expect(clippy::cast_possible_truncation, reason = "a scale factor needs no double precision")]
    let scale = scale as f32;
    let side = Some(canvas.max_texture_side());
    let mut egui = egui_winit::State::new(context.clone(), ViewportId::ROOT, window, Some(scale), None, side);
    egui.init_accesskit(event_loop, window, proxy);
    (context, egui)
}
