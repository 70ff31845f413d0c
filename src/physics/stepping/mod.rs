//! Divides time: decides how long a part of a substep is and which scheme takes it, and has it taken.
//!
//! ```text
//! step       one dt
//! span       one or several steps: `Plan::substeps` substeps, as many as the scheme's stability limit at rest asks for
//! substep    whole, or in equal parts: up to `Plan::parts` while links are strained (strain); as many as a scheme with a
//!            place for the contact needs while bodies come near each other or themselves (`Plan::between_bodies`) or
//!            points of a body's mesh come near an obstacle (`Plan::on_mesh`), or any body with the schemes of Runge and
//!            Kutta (`Plan::at_obstacles`); and in parts where the stabilised scheme
//!            finds that contact tears bodies apart in the whole. The implicit scheme takes those in which bodies come near
//!            each other itself, in halves short enough that none travels past another, where that is cheaper
//! part       the implicit scheme may refuse it, where its linear equations would give energy from nowhere: it is then
//!            halved, down to a length that an explicit scheme can take, and left to that scheme where even this is refused
//! work       past `Plan::most_work` nothing is halved any more: parts are as long as the grid of halves allows, and
//!            bodies that would gain energy are slowed
//! ```
//!
//! Modal bodies move after the particles of each part.
//!
//! The division under way is in the state, so that a state saved in the middle of a divided step goes on bit for bit.

pub(in crate::physics) mod checks;
pub(in crate::physics) mod strain;
#[cfg(test)]
mod strain_tests;

use super::contact::{ContactWorkspace, Placed, arrive, bodies, near, samples, sweep};
use super::forces::ForceWorkspace;
use super::forces::strain::StraightMotion;
use super::interaction::Grab;
use super::limits::any_state::MAX_PARTS;
use super::model::plan::{MOST_HALVINGS, Plan};
use super::model::{Model, Scheme};
use super::modes;
use super::report::{Counters, Recorder, StageTimer, StepReport};
use super::state::{State, Strain, WORK_SPENT, sleep};
use super::step::precision::substep;
use super::step::substep::{OnEnergyGain, Part};
use super::step::{Ending, Inputs, StepWorkspace};
use crate::math::Real;
use strain::StrainPolicy;

/// Advances by a substep, in the parts that it is divided into; with the implicit scheme by one part, for which its linear
/// equations hold.
pub(super) fn advance<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    state: &mut State<R>,
    workspace: &mut StepWorkspace<R>,
    obstacles: &mut Placed<R>,
    grab: Option<&Grab<R>>,
    timer: &mut dyn StageTimer,
) -> StepReport {
    let mut recorder = Recorder::new(timer);
    workspace.contact.bodies.pushed_pairs.clear();
    workspace.contact.bodies.store_self_proximity(state);
    if plan.on_mesh.is_some() || plan.at_obstacles.is_some() {
        obstacles.place(model, state, plan.substep_secs());
    }
    let hand_pulls = grab.is_some_and(|grab| !state.bodies[grab.body].asleep);
    let mut division = Division::of(model, plan, state, (obstacles, hand_pulls), workspace);
    let mut ending = Ending::Taken;
    while let Some(part) = division.next(plan, state, &mut recorder.counters) {
        obstacles.place(model, state, part.secs);
        let work_before = recorder.counters.implicit_work();
        workspace.modal.discard_substep();
        let inputs = Inputs {
            obstacles,
            grab: grab.filter(|grab| !state.bodies[grab.body].asleep),
            modal_grab: grab.filter(|grab| state.bodies[grab.body].is_modal),
        };
        ending = substep(model, plan, part, inputs, state, workspace, &mut recorder);
        if ending == Ending::Stopped {
            workspace.contact.bodies.restore_self_proximity(state);
            division.forget_tears(state);
            break;
        }
        state.work = state.work.saturating_add(recorder.counters.implicit_work() - work_before);
        if ending == Ending::Refused {
            match part.scheme {
                Scheme::Implicit => division.divide_refused(plan, state, &mut recorder.counters),
                _ => division.divide_torn(model, plan, state, workspace),
            }
            continue;
        }
        if ending == Ending::Diverged {
            break;
        }
        if !advance_modal(model, plan, part, inputs, state, workspace, &mut recorder) {
            ending = Ending::Diverged;
            break;
        }
        arrive::advance(model, &workspace.contact, part.secs, state);
        sweep::advance(model, part.secs, state);
        division.take(&mut recorder.counters);
        division.divide_further(model, plan, state, &mut workspace.forces);
    }
    recorder.leave(ending == Ending::Diverged)
}

/// Moves modal bodies over a part. Returns whether all numbers are finite.
fn advance_modal<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    part: Part,
    Inputs { obstacles, modal_grab, .. }: Inputs<'_, R>,
    state: &mut State<R>,
    workspace: &mut StepWorkspace<R>,
    recorder: &mut Recorder<'_>,
) -> bool {
    if model.bodies.iter().all(|body| body.modal.is_none()) {
        return true;
    }
    let StepWorkspace { modal, contact, .. } = workspace;
    let min_still_substeps = sleep::min_still_substeps(plan);
    let waits = |state: &State<R>, body| {
        sleep::must_wait_for_others(body, contact.bodies.pushing_pairs(), &state.bodies, min_still_substeps)
    };
    let inputs = modes::Inputs { model, plan, obstacles, grab: modal_grab, secs: part.secs };
    let report = modes::advance(inputs, part.is_last, waits, state, modal, recorder);
    recorder.last.contacts += report.contacts;
    recorder.note_depth(report.max_depth_m.max(recorder.last.max_penetration_m));
    report.is_finite
}

/// A whole substep in one part that is never refused, by a scheme that has a place for all contact in it.
pub(in crate::physics) fn whole_substep(plan: &Plan) -> Part {
    Part {
        secs: plan.substep_secs(),
        scheme: plan.contact_plan().map_or(plan.scheme, |contact_plan| contact_plan.scheme),
        is_strained: false,
        bodies_are_near: plan.between_bodies.is_some(),
        points_are_near: plan.on_mesh.is_some(),
        on_energy_gain: OnEnergyGain::Take,
        is_last: true,
    }
}

/// The first of the parts that the coming substep is divided into, before any is halved; it is never refused.
pub(in crate::physics) fn first_part<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    state: &mut State<R>,
    workspace: &mut StepWorkspace<R>,
) -> Part {
    let obstacles = Placed::now(model, state);
    let Division { parts, secs, scheme, bodies_are_near, points_are_near, .. } =
        Division::of(model, plan, state, (&obstacles, false), workspace);
    Part { secs, scheme, is_strained: parts > 1, bodies_are_near, points_are_near, ..whole_substep(plan) }
}

/// The division of a substep into equal parts, for strain and contact. Halves of these are in the state.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is a fact about the substep, and any mixture may be")]
struct Division {
    parts: u32,
    left: u32,
    /// The length of each part, s.
    secs: f64,
    /// The parts while a body is strained; strain is looked out for between parts where these are more.
    strain_policy: StrainPolicy,
    /// How long ago links were checked, s.
    secs_since_check: f64,
    /// The scheme that takes the parts.
    scheme: Scheme,
    /// Whether bodies come near each other.
    bodies_are_near: bool,
    /// Whether points of a mesh come near an obstacle, or an obstacle's edges near a body.
    points_are_near: bool,
    /// Whether it is divided because of that.
    is_for_contact: bool,
    /// Whether the smallest part was refused, so that the explicit scheme takes it.
    is_explicit: bool,
    /// Whether the whole substep was refused, as bodies would be torn apart in it.
    tears: bool,
}

impl Division {
    /// The division of the coming substep, in which obstacles are there and a hand pulls or not.
    fn of<R: Real>(
        model: &Model<R>,
        plan: &Plan,
        state: &mut State<R>,
        (obstacles, hand_pulls): (&Placed<R>, bool),
        workspace: &mut StepWorkspace<R>,
    ) -> Self {
        let StepWorkspace { contact: ContactWorkspace { bodies: of_bodies, .. }, forces, .. } = workspace;
        let needs_speeds = plan.parts > 0 || plan.contact_plan().is_some();
        of_bodies.velocity_bounds.clear();
        let bodies = model.bodies.iter().filter(|_| needs_speeds);
        of_bodies.velocity_bounds.extend(bodies.map(|body| checks::velocity_bounds(body, plan, state)));
        of_bodies.relative_speeds.clear();
        of_bodies.relative_speeds.extend(of_bodies.velocity_bounds.iter().map(checks::max_relative_speed_in));
        let secs = plan.substep_secs();
        let by_travel = bodies::parts(model, plan, secs, state, of_bodies);
        let bodies_are_near = by_travel.is_some();
        let velocity_bounds = &of_bodies.velocity_bounds;
        let on_mesh =
            plan.on_mesh.filter(|_| samples::comes_near((model, plan, obstacles), state, velocity_bounds, secs));
        let points_are_near = on_mesh.is_some();
        // The scheme for contact of meshes with obstacles has a place for contact between bodies, too.
        let contact_plan =
            on_mesh.or(plan.between_bodies.filter(|_| bodies_are_near)).or(plan.at_obstacles.filter(|_| {
                hand_pulls || near::comes_near_obstacle((model, plan, obstacles), state, velocity_bounds, secs)
            }));
        let contact_parts = contact_plan.map(|contact_plan| contact_plan.parts.max(by_travel.unwrap_or(1)));
        let halvings = by_travel.unwrap_or(1).next_power_of_two().trailing_zeros();
        let solve_cost =
            contact_plan.and_then(|plan| plan.parts_a_solve).map(|a_solve| a_solve * f64::from(1 << halvings));
        let is_solved_for = solve_cost.zip(contact_parts).is_some_and(|(cost, parts)| cost < f64::from(parts));
        if is_solved_for {
            state.halvings = state.halvings.max(halvings);
        }
        let (contact_plan, contact_parts) = if is_solved_for { (None, None) } else { (contact_plan, contact_parts) };
        let scheme = contact_plan.map_or(plan.scheme, |contact_plan| contact_plan.scheme);
        let strained_parts = contact_plan
            .filter(|_| plan.is_divided())
            .map_or([1, plan.parts], |contact_plan| [contact_plan.parts, contact_plan.strained_parts]);
        let strain_policy = StrainPolicy::new(scheme, strained_parts, plan);
        let parts = strain::parts_before_substep(model, plan, strain_policy, &of_bodies.relative_speeds, state, forces);
        let parts = parts.max(contact_parts.unwrap_or(1));
        Self {
            parts,
            left: parts,
            secs: secs / f64::from(parts),
            strain_policy,
            secs_since_check: 0.0,
            scheme,
            bodies_are_near,
            points_are_near,
            is_for_contact: parts > 1 && contact_parts.is_some(),
            is_explicit: false,
            tears: false,
        }
    }

    /// The part that comes next; none where all are taken.
    fn next<R: Real>(&mut self, plan: &Plan, state: &mut State<R>, counters: &mut Counters) -> Option<Part> {
        if self.left == 0 {
            return None;
        }
        if state.work >= plan.most_work {
            counters.slowed += u64::from(state.work != WORK_SPENT);
            state.work = WORK_SPENT;
            state.coarsen();
            // The part may be too long for the explicit scheme again.
            self.is_explicit = false;
        }
        let length = state.next_length();
        let substep_length = 1_u64 << MOST_HALVINGS;
        let is_checked = plan.halvings > 0 && !self.is_explicit && self.scheme == Scheme::Implicit;
        let can_be_refused = state.halvings < plan.halvings || plan.ends_explicitly;
        let on_energy_gain = match () {
            () if is_checked && state.work == WORK_SPENT => OnEnergyGain::Slow,
            () if is_checked && can_be_refused => OnEnergyGain::Refuse,
            () => OnEnergyGain::Take,
        };
        Some(Part {
            secs: self.secs * (length as f64 / substep_length as f64),
            scheme: if self.is_explicit { Scheme::SemiImplicit } else { self.scheme },
            is_strained: self.parts > 1,
            bodies_are_near: self.bodies_are_near,
            points_are_near: self.points_are_near,
            on_energy_gain,
            is_last: self.left == 1 && state.part + length == substep_length,
        })
    }

    /// Counts a part as taken.
    fn take(&mut self, counters: &mut Counters) {
        counters.contact_parts += u64::from(self.is_for_contact);
        (self.left, self.is_explicit) = (self.left - 1, false);
    }

    /// Divides what is left into shorter parts where bodies come near each other and one of them has become strained since the
    /// substep began.
    fn divide_further<R: Real>(
        &mut self,
        model: &Model<R>,
        plan: &Plan,
        state: &mut State<R>,
        forces: &mut ForceWorkspace<R>,
    ) {
        if !(self.bodies_are_near || self.points_are_near)
            || self.left == 0
            || self.parts >= self.strain_policy.strained_parts
        {
            return;
        }
        self.secs_since_check += self.secs;
        let now = strain::parts_within_substep(
            model,
            plan,
            state,
            self.strain_policy,
            &mut self.secs_since_check,
            self.secs,
            forces,
        );
        if let Some(strained_parts) = now.filter(|&now| now > self.parts) {
            let left = (u64::from(self.left) * u64::from(strained_parts)).div_ceil(u64::from(self.parts));
            let left = u32::try_from(left).unwrap_or(u32::MAX);
            self.secs *= f64::from(self.left) / f64::from(left);
            (self.parts, self.left) = (strained_parts.max(left + 1), left);
        }
    }

    /// Divides a substep that was refused as the velocities found would tear bodies apart; these bodies are strained from
    /// now on.
    fn divide_torn<R: Real>(
        &mut self,
        model: &Model<R>,
        plan: &Plan,
        state: &mut State<R>,
        workspace: &mut StepWorkspace<R>,
    ) {
        let StepWorkspace { velocity, forces, .. } = workspace;
        let motion = StraightMotion { position: &state.position, velocity, secs: R::from_f64(self.secs) };
        let check = strain::Check::BeforeSubstep(&|_| true);
        let parts_by_displacement = strain::check_strain(model, plan, check, motion, &mut state.bodies, forces);
        let parts = self.strain_policy.strained_parts.max(parts_by_displacement.min(MAX_PARTS));
        (self.parts, self.left, self.secs) = (parts, parts, self.secs / f64::from(parts));
        self.tears = true;
    }

    /// Forgets that bodies would be torn apart where no part of the substep was taken: it is found again.
    fn forget_tears<R: Real>(&self, state: &mut State<R>) {
        if self.tears && self.left == self.parts {
            state.bodies.iter_mut().filter(|memory| !memory.asleep).for_each(|memory| memory.strain = Strain::Small);
        }
    }

    /// Halves a part that was refused, or leaves it to the explicit scheme.
    fn divide_refused<R: Real>(&mut self, plan: &Plan, state: &mut State<R>, counters: &mut Counters) {
        if state.halvings < plan.halvings {
            state.halvings += 1;
            counters.halved += 1;
        } else {
            self.is_explicit = true;
        }
    }
}

impl<R: Real> State<R> {
    /// The length of the part that comes next, in units of 2^−[`MOST_HALVINGS`] of the substep.
    fn next_length(&self) -> u64 {
        1 << (MOST_HALVINGS - self.halvings)
    }

    /// Counts the next part as done and makes the one after it longer where the grid of halves allows. Returns whether the
    /// substep is done.
    pub(super) fn end_part(&mut self) -> bool {
        let length = self.next_length();
        self.part += length;
        if self.halvings > 0 && self.part.is_multiple_of(2 * length) {
            self.halvings -= 1;
        }
        let ends = self.part == 1 << MOST_HALVINGS;
        if ends {
            (self.part, self.halvings, self.work) = (0, 0, 0);
        }
        ends
    }

    /// Lets the next part be as long as the grid of halves allows.
    fn coarsen(&mut self) {
        self.halvings = if self.part == 0 { 0 } else { MOST_HALVINGS.saturating_sub(self.part.trailing_zeros()) };
    }
}
