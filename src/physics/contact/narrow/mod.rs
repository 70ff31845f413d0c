//! Where a particle's motion crosses the surface of an obstacle: one file for every shape.

mod capsule;
mod cuboid;
mod cylinder;
pub(super) mod mesh;
pub(super) mod oriented;
pub(super) mod plane;
mod round;
pub(super) mod sphere;

use super::surface::Surface;
use crate::math::Real;
use crate::physics::model::ObstacleShape;

/// Returns the surface as met by a particle that starts at `from`, moves by `path` past the obstacle, and touched a plane or
/// an open mesh on `side` before. None where it meets none.
pub(super) fn meet<R: Real>(shape: &ObstacleShape<R>, side: i8, from: R::Vec3, path: R::Vec3) -> Option<Surface<R>> {
    match shape {
        ObstacleShape::Plane(plane) => plane::meet(plane, side, from, path),
        ObstacleShape::Sphere { center, radius } => sphere::meet(*center, *radius, from, path),
        ObstacleShape::Oriented(oriented) => oriented::meet(oriented, from, path),
        ObstacleShape::Mesh(mesh) => mesh::meet(mesh, side, from, path, &mut mesh::NearestPointCache::default()),
    }
}
