//! The edges of obstacles: where bodies may meet an obstacle between their particles.

use glam::DVec3;

use super::ObstacleShape;
use crate::math::{Aabb, Real, Vector};

/// Points on the edges of obstacles are numbered from here on, where points of bodies' meshes have numbers, too.
pub(in crate::physics) const FIRST_EDGE_POINT: usize = 1 << 30;

/// A stretch of points on an obstacle that meet the cells of bodies, in the obstacle's own axes about its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics) struct Edge {
    /// Where it begins and ends, m.
    pub(in crate::physics) ends: [DVec3; 2],
    /// The way out of the obstacle, of length 1; zero where it is not known.
    pub(in crate::physics) outward: DVec3,
    /// The number of its first point among all of the obstacle.
    pub(in crate::physics) first: usize,
    /// How many points it has, each in the middle of a part of equal length.
    pub(in crate::physics) count: usize,
}

/// All edges of an obstacle.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::physics) struct Edges {
    all: Vec<Edge>,
    /// For every [`GROUP`] edges the middle of a ball around them, and its radius, m.
    balls: Vec<(DVec3, f64)>,
}

/// Edges that are left out together where they are far away.
const GROUP: usize = 64;

impl Edges {
    /// The edges in their order.
    pub(in crate::physics) fn new(all: Vec<Edge>) -> Self {
        let ball = |group: &[Edge]| {
            let around: Aabb<f64> = Aabb::around(group.iter().flat_map(|edge| edge.ends));
            (around.center(), 0.5 * around.size().length())
        };
        let balls = all.chunks(GROUP).map(ball).collect();
        Self { all, balls }
    }

    /// Whether there are none.
    pub(in crate::physics) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// How many points are on them.
    pub(in crate::physics) fn point_count(&self) -> usize {
        self.all.last().map_or(0, |last| last.first + last.count)
    }

    /// The edges that may be near: those of groups whose ball `is_near`, given its middle and its radius.
    pub(in crate::physics) fn near(&self, is_near: impl Fn(DVec3, f64) -> bool) -> impl Iterator<Item = &Edge> {
        let groups = self.all.chunks(GROUP).zip(&self.balls);
        groups.filter(move |(_, (middle, radius))| is_near(*middle, *radius)).flat_map(|(edges, _)| edges)
    }
}

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
