//! The window: an event loop around a running sandbox. The sandbox lives on a [`worker`] thread. The window draws the newest
//! snapshot, sends commands, and never sees the physics.
//!
//! ```text
//! winit event ─ input ──┐                              ┌─ worker thread ─┐
//! egui panel ── ui ─────┼─ Command ─── channel ──────► │     Session     │
//! surface ◄─ canvas ◄─ shell ◄─ newest Snapshot ◄ slot ┴─────────────────┘
//! ```
//!
//! Everything is event-driven: nothing is drawn without a new snapshot, an event or an animation.

pub mod canvas;
pub mod frame_meter;
pub mod frame_pacer;
pub mod hand;
pub mod handles;
pub mod input;
pub mod preferences;
pub mod recovery;
pub mod redraw_policy;
pub mod theme;
pub mod ui;
pub mod worker;

mod background_job;
mod damage;
mod files;
mod jellify_job;
mod kept_file;
mod native_dialog;
mod processor_meter;
mod recent;
mod sentence;
mod shell;
mod unanswered;
mod urgent_orders;
mod wake;

use thiserror::Error;
use winit::application::ApplicationHandler;
use winit::error::EventLoopError;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::WindowId;

pub use self::kept_file::cache_folder;
use self::shell::Shell;
pub use self::shell::ShellError;
use self::wake::Wake;
use self::worker::Worker;
use crate::session::document::Opened;

/// Why there is no window, or no longer one.
#[derive(Debug, Error)]
pub enum AppError {
    /// There is no display.
    #[error(
        "there is no display to open a window on: set DISPLAY (or WAYLAND_DISPLAY), or use `gelatin render` to make \
         a picture without a window ({0})"
    )]
    NoDisplay(String),
    /// The event loop broke.
    #[error("the connection to the display was lost ({0})")]
    Display(String),
    /// The window cannot go on.
    #[error(transparent)]
    Shell(#[from] ShellError),
}

/// Opens the sandbox on a scene and returns when it is closed.
pub fn run(opened: Opened) -> Result<(), AppError> {
    let event_loop =
        EventLoop::<Wake>::with_user_event().build().map_err(|error| AppError::NoDisplay(cause(&error)))?;
    let proxy = event_loop.create_proxy();
    // The scene is prepared while the window opens.
    let worker = shell::start_worker(&proxy, opened);
    let mut app = App { proxy, start: Some(worker), shell: None, error: None };
    event_loop.run_app(&mut app).map_err(|error| AppError::Display(cause(&error)))?;
    app.error.map_or(Ok(()), |error| Err(error.into()))
}

/// The system's message, without the place in winit's source that reports it.
fn cause(error: &EventLoopError) -> String {
    let words = error.to_string();
    match words.strip_prefix("os error at ").and_then(|placed| placed.split_once(": ")) {
        Some((_, said)) => said.trim_end_matches('.').to_owned(),
        None => words,
    }
}

struct App {
    proxy: EventLoopProxy<Wake>,
    start: Option<Worker>,
    shell: Option<Shell>,
    error: Option<ShellError>,
}

impl App {
    /// Calls `what` on the open window. An error closes it.
    fn with_shell(&mut self, event_loop: &ActiveEventLoop, what: impl FnOnce(&mut Shell) -> Result<(), ShellError>) {
        let outcome = self.shell.as_mut().map_or(Ok(()), what);
        self.end_on_error(event_loop, outcome);
    }

    fn end_on_error(&mut self, event_loop: &ActiveEventLoop, outcome: Result<(), ShellError>) {
        if let Err(error) = outcome {
            self.error.get_or_insert(error);
            event_loop.exit();
        }
    }
}

impl ApplicationHandler<Wake> for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        let Some(worker) = self.start.take() else { return };
        let opened = Shell::open(event_loop, self.proxy.clone(), worker);
        let outcome = opened.and_then(|mut shell| {
            // The worker may have sent its wake-up before there was a window.
            let outcome = shell.on_wake(Wake::Worker);
            self.shell = Some(shell);
            outcome
        });
        self.end_on_error(event_loop, outcome);
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _window: WindowId, event: WindowEvent) {
        self.with_shell(event_loop, |shell| shell.on_window_event(event_loop, &event));
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, wake: Wake) {
        self.with_shell(event_loop, |shell| shell.on_wake(wake));
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let next = self.shell.as_mut().and_then(Shell::next_frame);
        event_loop.set_control_flow(next.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }
}
