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
//! The implicit scheme solves for pull, contact, also of bodies with each other, and v' at once: find constraints, solve,
//! finish. Where that would give energy the part is taken again in halves; an explicit scheme takes the smallest of them if it
//! is refused, too.
//!
//! A part that would make any number infinite or NaN, or in manual stepping tear a body apart, is abandoned before anything
//! moves: positions stay the last good ones and the report says so.

pub(in crate::physics) mod precision;
pub(in crate::physics) mod pull;
pub(in crate::physics) mod substep;
mod workspace;

pub(super) use substep::Inputs;
pub(super) use workspace::StepWorkspace;

use std::ops::Range;

use super::contact::{self, BodyContact, ContactRecord, ContactWorkspace, SampleContact};
use super::forces;
use super::forces::Kick;
use super::forces::exact::ExactLinks;
use super::forces::links::Configuration;
use super::forces::strain::StraightMotion;
use super::model::Model;
use super::report::Recorder;
use super::state::{BodyMemory, State};
use crate::math::{Real, Vector};
use crate::physics::forces::recovery;
use crate::physics::kernels;
use crate::physics::model::plan::{Plan, Stage};
use crate::physics::model::{ContactRule, Scheme};
use crate::physics::modes;
use crate::physics::observe::runaway::runs_away;
use crate::physics::schemes::implicit::arcs;
use crate::physics::schemes::implicit::balance::{SubstepEnd, body_gains_energy, gains_energy};
use crate::physics::schemes::{self, SchemeWorkspace};
use crate::physics::state::fallen;
use crate::physics::state::sleep;
use crate::physics::step::substep::{OnEnergyGain, Part, Substep};
use crate::physics::stepping::strain;
use crate::physics::team;

/// How often the velocities are halved in a body that would gain energy however short its substeps are.
const MAX_VELOCITY_HALVINGS: u32 = 12;

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
    let due = &mut workspace.due_bodies;
    if plan.recovery && recovery::find_due_bodies(model, plan, state, due) {
        recorder.enter(Stage::Recovery);
        recovery::check_cells(model, plan, state, due, part.secs, recorder);
    }
    if schemes::starts_on_time(part.scheme) && state.velocity_lag_secs > 0.0 {
        find_forces(inputs.substep(model, plan, part, state), workspace, recorder);
        if !recorder.has_stopped() {
            schemes::synchronise(model, plan, &workspace.force, state);
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
    if has_implicit_contact(plan) {
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

/// Whether the velocities that the forces predict are known with the forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Prediction {
    /// They are not known yet.
    Missing,
    /// All of them are known.
    Made {
        /// Whether they lead to finite places.
        is_finite: bool,
    },
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
    if substep.scheme != Scheme::Implicit {
        return predicted_velocities(substep, prediction, workspace, recorder);
    }
    solved_velocities(substep, workspace, recorder);
    if on_energy_gain == OnEnergyGain::Take || recorder.has_stopped() {
        return true;
    }
    let StepWorkspace { velocity, force, contact, scheme, forces: of_forces, .. } = workspace;
    let (contacts, between_bodies, on_mesh) =
        (&contact.contacts[..], &contact.bodies.contacts[..], &contact.samples.contacts[..]);
    let end = SubstepEnd { velocity, moving: scheme.moving(velocity), force, contacts, between_bodies, on_mesh };
    let stops = || recorder.stops();
    if stays_finite(substep, velocity)
        && stays_finite(substep, end.moving)
        && !gains_energy(substep, end, &mut of_forces.exact, &stops)
    {
        return true;
    }
    if on_energy_gain == OnEnergyGain::Slow {
        let contacts = (contacts, between_bodies, on_mesh);
        slow(substep, velocity, force, contacts, &mut of_forces.exact, &stops);
        if let Some(moving) = &mut scheme.mean_velocity {
            moving.copy_from_slice(velocity);
        }
    }
    on_energy_gain == OnEnergyGain::Slow
}

/// Whether the velocities that were found lead to finite places and, in manual stepping, tear no body apart. Contact
/// may still change the paths of schemes that move particles by a mean velocity.
fn is_sound<R: Real>(substep: Substep<'_, R>, prediction: Prediction, workspace: &StepWorkspace<R>) -> bool {
    let StepWorkspace { velocity, scheme, contact, .. } = workspace;
    let moving = scheme.moving(velocity);
    if substep.plan.watched && runs_away(substep.model, substep.plan.simd, substep.dt, moving) {
        return false;
    }
    if prediction == (Prediction::Made { is_finite: true }) && substep.grab.is_none() {
        // Since then contact alone has changed velocities.
        let between_bodies = contact.bodies.contacts.iter();
        let between_bodies = between_bodies.flat_map(|met| met.cell.iter().chain(met.own.iter()));
        let between_bodies = between_bodies.map(|(particle, _)| particle);
        let on_mesh = contact.samples.contacts.iter().flat_map(|met| met.carriers);
        let mut met = contact.contacts.iter().map(|contact| contact.particle).chain(between_bodies).chain(on_mesh);
        return met.all(|p| (substep.state.position[p] + velocity[p] * substep.dt).is_finite());
    }
    stays_finite(substep, moving) && (scheme.mean_velocity.is_none() || stays_finite(substep, velocity))
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
    state.time_secs += part.secs;
    if plan.between_bodies.is_some() {
        std::mem::swap(&mut state.presses, &mut workspace.contact.bodies.presses);
    }
    if plan.on_mesh.is_some() {
        std::mem::swap(&mut state.touches, &mut workspace.contact.samples.touches);
    }
}

/// Halves the velocities of each body until it gains no energy from nowhere; a body that does even then stands still.
fn slow<R: Real>(
    substep: Substep<'_, R>,
    velocity: &mut [R::Vec3],
    force: &[R::Vec3],
    (contacts, between_bodies, on_mesh): (&[ContactRecord<R>], &[BodyContact], &[SampleContact]),
    exact: &mut ExactLinks,
    stops: &dyn Fn() -> bool,
) {
    let Substep { model, state, dt, .. } = substep;
    for (number, body) in model.bodies.iter().enumerate() {
        let own = body.particles.clone();
        for halvings_left in (0..MAX_VELOCITY_HALVINGS).rev() {
            let is_finite =
                own.clone().all(|p| velocity[p].is_finite() && (state.position[p] + velocity[p] * dt).is_finite());
            let end = SubstepEnd { velocity, moving: velocity, force, contacts, between_bodies, on_mesh };
            if is_finite && !body_gains_energy(substep, number, end, exact, stops) {
                break;
            }
            for velocity in &mut velocity[own.clone()] {
                *velocity = if halvings_left == 0 || !is_finite { R::Vec3::ZERO } else { *velocity * R::from_f64(0.5) };
            }
        }
    }
}

/// Writes the velocities at the end of a substep from the predicted ones, and the mean velocities of schemes that move
/// particles by these. Returns false where the stabilised scheme would take a long substep for a body at rest although its
/// links become many times as long in it.
fn predicted_velocities<R: Real>(
    substep: Substep<'_, R>,
    prediction: Prediction,
    workspace: &mut StepWorkspace<R>,
    recorder: &mut Recorder<'_>,
) -> bool {
    predict(substep, prediction, workspace);
    meet_bodies(substep, workspace, recorder);
    meet_obstacles(substep, workspace, recorder);
    if substep.scheme == Scheme::Stabilised && !pass_contacts_to_stages(substep, workspace) {
        return false;
    }
    refine(substep, workspace, recorder);
    if schemes::moves_by_mean(substep.scheme) && has_implicit_contact(substep.plan) {
        correct_paths(substep, workspace, recorder);
    }
    true
}

/// Writes the velocities that forces and a hand predict.
fn predict<R: Real>(substep: Substep<'_, R>, prediction: Prediction, workspace: &mut StepWorkspace<R>) {
    let (mut stepper, _, velocity) = workspace.stepper(substep);
    if prediction == Prediction::Missing {
        stepper.predict(velocity);
    }
    if let Some(grab) = substep.grab {
        pull::apply_pull(substep, grab, velocity);
    }
}

/// Changes the predicted velocities by contact of bodies with each other and themselves.
fn meet_bodies<R: Real>(substep: Substep<'_, R>, workspace: &mut StepWorkspace<R>, recorder: &mut Recorder<'_>) {
    let StepWorkspace { velocity, contact, modal, .. } = workspace;
    if !substep.bodies_are_near {
        contact::bodies::skip_contact(substep, &mut contact.bodies, recorder);
        return;
    }
    recorder.begin_bodies();
    let Substep { model, plan, state, obstacles, modal_grab: grab, .. } = substep;
    let inputs = modes::Inputs { model, plan, obstacles, grab, secs: substep.dt.to_f64() };
    let mut modal = modes::ModalBodiesInContact::begin(inputs, state, modal, recorder);
    contact::bodies::meet(substep, velocity, &mut modal, &mut contact.bodies, recorder);
    recorder.end_bodies();
    recorder.enter(Stage::Integrate);
}

/// Changes the predicted velocities by contact with obstacles.
fn meet_obstacles<R: Real>(substep: Substep<'_, R>, workspace: &mut StepWorkspace<R>, recorder: &mut Recorder<'_>) {
    let StepWorkspace { velocity, contact, .. } = workspace;
    if has_implicit_contact(substep.plan) {
        if substep.plan.on_mesh.is_some() {
            contact::samples::meet(substep, velocity, &mut contact.samples, recorder);
        }
        contact::respond(substep, velocity, contact, recorder);
        recorder.enter(Stage::Integrate);
        contact::samples::count_parting_work(substep, velocity, &contact.samples, recorder);
    }
    if substep.bodies_are_near {
        contact::bodies::count_parting_work(substep, velocity, &contact.bodies, recorder);
    }
}

/// Hands the contacts found over to the stages of the stabilised scheme. Returns false where a body that is not strained
/// would be torn apart.
fn pass_contacts_to_stages<R: Real>(substep: Substep<'_, R>, workspace: &mut StepWorkspace<R>) -> bool {
    let Substep { model, plan, state, dt, is_strained, .. } = substep;
    let (stepper, contact, velocity) = workspace.stepper(substep);
    let motion = StraightMotion { position: &state.position, velocity, secs: dt };
    if plan.parts > 1 && !is_strained && strain::would_tear_bodies(model, plan, &state.bodies, motion, stepper.forces) {
        return false;
    }
    contact.list_held_particles(substep, stepper.force, velocity, &mut stepper.workspace.stages.held);
    true
}

/// Finds the velocities at the end and the mean velocities, with more forces on the way where the scheme has stages.
fn refine<R: Real>(substep: Substep<'_, R>, workspace: &mut StepWorkspace<R>, recorder: &mut Recorder<'_>) {
    let (mut stepper, _, velocity) = workspace.stepper(substep);
    stepper.refine(velocity, recorder);
    if !schemes::moves_by_mean(substep.scheme) {
        // The part is taken by another scheme than the plan's.
        if let Some(mean_velocity) = &mut workspace.scheme.mean_velocity {
            mean_velocity.copy_from_slice(&workspace.velocity);
        }
    }
}

/// Changes mean velocities that lead into obstacles.
fn correct_paths<R: Real>(substep: Substep<'_, R>, workspace: &mut StepWorkspace<R>, recorder: &mut Recorder<'_>) {
    let Some(mean_velocity) = &mut workspace.scheme.mean_velocity else { return };
    if substep.scheme == Scheme::Stabilised {
        let held = &mut workspace.scheme.stages.held;
        contact::limit_depths(substep, held, mean_velocity, &mut workspace.velocity);
    }
    contact::respond_to_paths(substep, &mut workspace.velocity, mean_velocity, &mut workspace.contact, recorder);
    if substep.scheme == Scheme::Stabilised {
        let SchemeWorkspace { stages, velocity: left, .. } = &workspace.scheme;
        workspace.contact.record_forces(substep, &stages.held, [left, &workspace.velocity]);
    }
    recorder.enter(Stage::Integrate);
}

/// Writes the velocities at the end of a substep as the implicit scheme solves for them.
fn solved_velocities<R: Real>(substep: Substep<'_, R>, workspace: &mut StepWorkspace<R>, recorder: &mut Recorder<'_>) {
    let (mut stepper, contact, velocity) = workspace.stepper(substep);
    let meets_obstacles = has_implicit_contact(substep.plan);
    let meets_on_mesh = meets_obstacles && substep.plan.on_mesh.is_some();
    contact.begin_equations();
    contact.samples.keep_sleeping_contacts(substep.state);
    contact.samples.forget_found();
    if meets_obstacles || substep.bodies_are_near {
        stepper.fall(velocity);
    }
    if substep.bodies_are_near {
        recorder.begin_bodies();
        contact::bodies::find_constraints(substep, velocity, &mut contact.bodies, &mut contact.equations, recorder);
        recorder.end_bodies();
    } else {
        contact::bodies::skip_contact(substep, &mut contact.bodies, recorder);
    }
    if meets_obstacles {
        contact::find_constraints(substep, velocity, contact, recorder);
    }
    // Where solutions lead more points of meshes into obstacles, the equations are solved again with these.
    for round in 0..=contact::samples::MAX_SEARCH_REPEATS {
        let ContactWorkspace { samples, equations, .. } = &mut *contact;
        let has_more =
            meets_on_mesh && contact::samples::find_constraints(substep, velocity, samples, equations, recorder);
        if round > 0 && !has_more {
            break;
        }
        recorder.enter(Stage::Integrate);
        stepper.solve(contact, velocity, recorder);
        if recorder.has_stopped() {
            return;
        }
    }
    if meets_obstacles {
        contact::finish_constraints(substep, velocity, contact, recorder);
    }
    let ContactWorkspace { bodies, samples, equations, .. } = &mut *contact;
    if meets_on_mesh {
        contact::samples::finish_constraints(substep, velocity, samples, equations, recorder);
        contact::samples::count_parting_work(substep, velocity, samples, recorder);
    }
    if substep.bodies_are_near {
        contact::bodies::finish_constraints(substep, velocity, bodies, equations, recorder);
        contact::bodies::count_parting_work(substep, velocity, bodies, recorder);
    }
    recorder.enter(Stage::Integrate);
    if let Some(moving) = &mut workspace.scheme.mean_velocity {
        arcs::write(substep.model, substep.state, substep.dt.to_f64(), &workspace.velocity, moving);
    }
}

/// Whether there is contact, by any rule but that of the thesis.
fn has_implicit_contact(plan: &Plan) -> bool {
    plan.contact && plan.contact_rule == ContactRule::Implicit
}

/// Whether velocities lead all particles that are awake to finite places.
fn stays_finite<R: Real>(Substep { model, plan, state, dt, .. }: Substep<'_, R>, velocity: &[R::Vec3]) -> bool {
    sleep::awake(model, &state.bodies).all(|body| {
        let own = body.particles.clone();
        kernels::are_finite(plan.simd, &state.position[own.clone()], &velocity[own], dt)
    })
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
