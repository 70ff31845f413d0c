//! Where a body is in a substep, and how fast, as a whole.

use crate::math::{Aabb, Real, Vector};
use crate::physics::kernels::bounds;
use crate::physics::model::Model;
use crate::physics::model::plan::Plan;
use crate::physics::state::State;

/// Where a body is in the coming substep, and how fast.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Motion<R: Real> {
    /// Around where it is and where it would come to, m.
    pub(super) bounds: Aabb<R>,
    /// Around its velocities, m/s.
    pub(super) velocity: Aabb<R>,
}

impl<R: Real> Motion<R> {
    /// That of a body for so many seconds.
    pub(super) fn of(model: &Model<R>, plan: &Plan, state: &State<R>, body: usize, secs: R) -> Self {
        let own = model.bodies[body].particles.clone();
        let at = bounds::<R>(plan.simd, &state.position[own.clone()]);
        if state.bodies[body].asleep {
            return Self { bounds: at, velocity: Aabb { min: R::Vec3::ZERO, max: R::Vec3::ZERO } };
        }
        let velocity = bounds::<R>(plan.simd, &state.velocity[own]);
        let ahead = Aabb { min: at.min + velocity.min * secs, max: at.max + velocity.max * secs };
        Self { bounds: at.joined(ahead), velocity }
    }
}
