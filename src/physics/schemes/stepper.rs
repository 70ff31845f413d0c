//! A scheme at work on a substep: the workspace and the stages that schemes share.

use crate::math::{Real, Vector};
use crate::physics::forces;
use crate::physics::forces::links::Configuration;
use crate::physics::forces::particles::kick_particles;
use crate::physics::kernels::SimdLevel;
use crate::physics::model::Model;
use crate::physics::model::Scheme;
use crate::physics::model::plan::{Plan, Stage};
use crate::physics::report::Recorder;
use crate::physics::schemes::held::StageWorkspace;
use crate::physics::schemes::implicit::system::ImplicitWorkspace;
use crate::physics::schemes::verlet;
use crate::physics::state::BodyMemory;
use crate::physics::state::sleep::awake;
use crate::physics::step::substep::Substep;

/// The workspace of a scheme between two states; vectors that a scheme does not need are empty.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct SchemeWorkspace<R: Real> {
    /// Mean velocity over the substep, m/s, for schemes that move particles with it rather than with that at the end, and for
    /// the implicit one, which moves bodies that turn along arcs.
    pub(in crate::physics) mean_velocity: Option<Vec<R::Vec3>>,
    /// The predicted velocities, m/s, before contact changed them.
    pub(super) predicted: Vec<R::Vec3>,
    /// The velocities that contact left, m/s.
    pub(super) after_contact: Vec<R::Vec3>,
    /// Positions at which forces are evaluated between two states, m.
    pub(super) position: Vec<R::Vec3>,
    /// Velocities with which forces are evaluated, if not those of the state, m/s.
    pub(in crate::physics) velocity: Vec<R::Vec3>,
    /// Forces there, N.
    pub(super) force: Vec<R::Vec3>,
    /// Workspace of the stabilised scheme.
    pub(in crate::physics) stages: StageWorkspace<R>,
    /// Workspace of the implicit scheme.
    pub(super) implicit: ImplicitWorkspace<R>,
}

impl<R: Real> SchemeWorkspace<R> {
    /// Allocates the workspace for the scheme of a plan.
    pub(in crate::physics) fn new(model: &Model<R>, plan: &Plan) -> Self {
        let room = |needed: bool| vec![R::Vec3::ZERO; if needed { model.particle_count() } else { 0 }];
        let has_stages = matches!(plan.scheme, Scheme::Rk2 | Scheme::Rk4 | Scheme::Stabilised);
        let surface = || model.bodies.iter().map(|body| body.lattice.surface).sum();
        Self {
            mean_velocity: (moves_by_mean(plan.scheme) || plan.scheme == Scheme::Implicit).then(|| room(true)),
            predicted: room(moves_by_mean(plan.scheme)),
            after_contact: room(matches!(plan.scheme, Scheme::Rk2 | Scheme::Rk4)),
            position: room(has_stages),
            velocity: room(has_stages || plan.scheme == Scheme::Verlet),
            force: room(has_stages),
            stages: match plan.scheme {
                Scheme::Stabilised => StageWorkspace::new(model.particle_count(), surface()),
                _ => StageWorkspace::default(),
            },
            implicit: match plan.scheme {
                Scheme::Implicit => ImplicitWorkspace::new(model),
                _ => ImplicitWorkspace::default(),
            },
        }
    }
}

impl<R: Real> SchemeWorkspace<R> {
    /// Adapts the workspace to a model of the same bodies with other constants; `before` is the scheme it was made for. The
    /// workspace of the implicit scheme depends on the constants.
    pub(in crate::physics) fn fit(&mut self, before: Scheme, model: &Model<R>, plan: &Plan) {
        if plan.scheme != before || plan.scheme == Scheme::Implicit {
            *self = Self::new(model, plan);
        }
    }

    /// Returns the velocities that move particles, given those at the end of the substep.
    pub(in crate::physics) fn moving<'a>(&'a self, velocity: &'a [R::Vec3]) -> &'a [R::Vec3] {
        self.mean_velocity.as_deref().unwrap_or(velocity)
    }
}

/// A scheme at work on a substep whose forces are known.
pub(in crate::physics) struct Stepper<'a, R: Real> {
    pub(in crate::physics) substep: Substep<'a, R>,
    /// Forces at the state, N.
    pub(in crate::physics) force: &'a [R::Vec3],
    /// The part of the thesis's contact, N: constant over the substep. None without that rule.
    pub(in crate::physics) thesis_force: Option<&'a [R::Vec3]>,
    pub(in crate::physics) workspace: &'a mut SchemeWorkspace<R>,
    pub(in crate::physics) forces: &'a mut forces::ForceWorkspace<R>,
}

impl<R: Real> Stepper<'_, R> {
    /// Makes the stage that every scheme begins with: the state itself.
    pub(super) fn first_stage(&mut self) {
        self.workspace.velocity.copy_from_slice(&self.substep.state.velocity);
        self.workspace.force.copy_from_slice(self.force);
        self.add_contact_forces();
    }

    /// Goes from the state for `ahead` (s) along the slope of the last stage, and evaluates the forces there.
    pub(super) fn next_stage(&mut self, ahead: R, recorder: &mut Recorder<'_>) {
        let SchemeWorkspace { position, velocity, force, .. } = self.workspace;
        for ((position, start), velocity) in position.iter_mut().zip(&self.substep.state.position).zip(velocity.iter())
        {
            *position = *start + *velocity * ahead;
        }
        velocity.copy_from_slice(&self.substep.state.velocity);
        kick(self.substep.model, self.substep.plan.simd, &self.substep.state.bodies, ahead, force, velocity);
        let at = Configuration { position, velocity, residual: None };
        forces::evaluate(self.substep, at, force, None, self.forces, recorder);
        for (force, held) in force.iter_mut().zip(self.thesis_force.into_iter().flatten()) {
            *force += *held;
        }
        self.add_contact_forces();
        recorder.enter(Stage::Integrate);
    }

    /// Adds the mean force by which contact changed the predicted velocities.
    fn add_contact_forces(&mut self) {
        let SchemeWorkspace { predicted, after_contact, force, .. } = self.workspace;
        for body in awake(self.substep.model, &self.substep.state.bodies) {
            for (local, particle) in body.particles.clone().enumerate() {
                force[particle] +=
                    (after_contact[particle] - predicted[particle]) * (body.mass(local) / self.substep.dt);
            }
        }
    }
}

/// Returns how long the forces at the state act on its velocities to give those at the end of a substep, s.
pub(in crate::physics) fn kick_secs<R: Real>(Substep { plan, state, dt, scheme, .. }: Substep<'_, R>) -> R {
    let is_leapfrog = state.velocity_lag_secs > 0.0 || starts_on_time(plan.scheme);
    match scheme {
        Scheme::Verlet => verlet::kick_secs(dt, state),
        Scheme::SemiImplicit if is_leapfrog => verlet::kick_secs(dt, state),
        _ => dt,
    }
}

/// Whether velocities that semi-implicit Euler leaves half a part behind are brought up to time before a scheme takes over.
/// From late ones a Runge–Kutta scheme would go on with an error of the first order: a vibration would gain or lose energy each
/// time that contact comes near and goes. The other schemes are of the first order themselves, or damp vibrations.
pub(in crate::physics) fn starts_on_time(scheme: Scheme) -> bool {
    matches!(scheme, Scheme::Rk2 | Scheme::Rk4)
}

/// Whether particles move with another velocity than that at the end of the substep.
pub(in crate::physics) fn moves_by_mean(scheme: Scheme) -> bool {
    matches!(scheme, Scheme::Explicit | Scheme::Rk2 | Scheme::Rk4 | Scheme::Stabilised)
}

/// `v += dt a` for every particle that is not pinned, where `a` is the force over the mass; pinned ones stand still.
pub(super) fn kick<R: Real>(
    model: &Model<R>,
    level: SimdLevel,
    memory: &[BodyMemory],
    dt: R,
    force: &[R::Vec3],
    velocity: &mut [R::Vec3],
) {
    for body in awake(model, memory) {
        let own = body.particles.clone();
        kick_particles(body, 0..own.len(), level, dt, &force[own.clone()], &mut velocity[own]);
    }
}
