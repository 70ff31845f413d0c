//! A point on its way through a substep, past an obstacle that may move.

use super::narrow;
use super::narrow::mesh::NearestPointCache;
use super::surface::Surface;
use crate::math::{Real, Vector};
use crate::physics::model::{ObstacleModel, ObstacleShape};

/// A point on its way.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct SweptPoint<R: Real> {
    /// Where it begins, m.
    pub(in crate::physics) from: R::Vec3,
    /// The way that it would go, m.
    pub(in crate::physics) path: R::Vec3,
    /// The side of a plane or an open mesh that it touched before, else 0.
    pub(in crate::physics) side: i8,
    /// Largest coordinates of the particles that the point is the mean of, m, as rounding error is a share of them; none where
    /// the point is a particle.
    pub(in crate::physics) largest_coordinates: Option<R::Vec3>,
}

impl<R: Real> SweptPoint<R> {
    /// Returns how the point meets an obstacle in a substep of `dt` (s), and the velocity of the surface. `caches` holds the
    /// cached search results of the point, by mesh.
    ///
    /// Contact with an obstacle that moves is swept in the obstacle's own frame: the point's start rides along, and the rest
    /// of its path is its motion past the obstacle.
    pub(in crate::physics) fn meet(
        &self,
        obstacle: &ObstacleModel<R>,
        dt: R,
        caches: &mut [NearestPointCache],
    ) -> Option<(Surface<R>, R::Vec3)> {
        let &Self { from, path, side, largest_coordinates } = self;
        let mut meet = |from, path| {
            let largest_coordinates = largest_coordinates.unwrap_or(from);
            match &obstacle.shape {
                ObstacleShape::Plane(plane) => narrow::plane::meet_within(
                    plane,
                    side,
                    from,
                    path,
                    narrow::plane::rounding_margin(plane, largest_coordinates),
                ),
                ObstacleShape::Mesh(mesh) => {
                    let margin = narrow::mesh::rounding_margin(mesh, largest_coordinates);
                    narrow::mesh::meet_within(mesh, side, from, path, margin, &mut caches[mesh.place])
                }
                shape => narrow::meet(shape, side, from, path),
            }
        };
        let Some(carry) = &obstacle.carry else { return Some((meet(from, path)?, R::Vec3::ZERO)) };
        let carried = carry.apply(from);
        let surface = meet(carried, from + path - carried)?;
        Some((surface, (carried - from) * (R::ONE / dt)))
    }
}
