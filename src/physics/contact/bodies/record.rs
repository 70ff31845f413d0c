//! A contact of one point of a body and the cell of another that it met.

use glam::DVec3;

use crate::math::{Real, Vector};
use crate::physics::state::State;
use crate::physics::state::press::BodyPoint;

/// A point of one body that met a cell of another in the last substep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyContact {
    /// The body that the point is of, and the one that the cell is of.
    pub bodies: [usize; 2],
    /// The point.
    pub point: BodyPoint,
    /// The particles that carry it.
    pub own: WeightedParticles,
    /// The particles of the cell: their weighted mean is where the point is.
    pub cell: WeightedParticles,
    /// Unit normal, out of the cell's body.
    pub normal: DVec3,
    /// Distance from the cell's body along the normal when the substep began, m; negative inside.
    pub gap: f64,
    /// How far it was to a nearer side by which the point was not let out, m: that of a thin body it is most of the way through.
    pub nearer: Option<f64>,
    /// Mean force on the point over the substep, normal and friction, N; the cell has the opposite.
    pub force: DVec3,
    /// The most work that its spring and being parted can do in the substep, J.
    pub max_work_j: f64,
}

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
    pub(super) fn one(particle: usize) -> Self {
        let mut weights = [0.0; 8];
        weights[0] = 1.0;
        Self { particles: [particle; 8], weights, count: 1 }
    }

    /// The eight of a cell.
    pub(super) fn of_cell(particles: [usize; 8], weights: [f64; 8]) -> Self {
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
