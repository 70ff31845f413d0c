//! The classical Runge–Kutta method: fourth order in smooth motion, for study and reference.
//!
//! With `y = (x, v)` and `y' = (v, a)`: slopes at the state, twice at the midpoint and at the end, weighted by 1, 2, 2 and 1
//! sixths.

use super::stepper::{Stepper, kick};
use crate::math::Real;
use crate::physics::report::Recorder;

/// Four evaluations; the weighted slopes are summed on the way.
pub(super) fn refine<R: Real>(stepper: &mut Stepper<'_, R>, velocity: &mut [R::Vec3], recorder: &mut Recorder<'_>) {
    stepper.first_stage();
    if let Some(mean_velocity) = &mut stepper.workspace.mean_velocity {
        mean_velocity.fill(R::Vec3::default());
    }
    velocity.copy_from_slice(&stepper.substep.state.velocity);
    add_share(stepper, 1.0 / 6.0, velocity);
    for (ahead, share) in [(0.5, 1.0 / 3.0), (0.5, 1.0 / 3.0), (1.0, 1.0 / 6.0)] {
        stepper.next_stage(stepper.substep.dt * R::from_f64(ahead), recorder);
        add_share(stepper, share, velocity);
    }
}

fn add_share<R: Real>(stepper: &mut Stepper<'_, R>, share: f64, velocity: &mut [R::Vec3]) {
    let share = R::from_f64(share);
    for (mean_velocity, stage) in stepper.workspace.mean_velocity.iter_mut().flatten().zip(&stepper.workspace.velocity)
    {
        *mean_velocity += *stage * share;
    }
    kick(
        stepper.substep.model,
        stepper.substep.plan.simd,
        &stepper.substep.state.bodies,
        stepper.substep.dt * share,
        &stepper.workspace.force,
        velocity,
    );
}
