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
use crate::math::{Real, Vector};
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

/// How far a point may seem to be off an obstacle that has sides and no inside by rounding error alone, m: of coordinates as large
/// as those of `at`.
pub(super) fn rounding_margin<R: Real>(shape: &ObstacleShape<R>, at: R::Vec3) -> R {
    match shape {
        ObstacleShape::Plane(plane) => plane::rounding_margin(plane, at),
        ObstacleShape::Mesh(mesh) if mesh.side_row.is_some() => mesh::rounding_margin(mesh, at),
        _ => R::ZERO,
    }
}

/// Whether a point is inside a closed obstacle, deeper than `depth` (m).
pub(super) fn is_deeper<R: Real>(shape: &ObstacleShape<R>, at: R::Vec3, depth: R) -> bool {
    match shape {
        ObstacleShape::Plane(_) => false,
        ObstacleShape::Mesh(mesh) => mesh.surface.holds_deep(mesh.in_local_frame(at), depth.to_f64() / mesh.length),
        _ => meet(shape, 0, at, R::Vec3::ZERO).is_some_and(|surface| surface.gap < -depth),
    }
}
