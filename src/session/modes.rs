//! How a body of the sandbox swings ([`crate::modal`]), and what that looks like.

use super::Session;
use crate::geometry::Watch;
use crate::machine;
use crate::math::rotation::from_euler_deg;
use crate::modal::{self, ModalError, Mode, Modes, Wanted};

/// How far the farthest particle of a body that is bent to be looked at is from its start, over the size of the body.
const BENT_SHARE: f64 = 0.15;

impl Session {
    /// The lowest modes of a body about its form at rest.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn modes(&self, body: usize, count: usize, watch: &dyn Watch) -> Result<Modes, ModalError> {
        let most_bytes = machine::free_memory().map_or(u64::MAX, |free| free.bytes);
        modal::modes(&self.simulation.model().bodies[body], Wanted { count, most_bytes }, watch)
    }

    /// Puts a body to its start, at rest and bent by one of its modes.
    ///
    /// # Panics
    /// If there is no such body, or the mode is another's.
    pub fn bend(&mut self, body: usize, mode: &Mode) {
        let model = &self.simulation.model().bodies[body];
        let turn = from_euler_deg(self.scene.bodies[body].pose.rotation_deg);
        let scale = if mode.reach() > 0.0 { BENT_SHARE * f64::from(model.size) / mode.reach() } else { 0.0 };
        let mut state = self.simulation.state().clone();
        for ((particle, start), way) in model.particles.clone().zip(&model.start).zip(&mode.shape) {
            state.position[particle] = *start + (turn * *way * scale).as_vec3();
            state.velocity[particle] = glam::Vec3::ZERO;
        }
        self.simulation.set_state(state);
    }
}
