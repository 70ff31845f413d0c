//! How far every mode of a body is from rest and how fast it goes, and where it is where nothing holds it.

use super::rigid::RigidState;
use crate::physics::model::ModalModel;

/// The motion of a modal body; of no length where it moves by its cells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModalState {
    /// `q`, m √kg.
    pub amplitude: Vec<f64>,
    /// `q'` as the next substep begins with it, m √kg / s: what has just been pushed may have one that its weight takes back.
    pub rate: Vec<f64>,
    /// What it was on the whole in the last substep: this is how fast the body is seen to move.
    pub mean_rate: Vec<f64>,
    /// Where it is as a whole; none of a body that is held.
    pub rigid: Option<RigidState>,
}

impl ModalState {
    /// So many modes at rest, of a body that is held.
    pub fn at_rest(count: usize) -> Self {
        Self { amplitude: vec![0.0; count], rate: vec![0.0; count], mean_rate: vec![0.0; count], rigid: None }
    }

    /// Nothing is seen to move.
    pub(in crate::physics) fn rest(&mut self) {
        self.mean_rate.fill(0.0);
        if let Some(rigid) = &mut self.rigid {
            (rigid.mean_velocity, rigid.mean_spin) = Default::default();
        }
    }

    /// Everything stops where it is.
    pub(in crate::physics) fn stop(&mut self) {
        self.rate.fill(0.0);
        self.mean_rate.fill(0.0);
        self.rigid.iter_mut().for_each(RigidState::stop);
    }

    /// The energy of the swing, J: kinetic and elastic.
    pub fn energy(&self, modes: &ModalModel) -> [f64; 2] {
        let kinetic = self.rate.iter().map(|v| 0.5 * v * v).sum();
        let swings = modes.rates().iter().zip(&self.amplitude).map(|([omega, _], q)| omega * q);
        [kinetic, swings.map(|swing| 0.5 * swing * swing).sum()]
    }
}
