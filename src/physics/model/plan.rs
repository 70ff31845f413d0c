//! What a step does for this scene, and no more: which stages run, how a whole step is subdivided.

use crate::geometry::Family;
use crate::math::Real;
use crate::physics::kernels::SimdLevel;
use crate::physics::limits::SceneLimits;
use crate::physics::model::{ContactRule, Model, Scheme};
use crate::physics::schemes::chebyshev::stages_for;

/// The most halvings of a substep of the implicit integrator.
pub const MOST_HALVINGS: u32 = 24;

/// The most work of the implicit integrator in 1/60 s for each body, in iterations of its solver: some hundred times what a
/// body takes that lands on the ground. It is counted in work, never in time, so that the motion is the same everywhere.
pub const MOST_WORK_A_FRAME: u64 = 100_000;

/// The work of a solve beside its iterations: forces, matrix, contact and balance.
pub const SOLVE_WORK: u64 = 10;

/// The stages of a substep in their order (GC Algorithm 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// Gravity, where no links are swept: their sweep begins with the weight.
    Gravity,
    /// Forces of the links with the weight, and the velocities that they give where they come last.
    Links,
    /// Cells that are near inversion (S7).
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

    /// The stage's word in figures.
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
    /// Operations for a simulated second, predicted; the unit is the force of a link that is worked out in a box.
    pub cost_per_sec: f64,
}

impl SchemeCost {
    /// The cheapest of some, the earliest where several are.
    pub(in crate::physics) fn cheapest(of: &[Self]) -> Option<&Self> {
        of.iter().min_by(|a, b| a.cost_per_sec.total_cmp(&b.cost_per_sec))
    }
}

/// Rates that the stabilised scheme has as many stages for as they ask for.
#[derive(Clone, Debug, PartialEq)]
pub struct StageRates {
    /// Its stability limits, with the largest rate of damping of bodies at rest.
    pub limits: SceneLimits,
    /// That rate in any state, 1/s.
    pub strained: f64,
    /// What a particle's links resist with while their other ends stand still, over its mass, by body: stiffness, 1/s²,
    /// and damping, 1/s.
    pub own: Vec<[f64; 2]>,
}

impl StageRates {
    /// Stages of a substep of so many seconds.
    pub fn stages_at_rest(&self, secs: f64) -> u32 {
        stages_for(self.limits.damping_rate * secs)
    }

    /// The same where a body is strained.
    pub(in crate::physics) fn stages_strained(&self, secs: f64) -> u32 {
        stages_for(self.strained * secs)
    }
}

/// Bodies whose substeps would have to be divided further where they come near each other pass through each other: they are
/// millions of times as stiff as jelly, and a second of them would take hours.
pub const MOST_PARTS_BETWEEN_BODIES: u32 = 1 << 14;

/// How substeps are taken in which bodies come near each other, or their meshes near obstacles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyContactPlan {
    /// What takes them: such contact is an impulse on the velocities that forces predict, which the implicit and the stabilised
    /// scheme have no place for.
    pub scheme: Scheme,
    /// Parts that they are divided into for that, at least.
    pub parts: u32,
    /// The same while a body is strained.
    pub(in crate::physics) strained_parts: u32,
}

/// What a step does for one scene.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a stage that runs or does not, and any mixture is a plan")]
pub struct Plan {
    /// The scheme in use.
    pub scheme: Scheme,
    /// The schemes that might have been, the one that the person chose first.
    pub scheme_costs: Vec<SchemeCost>,
    /// The whole step, s: what the person asked for, or as much of it as can be counted in substeps that are safe.
    pub dt_secs: f64,
    /// Substeps in a whole step.
    pub substeps: u32,
    /// Whole steps that one substep covers: more than one only where the implicit integrator has taken over, as many as
    /// its own step has room for. The steps before the last are counted and the motion waits for it.
    pub span: u32,
    /// How often a substep of the implicit integrator may be halved whose linear equations prove wrong: down to a step
    /// that an explicit integrator could take, or as often as can be. Never in manual stepping.
    pub halvings: u32,
    /// Whether an explicit integrator can take what is left after that many; otherwise the linear equations have the last
    /// word.
    pub(in crate::physics) ends_explicitly: bool,
    /// The work on one substep after which the implicit integrator halves no more, see [`MOST_WORK_A_FRAME`].
    pub most_work: u64,
    /// Parts that a substep is taken in while a body is strained, at least; none where nothing is divided for that: manual
    /// steps, and those of the implicit scheme, which are halved where they would give energy.
    pub(in crate::physics) parts: u32,
    /// A body is strained from the larger of these strains of any link on, stretched or compressed, until all are below the
    /// smaller.
    pub(in crate::physics) strains: [f64; 2],
    /// What damping asks of the stabilised scheme; none with others.
    pub stage_rates: Option<StageRates>,
    /// The predicted stability limits of the scheme that was asked for: what a division of its steps follows from.
    pub limits: SceneLimits,
    /// Which families have a link with a force, in any body.
    pub families: [bool; 3],
    /// Which families have a damping to work out, in any body.
    pub damped: [bool; 3],
    /// The instructions that work out the forces of links; the result is the same with all of them.
    pub simd: SimdLevel,
    /// Threads that take a step, of the pool that it is asked for in; the result is the same with any number.
    pub threads: usize,
    /// Whether crushed cells are pushed back to shape.
    pub recovery: bool,
    /// Whether anything can be met.
    pub contact: bool,
    /// How bodies meet each other; none where they do not.
    pub between_bodies: Option<BodyContactPlan>,
    /// How points of bodies' meshes meet obstacles; none where no body has any that do, or nothing can take such steps: then
    /// their cells meet them.
    pub on_mesh: Option<BodyContactPlan>,
    /// Whether any obstacle is a sphere.
    pub(in crate::physics) spheres: bool,
    /// Whether any obstacle rubs.
    pub friction: bool,
    /// How obstacles push back.
    pub(in crate::physics) contact_rule: ContactRule,
    /// Whether the thesis's rule turns back the force that presses a particle on (GC §5.2), as it is written.
    pub pressing_force: bool,
    /// Whether an explosion is looked for: where steps are not divided until they are stable.
    pub watched: bool,
    /// Whether boxes keep particles from the narrow phase; the result is the same without, only more expensive.
    pub broad_phase: bool,
    /// Whether bodies at rest sleep.
    pub sleeping: bool,
    /// Whether what cannot change anything is left out; the result is the same without, only more expensive.
    pub(in crate::physics) lean: bool,
}

impl Plan {
    /// The step in use, s.
    pub fn substep_secs(&self) -> f64 {
        self.dt_secs * f64::from(self.span) / f64::from(self.substeps)
    }

    /// Whether substeps are divided until they are stable.
    pub(in crate::physics) fn is_divided(&self) -> bool {
        !self.watched
    }

    /// The stability limits of the explicit scheme in use, or of the one that was asked for.
    pub fn limits_at_work(&self) -> &SceneLimits {
        self.stage_rates.as_ref().map_or(&self.limits, |rates| &rates.limits)
    }

    /// The longest part of a substep in which cells near inversion are pushed, s.
    pub(in crate::physics) fn recovery_secs(&self) -> f64 {
        let parts = if self.scheme == Scheme::Stabilised { self.parts.max(1) } else { 1 };
        self.substep_secs() / f64::from(parts)
    }

    /// Has everything worked out in every substep, whether the scene needs it or not: more expensive, and the same to the bit.
    pub fn work_out_everything(&mut self) {
        self.families = [true; 3];
        self.broad_phase = false;
        self.lean = false;
    }

    /// What this scene does not need and no step does, with the reason.
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

/// Planes among the obstacles of a model.
pub(in crate::physics) fn plane_count<R: Real>(model: &Model<R>) -> usize {
    model.obstacles.iter().filter(|obstacle| obstacle.shape.side_row().is_some()).count()
}
