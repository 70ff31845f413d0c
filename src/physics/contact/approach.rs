//! Where a body meets an obstacle that comes to it: see [`super::arrive`].

use glam::DVec3;

use crate::math::{Real, Vector};
use crate::physics::model::{BodyModel, Carry, Model, ObstacleModel};
use crate::physics::state::moving::Approach;

/// How fast an obstacle on its way speeds up and slows down, body sizes per second squared. To get out of half a body takes
/// 0.7 s, whatever the body's size.
pub(super) const ACCELERATION: f64 = 4.0;

impl Approach {
    /// Returns the speed in the next `secs` and the distance covered in them, m.
    pub(super) fn next<R: Real>(&self, body: &BodyModel<R>, secs: f64) -> (f64, f64) {
        if self.waits {
            return (0.0, 0.0);
        }
        let acceleration = ACCELERATION * body.size.to_f64();
        let speed = (self.speed + acceleration * secs).min((2.0 * acceleration * self.left_m).sqrt());
        (speed, (speed * secs).min(self.left_m))
    }
}

/// Returns an obstacle where the body of an approach meets it in the next `secs`.
pub(super) fn displaced<R: Real>(
    approach: &Approach,
    model: &Model<R>,
    obstacle: &ObstacleModel<R>,
    secs: f64,
) -> ObstacleModel<R> {
    let (_, distance_m) = approach.next(&model.bodies[approach.body], secs);
    let before = approach.way * -approach.left_m;
    let after = approach.way * (distance_m - approach.left_m);
    moved(obstacle, before, after, secs > 0.0)
}

/// An obstacle that is displaced by `before` at the beginning of a substep and by `after` at its end.
fn moved<R: Real>(obstacle: &ObstacleModel<R>, before: DVec3, after: DVec3, moves: bool) -> ObstacleModel<R> {
    let mut met = obstacle.clone();
    let [from, to] = [before, after].map(R::Vec3::from_dvec3);
    let center = met.shape.center_mut();
    let placed = *center;
    *center = placed + to;
    let [x, y, z] = DVec3::AXES.map(R::Vec3::from_dvec3);
    let still = Carry { from: placed, to: placed, turn: [x, y, z] };
    let carry = obstacle.carry.unwrap_or(still);
    met.carry = moves.then_some(Carry { from: carry.from + from, to: carry.to + to, ..carry });
    let bounds = obstacle.bounds;
    met.bounds.min = (bounds.min + from).min(bounds.min + to);
    met.bounds.max = (bounds.max + from).max(bounds.max + to);
    met
}
