//! A particle between several obstacles: the velocity that none of them forbids, and the force of each that brings it there.

use super::account::energy;
use super::candidate::Candidate;
use super::record::ContactRecord;
use super::response;
use crate::math::{Real, Vector};
use crate::physics::model::ContactModel;

/// Rounds in which a velocity is looked for; then the particle stops dead, or rides along with an obstacle that moves.
const MAX_ROUNDS: usize = 4;

impl<R: Real> Candidate<'_, R> {
    /// Whether the particle and its springs would end with more energy at this velocity than they began with at the
    /// `predicted` one; false where an obstacle moves. Where the depth limit of one obstacle leads into a stiff other one,
    /// no velocity is a minimum of the springs' energy; standing still gives neither particle nor springs any more.
    pub(super) fn gains_energy(
        &mut self,
        predicted: R::Vec3,
        velocity: R::Vec3,
        mass: R,
        contacts: &[ContactModel<R>],
    ) -> bool {
        let half_mass = R::from_f64(0.5) * mass;
        let had = half_mass * predicted.dot(predicted);
        let (mut before, mut after) = (had, half_mass * velocity.dot(velocity));
        for (obstacle, contact) in contacts.iter().enumerate() {
            let Some((surface, surface_velocity)) = self.surface(obstacle, velocity) else { continue };
            if surface_velocity != R::Vec3::ZERO {
                return false;
            }
            before += contact.energy(-surface.gap);
            after += contact.energy(-(surface.gap + velocity.dot(surface.normal) * self.substep.dt));
        }
        // The tolerance is for rounding error.
        after - before > R::from_f64(1e-4) * before
    }

    /// Looks for a velocity that no obstacle forbids, as a push from one may lead into another. Where the rounds find none,
    /// the particle stands still if all obstacles do, else it rides along with one that moves.
    pub(super) fn allowed_by_all(&mut self, mut velocity: R::Vec3, contacts: &[ContactModel<R>]) -> R::Vec3 {
        let mut riding = R::Vec3::ZERO;
        for _ in 0..MAX_ROUNDS {
            let mut forbidden = false;
            for (obstacle, contact) in contacts.iter().enumerate() {
                let Some((surface, surface_velocity)) = self.surface(obstacle, velocity) else { continue };
                let min_normal_velocity = response::min_normal_velocity(&surface, contact, self.substep.dt);
                let along = (velocity - surface_velocity).dot(surface.normal);
                // The tolerance is for rounding error: a corrected velocity must not count as forbidden again.
                let speeds = along.abs() + min_normal_velocity.abs() + surface_velocity.length();
                if along < min_normal_velocity - R::from_f64(1e-6) * speeds {
                    velocity += surface.normal * (min_normal_velocity - along);
                    if surface_velocity != R::Vec3::ZERO {
                        riding = surface_velocity;
                    }
                    forbidden = true;
                }
            }
            if !forbidden {
                return velocity;
            }
        }
        riding
    }

    /// Shares out among the forces in `found` the force that brings a particle from the `velocity` that the springs leave it
    /// to the `allowed` one.
    ///
    /// A moving obstacle carries the particle along. The energy that particle and springs have beyond what they `had`, J,
    /// comes from that obstacle, as one that stands still does no work. So where its push does less work than that, it
    /// presses the particle harder against an obstacle that stands still.
    pub(super) fn distribute_force(
        &self,
        had: R,
        [velocity, allowed]: [R::Vec3; 2],
        mass: R,
        contacts: &[ContactModel<R>],
        found: &mut [ContactRecord<R>],
    ) {
        let dt = self.substep.dt;
        let change = (allowed - velocity) * (mass / dt);
        let moves = |record: &ContactRecord<R>| record.surface_velocity != R::Vec3::ZERO;
        let Some(moving) = found.iter().position(moves) else {
            if let Some(last) = found.last_mut() {
                last.force += change;
            }
            return;
        };
        let surface = found[moving].surface_velocity;
        let missing = energy(allowed, dt, mass, contacts, found) - had - change.dot(surface) * dt;
        found[moving].force += change;
        if missing > R::ZERO {
            let press = surface * (missing / (surface.dot(surface) * dt));
            found[moving].force += press;
            if let Some(standing) = found.iter().position(|record| !moves(record)) {
                found[standing].force -= press;
            }
        }
    }
}
