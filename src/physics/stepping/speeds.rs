//! How fast the particles of each body move, and past each other.

use std::ops::Range;

use crate::math::{Aabb, Real, Vector};
use crate::physics::kernels;
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Model};
use crate::physics::state::State;
use crate::physics::team;

/// Particles whose velocities are looked at together, by one thread.
const GROUP_PARTICLES: usize = 2048;

/// Bounds on the velocities of each body as a part of a substep begins. Workspace: nothing in it lasts.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Speeds<R: Real> {
    /// The box around the velocities of each body's particles, m/s.
    pub(in crate::physics) velocity_bounds: Vec<Aabb<R>>,
    /// How fast the particles of each body move past each other at most, m/s.
    pub(in crate::physics) relative: Vec<f64>,
    /// Whether these are of the present velocities.
    are_current: bool,
    /// The bodies cut into groups of particles, and the box around the velocities of each.
    groups: Vec<(usize, Range<usize>)>,
    group_bounds: Vec<Aabb<R>>,
}

impl<R: Real> Speeds<R> {
    /// Room for the bodies of a model.
    pub(in crate::physics) fn new(model: &Model<R>) -> Self {
        let bodies = model.bodies.len();
        // Particles of modal bodies are not checked.
        let checked = model.bodies.iter().enumerate().filter(|(_, body)| body.modal.is_none());
        let groups: Vec<_> = checked
            .flat_map(|(number, body)| {
                let own = body.particles.clone();
                let group = move |first| (number, first..own.end.min(first + GROUP_PARTICLES));
                body.particles.clone().step_by(GROUP_PARTICLES).map(group)
            })
            .collect();
        Self {
            velocity_bounds: Vec::with_capacity(bodies),
            relative: Vec::with_capacity(bodies),
            are_current: false,
            group_bounds: vec![Aabb::empty(); groups.len()],
            groups,
        }
    }

    /// Says that velocities have changed since they were measured.
    pub(in crate::physics) fn forget(&mut self) {
        self.are_current = false;
    }

    /// Measures those of a state, if velocities have changed since that was done.
    pub(in crate::physics) fn measure(&mut self, model: &Model<R>, plan: &Plan, state: &State<R>) {
        if self.are_current {
            return;
        }
        let groups = &self.groups;
        let mean = (model.particle_count() / groups.len().max(1)).clamp(1, GROUP_PARTICLES);
        team::by_groups(plan.threads, mean, &mut self.group_bounds, |these, bounds| {
            for ((_, particles), bounds) in groups[these].iter().zip(bounds) {
                *bounds = kernels::bounds::<R>(plan.simd, &state.velocity[particles.clone()]);
            }
        });
        // A body of which no particle is checked counts as still.
        let is_checked = |body: &BodyModel<R>| body.modal.is_none() && !body.particles.is_empty();
        let begin = |body| if is_checked(body) { Aabb::empty() } else { Aabb::around([R::Vec3::ZERO]) };
        self.velocity_bounds.clear();
        self.velocity_bounds.extend(model.bodies.iter().map(begin));
        for ((body, _), bounds) in self.groups.iter().zip(&self.group_bounds) {
            self.velocity_bounds[*body] = self.velocity_bounds[*body].joined(*bounds);
        }
        self.relative.clear();
        self.relative.extend(self.velocity_bounds.iter().map(max_relative_speed_in));
        self.are_current = true;
    }
}

/// A bound on the relative speed of any two of some particles with these velocities, m/s.
pub(super) fn max_relative_speed_of<R: Real>(plan: &Plan, velocity: &[R::Vec3]) -> f64 {
    if velocity.is_empty() { 0.0 } else { max_relative_speed_in(&kernels::bounds::<R>(plan.simd, velocity)) }
}

/// The same of particles whose velocities are in a box. Bounds of the components are cheap.
fn max_relative_speed_in<R: Real>(bounds: &Aabb<R>) -> f64 {
    (bounds.max - bounds.min).length().to_f64()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::DVec3;

    use super::*;
    use crate::math::rng::Rng;
    use crate::physics::Simulation;
    use crate::scene::body::CubeShape;
    use crate::scene::{Body, Scene, Shape};

    #[test]
    fn bounds_are_around_the_velocities_of_each_body_until_these_are_forgotten() {
        let cube = |cells| Body { shape: Shape::Cube(CubeShape { cells, size: 1.0 }), ..Body::default() };
        let scene = Scene { bodies: vec![cube(17), cube(3)], ..Scene::default() };
        let mut simulation = Simulation::<f64>::from_scene(&scene, Path::new(".")).expect("cubes");
        simulation.set_threads(2);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
        let (model, plan, mut state) = (simulation.model(), simulation.plan(), simulation.state().clone());
        let mut speeds = Speeds::new(model);
        assert!(speeds.groups.len() > model.bodies.len(), "a body of several groups, which threads share");
        let mut rng = Rng::new(5);
        for _ in 0..3 {
            let before = speeds.velocity_bounds.clone();
            state.velocity.fill_with(|| DVec3::from_array([0; 3].map(|_| rng.between(-2.0, 3.0))));
            if !before.is_empty() {
                pool.install(|| speeds.measure(model, plan, &state));
                assert_eq!(speeds.velocity_bounds, before, "nobody said that velocities changed");
            }
            speeds.forget();
            pool.install(|| speeds.measure(model, plan, &state));
            for (number, body) in model.bodies.iter().enumerate() {
                let own = state.velocity[body.particles.clone()].iter().copied();
                let bounds = Aabb::around(own);
                assert_eq!(speeds.velocity_bounds[number], bounds, "body {number}");
                let off = speeds.relative[number] - (bounds.max - bounds.min).length();
                assert!(off.abs() < 1e-12, "body {number}: {off} m/s");
            }
        }
    }
}
