//! Observes a simulation: energies, scalars to colour particles by, detection of explosions.

pub(in crate::physics) mod diagnostics;
mod link_loads;
pub(in crate::physics) mod runaway;
pub(in crate::physics) mod scalars;
