//! The midpoint rule, a Runge–Kutta method of second order: forces at the state and half a substep ahead. An undamped
//! vibration grows by a factor of `1 + (dt ω)⁴/8` a substep.

use super::free::{Free, kick};
use crate::math::Real;
use crate::physics::report::Recorder;

/// Two evaluations; the velocity at the midpoint moves the particles.
pub(super) fn refine<R: Real>(free: &mut Free<'_, R>, velocity: &mut [R::Vec3], recorder: &mut Recorder<'_>) {
    free.first_stage();
    free.next_stage(free.substep.dt * R::from_f64(0.5), recorder);
    if let Some(path) = &mut free.scratch.path {
        path.copy_from_slice(&free.scratch.velocity);
    }
    velocity.copy_from_slice(&free.substep.state.velocity);
    kick(free.substep.model, &free.substep.state.bodies, free.substep.dt, &free.scratch.force, velocity);
}
