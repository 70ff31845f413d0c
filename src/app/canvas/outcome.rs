//! The outcome of a frame, and the reasons why there can be none.

use thiserror::Error;

use crate::render::{GpuError, RenderError};

/// Why nothing can be drawn in the window.
#[derive(Debug, Error)]
pub enum CanvasError {
    /// The window gives no surface.
    #[error("the window cannot be drawn to: install a Vulkan driver such as `mesa-vulkan-drivers`")]
    NoSurface(#[source] wgpu::CreateSurfaceError),
    /// There is no device, or no longer one.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The surface lacks a needed capability.
    #[error(
        "the graphics driver ({adapter}) cannot show pictures in a window: it needs a surface that can be copied to; \
         install a Vulkan driver such as `mesa-vulkan-drivers`, or use `gelatin render`"
    )]
    Surface {
        /// The adapter's name, kind and interface.
        adapter: String,
    },
    /// The surface repeatedly refuses to provide a texture.
    #[error("the window's surface gives no picture to draw on; restarting the display or the graphics driver may help")]
    Refused,
    /// The picture cannot be drawn.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// The outcome of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameOutcome {
    /// It is on the screen.
    Presented,
    /// It is not on the screen; the next one may be.
    Retry,
    /// Nobody could see it: the window is minimised, empty or covered.
    Unseen,
}
