//! One substep, in the order of GC Algorithm 1.
//!
//! ```text
//! forces   F  = m g + Σ links + Σ cells near inversion
//! predict  v* = v + dt F/m
//! pull     v* of a grabbed point's particles   (an implicit spring)
//! contact  v* → v'   (implicit penalty and friction; the thesis rule adds to F before the prediction)
//! refine   v' and the mean velocity u, where the scheme has one, with more forces on the way
//! move     x += dt v'   (or dt u)
//! rest     bodies that have been at rest for long enough, or have fallen out of the scene, fall asleep and are left out
//!          of all this
//!
//! The implicit scheme solves for pull, contact and v' at once: find touches, solve, settle. Where that would give energy
//! it is taken again in halves, and in the smallest of them as the other schemes do.
//! ```
//!
//! A step that would make any number infinite or NaN, or in manual stepping tear a body apart, is abandoned before
//! anything is written: the state stays the last good one and the report says so.

use super::balance::{body_gains_energy, gains_energy};
use super::contact::{self, ContactRecord};
use super::fallen;
use super::forces;
use super::integrate::{self, Free};
use super::interaction::{self, Grab};
use super::model::Model;
use super::plan::{Plan, Stage};
use super::recovery;
use super::report::{StageTimer, StepReport};
use super::runaway::runs_away;
use super::sleep;
use super::state::{BodyMemory, State};
use crate::math::{Real, Vector};
use crate::scene::settings::{ContactRule, Integrator};

/// Room a substep works in: allocated once, meaningless between substeps except for reading the last one's forces.
#[derive(Clone, Debug)]
pub struct Scratch<R: Real> {
    /// Net force on every particle without implicit contact, N.
    pub force: Vec<R::Vec3>,
    /// Of it the thesis's contact, N; empty without that rule.
    thesis_force: Vec<R::Vec3>,
    /// The velocity at the end of the substep, m/s.
    pub velocity: Vec<R::Vec3>,
    /// Contact's working room and what it found.
    pub contact: contact::Scratch<R>,
    scheme: integrate::Scratch<R>,
    recovery: recovery::Scratch<R>,
    /// What was remembered of every body before the substep, where one may be given up.
    remembered: Vec<BodyMemory>,
}

impl<R: Real> Scratch<R> {
    /// Room for a model under a plan.
    pub fn new(model: &Model<R>, plan: &Plan) -> Self {
        let count = model.particle_count();
        let has_thesis_force = plan.contact && plan.contact_rule == ContactRule::Thesis;
        Self {
            force: vec![R::Vec3::ZERO; count],
            thesis_force: vec![R::Vec3::ZERO; if has_thesis_force { count } else { 0 }],
            velocity: vec![R::Vec3::ZERO; count],
            contact: contact::Scratch::new(model, plan),
            scheme: integrate::Scratch::new(model, plan),
            recovery: recovery::Scratch::new(model),
            remembered: remembered(model, plan),
        }
    }

    /// Makes room for a model of the same bodies with other constants or obstacles.
    pub(super) fn fit(&mut self, model: &Model<R>, plan: &Plan) {
        let Self { contact, thesis_force, scheme, recovery, remembered, .. } = Self::new(model, plan);
        (self.contact, self.thesis_force, self.scheme, self.recovery) = (contact, thesis_force, scheme, recovery);
        self.remembered = remembered;
    }
}

/// Room for what is remembered of the bodies before a substep that may be given up.
fn remembered<R: Real>(model: &Model<R>, plan: &Plan) -> Vec<BodyMemory> {
    if plan.integrator != Integrator::Implicit {
        return Vec::new();
    }
    let room = |cells: usize| BodyMemory { near_inversion: Vec::with_capacity(cells), ..BodyMemory::default() };
    model.bodies.iter().map(|body| room(body.lattice.cells.len())).collect()
}

/// How often the velocities of a body are halved that would gain energy however short its substeps are.
const SLOWINGS: u32 = 12;

/// What comes from outside into a substep.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a, R: Real> {
    /// A hand that pulls.
    pub grab: Option<&'a Grab<R>>,
}

/// What becomes of a part of a substep that would give energy from nowhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gain {
    /// It is abandoned and halved.
    Halve,
    /// It is taken as an explicit integrator can take it, or as it is.
    Take,
    /// It is taken with as much of the motion as gives none: there was enough work on the substep.
    Slow,
}

/// The time that a substep covers, or the part of one that is divided further.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Its length, s.
    pub secs: f64,
    /// What becomes of it where the implicit integrator would give energy from nowhere.
    pub gain: Gain,
    /// Whether the substep begins with it: what is under way is not given up.
    pub is_first: bool,
    /// Whether the substep ends with it.
    pub is_last: bool,
}

impl Part {
    /// A whole substep, come what may.
    pub fn whole(plan: &Plan) -> Self {
        Self { secs: plan.substep_secs(), gain: Gain::Take, is_first: true, is_last: true }
    }

    /// One of so many equal parts of it.
    pub fn of(self, parts: u32) -> Self {
        Self { secs: self.secs / f64::from(parts), ..self }
    }
}

/// Advances the state by one substep or a part of it. Abandons it, state untouched, where the report counts one as halved.
pub fn substep<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    part: Part,
    inputs: Inputs<'_, R>,
    state: &mut State<R>,
    scratch: &mut Scratch<R>,
    timer: &mut impl StageTimer,
) -> StepReport {
    let dt = R::from_f64(part.secs);
    let mut report = StepReport { substeps: 1, ..StepReport::default() };
    if sleep::is_quiet(state) {
        report.bodies_asleep = state.bodies.len();
        scratch.contact.report_kept(&mut report);
        state.time_secs += part.secs;
        return report;
    }
    let implicit_contact = meets_implicitly(plan);
    let thesis_contact = plan.contact && plan.contact_rule == ContactRule::Thesis;
    let Scratch { force, thesis_force, velocity, contact, scheme, recovery: recovering, remembered } = scratch;

    remembered.iter_mut().zip(&state.bodies).for_each(|(copy, memory)| copy.copy(memory));
    if plan.recovery && recovery::is_due(model, plan, state) {
        timer.enter(Stage::Recovery);
        recovery::look(model, state, part.secs, &mut report);
    }
    let felt = integrate::damping_velocity(plan, state, scheme);
    let residual = if plan.integrator == Integrator::Implicit { &state.position_residual[..] } else { &[] };
    let (bodies, position) = (&state.bodies, &state.position);
    forces::evaluate(model, plan, position, residual, felt, bodies, force, recovering, &mut report, timer);
    if thesis_contact {
        timer.enter(Stage::Contact);
        let rule = contact::thesis::ThesisRule { dt, pressing_force: plan.pressing_force };
        contact::thesis::add_forces(model, rule, state, force, thesis_force, contact, &mut report);
    }
    timer.enter(Stage::Integrate);
    let held_force = &thesis_force[..];
    let mut free = Free { model, plan, dt, state, force, held_force, scratch: scheme, recovery: recovering };
    if plan.integrator == Integrator::Implicit {
        solved_velocities(&mut free, inputs, contact, velocity, &mut report, timer, part.is_first);
        if report.stopped {
            state.bodies.iter_mut().zip(&*remembered).for_each(|(memory, copy)| memory.copy(copy));
            timer.leave();
            return StepReport { substeps: 0, ..report };
        }
        let holds = || {
            stays_finite(model, dt, state, velocity, velocity)
                && !gains_energy(model, plan, dt, state, force, velocity, &contact.contacts, inputs.grab)
        };
        if plan.halvings > 0 && !holds() {
            if part.gain == Gain::Halve {
                timer.leave();
                return StepReport { substeps: 0, halved: 1, ..report };
            }
            if part.gain == Gain::Slow {
                slow(model, plan, dt, state, velocity, force, &contact.contacts, inputs.grab);
            } else if plan.ends_explicitly {
                let felt = &state.velocity;
                forces::evaluate(model, plan, position, &[], felt, bodies, force, recovering, &mut report, timer);
                let mut free =
                    Free { model, plan, dt, state, force, held_force, scratch: scheme, recovery: recovering };
                predicted_velocities(&mut free, inputs, contact, velocity, &mut report, timer);
            }
        }
    } else {
        predicted_velocities(&mut free, inputs, contact, velocity, &mut report, timer);
    }
    let path = &mut scheme.path;
    if implicit_contact && !path.is_empty() {
        contact::respond_to_paths(model, plan, dt, state, velocity, path, contact, &mut report, timer);
        timer.enter(Stage::Integrate);
    }
    let moving = if path.is_empty() { &*velocity } else { &*path };
    let exploded = plan.watched && runs_away(model, dt, moving);
    let sound = !exploded && stays_finite(model, dt, state, moving, velocity);
    if sound {
        if implicit_contact {
            contact::remember_sides(model, dt, state, moving, contact, &mut report);
        }
        integrate::remember(model, plan, dt, force, held_force, state);
        move_particles(model, dt, state, moving, velocity);
        state.time_secs += part.secs;
    } else {
        report.diverged = true;
    }
    if plan.sleeping && part.is_last && !report.diverged {
        timer.enter(Stage::Rest);
        fallen::watch(model, state);
        sleep::watch(model, plan, inputs.grab.map(|grab| grab.body), state);
        report.bodies_asleep = sleep::asleep(state);
    }
    timer.leave();
    report
}

/// Halves the velocities of bodies until they gain no energy from nowhere by them; what does even then stands still.
#[expect(clippy::too_many_arguments, reason = "the parts of one substep, split borrow by borrow")]
fn slow<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    dt: R,
    state: &State<R>,
    velocity: &mut [R::Vec3],
    force: &[R::Vec3],
    contacts: &[ContactRecord<R>],
    grab: Option<&Grab<R>>,
) {
    for (number, body) in model.bodies.iter().enumerate() {
        let own = body.particles.clone();
        for slowing in (0..SLOWINGS).rev() {
            let is_finite =
                own.clone().all(|p| velocity[p].is_finite() && (state.position[p] + velocity[p] * dt).is_finite());
            if is_finite && !body_gains_energy(model, number, plan, dt, state, force, velocity, contacts, grab) {
                break;
            }
            for velocity in &mut velocity[own.clone()] {
                *velocity = if slowing == 0 || !is_finite { R::Vec3::ZERO } else { *velocity * R::from_f64(0.5) };
            }
        }
    }
}

/// Writes the velocities at the end of a substep from those that the forces predict.
fn predicted_velocities<R: Real>(
    free: &mut Free<'_, R>,
    inputs: Inputs<'_, R>,
    contact: &mut contact::Scratch<R>,
    velocity: &mut [R::Vec3],
    report: &mut StepReport,
    timer: &mut impl StageTimer,
) {
    let Free { model, plan, dt, state, .. } = *free;
    free.predict(velocity);
    if let Some(grab) = inputs.grab {
        interaction::pull(model, dt, grab, &state.position, velocity);
    }
    if meets_implicitly(plan) {
        contact::respond(model, plan, dt, state, velocity, contact, report, timer);
        timer.enter(Stage::Integrate);
    }
    free.refine(velocity, report, timer);
}

/// Writes the velocities at the end of a substep as the implicit scheme solves for them.
fn solved_velocities<R: Real>(
    free: &mut Free<'_, R>,
    inputs: Inputs<'_, R>,
    contact: &mut contact::Scratch<R>,
    velocity: &mut [R::Vec3],
    report: &mut StepReport,
    timer: &mut impl StageTimer,
    may_be_given_up: bool,
) {
    let Free { model, plan, dt, state, .. } = *free;
    if meets_implicitly(plan) {
        free.fall(velocity);
        contact::find_touches(model, plan, dt, state, velocity, contact, report, timer);
        timer.enter(Stage::Integrate);
    }
    free.solve(inputs.grab, &mut contact.touches, velocity, report, &|| may_be_given_up && timer.stops());
    if report.stopped {
        return;
    }
    if meets_implicitly(plan) {
        contact::settle_touches(model, plan, dt, state, velocity, contact, report, timer);
        timer.enter(Stage::Integrate);
    }
}

/// Whether there is contact, by any rule but that of the thesis.
fn meets_implicitly(plan: &Plan) -> bool {
    plan.contact && plan.contact_rule == ContactRule::Implicit
}

fn stays_finite<R: Real>(model: &Model<R>, dt: R, state: &State<R>, path: &[R::Vec3], velocity: &[R::Vec3]) -> bool {
    sleep::awake(model, &state.bodies).all(|body| {
        let mut own = body.particles.clone();
        own.all(|particle| {
            (state.position[particle] + path[particle] * dt).is_finite() && velocity[particle].is_finite()
        })
    })
}

/// `x += dt u`, with what rounding keeps back carried to the next step (Kahan 1965), and `v = v'`, of what is awake.
fn move_particles<R: Real>(model: &Model<R>, dt: R, state: &mut State<R>, path: &[R::Vec3], velocity: &[R::Vec3]) {
    for (number, body) in model.bodies.iter().enumerate() {
        if state.bodies[number].asleep {
            continue;
        }
        for particle in body.particles.clone() {
            let x = state.position[particle];
            let change = path[particle] * dt + state.position_residual[particle];
            let moved = x + change;
            state.position_residual[particle] = change - (moved - x);
            state.position[particle] = moved;
        }
        state.velocity[body.particles.clone()].copy_from_slice(&velocity[body.particles.clone()]);
    }
}
