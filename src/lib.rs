//! Gelatin: an interactive sandbox for soft bodies.

pub mod geometry;
pub mod math;
pub mod physics;
pub mod scene;
pub mod view;

pub mod export;
pub mod extract;
pub mod session;

#[cfg(feature = "render")]
pub mod render;

#[cfg(feature = "app")]
pub mod app;
#[cfg(feature = "app")]
pub mod cli;
