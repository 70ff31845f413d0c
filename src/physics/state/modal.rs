//! The motion of a modal body: amplitudes and rates of its modes, and the rigid motion of a free body.

use super::rigid::RigidState;
use crate::physics::model::ModalModel;

/// The motion of a modal body; empty where a body moves by its cells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModalState {
    /// `q`, m √kg.
    pub amplitude: Vec<f64>,
    /// `q'` at the start of the next substep, m √kg / s. It need not be zero in a body at rest: the weight takes back what
    /// contact has just pushed.
    pub rate: Vec<f64>,
    /// The mean of `q'` over the last substep: the speed that is shown.
    pub mean_rate: Vec<f64>,
    /// The rigid motion; none where the body is held.
    pub rigid: Option<RigidState>,
}

impl ModalState {
    /// A held body with `count` modes at rest.
    pub fn at_rest(count: usize) -> Self {
        Self { amplitude: vec![0.0; count], rate: vec![0.0; count], mean_rate: vec![0.0; count], rigid: None }
    }

    /// Sets the mean rates to zero: nothing is seen to move.
    pub(in crate::physics) fn rest(&mut self) {
        self.mean_rate.fill(0.0);
        if let Some(rigid) = &mut self.rigid {
            (rigid.mean_velocity, rigid.mean_spin) = Default::default();
        }
    }

    /// Stops all motion in place.
    pub(in crate::physics) fn stop(&mut self) {
        self.rate.fill(0.0);
        self.mean_rate.fill(0.0);
        self.rigid.iter_mut().for_each(RigidState::stop);
    }

    /// The kinetic and the elastic energy of the modes, J.
    pub fn energy(&self, modes: &ModalModel) -> [f64; 2] {
        let kinetic = self.rate.iter().map(|v| 0.5 * v * v).sum();
        let swings = modes.rates().iter().zip(&self.amplitude).map(|([omega, _], q)| omega * q);
        [kinetic, swings.map(|swing| 0.5 * swing * swing).sum()]
    }
}
