//! Contact of particles with obstacles (GC §5–§7).
//!
//! ```text
//! broad phase   box of a body's motion against box of an obstacle, then box of a particle's motion
//! narrow phase  does this particle cross the obstacle's surface in this step, on which side, where (plane, sphere)
//! response      a stiff, critically damped spring taken implicitly, then Coulomb friction (response)
//! ```
//!
//! Particles do not meet each other. What several obstacles do to one particle is found together (settle), and it is
//! brought to a velocity that none of them forbids.

pub(super) mod approach;
mod between;
mod broad;
mod narrow;
mod placed;
mod record;
mod response;
mod settle;
pub(super) mod sweep;
pub(super) mod thesis;
mod touch;
mod way_out;

pub use placed::Placed;
pub use record::ContactRecord;
pub(super) use record::Scratch;
pub(super) use touch::{Touch, find as find_touches, settle as settle_touches};

use super::model::{ContactModel, Model, ObstacleModel, ObstacleShape};
use super::report::{Counters, Recorder};
use super::state::State;
use crate::math::{Real, Vector};
use crate::physics::model::plan::Stage;
use crate::physics::step::substep::Substep;

/// The surface as one particle meets it: a tangent plane, in a frame that rides along with the obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Surface<R: Real> {
    /// Unit normal, towards the side the particle came from.
    pub(super) normal: R::Vec3,
    /// Distance of the particle from the surface along the normal when the substep begins, m; negative inside.
    pub(super) gap: R,
}

/// Changes the predicted velocities of all particles that meet an obstacle within this substep.
pub(super) fn respond<R: Real>(
    substep: Substep<'_, R>,
    velocity: &mut [R::Vec3],
    scratch: &mut Scratch<R>,
    recorder: &mut Recorder<'_>,
) {
    scratch.keep_of_sleepers(substep.model, substep.state);
    Meetings { substep, scratch, recorder }.of_all(velocity, |_, _| ());
}

/// Changes the velocities that move particles where those at the end of the substep are others. What has met an
/// obstacle already moves with the velocity at the end of the substep; one that only its path leads into an obstacle, or
/// that velocity where nothing had pushed it, is stopped there, and what stops it changes its velocity too.
pub(super) fn respond_to_paths<R: Real>(
    substep: Substep<'_, R>,
    velocity: &mut [R::Vec3],
    path: &mut [R::Vec3],
    scratch: &mut Scratch<R>,
    recorder: &mut Recorder<'_>,
) {
    for contact in &scratch.contacts {
        path[contact.particle] = velocity[contact.particle];
    }
    scratch.forget_unpushed(substep.model, substep.state);
    Meetings { substep, scratch, recorder }.of_all(path, |particle, change| velocity[particle] += change);
}

/// All particles among all obstacles.
struct Meetings<'a, 'r, R: Real> {
    substep: Substep<'a, R>,
    scratch: &'a mut Scratch<R>,
    recorder: &'a mut Recorder<'r>,
}

impl<R: Real> Meetings<'_, '_, R> {
    /// Resolves all velocities but of the particles that are known to meet something, and tells of each change.
    fn of_all(&mut self, velocity: &mut [R::Vec3], mut changed: impl FnMut(usize, R::Vec3)) {
        self.scratch.sort();
        let met = self.scratch.contacts.len();
        let Self { substep, scratch, recorder } = self;
        let Substep { model, plan, state, .. } = *substep;
        for (number, body) in model.bodies.iter().enumerate() {
            if state.bodies[number].asleep {
                continue;
            }
            let all_tests = (body.particles.len() * model.obstacles.len()) as u64;
            let tests_before = recorder.counters.narrow_tests;
            if plan.broad_phase {
                recorder.enter(Stage::BroadPhase);
            }
            let touching = &scratch.touching[number * model.obstacles.len()..][..model.obstacles.len()];
            broad::near_obstacles(*substep, number, velocity, touching, &mut scratch.near);
            if !scratch.near.is_empty() {
                recorder.enter(Stage::Contact);
                for (local, particle) in body.particles.clone().enumerate() {
                    // The contacts are in the order of the particles.
                    let has_met = || scratch.contacts[..met].binary_search_by_key(&particle, |c| c.particle).is_ok();
                    if body.is_pinned(local) || has_met() {
                        continue;
                    }
                    let mut meeting = Meeting::new(*substep, number, particle);
                    let before = velocity[particle];
                    velocity[particle] =
                        meeting.resolve(before, body.mass(local), &body.contacts, &scratch.near, &mut scratch.contacts);
                    changed(particle, velocity[particle] - before);
                    meeting.count(&mut recorder.counters);
                }
            }
            let made = recorder.counters.narrow_tests - tests_before;
            recorder.counters.narrow_tests_saved += all_tests.saturating_sub(made);
        }
        scratch.sort();
        recorder.last.contacts = scratch.pushing();
    }
}

/// One particle among the obstacles near its body.
struct Meeting<'a, R: Real> {
    substep: Substep<'a, R>,
    /// The body's place among the bodies.
    body: usize,
    particle: usize,
    tests: u64,
    sphere_tests: u64,
    frictions: u64,
}

impl<'a, R: Real> Meeting<'a, R> {
    fn new(substep: Substep<'a, R>, body: usize, particle: usize) -> Self {
        Self { substep, body, particle, tests: 0, sphere_tests: 0, frictions: 0 }
    }

    /// Adds what it tested.
    fn count(&self, counters: &mut Counters) {
        counters.narrow_tests += self.tests;
        counters.sphere_tests += self.sphere_tests;
        counters.frictions += self.frictions;
    }

    /// The velocity the obstacles leave this particle; what pushed is recorded.
    fn resolve(
        &mut self,
        predicted: R::Vec3,
        mass: R,
        contacts: &[ContactModel<R>],
        near: &[u32],
        records: &mut Vec<ContactRecord<R>>,
    ) -> R::Vec3 {
        let mut velocity = predicted;
        let first_record = records.len();
        for (number, obstacle) in (0u32..).zip(0..contacts.len()) {
            // A pushed particle leaves the motion that was found near these obstacles only: it may meet any.
            if records.len() == first_record && !near.contains(&number) {
                continue;
            }
            let Some((surface, surface_velocity)) = self.surface(obstacle, velocity) else { continue };
            let before = velocity;
            let rubs = !self.substep.plan.lean || response::has_friction(&self.substep.model.obstacles[obstacle]);
            velocity = response::respond(
                &surface,
                &contacts[obstacle],
                &self.substep.model.obstacles[obstacle],
                rubs,
                mass,
                self.substep.dt,
                velocity - surface_velocity,
            ) + surface_velocity;
            self.frictions += u64::from(rubs && velocity != before);
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
        if records.len() > first_record + 1 {
            let (obstacles, found) = (&self.substep.model.obstacles, &mut records[first_record..]);
            velocity = settle::settle(predicted, contacts, obstacles, mass, self.substep.dt, found);
        }
        if records.len() > first_record {
            let mut allowed = self.allowed_by_all(velocity, contacts);
            let among_several = records.len() > first_record + 1 || allowed != velocity;
            if among_several && self.gains(predicted, allowed, mass, contacts) {
                allowed = R::Vec3::ZERO;
            }
            if allowed != velocity {
                self.share_out(velocity, allowed, mass, contacts, &mut records[first_record..]);
                velocity = allowed;
            }
        }
        velocity
    }

    /// The narrow phase, if this particle's motion comes near the obstacle at all, and the velocity of the surface.
    ///
    /// Contact with an obstacle that moves is swept in the obstacle's own frame: the particle's start rides along, and
    /// what is left of its path is its motion past the obstacle.
    fn surface(&mut self, obstacle: usize, velocity: R::Vec3) -> Option<(Surface<R>, R::Vec3)> {
        let ObstacleModel { shape, bounds, carry, .. } = self.substep.obstacles.met(self.body, obstacle);
        let from = self.substep.state.position[self.particle];
        let path = velocity * self.substep.dt;
        let side = match shape {
            ObstacleShape::Plane(plane) => self.substep.state.side[plane.side_row][self.particle],
            ObstacleShape::Sphere { .. } => 0,
        };
        if self.substep.plan.broad_phase && side == 0 && !broad::sweep::<R>(from, path).overlaps(bounds) {
            return None;
        }
        self.tests += 1;
        self.sphere_tests += u64::from(matches!(shape, ObstacleShape::Sphere { .. }));
        let Some(carry) = carry else { return Some((narrow::meet(shape, side, from, path)?, R::Vec3::ZERO)) };
        let carried = carry.apply(from);
        let surface = narrow::meet(shape, side, carried, from + path - carried)?;
        Some((surface, (carried - from) * (R::ONE / self.substep.dt)))
    }
}

/// The body that a contact's particle is of.
fn body_of<R: Real>(model: &Model<R>, contact: &ContactRecord<R>) -> Option<usize> {
    model.bodies.iter().position(|body| body.particles.contains(&contact.particle))
}

/// Writes down on which side of which plane every touching particle is once it has moved, and how deep the deepest is.
pub(super) fn remember_sides<R: Real>(
    model: &Model<R>,
    obstacles: &Placed<R>,
    dt: R,
    state: &mut State<R>,
    velocity: &[R::Vec3],
    scratch: &mut Scratch<R>,
    recorder: &mut Recorder<'_>,
) {
    let mut deepest = R::ZERO;
    // What touched before and does not any more is forgotten; what touches is in the records.
    for (number, body) in model.bodies.iter().enumerate() {
        if state.bodies[number].asleep {
            continue;
        }
        for (obstacle, shape) in model.obstacles.iter().map(|o| &o.shape).enumerate() {
            let touching = &mut scratch.touching[number * model.obstacles.len() + obstacle];
            if !*touching {
                continue;
            }
            *touching = false;
            if let ObstacleShape::Plane(plane) = shape {
                state.side[plane.side_row][body.particles.clone()].fill(0);
            }
        }
    }
    for contact in &scratch.contacts {
        let Some(number) = body_of(model, contact) else { continue };
        if state.bodies[number].asleep {
            deepest = deepest.max(-contact.gap);
            continue;
        }
        let counters = &mut recorder.counters;
        counters.obstacle_work_j += contact.force.dot(contact.surface_velocity).to_f64() * dt.to_f64();
        counters.fastest_surface_m_s = counters.fastest_surface_m_s.max(contact.surface_velocity.length().to_f64());
        let depth = -(contact.gap + (velocity[contact.particle] - contact.surface_velocity).dot(contact.normal) * dt);
        let ObstacleShape::Plane(plane) = &obstacles.met(number, contact.obstacle).shape else {
            deepest = deepest.max(depth);
            continue;
        };
        if depth >= -narrow::plane::rounding_margin::<R>(plane, state.position[contact.particle]) {
            let upper = contact.normal.dot(plane.normal) > R::ZERO;
            state.side[plane.side_row][contact.particle] = if upper { 1 } else { -1 };
            scratch.touching[number * model.obstacles.len() + contact.obstacle] = true;
            deepest = deepest.max(depth);
        }
    }
    recorder.note_depth(deepest.to_f64());
}
