//! A contact candidate: a particle of a body that is near an obstacle, the obstacles that it meets, and the velocity that
//! these leave it.

use super::account;
use super::broad;
use super::gauss_seidel;
use super::narrow::mesh::NearestPointCache;
use super::record::ContactRecord;
use super::response::{self, Friction};
use super::surface::Surface;
use super::swept_point::SweptPoint;
use super::workspace::TestCounts;
use crate::math::{Real, Vector};
use crate::physics::model::{ContactModel, ObstacleModel, ObstacleShape};
use crate::physics::step::substep::Substep;

/// A contact candidate: one particle, with the obstacles near its body.
pub(super) struct Candidate<'a, R: Real> {
    pub(super) substep: Substep<'a, R>,
    /// The body's place among the bodies.
    pub(super) body: usize,
    pub(super) particle: usize,
    /// Cached search results of this particle, by mesh.
    caches: &'a mut [NearestPointCache],
    pub(super) tests: TestCounts,
}

impl<'a, R: Real> Candidate<'a, R> {
    /// `caches` holds the cached search results of the particle, by mesh.
    pub(super) fn new(
        substep: Substep<'a, R>,
        body: usize,
        particle: usize,
        caches: &'a mut [NearestPointCache],
    ) -> Self {
        Self { substep, body, particle, caches, tests: TestCounts::default() }
    }

    /// Returns the velocity that the obstacles leave this particle, and records the obstacles that it meets.
    pub(super) fn resolve(
        &mut self,
        predicted: R::Vec3,
        mass: R,
        contacts: &[ContactModel<R>],
        near: &[u32],
        records: &mut Vec<ContactRecord<R>>,
    ) -> R::Vec3 {
        let mut velocity = predicted;
        let first_record = records.len();
        let mut is_pinched = false;
        loop {
            let records_before = records.len();
            velocity = self.apply_obstacles(velocity, mass, contacts, near, first_record, records);
            if records.len() == records_before {
                break;
            }
            if records.len() > first_record + 1 {
                let (obstacles, found) = (&self.substep.model.obstacles, &mut records[first_record..]);
                let settled = gauss_seidel::solve(predicted, contacts, obstacles, mass, self.substep.dt, found);
                is_pinched = settled.is_none();
                velocity = settled.unwrap_or(predicted);
            }
            if is_pinched {
                break;
            }
        }
        if records.len() > first_record {
            let mut allowed = if is_pinched { R::Vec3::ZERO } else { self.allowed_by_all(velocity, contacts) };
            let among_several = records.len() > first_record + 1 || allowed != velocity;
            if among_several && self.gains_energy(predicted, allowed, mass, contacts) {
                allowed = R::Vec3::ZERO;
            }
            if allowed != velocity {
                self.record_further_contacts(allowed, contacts.len(), first_record, records);
                let (dt, found) = (self.substep.dt, &mut records[first_record..]);
                // The least of three energies: with the predicted velocity, with the velocity at the start, which lacks
                // what forces are about to give a held particle, and after the springs, which take some of it.
                let began = [predicted, self.substep.state.velocity[self.particle]]
                    .map(|velocity| account::energy(velocity, R::ZERO, mass, contacts, found));
                let began = began[0].min(began[1]) + account::work(dt, found);
                let had = began.min(account::energy(velocity, dt, mass, contacts, found));
                self.distribute_force(had, [velocity, allowed], mass, contacts, found);
                velocity = allowed;
            }
        }
        velocity
    }

    /// Applies every obstacle that the particle meets with this velocity and has not met before, one after the other, and
    /// records it. Returns the velocity that they leave. A push out of one obstacle may lead into the next, so the caller
    /// repeats this until nothing new is met.
    fn apply_obstacles(
        &mut self,
        mut velocity: R::Vec3,
        mass: R,
        contacts: &[ContactModel<R>],
        near: &[u32],
        first_record: usize,
        records: &mut Vec<ContactRecord<R>>,
    ) -> R::Vec3 {
        for (number, obstacle) in (0u32..).zip(0..contacts.len()) {
            let own = &records[first_record..];
            // A push takes the particle off the motion for which `near` was found: it may meet any obstacle.
            if own.iter().any(|record| record.obstacle == obstacle) || own.is_empty() && !near.contains(&number) {
                continue;
            }
            let Some((surface, surface_velocity)) = self.surface(obstacle, velocity) else { continue };
            let before = velocity;
            let computes_friction =
                !self.substep.plan.lean || response::has_friction(&self.substep.model.obstacles[obstacle]);
            let friction = if computes_friction { Friction::Coulomb } else { Friction::Without };
            let (contact, obstacle_met) = (&contacts[obstacle], &self.substep.model.obstacles[obstacle]);
            let relative_velocity = velocity - surface_velocity;
            let after =
                response::respond(&surface, contact, obstacle_met, friction, mass, self.substep.dt, relative_velocity);
            // A particle that is not pushed keeps its velocity to the last bit, however fast the surface is.
            if after != relative_velocity {
                velocity = after + surface_velocity;
            }
            self.tests.frictions += u64::from(computes_friction && velocity != before);
            // Also where nothing pushes: a particle that leaves must keep its side until it is out.
            records.push(ContactRecord {
                particle: self.particle,
                obstacle,
                normal: surface.normal,
                gap: surface.gap,
                surface_velocity,
                force: (velocity - before) * (mass / self.substep.dt),
            });
        }
        velocity
    }

    /// Records obstacles that the particle meets only with the velocity that all of them `allowed`: their springs take up
    /// what the others press into them, and a plane remembers the side that the particle came from.
    fn record_further_contacts(
        &mut self,
        allowed: R::Vec3,
        obstacles: usize,
        first_record: usize,
        records: &mut Vec<ContactRecord<R>>,
    ) {
        for obstacle in 0..obstacles {
            if records[first_record..].iter().any(|record| record.obstacle == obstacle) {
                continue;
            }
            let Some((surface, surface_velocity)) = self.surface(obstacle, allowed) else { continue };
            let (normal, gap) = (surface.normal, surface.gap);
            let (particle, force) = (self.particle, R::Vec3::ZERO);
            records.push(ContactRecord { particle, obstacle, normal, gap, surface_velocity, force });
        }
    }

    /// Runs the narrow phase if this particle's motion comes near the obstacle. Returns the surface and its velocity.
    pub(super) fn surface(&mut self, obstacle: usize, velocity: R::Vec3) -> Option<(Surface<R>, R::Vec3)> {
        let met @ ObstacleModel { shape, bounds, .. } = self.substep.obstacles.for_body(self.body, obstacle);
        let from = self.substep.state.position[self.particle];
        let path = velocity * self.substep.dt;
        let side = shape.side_row().map_or(0, |row| self.substep.state.side[row][self.particle]);
        if self.substep.plan.broad_phase && side == 0 && !broad::path_bounds::<R>(from, path).overlaps(bounds) {
            return None;
        }
        self.tests.all += 1;
        self.tests.of_spheres += u64::from(matches!(shape, ObstacleShape::Sphere { .. }));
        SweptPoint { from, path, side, largest_coordinates: None }.meet(met, self.substep.dt, self.caches)
    }
}
