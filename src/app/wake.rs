//! The events that other threads send to the event loop.

use egui_winit::accesskit_winit;

/// A wake-up from another thread.
#[derive(Debug)]
pub(crate) enum Wake {
    /// The worker has something to take, or has begun long work.
    Worker,
    /// A system dialog was answered, or background work has ended.
    Dialog,
    /// A request from the accessibility tree.
    Accessibility(accesskit_winit::Event),
}

impl From<accesskit_winit::Event> for Wake {
    fn from(event: accesskit_winit::Event) -> Self {
        Self::Accessibility(event)
    }
}
