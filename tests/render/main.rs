//! The renderer, on a software adapter: layouts shared with shaders, shaders, analytic pictures, and that the comparison of
//! pictures can fail. A machine without an adapter fails these tests and says what to install.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod compose;
mod errors;
mod floor;
mod harness;
mod layout;
mod outline;
mod overlay;
mod properties;
mod shaders;
mod textured;
mod textured_files;
mod uploads;

#[path = "../support/gpu.rs"]
mod gpu;
#[path = "../support/image_diff.rs"]
mod image_diff;
#[path = "../support/scenes.rs"]
mod scenes;
