//! What wakes the event loop from another thread.

use egui_winit::accesskit_winit;

/// A wake-up from another thread.
#[derive(Debug)]
pub(crate) enum Wake {
    /// The worker has something to take.
    Worker,
    /// A dialog of the system was answered, or a model is ready.
    Dialog,
    /// Somebody looks at the window through its accessibility tree.
    Accessibility(accesskit_winit::Event),
}

impl From<accesskit_winit::Event> for Wake {
    fn from(event: accesskit_winit::Event) -> Self {
        Self::Accessibility(event)
    }
}
