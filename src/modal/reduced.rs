//! The modes as the physics takes them: plain numbers in the precision with which it moves a body.

use std::sync::Arc;

use super::Modes;
use crate::math::Real;
use crate::physics::{BodyModel, ModalModel};

impl Modes {
    /// Returns the modes of a compiled body as the model that the physics moves it with.
    pub fn reduced<R: Real>(&self, body: &BodyModel<R>) -> Arc<ModalModel> {
        let rates = self.modes.iter().map(|mode| [mode.angular_frequency(), mode.damping]).collect();
        let row = |particle: usize| self.modes.iter().map(move |mode| mode.shape[particle].as_vec3().to_array());
        let shapes = (0..body.start.len()).flat_map(row).collect();
        Arc::new(ModalModel::new(&masses(body), rates, shapes))
    }
}

/// The masses of a body's particles, kg.
pub fn masses<R: Real>(body: &BodyModel<R>) -> Vec<f64> {
    (0..body.start.len()).map(|particle| body.mass(particle).to_f64()).collect()
}
