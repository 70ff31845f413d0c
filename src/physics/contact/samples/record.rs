//! A contact of one point of a body's mesh and one obstacle.

use glam::DVec3;

use crate::math::{Real, Vector};
use crate::physics::state::State;

/// A point of a body's mesh that met an obstacle in the last substep, or a place in its cells that met an obstacle's edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleContact {
    /// The body.
    pub body: usize,
    /// The point, by its number in the body; a point on an edge of the obstacle has one that no body's points have.
    pub sample: usize,
    /// The obstacle.
    pub obstacle: usize,
    /// The particles that carry the point, in the state's arrays.
    pub carriers: [usize; 8],
    /// Their weights: the weighted mean of the particles is where the point is, and each gets that share of the force.
    pub weights: [f64; 8],
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

impl SampleContact {
    /// Where the point is, m.
    pub fn place<R: Real>(&self, state: &State<R>) -> DVec3 {
        let carried = self.carriers.iter().zip(self.weights);
        carried.map(|(carrier, weight)| state.position[*carrier].to_dvec3() * weight).sum()
    }
}
