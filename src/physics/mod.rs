//! The core: a mass-spring lattice that moves, meets obstacles and comes to rest (GC §2–§7).
//!
//! [`compile`](compile::compile) turns a [`crate::scene::Scene`] and the lattices of its bodies into a constant
//! [`Model`] and the [`Plan`] of a step; a [`Simulation`] owns both with the mutable [`State`]. The core does no
//! input or output, reads no clock, never fails and does not allocate once it runs. It is generic over the scalar:
//! `f32` to run, `f64` as reference.

mod assembly;
mod balance;
mod cell_bound;
pub mod compile;
pub mod contact;
pub mod diagnostics;
mod fallen;
pub mod forces;
pub mod hash;
mod integrate;
pub mod interaction;
pub mod memory;
pub mod model;
pub mod other_form;
pub mod plan;
pub mod recovery;
pub mod report;
pub mod runaway;
pub mod safe_values;
pub mod scalars;
pub mod simulation;
pub mod sleep;
pub mod stability;
pub mod state;
pub mod step;
pub mod strain;
mod substep;

pub use model::Model;
pub use plan::Plan;
pub use report::StepReport;
pub use simulation::Simulation;
pub use state::State;
