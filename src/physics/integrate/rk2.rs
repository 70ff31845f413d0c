//! The midpoint rule, a Runge–Kutta method of second order: forces at the state and half a substep ahead. An undamped
//! vibration grows by a factor of `1 + (dt ω)⁴/8` a substep.

use super::{Free, kick};
use crate::math::Real;
use crate::physics::report::{StageTimer, StepReport};

/// Two evaluations; the velocity at the midpoint moves the particles.
pub(super) fn refine<R: Real>(
    free: &mut Free<'_, R>,
    velocity: &mut [R::Vec3],
    report: &mut StepReport,
    timer: &mut impl StageTimer,
) {
    free.first_stage();
    free.next_stage(free.dt * R::from_f64(0.5), report, timer);
    free.scratch.path.copy_from_slice(&free.scratch.velocity);
    velocity.copy_from_slice(&free.state.velocity);
    kick(free.model, &free.state.bodies, free.dt, &free.scratch.force, velocity);
}
