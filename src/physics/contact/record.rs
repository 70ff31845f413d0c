//! A contact of one particle and one obstacle.

use crate::math::Real;

/// A particle that met an obstacle in the last substep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactRecord<R: Real> {
    /// The particle, in the state's arrays.
    pub particle: usize,
    /// The obstacle.
    pub obstacle: usize,
    /// Unit normal, away from the obstacle.
    pub normal: R::Vec3,
    /// Distance from the surface along the normal when the substep began, m; negative inside.
    pub gap: R,
    /// Velocity of the surface, m/s.
    pub surface_velocity: R::Vec3,
    /// Mean contact force over the substep, normal and friction, N.
    pub force: R::Vec3,
}
