//! A surface as one particle meets it.

use crate::math::Real;

/// The surface as one particle meets it: a tangent plane, in a frame that rides along with the obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics::contact) struct Surface<R: Real> {
    /// Unit normal, towards the side the particle came from.
    pub(in crate::physics::contact) normal: R::Vec3,
    /// Distance of the particle from the surface along the normal when the substep begins, m; negative inside.
    pub(in crate::physics::contact) gap: R,
}
