//! The material constants of a cell.

/// What a cell of one material contributes to its links and corners, shares of neighbours not counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics) struct CellKind {
    /// Stiffness by family of a link that only cells of this kind hold: force at 100 % strain, N.
    pub(in crate::physics) stiffness: [f64; 3],
    /// Damping by family of such a link, N·s.
    pub(in crate::physics) damping: [f64; 3],
    /// Mass of a cell of a solid, or of a particle of springs, kg.
    pub(in crate::physics) mass: f64,
}
