//! The points of a body that meet obstacles: its particles, or points of its mesh.

use glam::DVec3;

use super::way::free_particles;
use crate::math::{Real, Vector};
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Model, Samples};

/// The points of a body that meet obstacles, where they are.
pub(in crate::physics::contact) struct MeetingPoints<'a, R: Real> {
    pub(super) model: &'a Model<R>,
    /// The number of the body.
    pub(super) number: usize,
    pub(super) body: &'a BodyModel<R>,
    /// The positions of all particles, m.
    pub(super) position: &'a [R::Vec3],
    /// The points of its mesh, where those meet obstacles.
    samples: Option<&'a Samples>,
    /// Which of its particles carry such points; empty where there are none.
    is_carrier: Vec<bool>,
}

impl<'a, R: Real> MeetingPoints<'a, R> {
    pub(in crate::physics::contact) fn new(
        model: &'a Model<R>,
        plan: &Plan,
        number: usize,
        position: &'a [R::Vec3],
    ) -> Self {
        let body = &model.bodies[number];
        let samples = body.samples.as_deref().filter(|_| plan.on_mesh.is_some());
        let mut is_carrier = vec![false; if samples.is_some() { body.particles.len() } else { 0 }];
        for carrier in samples.iter().flat_map(|samples| &samples.cells).flat_map(|cell| cell.carriers) {
            is_carrier[carrier as usize] = true;
        }
        Self { model, number, body, position, samples, is_carrier }
    }

    /// Whether the points are those of the body's mesh.
    pub(super) fn are_on_mesh(&self) -> bool {
        self.samples.is_some()
    }

    /// The middle of the body's particles, m.
    pub(super) fn middle(&self) -> DVec3 {
        let sum: DVec3 = self.body.particles.clone().map(|particle| self.position[particle].to_dvec3()).sum();
        sum / self.body.particles.len().max(1) as f64
    }

    /// The points that are free to move, with their numbers: those of particles in the state, or of mesh points in the body.
    pub(super) fn free_points(&self) -> impl Iterator<Item = (usize, R::Vec3)> {
        let particles = free_particles(self.body).filter(|_| self.samples.is_none());
        let particles = particles.map(|particle| (particle, self.position[particle]));
        let samples = self.samples.into_iter().flat_map(|samples| (0..samples.count()).map(move |of| (samples, of)));
        let samples = samples.filter_map(|(samples, of)| {
            let (carriers, weights) = samples.point(of);
            let is_free = carriers.iter().any(|carrier| !self.body.is_pinned(*carrier as usize));
            is_free.then(|| {
                let terms = carriers.iter().zip(weights);
                (of, R::Vec3::from_dvec3(terms.map(|(at, weight)| self.local_position(*at).to_dvec3() * *weight).sum()))
            })
        });
        particles.chain(samples)
    }

    /// Lines through the body that no obstacle may cut: its links. Where its mesh meets obstacles, only links within, and lines
    /// from points to the middles of their cells: corners of cells may reach through an obstacle that the mesh does not touch.
    pub(super) fn lines(&self) -> impl Iterator<Item = [R::Vec3; 2]> {
        let links = self.body.links.iter().flat_map(|family| family.links.iter());
        let within = links.filter(|link| !link.ends.iter().any(|end| self.carries(*end)));
        let links = within.map(|link| link.ends.map(|end| self.local_position(end)));
        let inwards =
            self.samples.into_iter().flat_map(|samples| self.free_points().map(move |point| (samples, point)));
        let inwards = inwards.map(|(samples, (of, at))| {
            let carriers = samples.point(of).0.iter();
            let sum = carriers.fold(R::Vec3::ZERO, |sum, carrier| sum + self.local_position(*carrier));
            [at, sum * R::from_f64(0.125)]
        });
        links.chain(inwards)
    }

    fn carries(&self, particle: u32) -> bool {
        self.is_carrier.get(particle as usize) == Some(&true)
    }

    fn local_position(&self, particle: u32) -> R::Vec3 {
        self.position[self.body.particles.start + particle as usize]
    }
}
