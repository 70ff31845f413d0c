//! Contacts of points among the equations of the implicit integrator: each is one constraint on a weighted sum of velocities.

use glam::DVec3;

use super::constraint::PointConstraint;
use super::movers::Movers;
use crate::math::{Real, Vector};
use crate::physics::contact::ContactConstraint;
use crate::physics::model::Model;
use crate::physics::state::State;

/// What touches in a contact of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::physics) enum Touching {
    /// A point of the first body, and a cell of the second.
    Bodies([usize; 2]),
    /// A point of the mesh of a body, and an obstacle.
    MeshAtObstacle(usize),
}

impl Touching {
    /// The bodies that the contact pushes; the same twice where there is only one.
    pub(in crate::physics) fn bodies(self) -> [usize; 2] {
        match self {
            Self::Bodies(bodies) => bodies,
            Self::MeshAtObstacle(body) => [body; 2],
        }
    }
}

/// Most particles that a contact of a particle in a cell weighs.
const WEIGHTS_A_CONTACT: usize = 9;

/// Bytes of a contact among the equations.
pub(in crate::physics) const BYTES_A_CONTACT: usize =
    size_of::<WeightedConstraint>() + WEIGHTS_A_CONTACT * size_of::<(u32, f64)>();

/// A contact of a point among the equations.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics) struct WeightedConstraint {
    /// Its place among the contacts.
    pub(in crate::physics) number: u32,
    /// What touches.
    pub(in crate::physics) touching: Touching,
    /// Whether it keeps the point from getting deeper. Where few particles of a held cell are free these would be thrown
    /// ([`super::constraint`]); there the spring alone pushes.
    pub(in crate::physics) has_depth_limit: bool,
    first_weight: u32,
    weight_count: u32,
    pub(in crate::physics) constraint: ContactConstraint,
}

impl WeightedConstraint {
    /// The free particles whose velocities it weighs, with their weights: entries of [`WeightedConstraints::weights`].
    pub(in crate::physics) fn own<'a>(&self, weights: &'a [(u32, f64)]) -> &'a [(u32, f64)] {
        &weights[self.first_weight as usize..][..self.weight_count as usize]
    }

    /// The weighted sum of some vectors of all particles.
    pub(in crate::physics) fn sum(&self, weights: &[(u32, f64)], of: &[DVec3]) -> DVec3 {
        self.own(weights).iter().fold(DVec3::ZERO, |sum, &(particle, weight)| sum + of[particle as usize] * weight)
    }
}

/// The contacts of points in a substep among the equations.
#[derive(Clone, Debug, Default)]
pub(in crate::physics) struct WeightedConstraints {
    pub(in crate::physics) all: Vec<WeightedConstraint>,
    pub(in crate::physics) weights: Vec<(u32, f64)>,
}

impl WeightedConstraints {
    /// Forgets all.
    pub(in crate::physics::contact) fn clear(&mut self) {
        self.all.clear();
        self.weights.clear();
    }

    /// Makes room for so many contacts.
    pub(in crate::physics::contact) fn make_room(&mut self, contacts: usize) {
        self.all.reserve(contacts);
        self.weights.reserve(WEIGHTS_A_CONTACT * contacts);
    }

    /// Adds a contact as it is when a substep begins.
    pub(in crate::physics::contact) fn add<R: Real>(
        &mut self,
        point: &PointConstraint,
        touching: Touching,
        movers: &Movers,
        (model, state): (&Model<R>, &State<R>),
    ) {
        let size =
            touching.bodies().map(|body| model.bodies[body].size.to_f64()).into_iter().fold(f64::INFINITY, f64::min);
        let free = movers.weighted_movers(point.shares()).filter(|(mover, _)| mover.mobility > 0.0);
        let first = self.weights.len();
        self.weights.extend(free.map(|(mover, weight)| (mover.particle, weight)));
        #[expect(clippy::cast_possible_truncation, reason = "contacts are counted in 32 bits, and weigh few particles")]
        let [first_weight, weight_count, number] =
            [first, self.weights.len() - first, self.all.len()].map(|count| count as u32);
        let velocity = self.weights[first..]
            .iter()
            .fold(DVec3::ZERO, |sum, &(particle, weight)| sum + state.velocity[particle as usize].to_dvec3() * weight);
        let constraint = point.in_equations(velocity, movers, size);
        let has_depth_limit = !point.throws();
        self.all.push(WeightedConstraint { number, touching, has_depth_limit, first_weight, weight_count, constraint });
    }

    /// Hands over to contacts, whose equations begin at the place `first`, what was solved for: their impulses, and the
    /// velocities of particles, m/s.
    pub(in crate::physics::contact) fn finish<R: Real>(
        &self,
        first: usize,
        points: &mut [PointConstraint],
        movers: &mut Movers,
        velocity: &[R::Vec3],
    ) {
        for (point, solved) in points.iter_mut().zip(&self.all[first..]) {
            point.take_impulse(solved.constraint.solved_impulse());
        }
        for (mover, now) in movers.all.iter().zip(&mut movers.velocity).filter(|(mover, _)| mover.mobility > 0.0) {
            *now = velocity[mover.particle as usize].to_dvec3();
        }
    }
}
