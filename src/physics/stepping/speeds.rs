//! How fast the particles of each body move, and past each other.

use crate::math::{Aabb, Real, Vector};
use crate::physics::kernels::bounds;
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Model};
use crate::physics::state::State;

/// Bounds on the velocities of each body as a substep begins. Workspace: nothing in it lasts.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Speeds<R: Real> {
    /// The box around the velocities of each body's particles, m/s.
    pub(in crate::physics) velocity_bounds: Vec<Aabb<R>>,
    /// How fast the particles of each body move past each other at most, m/s.
    pub(in crate::physics) relative: Vec<f64>,
}

impl<R: Real> Speeds<R> {
    /// Room for the bodies of a model.
    pub(in crate::physics) fn new(model: &Model<R>) -> Self {
        let bodies = model.bodies.len();
        Self { velocity_bounds: Vec::with_capacity(bodies), relative: Vec::with_capacity(bodies) }
    }

    /// Writes those of a state; none where neither strain nor contact divides substeps.
    pub(super) fn measure(&mut self, model: &Model<R>, plan: &Plan, state: &State<R>) {
        self.velocity_bounds.clear();
        self.relative.clear();
        if plan.parts > 0 || plan.contact_plan().is_some() {
            self.velocity_bounds.extend(model.bodies.iter().map(|body| velocity_bounds(body, plan, state)));
            self.relative.extend(self.velocity_bounds.iter().map(max_relative_speed_in));
        }
    }
}

/// A bound on the relative speed of any two particles of a body, m/s.
pub(in crate::physics) fn max_relative_speed<R: Real>(body: &BodyModel<R>, plan: &Plan, state: &State<R>) -> f64 {
    max_relative_speed_in(&velocity_bounds(body, plan, state))
}

/// The box around the velocities of a body's particles, m/s.
fn velocity_bounds<R: Real>(body: &BodyModel<R>, plan: &Plan, state: &State<R>) -> Aabb<R> {
    // Particles of modal bodies are not checked.
    let own = if body.modal.is_some() { &[][..] } else { &state.velocity[body.particles.clone()] };
    bounds_of(plan, own)
}

/// The same of particles with these velocities, m/s.
pub(super) fn max_relative_speed_of<R: Real>(plan: &Plan, velocity: &[R::Vec3]) -> f64 {
    max_relative_speed_in(&bounds_of::<R>(plan, velocity))
}

/// The same of particles whose velocities are in a box. Bounds of the components are cheap.
fn max_relative_speed_in<R: Real>(bounds: &Aabb<R>) -> f64 {
    (bounds.max - bounds.min).length().to_f64()
}

/// The box around some velocities; a point where there is none.
fn bounds_of<R: Real>(plan: &Plan, velocity: &[R::Vec3]) -> Aabb<R> {
    if velocity.is_empty() {
        return Aabb { min: R::Vec3::ZERO, max: R::Vec3::ZERO };
    }
    bounds::<R>(plan.simd, velocity)
}
