//! The points of a body that meet the cells of others: the particles on its outside, or points of its mesh.

use glam::DVec3;

use super::cell::Cell;
use crate::math::Real;
use crate::physics::contact::weighted::WeightedParticles;
use crate::physics::model::{BodyModel, Hull, Model, Samples};
use crate::physics::state::press::BodyPoint;

/// The points of a body that meet others, or itself.
#[derive(Clone, Copy, Debug)]
pub(super) enum SurfacePoints<'a> {
    /// The particles on its outside.
    Particles(&'a Hull),
    /// Points of its mesh, each carried by a cell.
    Mesh(&'a Samples),
}

impl<'a> SurfacePoints<'a> {
    /// The points of the first of a pair of bodies that meet the second.
    pub(super) fn of<R: Real>(model: &'a Model<R>, [points, cells]: [usize; 2]) -> Self {
        let body = &model.bodies[points];
        // Contact of a body with itself leaves out the cells around each point, which are known for particles only.
        let samples = body.samples_among_bodies().filter(|_| points != cells);
        samples.map_or_else(|| Self::Particles(body.hull()), Self::Mesh)
    }

    /// The numbers of its points.
    pub(super) fn numbers(self) -> impl Iterator<Item = u32> + use<'a> {
        #[expect(clippy::cast_possible_truncation, reason = "points are counted in 32 bits")]
        let all = 0..self.count() as u32;
        all.filter(move |number| match self {
            Self::Particles(_) => true,
            Self::Mesh(samples) => samples.is_in_its_cell(*number as usize),
        })
    }

    /// How many there are at most.
    pub(super) fn count(self) -> usize {
        match self {
            Self::Particles(hull) => hull.points.len(),
            Self::Mesh(samples) => samples.count(),
        }
    }

    /// Where a point is, of a body whose particles are at `own`, m.
    pub(super) fn position(self, number: u32, own: &[DVec3]) -> DVec3 {
        match self {
            Self::Particles(hull) => own[hull.points[number as usize] as usize],
            Self::Mesh(samples) => {
                let (carriers, weights) = samples.point(number as usize);
                let weighed = carriers.iter().zip(weights);
                weighed.fold(DVec3::ZERO, |sum, (carrier, weight)| sum + own[*carrier as usize] * *weight)
            }
        }
    }

    /// Whether the cell with this lowest corner belongs to a point, so that the two do not meet in contact of a body with itself.
    pub(super) fn touch(self, number: u32, low: [u32; 3]) -> bool {
        match self {
            Self::Particles(hull) => hull.surroundings[number as usize].contains(low),
            Self::Mesh(_) => false,
        }
    }

    /// The outward direction of a point, of length 1: away from the middle of the cells around a particle, or along the normal of
    /// a mesh that has an inside. Zero where it is not known.
    pub(super) fn outward<R: Real>(self, body: &BodyModel<R>, number: u32, at: DVec3, own: &[DVec3]) -> DVec3 {
        let away = |corners: &mut dyn Iterator<Item = u32>| {
            let (sum, count) = corners.fold((DVec3::ZERO, 0.0), |(sum, count), p| (sum + own[p as usize], count + 1.0));
            (at - sum / count).normalize_or_zero()
        };
        match self {
            Self::Particles(hull) => {
                let around = hull.cells_around(number as usize).iter();
                away(&mut around.flat_map(|cell| body.lattice.cells[*cell as usize]))
            }
            Self::Mesh(samples) => {
                let (carriers, weights) = samples.point(number as usize);
                let Some(normal) = samples.normal(number as usize) else { return away(&mut carriers.iter().copied()) };
                let cell = Cell(carriers.map(|carrier| own[carrier as usize]));
                let layers = cell.jacobian(place(weights)).inverse().transpose();
                (layers * normal).normalize_or_zero()
            }
        }
    }

    /// Which point it is, and the particles that carry it, in a body whose first particle is `start`.
    pub(super) fn carried(self, number: u32, start: usize) -> (BodyPoint, WeightedParticles) {
        match self {
            Self::Particles(hull) => {
                let particle = start + hull.points[number as usize] as usize;
                (BodyPoint::Particle(particle), WeightedParticles::one(particle))
            }
            Self::Mesh(samples) => {
                let (carriers, weights) = samples.point(number as usize);
                let carriers = carriers.map(|carrier| start + carrier as usize);
                (BodyPoint::OfMesh(number as usize), WeightedParticles::of_cell(carriers, *weights))
            }
        }
    }
}

/// The place in a cell with these weights of its corners.
fn place(weights: &[f64; 8]) -> DVec3 {
    let along = |axis: usize| weights.iter().enumerate().filter(move |(corner, _)| corner >> axis & 1 == 1);
    DVec3::from([0, 1, 2].map(|axis| along(axis).map(|(_, weight)| weight).sum::<f64>()))
}
