//! The pull of a hand in a substep: a spring from a point of a body to a place, taken implicitly.
//!
//! The point is a weighted mean of particles, `p = Σ w x`, whose effective mass is `1 / Σ (w²/m)`. With the velocity
//! `u` of the point at the end of the substep the pull is `J = dt (k (target − p − dt u) − d u)`, which solves to the
//! impulse below: it adds no stability limit, however strong it is.

use crate::math::Real;
use crate::physics::interaction::{Grab, resistance};
use crate::physics::step::substep::Substep;

/// Changes the predicted velocities of the particles that carry the point. Held particles stay.
pub(in crate::physics) fn apply_pull<R: Real>(substep: Substep<'_, R>, grab: &Grab<R>, velocity: &mut [R::Vec3]) {
    let impulse = impulse(substep, grab, velocity);
    for &(particle, weight) in &grab.weights {
        velocity[particle] += impulse * (weight * inverse_effective_mass(substep, grab, particle));
    }
}

/// The impulse of a grab in a substep, given the velocities without it, N·s. The particles that carry the point share it by
/// their weights.
pub(in crate::physics) fn impulse<R: Real>(substep: Substep<'_, R>, grab: &Grab<R>, velocity: &[R::Vec3]) -> R::Vec3 {
    let Substep { model, state, dt, .. } = substep;
    let inverse_mass = grab
        .weights
        .iter()
        .fold(R::ZERO, |sum, &(particle, w)| sum + w * w * inverse_effective_mass(substep, grab, particle));
    let point_velocity = grab.point(velocity);
    let resistance = dt * resistance([grab.stiffness, grab.damping(&model.bodies[grab.body])], dt);
    let pulling = (grab.target - grab.point(&state.position)) * (dt * grab.stiffness) - point_velocity * resistance;
    pulling * (R::ONE / (R::ONE + resistance * inverse_mass))
}

/// The inverse of a particle's effective mass, 1/kg; zero where it is held.
fn inverse_effective_mass<R: Real>(substep: Substep<'_, R>, grab: &Grab<R>, particle: usize) -> R {
    let body = &substep.model.bodies[grab.body];
    let local = particle - body.particles.start;
    if body.is_pinned(local) { R::ZERO } else { R::ONE / substep.inertia(grab.body, local) }
}
