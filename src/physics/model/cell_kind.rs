//! A cell by what it is made of.

/// What a cell of one material gives to its links and corners, shares of neighbours not counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics) struct CellKind {
    /// By family, constants of links between such cells alone: force at 100 % strain, N.
    pub(in crate::physics) stiffness: [f64; 3],
    /// The same of damping, N·s.
    pub(in crate::physics) damping: [f64; 3],
    /// Mass of a cell of a solid, of a particle of springs, kg.
    pub(in crate::physics) mass: f64,
}
