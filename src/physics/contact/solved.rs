//! Contact as part of a system of equations: what the implicit integrator solves for, and what is left to do after it.
//!
//! ```text
//! find     which particles touch, or would if they fell freely: one constraint for each obstacle
//! (solve)  the normal penalty, its damping and a resistance against sliding are in the matrix, chosen anew every round
//! finish   particles that met an obstacle only in the solution, or lacked its push when the rounds of solving ended, are
//!          resolved as in an explicit step; nothing ends too deep
//! ```

use glam::DVec3;

use super::account;
use super::candidate::Candidate;
use super::candidates::Candidates;
use super::constraint::{ConstraintLaw, ContactConstraint, ParticleConstraint};
use super::record::ContactRecord;
use super::response;
use super::workspace::{ContactWorkspace, ObstaclesWorkspace};
use crate::math::{Real, Vector};
use crate::physics::model::plan::Stage;
use crate::physics::report::Recorder;
use crate::physics::step::substep::Substep;

/// Finds the constraints of a substep in which every particle would have the velocity `free_velocity`, by particle.
pub(in crate::physics) fn find_constraints<R: Real>(
    substep: Substep<'_, R>,
    free_velocity: &[R::Vec3],
    workspace: &mut ContactWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    let Substep { model, state, dt, .. } = substep;
    let meshes = model.mesh_count();
    workspace.constraints.clear();
    for (number, body) in model.bodies.iter().enumerate() {
        if state.bodies[number].asleep || substep.meets_on_mesh(number) {
            continue;
        }
        let marked_near = &workspace.marked_near[number * model.obstacles.len()..][..model.obstacles.len()];
        recorder.enter(Stage::BroadPhase);
        let (own, of_body) = (&free_velocity[body.particles.clone()], &mut workspace.of_bodies[number]);
        of_body.broad_phase.find_obstacles(substep, number, own, R::ZERO, |obstacle| marked_near[obstacle]);
        if of_body.broad_phase.obstacles.is_empty() {
            continue;
        }
        recorder.enter(Stage::Contact);
        of_body.broad_phase.find_particles(substep, number, own, &of_body.caches);
        let ObstaclesWorkspace { broad_phase, caches, .. } = of_body;
        for local in broad_phase.particles.iter() {
            let particle = body.particles.start + local;
            if body.is_pinned(local) {
                continue;
            }
            let mut candidate = Candidate::new(substep, number, particle, &mut caches[local * meshes..][..meshes]);
            for &near in &broad_phase.obstacles {
                let obstacle = near as usize;
                let Some((surface, surface_velocity)) = candidate.surface(obstacle, free_velocity[particle]) else {
                    continue;
                };
                let (contact, shape) = (&body.contacts[obstacle], &model.obstacles[obstacle]);
                let law = ConstraintLaw {
                    normal: surface.normal.to_dvec3(),
                    surface_velocity: surface_velocity.to_dvec3(),
                    resistance: (dt * (dt * contact.stiffness + contact.damping)).to_f64(),
                    // A body put deep inside is pushed out as if it were at the limit.
                    impulse_at_rest: (dt * contact.stiffness * (-surface.gap).min(contact.depth_limit)).to_f64(),
                    parting: None,
                    min_normal_velocity: response::min_normal_velocity(&surface, contact, dt).to_f64(),
                    friction: [shape.friction_static, shape.friction_dynamic].map(Real::to_f64),
                    size: body.size.to_f64(),
                };
                let velocities = [state.velocity[particle], free_velocity[particle]].map(Vector::to_dvec3);
                let constraint = ContactConstraint::new(law, velocities[0], velocities[1]);
                let gap = surface.gap.to_f64();
                workspace.constraints.push(ParticleConstraint { body: number, particle, obstacle, gap, constraint });
            }
            candidate.tests.count(&mut recorder.counters);
        }
    }
}

/// Turns the constraints into contacts, and resolves particles that the solution leads into an obstacle without a push: they
/// did not touch it before, or the rounds ended before it was settled which constraints push.
pub(in crate::physics) fn finish_constraints<R: Real>(
    substep: Substep<'_, R>,
    velocity: &mut [R::Vec3],
    workspace: &mut ContactWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    let Substep { model, state, dt, .. } = substep;
    workspace.keep_sleeping_contacts(model, state);
    let mut constraints = workspace.constraints.chunk_by(|a, b| a.particle == b.particle).peekable();
    for (number, body) in model.bodies.iter().enumerate() {
        while let Some(own) = constraints.next_if(|own| body.particles.contains(&own[0].particle)) {
            let particle = own[0].particle;
            // A particle that should be pushed and is not is resolved below, with those that touched nothing before.
            let are_left_out = own.iter().any(|own| own.constraint.is_left_out());
            if are_left_out && own.iter().all(|own| own.constraint.impulse == DVec3::ZERO) {
                continue;
            }
            let over_dt = R::ONE / dt;
            let caches =
                workspace.of_bodies[number].caches_of_particle(particle - body.particles.start, model.mesh_count());
            let mut candidate = Candidate::new(substep, number, particle, caches);
            let first = workspace.contacts.len();
            for obstacle in 0..model.obstacles.len() {
                let record = match own.iter().find(|own| own.obstacle == obstacle) {
                    Some(ParticleConstraint { gap, constraint, .. }) => Some(ContactRecord {
                        particle,
                        obstacle,
                        normal: R::Vec3::from_dvec3(constraint.normal),
                        gap: R::from_f64(*gap),
                        surface_velocity: R::Vec3::from_dvec3(constraint.surface_velocity),
                        force: R::Vec3::from_dvec3(constraint.impulse) * over_dt,
                    }),
                    None => candidate.surface(obstacle, velocity[particle]).map(|(surface, surface_velocity)| {
                        let (normal, gap) = (surface.normal, surface.gap);
                        ContactRecord { particle, obstacle, normal, gap, surface_velocity, force: R::Vec3::ZERO }
                    }),
                };
                workspace.contacts.extend(record);
            }
            let allowed = candidate.allowed_by_all(velocity[particle], &body.contacts);
            if allowed != velocity[particle] {
                let mass = body.mass(particle - body.particles.start);
                let found = &mut workspace.contacts[first..];
                let solved = velocity[particle];
                let has = account::energy(solved, dt, mass, &body.contacts, found);
                candidate.distribute_force(has, [solved, allowed], mass, &body.contacts, found);
                velocity[particle] = allowed;
            }
            candidate.tests.count(&mut recorder.counters);
            recorder.counters.frictions +=
                own.iter().filter(|own| own.constraint.friction_limit() > 0.0).count() as u64;
        }
    }
    Candidates { substep, workspace, recorder }.resolve_all(velocity);
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::physics::Simulation;
    use crate::physics::contact::Placed;
    use crate::physics::model::Scheme;
    use crate::scene::obstacle::{ContactStiffness, Plane};
    use crate::scene::resolve::resolve;
    use crate::scene::{Body, Obstacle, ObstacleShape, Scene};

    #[test]
    fn what_the_rounds_leave_without_its_push_is_stopped_by_the_obstacle() {
        let mut scene = Scene { bodies: vec![Body::default()], ..Scene::default() };
        scene.bodies[0].pose.position = [0.0, 0.501, 0.0];
        let ground = ObstacleShape::Plane(Plane::default());
        let stiffness = ContactStiffness::Given(1e6);
        scene.obstacles = vec![Obstacle { shape: ground, stiffness, ..Obstacle::default() }];
        let lattice = resolve(&scene.bodies[0].shape, Path::new("."), &()).expect("a cube").lattice;
        let simulation = Simulation::<f64>::new(&scene, &[lattice]);
        let (model, plan, state) = (simulation.model(), simulation.plan(), simulation.state());
        let (obstacles, dt) = (Placed::now(model, state), 5e-3);
        let substep = Substep {
            model,
            plan,
            state,
            obstacles: &obstacles,
            dt,
            scheme: Scheme::Implicit,
            is_strained: false,
            bodies_are_near: false,
            points_are_near: false,
            grab: None,
            modal_grab: None,
        };
        let mut workspace = ContactWorkspace::new(model, plan);
        let timer = &mut ();
        let mut recorder = Recorder::new(timer);
        let mut velocity = vec![DVec3::NEG_Y; model.particle_count()];
        find_constraints(substep, &velocity, &mut workspace, &mut recorder);
        for ParticleConstraint { constraint, .. } in &mut workspace.constraints {
            // In one round the particle leaves, in the last it is pressed in again.
            constraint.relinearize(DVec3::Y, false);
            constraint.relinearize(DVec3::NEG_Y, false);
            assert!(constraint.is_left_out(), "{constraint:?}");
        }
        finish_constraints(substep, &mut velocity, &mut workspace, &mut recorder);
        let touching = workspace.contacts.len();
        assert!(touching > 50 && touching == workspace.constraints.len(), "{touching} particles touch");
        for contact in &workspace.contacts {
            let depth = -(contact.gap + dt * velocity[contact.particle].y);
            assert!(depth < 1e-4, "{depth} m deep by {} in a stiff obstacle", velocity[contact.particle]);
            let mass = model.bodies[0].mass(contact.particle);
            let change = (velocity[contact.particle] + DVec3::Y) * mass / dt;
            assert!(contact.force.distance(change) < 1e-9 * change.length(), "its force made the change: {contact:?}");
        }
    }
}
