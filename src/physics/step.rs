//! One substep, in the order of GC Algorithm 1.
//!
//! ```text
//! forces   F  = m g + Σ links
//! predict  v* = v + dt F/m
//! pull     v* of a grabbed point's particles   (an implicit spring)
//! contact  v* → v'   (implicit penalty and friction; the thesis rule adds to F before the prediction)
//! move     x += dt v'
//! ```
//!
//! A step that would make any number infinite or NaN, or in manual stepping tear a body apart, is abandoned before
//! anything is written: the state stays the last good one and the report says so.

use super::contact;
use super::forces;
use super::interaction::{self, Grab};
use super::model::Model;
use super::plan::{Plan, Stage};
use super::report::{StageTimer, StepReport};
use super::runaway::runs_away;
use super::state::State;
use crate::math::{Real, Vector};
use crate::scene::settings::ContactRule;

/// Room a substep works in: allocated once, meaningless between substeps except for reading the last one's forces.
#[derive(Clone, Debug)]
pub struct Scratch<R: Real> {
    /// Net force on every particle without implicit contact, N.
    pub force: Vec<R::Vec3>,
    /// The velocity at the end of the substep, m/s.
    pub velocity: Vec<R::Vec3>,
    /// Contact's working room and what it found.
    pub contact: contact::Scratch<R>,
}

impl<R: Real> Scratch<R> {
    /// Room for a model.
    pub fn new(model: &Model<R>) -> Self {
        let count = model.particle_count();
        Self {
            force: vec![R::Vec3::ZERO; count],
            velocity: vec![R::Vec3::ZERO; count],
            contact: contact::Scratch::new(model),
        }
    }

    /// Makes room for a model of the same bodies and other obstacles.
    pub(super) fn fit(&mut self, model: &Model<R>) {
        self.contact = contact::Scratch::new(model);
    }
}

/// What comes from outside into a substep.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a, R: Real> {
    /// A hand that pulls.
    pub grab: Option<&'a Grab<R>>,
}

/// Advances the state by one substep.
pub fn substep<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    inputs: Inputs<'_, R>,
    state: &mut State<R>,
    scratch: &mut Scratch<R>,
    timer: &mut impl StageTimer,
) -> StepReport {
    let dt = R::from_f64(plan.substep_secs());
    let mut report = StepReport { substeps: 1, ..StepReport::default() };

    timer.enter(Stage::Gravity);
    forces::gravity(model, &mut scratch.force);
    if plan.runs(Stage::Links) {
        timer.enter(Stage::Links);
        report.link_forces = forces::links(model, plan, &state.position, &state.velocity, &mut scratch.force);
    }
    if plan.contact && plan.contact_rule == ContactRule::Thesis {
        timer.enter(Stage::Contact);
        contact::thesis::add_forces(model, dt, state, &mut scratch.force, &mut scratch.contact.contacts, &mut report);
    }
    timer.enter(Stage::Integrate);
    predict_velocity(model, dt, state, &scratch.force, &mut scratch.velocity);
    if let Some(grab) = inputs.grab {
        interaction::pull(model, dt, grab, &state.position, &mut scratch.velocity);
    }
    if plan.contact && plan.contact_rule == ContactRule::Implicit {
        contact::respond(model, plan, dt, state, &mut scratch.velocity, &mut scratch.contact, &mut report, timer);
        timer.enter(Stage::Integrate);
    }
    let exploded = plan.watched && runs_away(model, dt, &scratch.velocity);
    if !exploded && stays_finite(dt, state, &scratch.velocity) {
        if plan.contact && plan.contact_rule == ContactRule::Implicit {
            contact::remember_sides(model, dt, state, &scratch.velocity, &mut scratch.contact, &mut report);
        }
        move_particles(dt, state, &scratch.velocity);
        state.time_secs += plan.substep_secs();
    } else {
        report.diverged = true;
    }
    timer.leave();
    report
}

fn predict_velocity<R: Real>(model: &Model<R>, dt: R, state: &State<R>, force: &[R::Vec3], velocity: &mut [R::Vec3]) {
    for body in &model.bodies {
        let uniform = dt / body.particle_mass;
        for (local, particle) in body.particles.clone().enumerate() {
            velocity[particle] = if body.is_pinned(local) {
                R::Vec3::ZERO
            } else {
                let dt_over_mass = body.masses.get(local).map_or(uniform, |mass| dt / *mass);
                state.velocity[particle] + force[particle] * dt_over_mass
            };
        }
    }
}

fn stays_finite<R: Real>(dt: R, state: &State<R>, velocity: &[R::Vec3]) -> bool {
    state.position.iter().zip(velocity).all(|(x, v)| (*x + *v * dt).is_finite() && v.is_finite())
}

/// `x += dt v`, with what rounding keeps back carried to the next step (Kahan 1965).
fn move_particles<R: Real>(dt: R, state: &mut State<R>, velocity: &[R::Vec3]) {
    for (particle, v) in velocity.iter().enumerate() {
        let x = state.position[particle];
        let change = *v * dt + state.position_residual[particle];
        let moved = x + change;
        state.position_residual[particle] = change - (moved - x);
        state.position[particle] = moved;
    }
    state.velocity.copy_from_slice(velocity);
}
