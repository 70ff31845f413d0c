//! What is to be seen of a simulation: energies, loads for colours, whether a step ran away.

pub(in crate::physics) mod diagnostics;
pub(in crate::physics) mod runaway;
mod scalars;
