//! What a step does for this scene, and no more: which stages run, how a whole step is subdivided.

use super::model::{Model, ObstacleShape};
use super::stability::SceneLimits;
use crate::math::Real;
use crate::scene::settings::{ContactRule, Integrator, Stepping};
use crate::scene::{Family, Settings};

/// The stages of a substep in their order (GC Algorithm 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// Gravity.
    Gravity,
    /// Forces of the links.
    Links,
    /// Cells that are near inversion (S7).
    Recovery,
    /// Boxes against boxes (GC §7).
    BroadPhase,
    /// Particles against obstacles, response and friction (GC §5, §6).
    Contact,
    /// Velocity and position.
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

/// What a step does for one scene.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a stage that runs or does not, and any mixture is a plan")]
pub struct Plan {
    /// The scheme in use.
    pub integrator: Integrator,
    /// The whole step, s: what the person asked for, or as much of it as can be counted in substeps that are safe.
    pub dt_secs: f64,
    /// Substeps in a whole step.
    pub substeps: u32,
    /// The predicted stability limits the subdivision follows from.
    pub limits: SceneLimits,
    /// Which families have a link with a force, in any body.
    pub families: [bool; 3],
    /// Which families have a damping to work out, in any body.
    pub damped: [bool; 3],
    /// Whether crushed cells are pushed back to shape.
    pub recovery: bool,
    /// Whether anything can be met.
    pub contact: bool,
    /// Whether any obstacle is a sphere.
    pub spheres: bool,
    /// Whether any obstacle rubs.
    pub friction: bool,
    /// How obstacles push back.
    pub contact_rule: ContactRule,
    /// Whether an explosion is looked for: where nobody vouches for the step.
    pub watched: bool,
    /// Whether boxes keep particles from the narrow phase; the result is the same without, only dearer.
    pub broad_phase: bool,
    /// Whether bodies at rest sleep.
    pub sleeping: bool,
    /// Whether what cannot change anything is left out; the result is the same without, only dearer.
    pub lean: bool,
}

impl Plan {
    /// The plan of a model under some settings.
    pub fn new<R: Real>(settings: &Settings, model: &Model<R>, limits: SceneLimits) -> Self {
        let has_force = |family: usize| {
            model.bodies.iter().any(|body| {
                let links = &body.links[family];
                !links.links.is_empty() && (links.stiffness > R::ZERO || links.damping > R::ZERO)
            })
        };
        let divided = settings.stepping == Stepping::Auto && settings.integrator.has_stable_step();
        Self {
            integrator: settings.integrator,
            dt_secs: if divided { settings.dt.min(limits.longest_step_secs()) } else { settings.dt },
            substeps: if divided { limits.substeps(settings.dt) } else { 1 },
            limits,
            families: Family::ALL.map(|family| has_force(family as usize)),
            damped: Family::ALL
                .map(|family| model.bodies.iter().any(|body| body.links[family as usize].damping > R::ZERO)),
            spheres: model.obstacles.iter().any(|o| matches!(o.shape, ObstacleShape::Sphere { .. })),
            friction: model.obstacles.iter().any(|o| o.friction_static > R::ZERO || o.friction_dynamic > R::ZERO),
            recovery: model.bodies.iter().any(|body| body.recovery_stiffness > R::ZERO),
            contact: !model.obstacles.is_empty() && !model.bodies.is_empty(),
            contact_rule: settings.contact,
            watched: !divided,
            broad_phase: true,
            sleeping: settings.sleeping,
            lean: true,
        }
    }

    /// The step in use, s.
    pub fn substep_secs(&self) -> f64 {
        self.dt_secs / f64::from(self.substeps)
    }

    /// Has everything worked out in every substep, whether the scene needs it or not: dearer, and the same to the bit.
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
            Stage::BroadPhase => self.contact && self.broad_phase,
            Stage::Contact => self.contact,
            Stage::Rest => self.sleeping,
        }
    }
}

/// Planes among the obstacles of a model.
pub(super) fn plane_count<R: Real>(model: &Model<R>) -> usize {
    model.obstacles.iter().filter(|obstacle| matches!(obstacle.shape, ObstacleShape::Plane(_))).count()
}
