//! Contacts that the stabilised scheme takes through all stages of a substep.

use super::record::ContactRecord;
use super::response;
use super::surface::Surface;
use super::workspace::ContactWorkspace;
use crate::math::{Real, Vector};
use crate::physics::model::{ContactModel, ObstacleModel};
use crate::physics::schemes::{ContactSpring, HeldFriction, HeldParticle, SurfaceContact};
use crate::physics::step::substep::Substep;

/// A particle whose velocity along a surface is no more than this share of the speeds it is computed from is held there.
const STICKING_SHARE: f64 = 1e-5;

impl<R: Real> ContactWorkspace<R> {
    /// Lists the particles that obstacles push, with the velocities that these leave them; `force` are the forces at the
    /// state, N.
    pub(in crate::physics) fn list_held_particles(
        &self,
        substep: Substep<'_, R>,
        force: &[R::Vec3],
        velocity: &[R::Vec3],
        held: &mut Vec<HeldParticle<R>>,
    ) {
        held.clear();
        for own in self.contacts.chunk_by(|a, b| a.particle == b.particle) {
            let particle = own[0].particle;
            let Some(number) = substep.model.body_of(particle) else { continue };
            let mut pushing = own.iter().filter(|record| record.force != R::Vec3::ZERO);
            let Some(record) = pushing.next().filter(|_| !substep.state.bodies[number].asleep) else { continue };
            let body = &substep.model.bodies[number];
            let mass = body.mass(particle - body.particles.start);
            let relative_velocity = substep.state.velocity[particle] - record.surface_velocity;
            let forces_now = [relative_velocity * (mass * substep.braking_rate(number)), force[particle]];
            let (contact, obstacle) = (&body.contacts[record.obstacle], &substep.model.obstacles[record.obstacle]);
            let by_one = || surface_contact(velocity[particle], forces_now, record, contact, obstacle, substep.dt);
            // Between several obstacles a particle does not slide.
            let touch = pushing.next().map_or_else(|| Some(by_one()), |_| None);
            let across = |of: R::Vec3| of - record.normal * of.dot(record.normal);
            let is_stopped = touch.is_some_and(|touch| matches!(touch.friction, HeldFriction::Sticks { .. }));
            let slides = if is_stopped { across(velocity[particle] - record.surface_velocity) } else { R::Vec3::ZERO };
            held.push(HeldParticle::new(particle, mass, velocity[particle] - slides, touch));
        }
    }

    /// Records the contact forces as they turned out. For a held particle that is its mean force; for one that only its path
    /// led into an obstacle, the force that changed the velocity that the stages `left` into the one it has.
    pub(in crate::physics) fn record_forces(
        &mut self,
        substep: Substep<'_, R>,
        held: &[HeldParticle<R>],
        [left, velocity]: [&[R::Vec3]; 2],
    ) {
        let mut held = held.iter().peekable();
        for own in self.contacts.chunk_by_mut(|a, b| a.particle == b.particle) {
            let particle = own[0].particle;
            let Some(number) = substep.model.body_of(particle) else { continue };
            if substep.state.bodies[number].asleep {
                continue;
            }
            while held.next_if(|held| held.particle < particle).is_some() {}
            let body = &substep.model.bodies[number];
            let mass = body.mass(particle - body.particles.start);
            let by_path = || (velocity[particle] - left[particle]) * (mass / substep.dt);
            let force =
                held.next_if(|held| held.particle == particle).map_or_else(by_path, |held| held.mean_force(substep.dt));
            let others = own.iter().skip(1).fold(R::Vec3::ZERO, |sum, record| sum + record.force);
            own[0].force = force - others;
        }
    }
}

/// Stops particles that the springs did not stop in time at the depth limit.
pub(in crate::physics) fn limit_depths<R: Real>(
    substep: Substep<'_, R>,
    held: &mut [HeldParticle<R>],
    path: &mut [R::Vec3],
    velocity: &mut [R::Vec3],
) {
    for held in held {
        let Some(SurfaceContact { normal, surface_velocity, spring: Some(spring), .. }) = held.contact else {
            continue;
        };
        let Some(number) = substep.model.body_of(held.particle) else { continue };
        let body = &substep.model.bodies[number];
        let deepest = spring.depth_limit.max(-spring.gap);
        let min_normal_velocity = -(deepest + spring.gap) / substep.dt;
        let missing = min_normal_velocity - (path[held.particle] - surface_velocity).dot(normal);
        if missing <= R::ZERO {
            continue;
        }
        path[held.particle] += normal * missing;
        let missing = min_normal_velocity - (velocity[held.particle] - surface_velocity).dot(normal);
        let change = normal * missing.max(R::ZERO);
        velocity[held.particle] += change;
        held.push += change * body.mass(held.particle - body.particles.start);
    }
}

/// Returns how one surface touches a particle that it leaves this `velocity`. Static friction holds the particle if it can
/// bear both the force that would stop it within the substep and the force on it: the two forces `forces_now`, N.
fn surface_contact<R: Real>(
    velocity: R::Vec3,
    forces_now: [R::Vec3; 2],
    record: &ContactRecord<R>,
    contact: &ContactModel<R>,
    obstacle: &ObstacleModel<R>,
    dt: R,
) -> SurfaceContact<R> {
    let &ContactRecord { normal, surface_velocity, gap, force, .. } = record;
    let across = |of: R::Vec3| of - normal * of.dot(normal);
    let relative_velocity = velocity - surface_velocity;
    let friction_limit = obstacle.friction_static * force.dot(normal);
    let holds =
        obstacle.friction_static > R::ZERO && forces_now.iter().all(|force| across(*force).length() <= friction_limit);
    let speeds = velocity.length() + surface_velocity.length();
    let is_stopped =
        across(force) != R::Vec3::ZERO && across(relative_velocity).length() <= R::from_f64(STICKING_SHARE) * speeds;
    let min_normal_velocity = response::min_normal_velocity(&Surface { normal, gap }, contact, dt);
    let &ContactModel { stiffness, damping, depth_limit, .. } = contact;
    let is_at_limit =
        relative_velocity.dot(normal) <= min_normal_velocity + R::from_f64(STICKING_SHARE) * min_normal_velocity.abs();
    SurfaceContact {
        normal,
        surface_velocity,
        spring: (!is_at_limit).then_some(ContactSpring { stiffness, damping, gap, depth_limit }),
        friction: match obstacle.friction_dynamic {
            dynamic if holds || is_stopped => HeldFriction::Sticks { coefficient: obstacle.friction_static, dynamic },
            dynamic => HeldFriction::Slides(dynamic),
        },
    }
}
