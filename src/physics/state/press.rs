//! Contact springs between bodies, as the state remembers them.

use crate::math::Real;
use crate::physics::model::Model;

/// A point of a body that meets others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BodyPoint {
    /// A particle, in the state's arrays.
    Particle(usize),
    /// A point of its mesh, by its number among those of the body.
    OfMesh(usize),
}

/// A contact spring between a point of a body and another body. The relative motion of the two presses it, not their
/// position: a point that finds itself deep inside another body has pressed nothing yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Press {
    /// The body of the point, and the one that it is in.
    pub bodies: [usize; 2],
    /// The point.
    pub point: BodyPoint,
    /// How far it is pressed together, m; no less than nothing.
    pub depth_m: f64,
}

impl Press {
    /// Whether a model can have this spring: of a particle where its body meets others with its cells, or itself; otherwise
    /// of a point that its mesh has. Both bodies must be in the model.
    pub fn fits<R: Real>(&self, model: &Model<R>) -> bool {
        let [own, other] = self.bodies;
        let body = &model.bodies[own];
        match (self.point, body.samples_among_bodies().filter(|_| own != other)) {
            (BodyPoint::Particle(particle), None) => body.particles.contains(&particle),
            (BodyPoint::OfMesh(number), Some(samples)) => number < samples.count(),
            _ => false,
        }
    }

    /// The key that springs are sorted by.
    pub(in crate::physics) fn place(&self) -> (usize, BodyPoint, usize) {
        (self.bodies[0], self.point, self.bodies[1])
    }
}
