//! The classical Runge–Kutta method: fourth order in smooth motion, for study and reference; at contact no better than
//! the others.
//!
//! With `y = (x, v)` and `y' = (v, a)`: slopes at the state, twice at the midpoint and at the end, in shares of 1, 2, 2
//! and 1 sixths.

use super::free::{Free, kick};
use crate::math::Real;
use crate::physics::report::Recorder;

/// Four evaluations. The shares are summed on the way.
pub(super) fn refine<R: Real>(free: &mut Free<'_, R>, velocity: &mut [R::Vec3], recorder: &mut Recorder<'_>) {
    free.first_stage();
    if let Some(path) = &mut free.scratch.path {
        path.fill(R::Vec3::default());
    }
    velocity.copy_from_slice(&free.substep.state.velocity);
    add_share(free, 1.0 / 6.0, velocity);
    for (ahead, share) in [(0.5, 1.0 / 3.0), (0.5, 1.0 / 3.0), (1.0, 1.0 / 6.0)] {
        free.next_stage(free.substep.dt * R::from_f64(ahead), recorder);
        add_share(free, share, velocity);
    }
}

fn add_share<R: Real>(free: &mut Free<'_, R>, share: f64, velocity: &mut [R::Vec3]) {
    let share = R::from_f64(share);
    for (path, stage) in free.scratch.path.iter_mut().flatten().zip(&free.scratch.velocity) {
        *path += *stage * share;
    }
    kick(free.substep.model, &free.substep.state.bodies, free.substep.dt * share, &free.scratch.force, velocity);
}
