//! The physics against analytic values, conservation laws and its own promises. Needs no GPU and no window.

mod analytic;
mod bodies;
mod bounds;
mod cantilever;
mod closed_obstacles;
mod contact;
mod determinism;
mod economy;
mod extremes;
mod fallen;
mod folds;
mod friction;
mod golden;
mod hertz;
mod integrators;
mod mesh_obstacles;
mod moving_obstacles;
mod placing;
mod presets;
mod recovery;
mod sleep;
mod solid;
mod stabilised;
mod stability;
mod support;
mod work;
