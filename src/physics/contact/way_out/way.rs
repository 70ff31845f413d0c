//! Ways out, and which of them is taken.

use glam::DVec3;

use crate::math::Real;
use crate::physics::model::BodyModel;

/// A way that leads straight down counts this many times its length, as there may be a floor.
const DOWNWARD_COST_FACTOR: f64 = 4.0;

/// Middles this near each other, over the body's size, count as one place.
pub(super) const SAME_MIDDLE_TOLERANCE: f64 = 1e-6;

/// A way out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::physics::contact) struct WayOut {
    /// Its direction, of length 1.
    pub(in crate::physics::contact) direction: DVec3,
    /// Its length, m.
    pub(in crate::physics::contact) length_m: f64,
}

/// The cheapest of some ways, by their length and whether they lead down.
pub(super) fn shortest(gravity: DVec3, ways: impl Iterator<Item = WayOut>) -> Option<WayOut> {
    let down = gravity.normalize_or_zero();
    let cost = |out: &WayOut| out.length_m * (1.0 + (DOWNWARD_COST_FACTOR - 1.0) * out.direction.dot(down).max(0.0));
    ways.min_by(|a, b| cost(a).total_cmp(&cost(b)))
}

/// The particles of a body that are free to move, in the state's arrays.
pub(super) fn free_particles<R: Real>(body: &BodyModel<R>) -> impl Iterator<Item = usize> {
    body.particles.clone().enumerate().filter(|(local, _)| !body.is_pinned(*local)).map(|(_, particle)| particle)
}
