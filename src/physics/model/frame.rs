//! The axes of an obstacle, in which its edges are known.

use glam::DVec3;

use super::ObstacleShape;
use crate::math::{Real, Vector};

/// Where an obstacle is and how it is turned.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Frame<R: Real> {
    center: R::Vec3,
    axes: [DVec3; 3],
}

impl<R: Real> Frame<R> {
    /// The frame of an obstacle.
    pub(in crate::physics) fn of(shape: &ObstacleShape<R>) -> Self {
        let (center, axes) = match shape {
            ObstacleShape::Plane(plane) => (plane.center, [plane.axes[0], plane.normal, plane.axes[1]]),
            ObstacleShape::Oriented(form) => (form.center, form.axes),
            ObstacleShape::Mesh(mesh) => (mesh.center, mesh.axes),
            ObstacleShape::Sphere { center, .. } => (*center, [DVec3::X, DVec3::Y, DVec3::Z].map(R::Vec3::from_dvec3)),
        };
        Self { center, axes: axes.map(Vector::to_dvec3) }
    }

    /// A direction of the obstacle's own axes, in the world.
    pub(in crate::physics) fn direction(&self, local: DVec3) -> DVec3 {
        self.axes[0] * local.x + self.axes[1] * local.y + self.axes[2] * local.z
    }

    /// A place in the obstacle's own axes, in the world, m.
    pub(in crate::physics) fn place(&self, local: DVec3) -> DVec3 {
        self.center.to_dvec3() + self.direction(local)
    }
}
