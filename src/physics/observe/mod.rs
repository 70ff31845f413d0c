//! What is to be seen of a simulation: energies, what particles can be coloured by, whether a step ran away.

pub(in crate::physics) mod diagnostics;
pub(in crate::physics) mod runaway;
pub(in crate::physics) mod scalars;
