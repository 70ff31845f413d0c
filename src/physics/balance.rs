//! The energy balance of an implicit substep: whether its linear equations were true enough.
//!
//! The equations of the implicit integrator are those of the links as they stand when the substep begins. Links that
//! turn or stretch far within it end with more energy than the equations took for them. With the impulses J of contact
//! and of a hand, and F all other forces, what comes from nowhere is
//!
//! ```text
//! Σ links and crushed cells [V(d') − V(d) − V'(d)·(d' − d)]  +  T(v') − T(v)  −  Σ particles v'·(dt F + J)
//! ```
//!
//! which is the change of a body's energy less all work done on it. Backward Euler, of which the integrator is the first
//! iteration, never has more than zero of it where the energy is convex (Hairer, Lubich and Wanner, "Geometric Numerical
//! Integration", 2006, VIII.6). The work of contact is that of the surfaces, and what it stores in springs counts as the
//! body's.

use super::contact::ContactRecord;
use super::forces::for_each_exact_link;
use super::interaction::Grab;
use super::model::{BodyModel, Model};
use super::plan::Plan;
use super::recovery;
use super::state::State;
use crate::math::{Real, Vector};

/// The share of a body's kinetic energy that is rounding: velocities are in single precision.
const ROUNDING: f64 = 1e-6;

/// The share of the work of contact that may be missing from the balance, as equations are solved to as much; of no more
/// than the kinetic energy that was there, or equations that were not solved at all would pass.
const UNSOLVED: f64 = 2e-4;

/// Whether a substep of `dt` (s) from `state` to the velocities `velocity` gives any body energy from nowhere. `force` is
/// that of the state without contact and hand.
#[expect(clippy::too_many_arguments, reason = "the parts of one substep, split borrow by borrow")]
pub(super) fn gains_energy<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    dt: R,
    state: &State<R>,
    force: &[R::Vec3],
    velocity: &[R::Vec3],
    contacts: &[ContactRecord<R>],
    grab: Option<&Grab<R>>,
) -> bool {
    let mut contacts = contacts;
    model.bodies.iter().enumerate().any(|(number, body)| {
        let own = contacts.partition_point(|contact| contact.particle < body.particles.end);
        let (own, others) = contacts.split_at(own);
        contacts = others;
        if state.bodies[number].asleep {
            return false;
        }
        let (kinetic, gained, work) = of_particles(body, dt.to_f64(), state, force, velocity);
        let there = (kinetic - gained - work).max(0.0);
        let (stored, carried, turned_over) = of_contacts(body, own, dt, velocity);
        let pulled = grab
            .filter(|grab| grab.body == number)
            .map_or(0.0, |grab| work_of(grab, body, dt.to_f64(), state, velocity));
        let own = [&state.position[..], &state.velocity, velocity].map(|of| &of[body.particles.clone()]);
        let unfolded = recovery::energy_past_work(plan, body, &state.bodies[number], own, dt);
        let from_nowhere =
            gained + of_links(body, plan, dt.to_f64(), state, velocity) + unfolded + stored - carried - pulled;
        // What is no number is no balance either.
        from_nowhere.is_nan() || from_nowhere > ROUNDING * kinetic + UNSOLVED * turned_over.min(there)
    })
}

/// The kinetic energy at the end, what the kinetic energy gains over the work of the forces, and that work, J.
fn of_particles<R: Real>(
    body: &BodyModel<R>,
    dt: f64,
    state: &State<R>,
    force: &[R::Vec3],
    velocity: &[R::Vec3],
) -> (f64, f64, f64) {
    body.particles.clone().enumerate().fold((0.0, 0.0, 0.0), |(kinetic, gained, sum), (local, particle)| {
        let mass = body.mass(local).to_f64();
        let [before, after] = [state.velocity[particle], velocity[particle]].map(Vector::to_dvec3);
        let change = 0.5 * mass * (after - before).dot(after + before);
        let work = dt * force[particle].to_dvec3().dot(after);
        (kinetic + 0.5 * mass * after.length_squared(), gained + change - work, sum + work)
    })
}

/// The energy that contact stores, the work that moving obstacles do, and all work of contact without regard to its
/// sign, J.
fn of_contacts<R: Real>(
    body: &BodyModel<R>,
    contacts: &[ContactRecord<R>],
    dt: R,
    velocity: &[R::Vec3],
) -> (f64, f64, f64) {
    let dt = dt.to_f64();
    contacts.iter().fold((0.0, 0.0, 0.0), |(stored, carried, turned_over), contact| {
        let [velocity, surface] = [velocity[contact.particle], contact.surface_velocity].map(Vector::to_dvec3);
        let spring = body.contacts[contact.obstacle].to_f64();
        let gap = contact.gap.to_f64();
        let later = gap + dt * (velocity - surface).dot(contact.normal.to_dvec3());
        let force = contact.force.to_dvec3();
        (
            stored + spring.energy(-later) - spring.energy(-gap),
            carried + dt * force.dot(surface),
            turned_over + dt * force.dot(velocity).abs(),
        )
    })
}

/// What the links have in the end past what their forces at the beginning did not do.
fn of_links<R: Real>(body: &BodyModel<R>, plan: &Plan, dt: f64, state: &State<R>, velocity: &[R::Vec3]) -> f64 {
    let own = body.particles.clone();
    let (position, residual) = (&state.position[own.clone()], &state.position_residual[own.clone()]);
    let velocity = &velocity[own];
    let mut sum = 0.0;
    for_each_exact_link(body, plan.families, position, residual, |[i, j], link| {
        let way = (velocity[j].to_dvec3() - velocity[i].to_dvec3()) * dt;
        let [before, after] = [link.d.length(), (link.d + way).length()];
        let [strained, later] = [before, after].map(|length| length * link.inverse_rest_length - 1.0);
        let along = if before > 0.0 { link.d.dot(way) / before } else { 0.0 };
        // k l0/2 (ε'² − ε²) − k ε δ, with the difference of squares taken apart.
        sum += link.stiffness * (0.5 * (later + strained) * (after - before) - strained * along);
    });
    sum
}

/// The work of a hand, J.
fn work_of<R: Real>(grab: &Grab<R>, body: &BodyModel<R>, dt: f64, state: &State<R>, velocity: &[R::Vec3]) -> f64 {
    let own = body.particles.clone();
    let away = (grab.target - grab.mean_of(&state.position[own.clone()], own.start)).to_dvec3();
    let speed = grab.mean_of(&velocity[own.clone()], own.start).to_dvec3();
    let pull = away * grab.stiffness.to_f64() - speed * (dt * grab.stiffness.to_f64() + grab.damping(body).to_f64());
    dt * pull.dot(speed)
}
