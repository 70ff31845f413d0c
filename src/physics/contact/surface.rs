//! A surface as one particle meets it, and as a line crosses it.

use crate::math::Real;

/// The surface as one particle meets it: a tangent plane, in a frame that rides along with the obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics) struct Surface<R: Real> {
    /// Unit normal, towards the side the particle came from.
    pub(in crate::physics) normal: R::Vec3,
    /// Distance of the particle from the surface along the normal when the substep begins, m; negative inside.
    pub(in crate::physics) gap: R,
}

/// The part of a line `from + t direction` that is inside a form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics::contact) struct Crossing<R: Real> {
    /// t where the line enters.
    pub(in crate::physics::contact) enter: R,
    /// t where it leaves.
    pub(in crate::physics::contact) leave: R,
    /// Unit normal of the surface where it enters, outwards.
    pub(in crate::physics::contact) normal: R::Vec3,
}
