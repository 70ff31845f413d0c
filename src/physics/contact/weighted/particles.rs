//! The particles that carry a point, with their weights.

use glam::DVec3;

use crate::math::{Real, Vector};
use crate::physics::state::State;

/// Up to eight particles with weights that sum to one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedParticles {
    /// The particles, in the state's arrays.
    particles: [usize; 8],
    weights: [f64; 8],
    count: usize,
}

impl WeightedParticles {
    /// One particle alone.
    pub(in crate::physics::contact) fn one(particle: usize) -> Self {
        let mut weights = [0.0; 8];
        weights[0] = 1.0;
        Self { particles: [particle; 8], weights, count: 1 }
    }

    /// The eight of a cell.
    pub(in crate::physics::contact) fn of_cell(particles: [usize; 8], weights: [f64; 8]) -> Self {
        Self { particles, weights, count: 8 }
    }

    /// The particles with their weights.
    pub fn iter(&self) -> impl Iterator<Item = (usize, f64)> + Clone {
        self.particles[..self.count].iter().copied().zip(self.weights[..self.count].iter().copied())
    }

    /// Where their mean is, m.
    pub fn place<R: Real>(&self, state: &State<R>) -> DVec3 {
        self.mean(|particle| state.position[particle].to_dvec3())
    }

    /// The mean of something that each of them has.
    pub(in crate::physics) fn mean(&self, of: impl Fn(usize) -> DVec3) -> DVec3 {
        // The mean of one particle is its value to the last bit, also where that is not finite.
        if self.count == 1 {
            return of(self.particles[0]);
        }
        self.iter().fold(DVec3::ZERO, |sum, (particle, weight)| sum + of(particle) * weight)
    }
}
