//! Strained bodies: links far from their length make a body stiffer than it is at rest, so that steps that are safe at
//! rest give it energy.
//!
//! The stability limit at rest does not hold there. While any link is far longer or shorter than at rest, a substep is taken
//! in parts: as many as the directions of the links at the last check ask for, beside the push on crushed cells
//! ([`crate::physics::limits::present`]). Where links turn far within a substep, it is as many as are stable in any state
//! ([`crate::physics::limits::any_state`]), and also in a crushed body that is nearly still or whose families are far apart.
//! At rest that would cost three times as much for nothing.
//!
//! Each step length conserves an energy of its own, so a change of length adds or takes some. A body that swings across the
//! strain limit would change the length at the same place of every swing, and gain a little each time. So a body has to be
//! calm for a while before its substeps are whole again.

use crate::math::Real;
use crate::physics::forces::strain::{self, StraightMotion};
use crate::physics::forces::{ForceWorkspace, recovery};
use crate::physics::limits::LinkLoad;
use crate::physics::limits::any_state::MAX_PARTS;
use crate::physics::limits::present::{self, Sums};
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Model, Scheme};
use crate::physics::state::{BodyMemory, State, Strain};
use crate::physics::stepping::speeds::Speeds;
use crate::physics::stepping::{checks, speeds};
use crate::physics::team::{self, MIN_CONTACT_PARTICLES};

/// The strain of a body becomes large when any link, stretched or compressed, exceeds the larger of these, and stays so
/// until all links are below the smaller. Bodies that fall on the ground by their own weight stay below. Where the plan's
/// scheme bears less, a body counts as taut above smaller strains ([`Plan::strain_thresholds`]): the scheme of substeps in which it
/// meets others may bear more.
pub(crate) const STRAIN_THRESHOLDS: [f64; 2] = [0.5, 0.7];

/// How long all links have to be below the smaller strain until the body is calm, s, ...
const CALM_SECS: f64 = 0.25;

/// ... and for how many substeps at least.
const CALM_SUBSTEPS: u64 = 100;

/// From check to check the load of a strained body's links falls to no less than this share: it, too, sets the step length,
/// which must not change suddenly.
const LOAD_DECAY: f64 = 0.98;

/// How far the ends of a link in a strained body move relative to each other in a part at most, in its length: a link that
/// turns about or is turned inside out within a step is stiffer on the way than at either end. A cube of one undamped cell,
/// torn by a blow at 1000 m/s, gained 7 % in a second at a half, nothing at 0.35.
const MAX_LINK_DISPLACEMENT: f64 = 0.25;

/// Into how many parts substeps are divided while a body is strained.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct StrainPolicy {
    /// The parts while no body is strained.
    pub(in crate::physics) parts_at_rest: u32,
    /// The parts while a body is strained.
    pub(in crate::physics) strained_parts: u32,
    /// The scheme that takes the parts.
    pub(in crate::physics) scheme: Scheme,
    /// The least strain of a body that counts as strained here.
    pub(in crate::physics) min_strain: Strain,
}

impl StrainPolicy {
    /// The division into these numbers of parts, taken by a scheme.
    pub(in crate::physics) fn new(scheme: Scheme, [parts_at_rest, strained_parts]: [u32; 2], plan: &Plan) -> Self {
        Self {
            parts_at_rest,
            strained_parts,
            scheme,
            min_strain: if scheme == plan.scheme { Strain::Taut } else { Strain::Large },
        }
    }

    /// The parts that the bodies need as they are strained now; none where none is.
    fn needed_parts<R: Real>(self, model: &Model<R>, plan: &Plan, state: &State<R>) -> Option<u32> {
        let secs = plan.substep_secs() / f64::from(self.parts_at_rest);
        let of = |(body, memory): (&BodyModel<R>, &BodyMemory)| {
            let is_strained = memory.strain >= self.min_strain;
            // The push on cells near inversion is not a link force. The longer substeps of the stabilised scheme bear little
            // of it, even where links need no shorter ones.
            let is_crushed =
                (is_strained || self.scheme == Scheme::Stabilised) && recovery::pushes(body, memory, state);
            let is_known = self.scheme == Scheme::SemiImplicit && memory.load != LinkLoad::default();
            // Crushed cells turn back, and what lies on them comes to rest, in the shortest parts.
            let needs_shortest =
                || memory.stuck || recovery::families_are_far_apart(body) || recovery::is_nearly_still(body, state);
            match () {
                () if is_strained && is_known && !(is_crushed && needs_shortest()) => {
                    let parts = present::parts(memory.load, is_crushed, secs);
                    Some(self.parts_at_rest.saturating_mul(parts).min(self.strained_parts))
                }
                () if is_strained || is_crushed => Some(self.strained_parts),
                () => None,
            }
        };
        let bodies = model.bodies.iter().zip(&state.bodies).filter(|(_, memory)| !memory.asleep);
        bodies.filter_map(of).max()
    }
}

/// Checks the links where that is due, as they are and as they would be after the substep. Returns into how many parts the
/// coming substep is divided: one, or at least as many as strained bodies need. `max_relative_speeds` bounds the relative
/// speeds of each body's particles, m/s.
pub(in crate::physics) fn parts_before_substep<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    strain_policy: StrainPolicy,
    max_relative_speeds: &[f64],
    state: &mut State<R>,
    forces: &mut ForceWorkspace<R>,
) -> u32 {
    if strain_policy.strained_parts == 0 {
        return 1;
    }
    let mut parts_by_displacement = 1;
    let taken = checks::substeps_taken(plan, state);
    let is_due = |body: usize| checks::is_check_due(&model.bodies[body], plan, taken, max_relative_speeds[body]);
    let is_strained = |memory: &BodyMemory| memory.strain > Strain::Small;
    if state.bodies.iter().any(is_strained) || (0..model.bodies.len()).any(is_due) {
        let State { position, velocity, bodies, .. } = state;
        let motion = StraightMotion { position, velocity, secs: R::from_f64(plan.substep_secs()) };
        parts_by_displacement = check_strain(model, plan, Check::BeforeSubstep(&is_due), motion, bodies, forces);
    }
    let parts_by_displacement = parts_by_displacement.min(strain_policy.parts_at_rest.saturating_mul(MAX_PARTS));
    let needed = strain_policy.needed_parts(model, plan, state);
    // Where links turn far in the substep, their present directions do not matter.
    needed.map_or(parts_by_displacement, |needed| {
        if parts_by_displacement > 1 { parts_by_displacement.max(strain_policy.strained_parts) } else { needed }
    })
}

/// Checks the links between two parts of a substep that began without a strained body, where that is due: the last check
/// was `secs_since_check` (s) ago, and the next part is `secs` (s) long. Returns how many parts of the substep the bodies
/// need that are strained by now. Without this, a body that becomes strained in a long substep that is divided for contact
/// between bodies would go through its other parts as if it were at rest.
pub(in crate::physics) fn parts_within_substep<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    state: &mut State<R>,
    strain_policy: StrainPolicy,
    secs_since_check: &mut f64,
    secs: f64,
    (speeds, forces): (&mut Speeds<R>, &mut ForceWorkspace<R>),
) -> Option<u32> {
    speeds.measure(model, plan, state);
    if *secs_since_check + secs > checks::check_interval_secs(model, &speeds.relative) {
        *secs_since_check = 0.0;
        let State { position, velocity, bodies, .. } = state;
        let motion = StraightMotion { position, velocity, secs: R::from_f64(secs) };
        check_strain(model, plan, Check::WithinSubstep, motion, bodies, forces);
    }
    strain_policy.needed_parts(model, plan, state)
}

/// Whether links of a body that is awake and not strained would exceed the larger strain in this motion, as where contact
/// stops some particles and not others.
pub(in crate::physics) fn would_tear_bodies<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    memories: &[BodyMemory],
    motion: StraightMotion<'_, R>,
    forces: &mut ForceWorkspace<R>,
) -> bool {
    forces.find_strained(model, memories, plan.simd, motion, |number| {
        let (body, memory) = (&model.bodies[number], &memories[number]);
        let is_due = !memory.asleep && memory.strain == Strain::Small && {
            let max_relative_speed = speeds::max_relative_speed_of::<R>(plan, motion.of(body).velocity);
            checks::body_check_interval_secs(body, max_relative_speed) < motion.secs.to_f64()
        };
        is_due.then_some(plan.strain_thresholds[1])
    });
    (0..model.bodies.len()).any(|body| forces.is_strained(body))
}

/// Which bodies' links are checked, and when.
#[derive(Clone, Copy)]
pub(in crate::physics) enum Check<'a> {
    /// Those of strained bodies and of these, before a substep.
    BeforeSubstep(&'a (dyn Fn(usize) -> bool + Sync)),
    /// Those of all, between two parts of a substep: it does not count as one more calm substep.
    WithinSubstep,
}

impl Check<'_> {
    /// Whether a body's links are checked.
    fn covers(self, body: usize, memory: &BodyMemory) -> bool {
        !memory.asleep && (memory.strain > Strain::Small || self.is_due(body))
    }

    /// Whether they are checked even if it is not strained.
    fn is_due(self, body: usize) -> bool {
        match self {
            Self::BeforeSubstep(is_due) => is_due(body),
            Self::WithinSubstep => true,
        }
    }
}

/// Checks the links in a motion and remembers which bodies are strained. Returns into how many parts the motion has to be
/// divided so that no link of a strained body goes too far in one.
pub(in crate::physics) fn check_strain<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    check: Check<'_>,
    motion: StraightMotion<'_, R>,
    memories: &mut [BodyMemory],
    forces: &mut ForceWorkspace<R>,
) -> u32 {
    let calm_substeps = checks::substeps_in(plan, CALM_SECS, libm::ceil).max(CALM_SUBSTEPS);
    let is_checked = |body: usize, memory: &BodyMemory| check.covers(body, memory);
    forces.find_strained(model, memories, plan.simd, motion, |body| {
        let memory = &memories[body];
        is_checked(body, memory).then_some(match memory.strain {
            Strain::Small => plan.strain_thresholds[1],
            Strain::Taut => plan.strain_thresholds[0],
            Strain::Large => STRAIN_THRESHOLDS[0],
        })
    });
    let may_be_taut = plan.strain_thresholds[1] < STRAIN_THRESHOLDS[1];
    let above_small = if may_be_taut { Strain::Taut } else { Strain::Large };
    for (number, memory) in memories.iter_mut().enumerate().filter(|(number, memory)| is_checked(*number, memory)) {
        if forces.is_strained(number) {
            (memory.strain, memory.calm_substeps) = (memory.strain.max(above_small), 0);
        } else if memory.strain > Strain::Small && matches!(check, Check::BeforeSubstep(_)) {
            memory.calm_substeps += 1;
            if u64::from(memory.calm_substeps) >= calm_substeps {
                let is_less = memory.strain == Strain::Large && may_be_taut;
                (memory.strain, memory.calm_substeps) = (if is_less { Strain::Taut } else { Strain::Small }, 0);
            }
        }
    }
    if may_be_taut {
        let is_taut = |memory: &BodyMemory| !memory.asleep && memory.strain == Strain::Taut;
        forces.find_strained(model, memories, plan.simd, motion, |body| {
            is_taut(&memories[body]).then_some(STRAIN_THRESHOLDS[1])
        });
        for (number, memory) in memories.iter_mut().enumerate().filter(|(_, memory)| is_taut(memory)) {
            if forces.is_strained(number) {
                (memory.strain, memory.calm_substeps) = (Strain::Large, 0);
            }
        }
    }
    update_loads(model, plan, check, motion.position, memories, &mut forces.sums);
    let strained =
        model.bodies.iter().zip(memories).filter(|(_, memory)| !memory.asleep && memory.strain > Strain::Small);
    let max_displacement = strained.fold(0.0, |most: f64, (body, _)| {
        let own = motion.of(body);
        let bound = speeds::max_relative_speed_of::<R>(plan, own.velocity)
            * body.inverse_cell_size.to_f64()
            * own.secs.to_f64();
        // No link is shorter at rest than a cell: where particles are slow relative to each other, the bound is enough.
        most.max(if bound <= MAX_LINK_DISPLACEMENT { bound } else { strain::max_link_displacement(body, own) })
    });
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count from zero up, saturating")]
    let parts = libm::ceil(max_displacement / MAX_LINK_DISPLACEMENT) as u32;
    parts.max(1)
}

/// Finds the load of the links of the bodies that are checked, at these positions (m).
fn update_loads<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    check: Check<'_>,
    position: &[R::Vec3],
    memories: &mut [BodyMemory],
    sums: &mut [Sums<R>],
) {
    let of_all = (memories, sums);
    team::for_body_ranges(plan.threads, MIN_CONTACT_PARTICLES, model, of_all, |these, memories, sums| {
        let first = model.bodies.get(these.start).map_or(0, |body| body.particles.start);
        for (number, memory) in these.zip(memories).filter(|(number, memory)| check.covers(*number, memory)) {
            let body = &model.bodies[number];
            if memory.strain == Strain::Small {
                memory.load = LinkLoad::default();
            } else if check.is_due(number) || memory.load == LinkLoad::default() {
                let own = body.particles.clone();
                let sums = &mut sums[own.start - first..own.end - first];
                let now = present::load(plan.simd, body, &position[own], sums);
                memory.load = now.larger_of(memory.load.times(LOAD_DECAY));
            }
        }
    });
}
