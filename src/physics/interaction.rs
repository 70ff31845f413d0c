//! A hand in the simulation: a spring from a point of a body to a place. [`super::step::pull`] applies it.

use super::model::BodyModel;
use crate::math::{Real, Vector};

/// A pull at a point of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Grab<R: Real> {
    /// The body pulled at.
    pub body: usize,
    /// The particles that carry the point (numbers in the state's arrays) and their weights, which sum to 1.
    pub weights: Vec<(usize, R)>,
    /// Where the point is pulled to, m.
    pub target: R::Vec3,
    /// Stiffness of the pull, N/m; its damping is half the critical one of the whole body on that spring.
    pub stiffness: R,
}

impl<R: Real> Grab<R> {
    /// The weighted mean of a quantity over the grabbed particles, from the values of the body's particles; `first` is the
    /// first of these.
    pub(super) fn mean_of(&self, of_body: &[R::Vec3], first: usize) -> R::Vec3 {
        self.weights.iter().fold(R::Vec3::ZERO, |sum, &(particle, weight)| sum + of_body[particle - first] * weight)
    }

    /// Damping of the pull, N·s/m.
    pub(super) fn damping(&self, body: &BodyModel<R>) -> R {
        (self.stiffness * body.total_mass()).sqrt()
    }

    /// The grabbed point's position (m) or velocity (m/s), from that of all particles.
    pub fn point(&self, of_all: &[R::Vec3]) -> R::Vec3 {
        self.mean_of(of_all, 0)
    }
}

/// The resistance of an implicit pull to the speed of its point, N·s/m: its damping, and its stiffness times the substep
/// `dt` (s).
pub(super) fn resistance<T: Real>([stiffness, damping]: [T; 2], dt: T) -> T {
    dt * stiffness + damping
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::DVec3;

    use super::*;
    use crate::physics::Simulation;
    use crate::scene::resolve::resolve;
    use crate::scene::{Body, Scene};

    fn cube() -> Simulation<f64> {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        scene.settings.gravity = [0.0; 3];
        let jelly = resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube");
        Simulation::new(&scene, &[jelly.lattice])
    }

    fn corner_pull(stiffness: f64, target: DVec3) -> Grab<f64> {
        Grab { body: 0, weights: vec![(0, 0.25), (1, 0.75)], target, stiffness }
    }

    #[test]
    fn a_body_comes_to_the_hand_and_rests_there() {
        let mut simulation = cube();
        let target = DVec3::new(1.0, 0.5, 0.2);
        simulation.set_grab(Some(corner_pull(1500.0, target)));
        (0..8000).for_each(|_| assert!(!simulation.step().diverged, "a pull is stable"));
        let left = corner_pull(0.0, target).point(&simulation.state().position).distance(target);
        assert!(left < 0.02, "the point is {left} m from the hand after 8 s");
    }

    #[test]
    fn no_strength_is_unstable() {
        for stiffness in [1e-3, 1.0, 1e6, 1e12] {
            let mut simulation = cube();
            simulation.set_grab(Some(corner_pull(stiffness, DVec3::Y * 3.0)));
            (0..2000).for_each(|_| assert!(!simulation.step().diverged, "a pull of {stiffness} N/m is stable"));
            let speed = simulation.diagnostics().max_speed;
            assert!(speed < 1e3, "a pull of {stiffness} N/m ends with {speed} m/s");
        }
    }

    #[test]
    fn a_pull_changes_momentum_by_its_impulse_and_letting_go_ends_it() {
        let mut simulation = cube();
        simulation.set_grab(Some(corner_pull(100.0, DVec3::Y * 3.0)));
        simulation.run_for(0.012);
        let pulled = simulation.diagnostics().momentum;
        assert!(pulled.y > 0.0, "it is pulled up: {pulled:?}");
        simulation.set_grab(None);
        (0..100).for_each(|_| assert!(!simulation.step().diverged, "still stable"));
        let free = simulation.diagnostics().momentum;
        assert!(free.distance(pulled) < 1e-9, "nothing pulls any more: {free}");
    }
}
