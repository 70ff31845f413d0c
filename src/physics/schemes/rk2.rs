//! The midpoint rule, a Runge–Kutta method of second order: forces at the state and half a substep ahead. An undamped
//! vibration grows by a factor of `1 + (dt ω)⁴/8` a substep.

use super::stepper::{Stepper, kick};
use crate::math::Real;
use crate::physics::report::Recorder;

/// Two evaluations; the velocity at the midpoint moves the particles.
pub(super) fn refine<R: Real>(stepper: &mut Stepper<'_, R>, velocity: &mut [R::Vec3], recorder: &mut Recorder<'_>) {
    stepper.first_stage();
    stepper.next_stage(stepper.substep.dt * R::from_f64(0.5), recorder);
    if let Some(mean_velocity) = &mut stepper.workspace.mean_velocity {
        mean_velocity.copy_from_slice(&stepper.workspace.velocity);
    }
    velocity.copy_from_slice(&stepper.substep.state.velocity);
    kick(
        stepper.substep.model,
        stepper.substep.plan.simd,
        &stepper.substep.state.bodies,
        stepper.substep.dt,
        &stepper.workspace.force,
        velocity,
    );
}
