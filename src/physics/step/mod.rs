//! One substep, in the order of GC Algorithm 1.
//!
//! ```text
//! cells    which cells are near inversion, where it is time to look
//! time     velocities that are half a part late are brought up to time, for schemes that begin on time
//! forces   F  = m g + Σ links + Σ cells near inversion
//! predict  v* = v + dt F/m
//! pull     v* of a grabbed point's particles   (an implicit spring)
//! bodies   v* of those that meet each other (implicit penalty and friction, the same on both)
//! contact  v* → v'   (points of meshes, then particles: implicit penalty and friction; the thesis's rule adds to F instead)
//! refine   v' and the mean velocity u, where the scheme has one, with more forces on the way
//! move     x += dt v'   (or dt u)
//! rest     bodies that have been at rest for long enough, or have fallen out of the scene, fall asleep and are left out
//!          of all this
//! ```
//!
//! What leads to the velocities is in `predicted` for the explicit schemes and in `solved` for the implicit one; both precisions
//! are compiled in `precision`.
//!
//! The implicit scheme solves for pull, contact, also of bodies with each other, and v' at once: find constraints, solve,
//! finish. Where that would give energy the part is taken again in halves; an explicit scheme takes the smallest of them if it
//! is refused, too.
//!
//! A part that would make any number infinite or NaN, or in manual stepping tear a body apart, is abandoned before anything
//! moves: positions stay the last good ones and the report says so.

pub(in crate::physics) mod precision;
mod predicted;
pub(in crate::physics) mod pull;
mod solved;
pub(in crate::physics) mod substep;
mod workspace;

pub(super) use substep::Inputs;
pub(super) use workspace::StepWorkspace;

use std::ops::Range;

use self::predicted::Prediction;
use super::contact;
use super::forces;
use super::forces::Kick;
use super::forces::links::Configuration;
use super::model::Model;
use super::report::Recorder;
use super::state::{BodyMemory, State};
use crate::math::{Aabb, Real, Vector};
use crate::physics::forces::recovery;
use crate::physics::kernels;
use crate::physics::model::Scheme;
use crate::physics::model::plan::{Plan, Stage};
use crate::physics::observe::runaway::runs_away;
use crate::physics::schemes;
use crate::physics::state::fallen;
use crate::physics::state::sleep;
use crate::physics::step::substep::{OnEnergyGain, Part, Substep};
use crate::physics::team;

/// How a part of a substep ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ending {
    /// The state is at its end.
    Taken,
    /// The state is untouched: the implicit scheme would have given energy from nowhere, or the stabilised one would have
    /// treated a body as at rest that is torn apart in the substep.
    Refused,
    /// The state is untouched: the timer stopped the substep.
    Stopped,
    /// Nothing has moved: a number would not have been finite, or a body torn apart. What bodies remember is of the attempt.
    Diverged,
}

/// Advances the state by a substep or a part of it: called by [`precision::substep`] alone.
fn take_part<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    part: Part,
    inputs: Inputs<'_, R>,
    state: &mut State<R>,
    workspace: &mut StepWorkspace<R>,
    recorder: &mut Recorder<'_>,
) -> Ending {
    if sleep::are_all_asleep(state) && !part.bodies_are_near {
        workspace.contact.bodies.keep_sleeping_contacts(model, plan, state);
        if plan.between_bodies.is_some() {
            std::mem::swap(&mut state.presses, &mut workspace.contact.bodies.presses);
        }
        workspace.contact.report_kept(recorder);
        state.time_secs += part.secs;
        recorder.note_part(part.secs, state.bodies.len());
        return Ending::Taken;
    }
    let memory_backup = &mut workspace.memory_backup;
    memory_backup.iter_mut().zip(&state.bodies).for_each(|(copy, memory)| copy.copy_from(memory));
    let StepWorkspace { due_bodies: due, speeds, .. } = workspace;
    if plan.recovery && recovery::find_due_bodies(model, plan, state, speeds, due) {
        recorder.enter(Stage::Recovery);
        recovery::check_cells(model, plan, state, due, part.secs, recorder);
    }
    if schemes::starts_on_time(part.scheme) && state.velocity_lag_secs > 0.0 {
        find_forces(inputs.substep(model, plan, part, state), workspace, recorder);
        if !recorder.has_stopped() {
            schemes::synchronise(model, plan, &workspace.force, state);
            workspace.speeds.forget();
            recorder.forbid_stop();
        }
    }
    let substep = inputs.substep(model, plan, part, state);
    let (obstacles, dt) = (inputs.obstacles, substep.dt);
    let prediction = find_forces(substep, workspace, recorder);
    let is_found = find_velocities(substep, part.on_energy_gain, prediction, workspace, recorder);
    let is_sound = is_found && is_sound(substep, prediction, workspace);
    if recorder.has_stopped() || !is_found {
        state.bodies.iter_mut().zip(&workspace.memory_backup).for_each(|(memory, copy)| memory.copy_from(copy));
        return if recorder.has_stopped() { Ending::Stopped } else { Ending::Refused };
    }
    if !is_sound {
        recorder.note_part(part.secs, sleep::asleep_count(state));
        return Ending::Diverged;
    }
    if plan.has_implicit_contact() {
        let moving = workspace.scheme.moving(&workspace.velocity);
        contact::remember_sides(model, obstacles, dt, state, moving, &mut workspace.contact, recorder);
    }
    if plan.recovery && state.bodies.iter().any(BodyMemory::is_watched) {
        recorder.enter(Stage::Recovery);
        let StepWorkspace { velocity, scheme, forces, .. } = workspace;
        recovery::track_energy((model, plan), (part.scheme, dt), scheme.moving(velocity), state, &mut forces.recovery);
    }
    accept(model, plan, part, state, workspace);
    if plan.sleeping && part.is_last {
        recorder.enter(Stage::Rest);
        fallen::put_to_sleep(model, state);
        sleep::put_to_sleep(
            model,
            plan,
            inputs.grab.map(|grab| grab.body),
            &workspace.contact.bodies.pushing_pairs(),
            state,
        );
    }
    recorder.note_part(part.secs, sleep::asleep_count(state));
    Ending::Taken
}

/// Forces at the state: gravity, links, cells near inversion, and contact by the thesis's rule. Where link forces come last,
/// their pass also predicts the velocities.
fn find_forces<R: Real>(
    substep: Substep<'_, R>,
    workspace: &mut StepWorkspace<R>,
    recorder: &mut Recorder<'_>,
) -> Prediction {
    let Substep { plan, state, scheme: by, .. } = substep;
    let StepWorkspace { force, thesis_force, velocity, contact, scheme, forces: of_forces, .. } = workspace;
    let is_predicted = by != Scheme::Implicit
        && !schemes::moves_by_mean(by)
        && thesis_force.is_none()
        && forces::links_come_last(plan, &state.bodies);
    let keeps_forces = schemes::remembers_forces(plan);
    let kick = is_predicted.then(|| Kick { secs: schemes::kick_secs(substep), velocity, keeps_forces });
    let at = Configuration {
        position: &state.position,
        velocity: schemes::damping_velocity(substep.scheme, state, scheme),
        residual: (substep.scheme == Scheme::Implicit).then_some(&state.position_residual),
    };
    forces::evaluate(substep, at, force, kick, of_forces, recorder);
    if let Some(thesis_force) = thesis_force {
        recorder.enter(Stage::Contact);
        contact::thesis::add_forces(substep, force, thesis_force, contact, recorder);
    }
    if is_predicted { Prediction::Made { is_finite: of_forces.is_finite() } } else { Prediction::Missing }
}

/// Finds the velocities at the end, contact and hand included. Returns whether they may be used: the implicit scheme refuses
/// them where its equations would give energy from nowhere, if `on_energy_gain` says so, the stabilised scheme where
/// contact tears apart a body that is not strained.
fn find_velocities<R: Real>(
    substep: Substep<'_, R>,
    on_energy_gain: OnEnergyGain,
    prediction: Prediction,
    workspace: &mut StepWorkspace<R>,
    recorder: &mut Recorder<'_>,
) -> bool {
    recorder.enter(Stage::Integrate);
    match substep.scheme {
        Scheme::Implicit => solved::find_velocities(substep, on_energy_gain, workspace, recorder),
        _ => predicted::find_velocities(substep, prediction, workspace, recorder),
    }
}

/// Whether the velocities that were found lead to finite places and, in manual stepping, tear no body apart. Contact
/// may still change the paths of schemes that move particles by a mean velocity.
fn is_sound<R: Real>(substep: Substep<'_, R>, prediction: Prediction, workspace: &StepWorkspace<R>) -> bool {
    let StepWorkspace { velocity, scheme, contact, forces, .. } = workspace;
    let Substep { model, plan, state, dt, .. } = substep;
    let moving = scheme.moving(velocity);
    // Contact alone has changed velocities since the forces predicted them.
    let is_predicted = prediction == (Prediction::Made { is_finite: true }) && substep.grab.is_none();
    let contacts = contact.all_contacts();
    if plan.watched {
        let after_contact = Aabb::around(contacts.particles().map(|p| velocity[p]));
        let known_bounds = |body: usize| {
            let is_known = is_predicted && !state.bodies[body].asleep;
            is_known.then(|| forces.predicted_bounds(body).joined(after_contact))
        };
        if runs_away(model, plan.simd, dt, moving, known_bounds) {
            return false;
        }
    }
    if is_predicted {
        return contacts.particles().all(|p| (state.position[p] + velocity[p] * dt).is_finite());
    }
    substep.stays_finite(moving) && (scheme.mean_velocity.is_none() || substep.stays_finite(velocity))
}

/// Moves everything, and remembers what the next substep of the scheme needs of this one.
fn accept<R: Real>(model: &Model<R>, plan: &Plan, part: Part, state: &mut State<R>, workspace: &mut StepWorkspace<R>) {
    let dt = R::from_f64(part.secs);
    let StepWorkspace { force, thesis_force, velocity, scheme, .. } = &mut *workspace;
    schemes::remember(model, (plan, part.scheme), dt, force, thesis_force.as_deref(), state);
    move_particles(model, plan, dt, state, scheme.moving(velocity));
    if sleep::asleep_count(state) == 0 {
        std::mem::swap(&mut state.velocity, velocity);
    } else {
        for body in sleep::awake(model, &state.bodies) {
            let own = body.particles.clone();
            state.velocity[own.clone()].copy_from_slice(&velocity[own]);
        }
    }
    workspace.speeds.forget();
    state.time_secs += part.secs;
    if plan.between_bodies.is_some() {
        std::mem::swap(&mut state.presses, &mut workspace.contact.bodies.presses);
    }
    if plan.on_mesh.is_some() {
        std::mem::swap(&mut state.touches, &mut workspace.contact.samples.touches);
    }
}

/// `x += dt u` for the bodies that are awake.
fn move_particles<R: Real>(model: &Model<R>, plan: &Plan, dt: R, state: &mut State<R>, moving_velocity: &[R::Vec3]) {
    let mut advance = |these: Range<usize>| {
        let to = [&mut state.position[these.clone()], &mut state.position_residual[these.clone()]];
        let moving_velocity = &moving_velocity[these];
        team::by_part(plan.threads, to, |part, [position, residual]| {
            kernels::advance(plan.simd, dt, &moving_velocity[part], position, residual);
        });
    };
    if state.bodies.iter().any(|memory| memory.asleep) {
        sleep::awake(model, &state.bodies).for_each(|body| advance(body.particles.clone()));
    } else {
        advance(0..model.particle_count());
    }
}
