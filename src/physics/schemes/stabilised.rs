//! The stabilised scheme: Runge–Kutta–Chebyshev of second order, with the polynomials of [`super::chebyshev`].
//!
//! Damping limits the substeps of an explicit scheme long before stiffness does. With s stages a substep is stable up to
//! about 0.65 s² over the rate of damping: it can be longer by more than it costs more.
//!
//! # Contact
//!
//! A particle must not fall freely through a long substep and hit what it rests on only at its end: its links would drag its
//! neighbours along. So contact is found first, as with the other schemes, but for a particle that is heavier by the
//! resistance of its links within the substep, taken implicitly for it alone
//! ([`crate::physics::step::substep::Substep::inertia`]). The spring of the contact then pushes at every stage, which bounds
//! the substep as links do. If friction holds, the particle is held across the normal, and along it too if it is at the
//! limit of its depth; if it slides, friction brakes it. What contact takes from the forces is summed over the stages with
//! their weights: that is the contact force.

use std::ops::Range;

use super::chebyshev::{StageWeights, Stages};
use super::held::{AtStage, StageWorkspace};
use super::stepper::{SchemeWorkspace, Stepper};
use crate::math::{Real, Vector};
use crate::physics::forces;
use crate::physics::forces::links::Configuration;
use crate::physics::forces::particles::zero_pinned;
use crate::physics::kernels::{self, SimdLevel, StageSources, StageTerms};
use crate::physics::model::{BodyModel, Values, plan};
use crate::physics::report::Recorder;
use crate::physics::state::sleep::awake;
use crate::physics::step::pull;
use crate::physics::team;

/// Writes the velocities that contact and the hand start from, m/s: every particle moves as if alone, with the resistance of
/// its links as inertia.
pub(super) fn predict<R: Real>(stepper: &mut Stepper<'_, R>, velocity: &mut [R::Vec3]) {
    let substep = stepper.substep;
    let predicted = &mut stepper.workspace.predicted;
    for (number, body) in substep.model.bodies.iter().enumerate() {
        let own = body.particles.clone();
        let (now, force) = (&substep.state.velocity[own.clone()], &stepper.force[own.clone()]);
        let (velocity, predicted) = (&mut velocity[own.clone()], &mut predicted[own]);
        if substep.state.bodies[number].asleep {
            velocity.copy_from_slice(now);
            predicted.copy_from_slice(now);
            continue;
        }
        team::by_part(substep.plan.threads, [velocity, predicted], |part, [velocity, predicted]| {
            let force = &force[part.clone()];
            velocity.copy_from_slice(&now[part.clone()]);
            if let Values::Uniform(_) = body.masses {
                kernels::kick(substep.plan.simd, substep.dt / substep.inertia(number, 0), force, velocity);
            } else {
                for (local, (velocity, force)) in part.clone().zip(velocity.iter_mut().zip(force)) {
                    *velocity += *force * (substep.dt / substep.inertia(number, local));
                }
            }
            zero_pinned(body, part, velocity);
            predicted.copy_from_slice(velocity);
        });
    }
}

/// Goes through as many stages as the substep needs, the first of them the state itself. Writes the mean velocities that
/// move particles, the velocities at the end, and what contact took from held particles.
pub(super) fn refine<R: Real>(stepper: &mut Stepper<'_, R>, velocity: &mut [R::Vec3], recorder: &mut Recorder<'_>) {
    let count = stepper.substep.stages();
    let (ahead, mut stages) = Stages::new(count);
    if !begin(stepper, recorder) {
        return;
    }
    advance_stage(stepper, StageWeights { last: 0.0, before: 0.0, slope: ahead, first: 0.0 });
    // The share of the substep that is over at the last two stages.
    let (mut share_before, mut share) = (0.0, ahead);
    for _ in 1..count {
        let SchemeWorkspace { position, velocity, force, .. } = &mut *stepper.workspace;
        let at = Configuration { position, velocity, residual: None };
        forces::evaluate(stepper.substep, at, force, None, stepper.forces, recorder);
        recorder.enter(plan::Stage::Integrate);
        if recorder.stops() {
            return;
        }
        add_constant(stepper);
        subtract_contact_forces(stepper, R::from_f64(share) * stepper.substep.dt);
        let stage = stages.next();
        (share_before, share) = (share, stage.next(share_before, share, 1.0, 1.0));
        advance_stage(stepper, stage);
    }
    let SchemeWorkspace { mean_velocity, velocity: end, stages, .. } = &mut *stepper.workspace;
    let Some(mean_velocity) = mean_velocity else { return };
    let (over_dt, moved) = (R::ONE / stepper.substep.dt, &stages.moved[1]);
    team::by_part(stepper.substep.plan.threads, [velocity, mean_velocity], |part, [velocity, mean_velocity]| {
        velocity.copy_from_slice(&end[part.clone()]);
        for (mean_velocity, moved) in mean_velocity.iter_mut().zip(&moved[part]) {
            *mean_velocity = *moved * over_dt;
        }
    });
}

/// Makes the first stage: the state, except that held particles have the velocity they are held at, with the forces at these
/// velocities. Returns false if the substep is given up.
fn begin<R: Real>(stepper: &mut Stepper<'_, R>, recorder: &mut Recorder<'_>) -> bool {
    let SchemeWorkspace { stages, velocity, force, .. } = &mut *stepper.workspace;
    let StageWorkspace {
        held, start_velocity, moved: [moved_before, moved], changed: [changed_before, changed], ..
    } = stages;
    let (state, known, threads) = (stepper.substep.state, stepper.force, stepper.substep.plan.threads);
    let to = [&mut start_velocity[..], velocity, force, moved_before, moved, changed_before, changed];
    team::by_part(threads, to, |part, [start_velocity, velocity, force, stages @ ..]: [&mut [R::Vec3]; 7]| {
        start_velocity.copy_from_slice(&state.velocity[part.clone()]);
        velocity.copy_from_slice(start_velocity);
        force.copy_from_slice(&known[part]);
        for stage in stages {
            stage.fill(R::Vec3::ZERO);
        }
    });
    let mut is_changed = false;
    for held in &mut *held {
        let start_velocity = &mut start_velocity[held.particle];
        held.begin(start_velocity);
        is_changed |= *start_velocity != state.velocity[held.particle];
        velocity[held.particle] = *start_velocity;
    }
    if is_changed {
        // Forces at the old velocity would drive the neighbours as if the particle still had it.
        let at = Configuration { position: &state.position, velocity, residual: None };
        forces::evaluate(stepper.substep, at, force, None, stepper.forces, recorder);
        recorder.enter(plan::Stage::Integrate);
        if recorder.stops() {
            return false;
        }
        add_constant(stepper);
    } else {
        add_pull(stepper);
    }
    subtract_contact_forces(stepper, R::ZERO);
    let SchemeWorkspace { stages: StageWorkspace { held, first_force, .. }, force, .. } = &mut *stepper.workspace;
    for held in held {
        held.contact_forces[0] = held.contact_forces[1];
    }
    team::by_part(threads, [&mut first_force[..]], |part, [first_force]| first_force.copy_from_slice(&force[part]));
    true
}

/// Adds to the forces at a stage those that are constant over the substep: the thesis's contact and the hand's pull.
fn add_constant<R: Real>(stepper: &mut Stepper<'_, R>) {
    for (force, held) in stepper.workspace.force.iter_mut().zip(stepper.thesis_force.into_iter().flatten()) {
        *force += *held;
    }
    add_pull(stepper);
}

/// Adds the pull of a hand, evaluated at the predicted velocities.
fn add_pull<R: Real>(stepper: &mut Stepper<'_, R>) {
    let Some(grab) = stepper.substep.grab else { return };
    let SchemeWorkspace { predicted, force, .. } = &mut *stepper.workspace;
    let impulse = pull::impulse(stepper.substep, grab, predicted);
    for &(particle, weight) in &grab.weights {
        force[particle] += impulse * (weight / stepper.substep.dt);
    }
}

/// Subtracts what contact takes from the forces at a stage, `secs` after the substep began.
fn subtract_contact_forces<R: Real>(stepper: &mut Stepper<'_, R>, secs: R) {
    let substep = stepper.substep;
    let SchemeWorkspace { stages: StageWorkspace { held, moved, .. }, velocity, force, .. } = &mut *stepper.workspace;
    for held in held {
        let (particle, Some(body)) = (held.particle, substep.model.body_of(held.particle)) else { continue };
        let force = &mut force[particle];
        let at = AtStage { secs, moved: moved[1][particle], velocity: velocity[particle], force: *force };
        held.contact_forces[1] = held.contact_force(&at, substep.dt, substep.braking_rate(body));
        *force -= held.contact_forces[1];
    }
}

/// Goes to the next stage.
fn advance_stage<R: Real>(stepper: &mut Stepper<'_, R>, stage: StageWeights) {
    let substep = stepper.substep;
    let SchemeWorkspace { stages, position, velocity, force, .. } = &mut *stepper.workspace;
    let StageWorkspace {
        held,
        start_velocity,
        first_force,
        moved: [moved_before, moved],
        changed: [changed_before, changed],
    } = stages;
    let [last, before] = [stage.last, stage.before].map(R::from_f64);
    let [slope, first_slope] = [stage.slope, stage.first].map(|of| R::from_f64(of) * substep.dt);
    let terms = StageTerms { last, before, slope, first: first_slope };
    for body in awake(substep.model, &substep.state.bodies) {
        let own = body.particles.clone();
        let sources = Sources {
            last: [&moved[own.clone()], &changed[own.clone()]],
            slopes: [&force[own.clone()], &first_force[own.clone()]],
            start: [&substep.state.position[own.clone()], &start_velocity[own.clone()]],
        };
        let to = [
            &mut moved_before[own.clone()],
            &mut changed_before[own.clone()],
            &mut position[own.clone()],
            &mut velocity[own],
        ];
        team::by_part(substep.plan.threads, to, |part, to| {
            next_stage(body, substep.plan.simd, terms, part.clone(), sources.of(part), to);
        });
    }
    for held in held {
        let [before, last] = held.contact_impulses;
        held.contact_impulses = [
            last,
            last * terms.last
                + before * terms.before
                + held.contact_forces[1] * terms.slope
                + held.contact_forces[0] * terms.first,
        ];
    }
    std::mem::swap(moved_before, moved);
    std::mem::swap(changed_before, changed);
}

/// The inputs of the next stage for consecutive particles of a body: each for positions and for velocities.
#[derive(Clone, Copy)]
struct Sources<'a, R: Real> {
    /// How far the last stage has gone from the state, ...
    last: [&'a [R::Vec3]; 2],
    /// ... the forces there and at the first stage, N, ...
    slopes: [&'a [R::Vec3]; 2],
    /// ... and the state.
    start: [&'a [R::Vec3]; 2],
}

impl<R: Real> Sources<'_, R> {
    /// Returns the inputs of a part of the particles.
    fn of(self, part: Range<usize>) -> Self {
        let Self { last, slopes, start } = self;
        let [last, slopes, start] = [last, slopes, start].map(|of| of.map(|of| &of[part.clone()]));
        Self { last, slopes, start }
    }
}

/// Writes the next stage of some particles of a body (local numbers). How far it has gone replaces how far the stage before
/// the last had, and where it is replaces where the last was.
fn next_stage<R: Real>(
    body: &BodyModel<R>,
    level: SimdLevel,
    terms: StageTerms<R>,
    local: Range<usize>,
    Sources { last, slopes: [force, first_force], start: [start_position, start_velocity] }: Sources<'_, R>,
    [moved, changed, position, velocity]: [&mut [R::Vec3]; 4],
) {
    let ways = StageSources { last: last[0], slope: &*velocity, first: start_velocity, start: start_position };
    kernels::next_stage(level, terms, R::ONE, ways, moved, position);
    let changes = StageSources { last: last[1], slope: force, first: first_force, start: start_velocity };
    match &body.masses {
        Values::Uniform(mass) => kernels::next_stage(level, terms, R::ONE / *mass, changes, changed, velocity),
        Values::Each(masses) => {
            kernels::next_stage_each(level, terms, &masses[local.clone()], changes, changed, velocity);
        }
    }
    if body.pinned != Values::Uniform(false) {
        for (at, _) in local.enumerate().filter(|(_, local)| body.is_pinned(*local)) {
            (position[at], velocity[at]) = (start_position[at], start_velocity[at]);
            (moved[at], changed[at]) = (R::Vec3::ZERO, R::Vec3::ZERO);
        }
    }
}
