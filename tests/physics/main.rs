//! The physics against analytic values, conservation laws and its own promises. Needs no GPU and no window.

mod analytic;
mod contact;
mod determinism;
mod economy;
mod extremes;
mod friction;
mod integrators;
mod presets;
mod recovery;
mod sleep;
mod stability;
mod support;
