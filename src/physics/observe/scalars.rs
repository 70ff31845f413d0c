//! One number per particle: what a body can be coloured by (GC §9).

use crate::math::{Real, Vector};
use crate::physics::model::{BodyModel, Values};
use crate::physics::observe::link_loads::{link_forces, mean_link_forces};
use crate::physics::simulation::Simulation;

/// A scalar of every particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The mean magnitude of the forces of its links, N.
    MeanLinkForce,
    /// The magnitude of their sum, N.
    LinkForce,
    /// The magnitude of weight, link and contact forces together, N.
    NetForce,
    /// The largest magnitude of strain among its links, %.
    Strain,
    /// The speed, m/s.
    Speed,
    /// The magnitude of the force of obstacles and of other bodies, N.
    ContactForce,
    /// The mean Young's modulus of the cells around it, kPa; of springs, that of the solid whose diagonal links are as stiff.
    Modulus,
}

impl<R: Real> Simulation<R> {
    /// A quantity of every particle, in its unit.
    pub fn scalars(&self, quantity: Quantity) -> Vec<f32> {
        let (model, plan, state) = (self.model(), self.plan(), self.state());
        let shown: Vec<R> = match quantity {
            Quantity::MeanLinkForce => mean_link_forces(model, plan, state),
            Quantity::LinkForce => link_forces(model, plan, state).into_iter().map(Vector::length).collect(),
            Quantity::NetForce => self.net_forces().into_iter().map(Vector::length).collect(),
            Quantity::Strain => self.strains(),
            Quantity::Speed => state.velocity.iter().map(|v| v.length()).collect(),
            Quantity::ContactForce => {
                let mut force = vec![R::Vec3::ZERO; state.position.len()];
                self.add_contact_forces(&mut force);
                force.into_iter().map(Vector::length).collect()
            }
            Quantity::Modulus => model.bodies.iter().flat_map(moduli).map(R::from_f64).collect(),
        };
        #[expect(clippy::cast_possible_truncation, reason = "what is shown needs no more than f32")]
        shown.into_iter().map(|x| x.to_f64() as f32).collect()
    }

    /// Weight, link and contact forces together, N.
    fn net_forces(&self) -> Vec<R::Vec3> {
        let (model, state) = (self.model(), self.state());
        let mut force = link_forces(model, self.plan(), state);
        for body in &model.bodies {
            for (local, particle) in body.particles.clone().enumerate() {
                force[particle] += model.gravity * body.mass(local);
            }
        }
        self.add_contact_forces(&mut force);
        force
    }

    /// The forces of obstacles, and of bodies on each other, N.
    fn add_contact_forces(&self, force: &mut [R::Vec3]) {
        for contact in self.contacts() {
            force[contact.particle] += contact.force;
        }
        for contact in self.sample_contacts() {
            for (carrier, weight) in contact.own.iter() {
                force[carrier] += R::Vec3::from_dvec3(contact.force * weight);
            }
        }
        for contact in self.body_contacts() {
            for (carrier, weight) in contact.own.iter() {
                force[carrier] += R::Vec3::from_dvec3(contact.force * weight);
            }
            for (carrier, weight) in contact.cell.iter() {
                force[carrier] -= R::Vec3::from_dvec3(contact.force * weight);
            }
        }
    }

    /// The largest magnitude of strain among each particle's links, %.
    fn strains(&self) -> Vec<R> {
        let mut strains = vec![R::ZERO; self.state().position.len()];
        for body in &self.model().bodies {
            let first = body.particles.start;
            for link in body.links.iter().flat_map(|family| family.links.iter()) {
                let [i, j] = link.ends.map(|end| first + end as usize);
                let length = (self.state().position[j] - self.state().position[i]).length();
                let strain = (length / link.rest_length - R::ONE).abs() * R::from_f64(100.0);
                for end in [i, j] {
                    strains[end] = strains[end].max(strain);
                }
            }
        }
        strains
    }
}
/// The mean modulus of the cells around each particle of a body, kPa.
fn moduli<R: Real>(body: &BodyModel<R>) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); body.particles.len()];
    for (cell, corners) in body.lattice.cells.iter().enumerate() {
        let modulus = match &body.moduli {
            Values::Uniform(modulus) => *modulus,
            Values::Each(moduli) => moduli[cell],
        };
        for corner in corners {
            let (sum, count) = &mut sums[*corner as usize];
            (*sum, *count) = (*sum + 1e-3 * f64::from(modulus), *count + 1.0);
        }
    }
    sums.into_iter().map(|(sum, count)| sum / f64::max(count, 1.0)).collect()
}
