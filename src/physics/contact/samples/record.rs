//! A contact of one point of a body's mesh and one obstacle.

use glam::DVec3;

use crate::physics::contact::weighted::WeightedParticles;

/// A point of a body's mesh that met an obstacle in the last substep, or a place in its cells that met an obstacle's edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleContact {
    /// The body.
    pub body: usize,
    /// The point, by its number in the body; a point on an edge of the obstacle has one that no body's points have.
    pub sample: usize,
    /// The obstacle.
    pub obstacle: usize,
    /// The particles that carry the point: their weighted mean is where it is, and each gets its share of the force.
    pub own: WeightedParticles,
    /// Unit normal, away from the obstacle.
    pub normal: DVec3,
    /// Distance from the surface along the normal when the substep began, m; negative inside.
    pub gap: f64,
    /// Velocity of the surface, m/s.
    pub surface_velocity: DVec3,
    /// Mean force on the point over the substep, normal and friction, N.
    pub force: DVec3,
    /// The most work that its spring and being parted from the obstacle can do in the substep, J.
    pub max_work_j: f64,
}
