//! A substep or a part of it, and the inputs that all its stages read and none writes.

use crate::math::Real;
use crate::physics::contact::placed::Placed;
use crate::physics::interaction::Grab;
use crate::physics::kernels;
use crate::physics::model::Model;
use crate::physics::model::Scheme;
use crate::physics::model::plan::Plan;
use crate::physics::state::{State, sleep};

/// A substep, or a part of one, as it begins.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Substep<'a, R: Real> {
    pub(in crate::physics) model: &'a Model<R>,
    pub(in crate::physics) plan: &'a Plan,
    /// The state as it begins.
    pub(in crate::physics) state: &'a State<R>,
    /// Where obstacles are in it.
    pub(in crate::physics) obstacles: &'a Placed<R>,
    /// Its length, s.
    pub(in crate::physics) dt: R,
    /// The scheme that takes it.
    pub(in crate::physics) scheme: Scheme,
    /// Whether a body is strained, so that it is taken in parts.
    pub(in crate::physics) is_strained: bool,
    /// Whether bodies come near each other in it.
    pub(in crate::physics) bodies_are_near: bool,
    /// Whether points of a mesh come near an obstacle in it, or an obstacle's edges near a body.
    pub(in crate::physics) points_are_near: bool,
    /// A hand that pulls at particles.
    pub(in crate::physics) grab: Option<&'a Grab<R>>,
    /// A hand that pulls at a modal body.
    pub(in crate::physics) modal_grab: Option<&'a Grab<R>>,
}

impl<R: Real> Substep<'_, R> {
    /// Whether velocities lead all particles that are awake to finite places.
    pub(in crate::physics) fn stays_finite(&self, velocity: &[R::Vec3]) -> bool {
        let Self { model, plan, state, dt, .. } = *self;
        sleep::awake(model, &state.bodies).all(|body| {
            let own = body.particles.clone();
            kernels::are_finite(plan.simd, &state.position[own.clone()], &velocity[own], dt)
        })
    }

    /// Whether a body meets obstacles with points of its mesh, and not with its particles.
    pub(in crate::physics) fn meets_on_mesh(&self, body: usize) -> bool {
        self.plan.on_mesh.is_some() && self.model.bodies[body].samples.is_some()
    }

    /// How many stages of the stabilised scheme it takes.
    pub(in crate::physics) fn stages(&self) -> u32 {
        let Some(rates) = &self.plan.stage_rates else { return 1 };
        let secs = self.dt.to_f64();
        if self.is_strained { rates.stages_strained(secs) } else { rates.stages_at_rest(secs) }
    }

    /// The largest rate at which friction may stop a particle of a body in the stages of the stabilised scheme, 1/s: one
    /// over the substep plus the damping of its links, which the stages are enough for.
    pub(in crate::physics) fn braking_rate(&self, body: usize) -> R {
        let damping = self.plan.stage_rates.as_ref().map_or(0.0, |rates| rates.own[body][1]);
        R::ONE / self.dt + R::from_f64(damping)
    }

    /// The effective mass of a particle (a local number) against a push, kg: its mass; in the long substeps of the
    /// stabilised scheme also its links, as if their other ends stood still: `m + dt c + dt² k`.
    pub(in crate::physics) fn inertia(&self, body: usize, local: usize) -> R {
        let mass = self.model.bodies[body].mass(local);
        match &self.plan.stage_rates {
            Some(rates) if self.scheme == Scheme::Stabilised => {
                let ([stiffness, damping], dt) = (rates.own[body], self.dt.to_f64());
                mass * R::from_f64(1.0 + dt * (damping + dt * stiffness))
            }
            _ => mass,
        }
    }
}

/// The stretch of time that one evaluation of a scheme covers: a substep or a part of it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a fact about the part, and any mixture may be")]
pub(in crate::physics) struct Part {
    /// Its length, s.
    pub(in crate::physics) secs: f64,
    /// The scheme that takes it.
    pub(in crate::physics) scheme: Scheme,
    /// Whether it is one of several because a body is strained.
    pub(in crate::physics) is_strained: bool,
    /// Whether bodies come near each other in it.
    pub(in crate::physics) bodies_are_near: bool,
    /// Whether points of a mesh come near an obstacle in it, or an obstacle's edges near a body.
    pub(in crate::physics) points_are_near: bool,
    /// What to do where the implicit scheme would give energy from nowhere.
    pub(in crate::physics) on_energy_gain: OnEnergyGain,
    /// Whether the substep ends with it.
    pub(in crate::physics) is_last: bool,
}

impl Part {
    /// A whole substep in one part that is never refused, by a scheme that has a place for all contact in it.
    pub(in crate::physics) fn whole_substep(plan: &Plan) -> Self {
        Self {
            secs: plan.substep_secs(),
            scheme: plan.contact_plan().map_or(plan.scheme, |contact_plan| contact_plan.scheme),
            is_strained: false,
            bodies_are_near: plan.between_bodies.is_some(),
            points_are_near: plan.on_mesh.is_some(),
            on_energy_gain: OnEnergyGain::Take,
            is_last: true,
        }
    }
}

/// What to do with a part in which the implicit scheme would give a body energy from nowhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::physics) enum OnEnergyGain {
    /// It is refused, the state untouched.
    Refuse,
    /// It is taken with so much of the motion as gives none: there was enough work on the substep.
    Slow,
    /// It is taken as it is, unchecked.
    Take,
}

/// What acts on a substep from outside.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct Inputs<'a, R: Real> {
    /// Where obstacles are in it.
    pub(in crate::physics) obstacles: &'a Placed<R>,
    /// A hand that pulls at particles.
    pub(in crate::physics) grab: Option<&'a Grab<R>>,
    /// A hand that pulls at a modal body.
    pub(in crate::physics) modal_grab: Option<&'a Grab<R>>,
}

impl<'a, R: Real> Inputs<'a, R> {
    /// A part of a substep from a state on.
    pub(super) fn substep(
        self,
        model: &'a Model<R>,
        plan: &'a Plan,
        part: Part,
        state: &'a State<R>,
    ) -> Substep<'a, R> {
        let Self { obstacles, grab, modal_grab } = self;
        let Part { secs, scheme, is_strained, bodies_are_near, points_are_near, .. } = part;
        let dt = R::from_f64(secs);
        Substep {
            model,
            plan,
            state,
            obstacles,
            dt,
            scheme,
            is_strained,
            bodies_are_near,
            points_are_near,
            grab,
            modal_grab,
        }
    }
}
