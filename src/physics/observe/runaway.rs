//! Detects an explosion before its numbers stop being finite, so that it is stopped while there is something to see.

use crate::math::{Aabb, Real, Vector};
use crate::physics::kernels::{SimdLevel, bounds};
use crate::physics::model::Model;

/// A particle that moves by more than this share of its body's size in one step, relative to the body's own motion, has left
/// all bounds: a sound step moves it by a small part of a link.
const MAX_STEP_SHARE: f64 = 0.25;

/// Whether a body is torn apart by a step of `dt` (s) with these velocities (m/s). `known_bounds` returns a box that holds those
/// of a body, and may be larger than the smallest, where one is known.
pub(crate) fn runs_away<R: Real>(
    model: &Model<R>,
    level: SimdLevel,
    dt: R,
    velocity: &[R::Vec3],
    known_bounds: impl Fn(usize) -> Option<Aabb<R>>,
) -> bool {
    model.bodies.iter().enumerate().any(|(number, body)| {
        let own = &velocity[body.particles.clone()];
        let longest = R::from_f64(MAX_STEP_SHARE) * body.size;
        // No velocity is further from their mean than the diagonal of the box around them, which is cheap to find.
        let is_calm = |bounds: Aabb<R>| (bounds.max - bounds.min).length() * dt <= longest;
        if known_bounds(number).is_some_and(is_calm) || is_calm(bounds::<R>(level, own)) {
            return false;
        }
        let sum = own.iter().fold(R::Vec3::ZERO, |sum, v| sum + *v);
        let mean = sum * (R::ONE / R::from_f64(own.len().max(1) as f64));
        let fastest = own.iter().fold(R::ZERO, |fastest, v| fastest.max((*v - mean).length()));
        fastest * dt > longest
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::DVec3;

    use super::*;
    use crate::physics::Simulation;
    use crate::scene::resolve::resolve;
    use crate::scene::{Body, Scene};

    #[test]
    fn a_fast_body_is_sound_and_a_torn_one_is_not() {
        let scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        let jelly = resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube");
        let simulation = Simulation::<f64>::new(&scene, &[jelly.lattice]);
        let level = SimdLevel::best();
        let runs_away = |dt: f64, velocity: &[DVec3]| {
            let around = Aabb::around(velocity.iter().copied());
            let verdicts = [None, Some(around), Some(around.grown(1e5))]
                .map(|known| super::runs_away(simulation.model(), level, dt, velocity, |_| known));
            assert!(verdicts.iter().all(|verdict| *verdict == verdicts[0]), "whatever is known: {verdicts:?}");
            verdicts[0]
        };
        let mut velocity = vec![DVec3::X * 1e4; simulation.model().particle_count()];
        assert!(!runs_away(1e-3, &velocity), "ten metres a step, all together");
        velocity[7].y = 300.0;
        assert!(runs_away(1e-3, &velocity), "0.3 m a step out of a body of 1 m");
        assert!(!runs_away(1e-4, &velocity), "a smaller step can take it");
    }
}
