//! A contact of one point of a body and the cell of another that it met.

use glam::DVec3;

use crate::physics::contact::weighted::WeightedParticles;
use crate::physics::state::press::BodyPoint;

/// A point of one body that met a cell of another in the last substep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyContact {
    /// The body that the point is of, and the one that the cell is of.
    pub bodies: [usize; 2],
    /// The point.
    pub point: BodyPoint,
    /// The particles that carry it.
    pub own: WeightedParticles,
    /// The particles of the cell: their weighted mean is where the point is.
    pub cell: WeightedParticles,
    /// Unit normal, out of the cell's body.
    pub normal: DVec3,
    /// Distance from the cell's body along the normal when the substep began, m; negative inside.
    pub gap: f64,
    /// How far it was to a nearer side by which the point was not let out, m: that of a thin body it is most of the way through.
    pub nearer: Option<f64>,
    /// Mean force on the point over the substep, normal and friction, N; the cell has the opposite.
    pub force: DVec3,
    /// The most work that its spring and being parted can do in the substep, J.
    pub max_work_j: f64,
}
