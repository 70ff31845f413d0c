//! What a step does for this scene, and no more: which stages run, how a whole step is subdivided.

use crate::geometry::Family;
use crate::math::Real;
use crate::physics::kernels::SimdLevel;
use crate::physics::limits::SceneLimits;
use crate::physics::model::{ContactRule, Model, Scheme};
use crate::physics::schemes::chebyshev::stages_for;

/// The most halvings of a substep of the implicit integrator.
pub const MOST_HALVINGS: u32 = 24;

/// The most work of the implicit integrator in 1/60 s for each body, in iterations of its solver: some hundred times that of
/// a body landing on the ground. It is counted in work, never in time, so that the motion is the same everywhere.
pub const MOST_WORK_A_FRAME: u64 = 100_000;

/// The work of a solve beside its iterations: forces, matrix, contact and balance.
pub const SOLVE_WORK: u64 = 10;

/// The stages of a substep in their order (GC Algorithm 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// Gravity, where there is no pass over links: such a pass starts from the weight.
    Gravity,
    /// Link forces with the weight, and the predicted velocities where link forces come last.
    Links,
    /// Cells that are near inversion.
    Recovery,
    /// Boxes against boxes (GC §7).
    BroadPhase,
    /// Particles against obstacles, response and friction (GC §5, §6).
    Contact,
    /// Velocity, where it is not found with the links, and position.
    Integrate,
    /// Whether bodies have come to rest.
    Rest,
}

impl Stage {
    /// All stages in their order.
    pub const ALL: [Self; 7] =
        [Self::Gravity, Self::Links, Self::Recovery, Self::BroadPhase, Self::Contact, Self::Integrate, Self::Rest];

    /// The stage's name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gravity => "gravity",
            Self::Links => "links",
            Self::Recovery => "recovery",
            Self::BroadPhase => "broad_phase",
            Self::Contact => "contact",
            Self::Integrate => "integrate",
            Self::Rest => "rest",
        }
    }
}

/// A scheme that may take a scene's steps, and what it would cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SchemeCost {
    /// The scheme.
    pub scheme: Scheme,
    /// The length of its substeps, s.
    pub substep_secs: f64,
    /// Predicted operations for a simulated second, in units of a link force evaluated in a box.
    pub cost_per_sec: f64,
}

impl SchemeCost {
    /// The cheapest of some; the first of those that are equally cheap.
    pub(in crate::physics) fn cheapest(of: &[Self]) -> Option<&Self> {
        of.iter().min_by(|a, b| a.cost_per_sec.total_cmp(&b.cost_per_sec))
    }
}

/// The rates that the number of stages of the stabilised scheme follows from.
#[derive(Clone, Debug, PartialEq)]
pub struct StageRates {
    /// The scheme's stability limits, with the largest damping rate of bodies at rest.
    pub limits: SceneLimits,
    /// The largest damping rate in any state, 1/s.
    pub strained: f64,
    /// By body, stiffness (1/s²) and damping (1/s) of a particle's links with their other ends held still, over the
    /// particle's mass.
    pub own: Vec<[f64; 2]>,
}

impl StageRates {
    /// Stages of a substep of `secs` (s) with bodies at rest.
    pub fn stages_at_rest(&self, secs: f64) -> u32 {
        stages_for(self.limits.damping_rate * secs)
    }

    /// The same where a body is strained.
    pub(in crate::physics) fn stages_strained(&self, secs: f64) -> u32 {
        stages_for(self.strained * secs)
    }
}

/// The most parts of a substep for contact between bodies. Bodies that would need more pass through each other: they are
/// millions of times as stiff as jelly, and a second of them would take hours.
pub const MOST_PARTS_BETWEEN_BODIES: u32 = 1 << 14;

/// How substeps are taken in which bodies come near each other or obstacles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyContactPlan {
    /// The scheme that takes them, unless the implicit one does. Such contact is an impulse on the predicted velocities, for
    /// which the stabilised scheme and those of Runge and Kutta have no place, nor has the implicit one where modal bodies are
    /// among the bodies.
    pub scheme: Scheme,
    /// The fewest parts that they are divided into.
    pub parts: u32,
    /// The same while a body is strained.
    pub(in crate::physics) strained_parts: u32,
    /// How many of these parts cost as much as one solve of the implicit scheme, which then may take such substeps itself; none
    /// where it has no place for the contact.
    pub(in crate::physics) parts_a_solve: Option<f64>,
}

/// What a step does for one scene.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a stage that runs or does not, and any mixture is a plan")]
pub struct Plan {
    /// The scheme in use.
    pub scheme: Scheme,
    /// The schemes that were considered, the one of the settings first.
    pub scheme_costs: Vec<SchemeCost>,
    /// The whole step, s: that of the settings, or as much of it as `u32::MAX` safe substeps cover.
    pub dt_secs: f64,
    /// Substeps in a span.
    pub substeps: u32,
    /// Whole steps in a span. After each of them as many substeps are taken as have begun and ended within it: the motion is
    /// behind by less than a substep until the span is over. Where the implicit integrator has taken over, a span is one
    /// substep, and its steps before the last are only counted.
    pub span: u32,
    /// How often a substep of the implicit integrator may be halved that would give energy: down to a step that an explicit
    /// integrator could take, or as often as is possible at all. Never in manual stepping.
    pub halvings: u32,
    /// Whether an explicit integrator can take the part that is left after so many halvings; otherwise the implicit one
    /// takes it, unchecked.
    pub(in crate::physics) ends_explicitly: bool,
    /// The work on one substep after which the implicit integrator halves no more, see [`MOST_WORK_A_FRAME`].
    pub most_work: u64,
    /// Parts that make a substep stable in any state of a strained body; zero where nothing is divided for that: manual
    /// steps, and those of the implicit scheme, which are halved where they would give energy.
    pub(in crate::physics) parts: u32,
    /// A body becomes strained when the strain of a link, stretched or compressed, exceeds the larger of these, and stays so
    /// until all links are below the smaller.
    pub(in crate::physics) strain_thresholds: [f64; 2],
    /// The rates behind the stages of the stabilised scheme; none with other schemes.
    pub stage_rates: Option<StageRates>,
    /// The predicted stability limits of the scheme in the settings, from which the division of its steps follows.
    pub limits: SceneLimits,
    /// Which families have a link with a force, in any body.
    pub families: [bool; 3],
    /// Which families have damping, in any body.
    pub damped: [bool; 3],
    /// The vector instructions that compute link forces; the result is the same with all of them.
    pub simd: SimdLevel,
    /// Threads of the caller's pool that take a step; the result is the same with any number.
    pub threads: usize,
    /// Whether crushed cells are pushed back to shape.
    pub recovery: bool,
    /// Whether there are obstacles, and bodies to meet them.
    pub contact: bool,
    /// How bodies meet each other; none where they do not.
    pub between_bodies: Option<BodyContactPlan>,
    /// How points of bodies' meshes meet obstacles; none where no body has such points, or no scheme can take such steps:
    /// then the bodies' cells meet obstacles.
    pub on_mesh: Option<BodyContactPlan>,
    /// How substeps are taken in which a body comes near an obstacle, or a hand pulls at one, where the scheme has no place for
    /// that; none where it has.
    pub at_obstacles: Option<BodyContactPlan>,
    /// Whether any obstacle is a sphere.
    pub(in crate::physics) spheres: bool,
    /// Whether any obstacle has friction.
    pub friction: bool,
    /// How obstacles push back.
    pub(in crate::physics) contact_rule: ContactRule,
    /// Whether the thesis's contact rule also reverses the force that presses a particle on (GC §5.2), as the thesis has it.
    pub pressing_force: bool,
    /// Whether explosions are watched for: where steps are not divided until they are stable.
    pub watched: bool,
    /// Whether a broad phase spares particles the narrow phase; the result is the same without it, only more expensive.
    pub broad_phase: bool,
    /// Whether bodies at rest sleep.
    pub sleeping: bool,
    /// Whether work that cannot change the result is left out; without this, steps are only more expensive.
    pub(in crate::physics) lean: bool,
}

impl Plan {
    /// The step in use, s.
    pub fn substep_secs(&self) -> f64 {
        self.dt_secs * f64::from(self.span) / f64::from(self.substeps)
    }

    /// Whether there is contact with obstacles, by any rule but that of the thesis.
    pub(in crate::physics) fn has_implicit_contact(&self) -> bool {
        self.contact && self.contact_rule == ContactRule::Implicit
    }

    /// Whether points of meshes meet obstacles, or cells their edges.
    pub(in crate::physics) fn has_point_contact(&self) -> bool {
        self.has_implicit_contact() && self.on_mesh.is_some()
    }

    /// How substeps with any of the contacts that have a plan of their own are taken.
    pub(in crate::physics) fn contact_plan(&self) -> Option<BodyContactPlan> {
        self.on_mesh.or(self.between_bodies).or(self.at_obstacles)
    }

    /// Whether the scheme may solve for substeps in contact of points as a whole.
    pub fn may_solve_for_contact(&self) -> bool {
        [self.between_bodies, self.on_mesh].into_iter().flatten().any(|plan| plan.parts_a_solve.is_some())
    }

    /// The parts that substeps are divided into in which points of bodies come near each other or an obstacle, where these are
    /// more than one: at rest, and while a body is strained.
    pub fn parts_in_contact(&self) -> Option<[u32; 2]> {
        let at_obstacles = self.at_obstacles.filter(|_| self.contact);
        let plans = [self.between_bodies, self.on_mesh, at_obstacles].into_iter().flatten();
        let divided = plans.filter(|plan| plan.parts > 1 && plan.parts < u32::MAX);
        divided.map(|plan| [plan.parts, plan.strained_parts]).max()
    }

    /// Substeps in a number of steps since the start.
    pub(in crate::physics) fn substeps_by(&self, steps: u64) -> u64 {
        let [span, substeps] = [self.span, self.substeps].map(u64::from);
        (steps / span).wrapping_mul(substeps).wrapping_add(steps % span * substeps / span)
    }

    /// Substeps in the step that follows on so many `steps`; none where it is only counted.
    pub(crate) fn substeps_after(&self, steps: u64) -> u32 {
        let count = self.substeps_by(steps.wrapping_add(1)).wrapping_sub(self.substeps_by(steps));
        u32::try_from(count).unwrap_or(u32::MAX)
    }

    /// The most substeps in a step.
    pub fn max_substeps_in_step(&self) -> u32 {
        self.substeps.div_ceil(self.span)
    }

    /// Whether substeps are divided until they are stable.
    pub(in crate::physics) fn is_divided(&self) -> bool {
        !self.watched
    }

    /// The stability limits of the explicit scheme in use, or of the one in the settings.
    pub fn limits_at_work(&self) -> &SceneLimits {
        self.stage_rates.as_ref().map_or(&self.limits, |rates| &rates.limits)
    }

    /// The longest part of a substep in which cells near inversion are pushed, s.
    pub(in crate::physics) fn recovery_secs(&self) -> f64 {
        let parts = if self.scheme == Scheme::Stabilised { self.parts.max(1) } else { 1 };
        self.substep_secs() / f64::from(parts)
    }

    /// Makes every substep compute everything, whether the scene needs it or not: more expensive, and the same to the bit.
    pub fn work_out_everything(&mut self) {
        self.families = [true; 3];
        self.broad_phase = false;
        self.lean = false;
    }

    /// The parts of a step that are left out as this scene does not need them, with the reasons.
    pub fn left_out(&self) -> Vec<(String, &'static str)> {
        let mut left_out = Vec::new();
        for (family, (forces, damped)) in Family::ALL.into_iter().zip(self.families.into_iter().zip(self.damped)) {
            if !forces {
                left_out.push((
                    format!("{} links", family.name()),
                    "their stiffness and damping are zero, or there are none",
                ));
            } else if !damped {
                left_out.push((format!("{} damping", family.name()), "it is zero: the undamped force is worked out"));
            }
        }
        let mut leave_out = |condition: bool, name: &str, reason| {
            if condition {
                left_out.push((name.to_owned(), reason));
            }
        };
        leave_out(!self.recovery, "recovery from inversion", "it is switched off, or no link has a stiffness");
        leave_out(!self.contact, "contact", "there is no obstacle, or no body");
        leave_out(
            self.between_bodies.is_none(),
            "contact between bodies",
            "no body may collide with another or with itself",
        );
        leave_out(self.contact && !self.spheres, "sphere contact", "there is no sphere");
        leave_out(self.contact && !self.friction, "friction", "all its coefficients are zero");
        leave_out(!self.sleeping, "sleeping", "it is switched off");
        leave_out(!self.watched, "watch for explosions", "the steps are known to be stable");
        left_out
    }

    /// Whether a stage ever runs.
    pub fn runs(&self, stage: Stage) -> bool {
        match stage {
            Stage::Gravity | Stage::Integrate => true,
            Stage::Links => self.families.contains(&true),
            Stage::Recovery => self.recovery,
            Stage::BroadPhase => self.contact && self.broad_phase || self.between_bodies.is_some(),
            Stage::Contact => self.contact || self.between_bodies.is_some(),
            Stage::Rest => self.sleeping,
        }
    }
}

/// Obstacles of a model that have two sides: planes and open meshes.
pub(in crate::physics) fn plane_count<R: Real>(model: &Model<R>) -> usize {
    model.obstacles.iter().filter(|obstacle| obstacle.shape.side_row().is_some()).count()
}
