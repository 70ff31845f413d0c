//! The renderer: turns a [`crate::view::DrawList`] into a picture, in a window or without one. Knows meshes carried by
//! points, solids, a camera and a light; knows no springs, scenes or windows.
//!
//! ```text
//! particles, scalars ─► skin (compute) ─► shadow, contact shadow ─► mesh, textured ─► solid ─► background ─► ground
//!                                         ─► lines, cells, points ─► fills ─► resolve ─► target
//! target, panels ─► compose ─► the window's surface
//! ```
//!
//! Lifetimes: a [`Gpu`] lives as long as the program, a [`Renderer`] as long as the device and the target's format, an
//! upload as long as the `Arc`s of the draw list are the same, a [`FrameTarget`] for one picture.

pub mod compose;
pub mod error;
pub mod gpu;
pub mod layout;
pub mod offscreen;
pub mod picture;
pub mod quality;
pub mod readback;
pub mod renderer;
pub mod shader;
pub mod target;

mod buffer;
mod contact_fit;
mod device;
mod driver_messages;
mod extents;
mod frame;
mod grid;
mod mesh_buffers;
mod overlay;
mod passes;
mod plane_parts;
mod shadow_fit;
mod shapes;
mod shared;
mod texture_cache;
mod upload_cache;

pub use compose::Compositor;
pub use error::{GpuError, RenderError};
pub use gpu::{Gpu, Preference};
pub use picture::{FrameCounters, FrameTarget, Viewport};
pub use quality::Quality;
pub use renderer::Renderer;
