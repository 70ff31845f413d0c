//! A particle between several obstacles: the velocity that none of them forbids, and who did what to bring it there.

use super::account::energy;
use super::candidate::Candidate;
use super::record::ContactRecord;
use super::response;
use crate::math::{Real, Vector};
use crate::physics::model::ContactModel;

/// Rounds in which a particle between several obstacles may look for a velocity; then it stops dead.
const ROUNDS: usize = 4;

impl<R: Real> Candidate<'_, R> {
    /// Whether the particle and the springs of obstacles that stand still would have more energy with this velocity than
    /// with the `predicted` one before them. Where the limit of one obstacle leads into a stiff other one, no velocity is
    /// a minimum of the springs' energy; standing still gives neither more than it has.
    pub(super) fn gains(
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
        // The tolerance is rounding.
        after - before > R::from_f64(1e-4) * before
    }

    /// A push from one obstacle may lead into another: looks for a velocity that no obstacle forbids. Standing still
    /// is one where all obstacles do; riding along with the one that moves is the way out where one pushes.
    pub(super) fn allowed_by_all(&mut self, mut velocity: R::Vec3, contacts: &[ContactModel<R>]) -> R::Vec3 {
        let mut riding = R::Vec3::ZERO;
        for _ in 0..ROUNDS {
            let mut forbidden = false;
            for (obstacle, contact) in contacts.iter().enumerate() {
                let Some((surface, surface_velocity)) = self.surface(obstacle, velocity) else { continue };
                let slowest = response::deepest_velocity(&surface, contact, self.substep.dt);
                let along = (velocity - surface_velocity).dot(surface.normal);
                // The tolerance is rounding: a corrected velocity must not count as forbidden again.
                let speeds = along.abs() + slowest.abs() + surface_velocity.length();
                if along < slowest - R::from_f64(1e-6) * speeds {
                    velocity += surface.normal * (slowest - along);
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

    /// Shares out what brought a particle from the `velocity` that the springs of its obstacles leave it to the one that
    /// all of them allow, among the forces in `found`.
    ///
    /// An obstacle that moves carries the particle along. What particle and springs have more than they `had`, J, that
    /// obstacle gave: one that stands still holds against and does no work. So where its push does less work than that, it
    /// presses the particle harder against what stands.
    pub(super) fn share_out(
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
