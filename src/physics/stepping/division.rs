//! The division of a substep into parts: how many contact and strain ask for, and which comes next.

use super::contact_need::ContactNeed;
use super::halves::SUBSTEP_LENGTH;
use super::strain::{self, StrainPolicy};
use crate::math::Real;
use crate::physics::contact::Placed;
use crate::physics::forces::strain::StraightMotion;
use crate::physics::limits::any_state::MAX_PARTS;
use crate::physics::model::plan::Plan;
use crate::physics::model::{Model, Scheme};
use crate::physics::report::Counters;
use crate::physics::state::{State, WORK_SPENT};
use crate::physics::step::StepWorkspace;
use crate::physics::step::substep::{OnEnergyGain, Part};

/// The division of a substep into equal parts, for strain and contact. Halves of these are in the state.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is a fact about the substep, and any mixture may be")]
pub(super) struct Division {
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
}

impl Division {
    /// The division of the coming substep, in which obstacles are there and a hand pulls or not.
    pub(super) fn of<R: Real>(
        model: &Model<R>,
        plan: &Plan,
        state: &mut State<R>,
        (obstacles, hand_pulls): (&Placed<R>, bool),
        workspace: &mut StepWorkspace<R>,
    ) -> Self {
        let StepWorkspace { contact, forces, speeds, .. } = workspace;
        speeds.forget();
        if plan.parts > 0 || plan.contact_plan().is_some() {
            speeds.measure(model, plan, state);
        }
        let need = ContactNeed::of(model, plan, state, (obstacles, hand_pulls), speeds, &mut contact.bodies);
        let scheme = |need: ContactNeed| need.plan.map_or(plan.scheme, |contact_plan| contact_plan.scheme);
        let strained_parts = need
            .plan
            .filter(|_| plan.is_divided())
            .map_or([1, plan.parts], |contact_plan| [contact_plan.parts, contact_plan.strained_parts]);
        let strain_policy = StrainPolicy::new(scheme(need), strained_parts, plan);
        let by_strain = strain::parts_before_substep(model, plan, strain_policy, &speeds.relative, state, forces);
        let need = need.with_parts(by_strain);
        state.halvings = state.halvings.max(need.halvings());
        let (parts, scheme) = (need.parts, scheme(need));
        Self {
            parts,
            left: parts,
            secs: plan.substep_secs() / f64::from(parts),
            strain_policy,
            secs_since_check: 0.0,
            scheme,
            bodies_are_near: need.bodies_are_near,
            points_are_near: need.points_are_near,
            is_for_contact: parts > 1 && need.plan.is_some(),
            is_explicit: false,
        }
    }

    /// The first part, before any is halved, in whose division contact counts.
    pub(super) fn first_part(&self, plan: &Plan) -> Part {
        Part {
            secs: self.secs,
            scheme: self.scheme,
            is_strained: self.parts > 1,
            bodies_are_near: self.bodies_are_near,
            points_are_near: self.points_are_near,
            ..Part::whole_substep(plan)
        }
    }

    /// The part that comes next; none where all are taken.
    pub(super) fn next<R: Real>(&mut self, plan: &Plan, state: &mut State<R>, counters: &mut Counters) -> Option<Part> {
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
        let is_checked = plan.halvings > 0 && !self.is_explicit && self.scheme == Scheme::Implicit;
        let can_be_refused = state.halvings < plan.halvings || plan.ends_explicitly;
        let on_energy_gain = match () {
            () if is_checked && state.work == WORK_SPENT => OnEnergyGain::Slow,
            () if is_checked && can_be_refused => OnEnergyGain::Refuse,
            () => OnEnergyGain::Take,
        };
        Some(Part {
            secs: self.secs * (length as f64 / SUBSTEP_LENGTH as f64),
            scheme: if self.is_explicit { Scheme::SemiImplicit } else { self.scheme },
            is_strained: self.parts > 1,
            bodies_are_near: self.bodies_are_near,
            points_are_near: self.points_are_near,
            on_energy_gain,
            is_last: self.left == 1 && state.part + length == SUBSTEP_LENGTH,
        })
    }

    /// Counts a part as taken.
    pub(super) fn take(&mut self, counters: &mut Counters) {
        counters.contact_parts += u64::from(self.is_for_contact);
        (self.left, self.is_explicit) = (self.left - 1, false);
    }

    /// Divides what is left into shorter parts where bodies come near each other and one of them has become strained since the
    /// substep began.
    pub(super) fn divide_further<R: Real>(
        &mut self,
        model: &Model<R>,
        plan: &Plan,
        state: &mut State<R>,
        workspace: &mut StepWorkspace<R>,
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
            (&mut workspace.speeds, &mut workspace.forces),
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
    pub(super) fn divide_torn<R: Real>(
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
    }

    /// Halves a part that was refused, or leaves it to the explicit scheme.
    pub(super) fn divide_refused<R: Real>(&mut self, plan: &Plan, state: &mut State<R>, counters: &mut Counters) {
        if state.halvings < plan.halvings {
            state.halvings += 1;
            counters.halved += 1;
        } else {
            self.is_explicit = true;
        }
    }
}
