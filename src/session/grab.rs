//! Pulling a body by a point: from what a hand asks for to the spring the simulation takes.

use super::{Pull, Session, SessionError};
use crate::math::Vector;
use crate::physics::Grab;

/// Stiffness of the pull over the body's mass, 1/s²: a metre of it holds fifteen times the body's weight.
const STIFFNESS_OVER_MASS: f32 = 150.0;

impl Session {
    /// Begins a pull, moves it on, or lets go.
    pub(super) fn grab(&mut self, pull: Option<Pull>) -> Result<(), SessionError> {
        let Some(pull) = pull else {
            self.simulation.set_grab(None);
            return Ok(());
        };
        let Some(body) = self.simulation.model().bodies.get(pull.body.0) else { return Err(SessionError::Pull) };
        let within = pull
            .weights
            .iter()
            .all(|(particle, weight)| body.particles.contains(&(*particle as usize)) && weight.is_finite());
        let target = glam::Vec3::from(pull.target);
        if !within || !Vector::is_finite(target) {
            return Err(SessionError::Pull);
        }
        let stiffness = STIFFNESS_OVER_MASS * body.particle_mass * body.particles.len() as f32;
        let weights = pull.weights.iter().map(|&(particle, weight)| (particle as usize, weight)).collect();
        self.simulation.set_grab(Some(Grab { body: pull.body.0, weights, target, stiffness }));
        Ok(())
    }
}
