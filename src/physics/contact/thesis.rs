//! The thesis's own contact and friction, to teach with (GC §5.2, §5.5, §6): kept as written, faults included.
//!
//! The reaction `(k p + |⟨F, n⟩|) n` is an explicit force, so its stiffness limits the step; the pressing force it
//! cancels is larger on the way out than on the way in, so a body gains energy with every bounce; static friction is
//! not clamped to the force that acts, so nothing ever quite rests. Planes act on the side of their normal and see a
//! particle only within a threshold: faster than threshold/dt it falls through.

use super::record::ContactRecord;
use super::workspace::{ContactWorkspace, ObstaclesWorkspace};
use crate::math::{Real, Vector};
use crate::physics::model::plan::Stage;
use crate::physics::model::{ContactModel, MeshModel, ObstacleModel, ObstacleShape, OrientedModel, PlaneModel};
use crate::physics::report::Recorder;
use crate::physics::step::substep::Substep;

/// Below this speed along the surface a particle counts as still and static friction applies, m/s. The thesis
/// compares with zero, which no number in a simulation ever is.
const STILL_SPEED: f64 = 1e-3;

/// The share by which boxes are made larger than planes reach, for rounding error.
const ROUNDING_SHARE: f64 = 1e-3;

/// Adds reaction and friction to the force of every particle found past a surface, and stores them alone in `thesis_force`.
pub(in crate::physics) fn add_forces<R: Real>(
    substep: Substep<'_, R>,
    force: &mut [R::Vec3],
    thesis_force: &mut [R::Vec3],
    workspace: &mut ContactWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    let Substep { model, plan, state, obstacles, dt, .. } = substep;
    workspace.keep_sleeping_contacts(model, state);
    thesis_force.fill(R::Vec3::ZERO);
    let mut deepest = workspace.deepest();
    for (place, body) in model.bodies.iter().enumerate().filter(|(place, _)| !state.bodies[*place].asleep) {
        let threshold = body.contacts.iter().map(|contact| contact.thesis_threshold).fold(R::ZERO, R::max);
        if plan.broad_phase {
            recorder.enter(Stage::BroadPhase);
        }
        let ObstaclesWorkspace { broad_phase, caches, .. } = &mut workspace.of_bodies[place];
        let own = &state.velocity[body.particles.clone()];
        broad_phase.find_obstacles(substep, place, own, threshold * R::from_f64(1.0 + ROUNDING_SHARE), |_| false);
        recorder.enter(Stage::Contact);
        let tests_before = recorder.counters.narrow_tests;
        broad_phase.find_particles(substep, place, own, caches);
        for particle in broad_phase.particles.iter().map(|local| body.particles.start + local) {
            for number in broad_phase.obstacles.iter().map(|near| *near as usize) {
                let obstacle = obstacles.for_body(place, number);
                recorder.counters.narrow_tests += 1;
                let contact = &body.contacts[number];
                let at = state.position[particle];
                let velocity = state.velocity[particle];
                let found = match &obstacle.shape {
                    ObstacleShape::Plane(plane) => past_plane(plane, contact, at),
                    ObstacleShape::Sphere { center, radius } => inside_sphere(*center, *radius, at, velocity * dt),
                    ObstacleShape::Oriented(oriented) => inside_oriented(oriented, at),
                    ObstacleShape::Mesh(mesh) => past_mesh(mesh, contact, at),
                };
                let Some((normal, depth)) = found else { continue };
                let pressing = force[particle];
                let turned_back = if plan.pressing_force { pressing } else { R::Vec3::ZERO };
                let reaction =
                    reaction(normal, depth, contact, turned_back) + friction(normal, obstacle, pressing, velocity);
                force[particle] += reaction;
                thesis_force[particle] += reaction;
                deepest = deepest.max(depth);
                workspace.contacts.push(ContactRecord {
                    particle,
                    obstacle: number,
                    normal,
                    gap: -depth,
                    surface_velocity: R::Vec3::ZERO,
                    force: reaction,
                });
            }
        }
        let made = recorder.counters.narrow_tests - tests_before;
        recorder.counters.narrow_tests_saved += (body.particles.len() * model.obstacles.len()) as u64 - made;
    }
    workspace.sort();
    recorder.last.contacts = workspace.contacts.len();
    recorder.note_depth(deepest.to_f64());
}

fn past_plane<R: Real>(plane: &PlaneModel<R>, contact: &ContactModel<R>, at: R::Vec3) -> Option<(R::Vec3, R)> {
    let offset = at - plane.center;
    let depth = -offset.dot(plane.normal);
    let inside = (0..2).all(|axis| offset.dot(plane.axes[axis]).abs() <= plane.half_extents[axis]);
    (inside && depth >= R::ZERO && depth <= contact.thesis_threshold).then_some((plane.normal, depth))
}

/// The normal is that of the point where the particle came in; the depth is the way back out along it (GC §5.5).
fn inside_sphere<R: Real>(center: R::Vec3, radius: R, at: R::Vec3, path: R::Vec3) -> Option<(R::Vec3, R)> {
    let offset = at - center;
    let distance = offset.length();
    if distance > radius {
        return None;
    }
    let entered = super::narrow::sphere::meet(center, radius, at - path, path);
    let radial = super::narrow::sphere::meet(center, radius, at, path)?;
    let normal = entered.map_or(radial.normal, |surface| surface.normal);
    let along = offset.dot(normal);
    let depth = (along * along - distance * distance + radius * radius).max(R::ZERO).sqrt() - along;
    Some((normal, depth))
}

/// The thesis has no boxes, capsules or cylinders; the way out is the nearest.
fn inside_oriented<R: Real>(oriented: &OrientedModel<R>, at: R::Vec3) -> Option<(R::Vec3, R)> {
    let nearest = super::narrow::oriented::meet(oriented, at, R::Vec3::ZERO)?;
    Some((nearest.normal, -nearest.gap))
}

/// An open mesh acts on the side of its normals, as a plane does.
fn past_mesh<R: Real>(mesh: &MeshModel<R>, contact: &ContactModel<R>, at: R::Vec3) -> Option<(R::Vec3, R)> {
    let (normal, depth) = super::narrow::mesh::penetration(mesh, at)?;
    (mesh.side_row.is_none() || depth <= contact.thesis_threshold).then_some((normal, depth))
}

fn reaction<R: Real>(normal: R::Vec3, depth: R, contact: &ContactModel<R>, force: R::Vec3) -> R::Vec3 {
    let pressing = (-force.dot(normal)).max(R::ZERO);
    normal * (contact.stiffness * depth + pressing)
}

fn friction<R: Real>(normal: R::Vec3, obstacle: &ObstacleModel<R>, force: R::Vec3, velocity: R::Vec3) -> R::Vec3 {
    let pressing = (-force.dot(normal)).max(R::ZERO);
    let sliding = velocity - normal * velocity.dot(normal);
    let speed = sliding.length();
    if speed > R::from_f64(STILL_SPEED) {
        return sliding * (-obstacle.friction_dynamic * pressing / speed);
    }
    let pulling = force - normal * force.dot(normal);
    let strength = pulling.length();
    if strength > R::ZERO { pulling * (-obstacle.friction_static * pressing / strength) } else { R::Vec3::ZERO }
}
