//! Verlet's scheme as leapfrog, with a predicted velocity for the damping: second order with one evaluation of the forces a
//! substep.
//!
//! The velocity is half a substep behind the position, `v₋½`. It starts with half a kick, and the damping is evaluated with
//! `v₋½ + dt/2 a₋₁` instead of `v₋½`: without either the scheme is only of first order as soon as there is damping. The
//! prediction counts the damping twice in the stability limit, `dt² ω² + 4 dt c < 4`. The remembered acceleration leaves out
//! contact, whose impulses would otherwise be predicted to go on.

use crate::math::{Real, Vector};
use crate::physics::model::Model;
use crate::physics::state::State;
use crate::physics::state::sleep::awake;

/// Returns how long the present forces kick the velocity, s: `v½ = v₋½ + dt a`, or half of it from a velocity that is not
/// behind.
pub(super) fn kick_secs<R: Real>(dt: R, state: &State<R>) -> R {
    lag(state) + dt * R::from_f64(0.5)
}

/// Returns the velocity at the position's time, predicted with the last acceleration.
pub(super) fn predicted_velocity<'a, R: Real>(state: &State<R>, predicted: &'a mut [R::Vec3]) -> &'a [R::Vec3] {
    let lag = lag(state);
    predicted.copy_from_slice(&state.velocity);
    for (predicted, acceleration) in predicted.iter_mut().zip(state.acceleration.iter().flatten()) {
        *predicted += *acceleration * lag;
    }
    predicted
}

/// Keeps the acceleration of an accepted substep for the next one.
pub(super) fn remember<R: Real>(
    model: &Model<R>,
    dt: R,
    force: &[R::Vec3],
    thesis_force: Option<&[R::Vec3]>,
    state: &mut State<R>,
) {
    state.velocity_lag_secs = 0.5 * dt.to_f64();
    let Some(acceleration) = &mut state.acceleration else { return };
    for body in awake(model, &state.bodies) {
        for (local, particle) in body.particles.clone().enumerate() {
            let held = thesis_force.map_or(R::Vec3::ZERO, |held| held[particle]);
            acceleration[particle] = if body.is_pinned(local) {
                R::Vec3::ZERO
            } else {
                (force[particle] - held) * (R::ONE / body.mass(local))
            };
        }
    }
}

fn lag<R: Real>(state: &State<R>) -> R {
    R::from_f64(state.velocity_lag_secs)
}
