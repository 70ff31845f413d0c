//! Observes a simulation: energies, scalars to colour particles by, detection of explosions.

pub(in crate::physics) mod diagnostics;
pub(in crate::physics) mod runaway;
pub(in crate::physics) mod scalars;
