//! Edges of obstacles on their way through a substep, and which bodies they come near.

use glam::DVec3;

use crate::math::{Aabb, Real, Vector};
use crate::physics::contact::near::AHEAD_SHARE;
use crate::physics::contact::placed::Placed;
use crate::physics::model::{Edge, Frame, Model, ObstacleModel};

/// Boxes are grown by this share of a cell, for places on its outside and for rounding error.
pub(super) const MARGIN_SHARE: f64 = 1e-3;

/// An edge of an obstacle on its way through a substep, in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct MovingEdge {
    /// Its ends at the beginning and at the end, m.
    ends: [[DVec3; 2]; 2],
}

impl MovingEdge {
    fn of<R: Real>(edge: &Edge, frame: &Frame<R>, obstacle: &ObstacleModel<R>) -> Self {
        let now = edge.ends.map(|end| frame.place(end));
        Self { ends: [now, now.map(|end| obstacle.carried(end))] }
    }

    /// The box around it at the end.
    pub(super) fn bounds(&self) -> Aabb<f64> {
        Aabb::around(self.ends[1])
    }

    /// Where the point at a share of its length is at the beginning and at the end, m.
    pub(super) fn points(&self, share: f64) -> [DVec3; 2] {
        self.ends.map(|[from, to]| from + (to - from) * share)
    }

    /// The part of it that is in a box at the end, as shares of its length; empty where none is.
    pub(super) fn clipped(&self, bounds: &Aabb<f64>) -> [f64; 2] {
        let [from, to] = self.ends[1];
        (0..3).fold([0.0, 1.0], |[first, last]: [f64; 2], axis| {
            let way = to[axis] - from[axis];
            let [low, high] = [bounds.min[axis] - from[axis], bounds.max[axis] - from[axis]];
            if way == 0.0 {
                return if low <= 0.0 && high >= 0.0 { [first, last] } else { [1.0, 0.0] };
            }
            let [a, b] = [low / way, high / way];
            [first.max(a.min(b)), last.min(a.max(b))]
        })
    }
}

/// The box around everything in a box of places that moves with velocities in another box for `dt`, at the end.
pub(super) fn moved_bounds<R: Real>(at: Aabb<R>, velocity: Aabb<R>, dt: R) -> Aabb<f64> {
    let dt = dt.to_f64();
    Aabb {
        min: at.min.to_dvec3() + velocity.min.to_dvec3() * dt,
        max: at.max.to_dvec3() + velocity.max.to_dvec3() * dt,
    }
}

/// The edges of an obstacle for a body on their way, but those that are far from a box at all times of the substep.
pub(super) fn edges_near<'a, R: Real>(
    (obstacle, body): (&'a ObstacleModel<R>, usize),
    frame: &'a Frame<R>,
    around: Option<&Aabb<f64>>,
) -> impl Iterator<Item = (&'a Edge, MovingEdge)> {
    let around = around.map(|around| [around.center(), 0.5 * around.size()]);
    let is_near = move |ball: DVec3, radius: f64| {
        around.is_none_or(|[middle, half]| {
            let from = frame.place(ball);
            let to = obstacle.carried(from);
            let reach = radius * (1.0 + MARGIN_SHARE) + MARGIN_SHARE * half.max_element() + (to - from).length();
            ((to - middle).abs() - half).max_element() <= reach
        })
    };
    obstacle.edges[body].near(is_near).map(move |edge| (edge, MovingEdge::of(edge, frame, obstacle)))
}

/// Whether a body whose places and velocities are in these boxes comes near an edge of an obstacle in the next `secs`.
pub(super) fn comes_near<R: Real>(
    model: &Model<R>,
    obstacles: &Placed<R>,
    number: usize,
    [at, velocity]: [Aabb<R>; 2],
    secs: R,
) -> bool {
    let body = &model.bodies[number];
    if body.modal.is_some() {
        return false;
    }
    let (now, then) = (moved_bounds(at, velocity, R::ZERO), moved_bounds(at, velocity, secs));
    let around = now.joined(then).grown(AHEAD_SHARE * body.lattice.grid.cell_size);
    let met = (0..model.obstacles.len()).map(|obstacle| obstacles.for_body(number, obstacle));
    met.filter(|obstacle| !obstacle.edges[number].is_empty()).any(|obstacle| {
        edges_near((obstacle, number), &Frame::of(&obstacle.shape), Some(&around))
            .any(|(_, MovingEdge { ends: [from, to] })| Aabb::around(from.into_iter().chain(to)).overlaps(&around))
    })
}
