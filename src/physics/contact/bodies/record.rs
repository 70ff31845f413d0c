//! What contact found of one point of a body and the cell of another that it met.

use glam::DVec3;

/// A particle of one body that met a cell of another in the last substep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyContact {
    /// The body that the particle is of, and the one that the cell is of.
    pub bodies: [usize; 2],
    /// The particle, in the state's arrays.
    pub particle: usize,
    /// The particles of the cell, in the state's arrays.
    pub carriers: [usize; 8],
    /// Their weights: the weighted mean of the cell's particles is where the particle is.
    pub weights: [f64; 8],
    /// Unit normal, out of the cell's body.
    pub normal: DVec3,
    /// Distance from the cell's body along the normal when the substep began, m; negative inside.
    pub gap: f64,
    /// How far it was to a nearer side that the particle was not let out by, m: a thin body's, most of the way through.
    pub nearer: Option<f64>,
    /// Mean force on the particle over the substep, normal and friction, N; the cell has the opposite.
    pub force: DVec3,
}
