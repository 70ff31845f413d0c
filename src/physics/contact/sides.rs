//! On which side of a plane or an open mesh particles touch it, from one substep to the next.

use super::narrow;
use super::placed::Placed;
use super::workspace::ContactWorkspace;
use crate::math::{Real, Vector};
use crate::physics::model::{Model, ObstacleShape};
use crate::physics::report::Recorder;
use crate::physics::state::State;

/// Returns the side of a plane or an open mesh on which a point is in contact with this normal: +1 or −1 along the normal of
/// the obstacle. 0 for an obstacle that has an inside.
pub(in crate::physics) fn contact_side<R: Real>(shape: &ObstacleShape<R>, at: R::Vec3, normal: R::Vec3) -> i8 {
    let is_upper = match shape {
        ObstacleShape::Plane(plane) => normal.dot(plane.normal) > R::ZERO,
        ObstacleShape::Mesh(mesh) if mesh.side_row.is_some() => narrow::mesh::is_upper(mesh, at, normal),
        _ => return 0,
    };
    if is_upper { 1 } else { -1 }
}

/// Records on which side of which plane or open mesh every touching particle is once it has moved, and the greatest depth.
pub(in crate::physics) fn remember_sides<R: Real>(
    model: &Model<R>,
    obstacles: &Placed<R>,
    dt: R,
    state: &mut State<R>,
    velocity: &[R::Vec3],
    workspace: &mut ContactWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    let mut deepest = R::from_f64(workspace.samples.deepest);
    // The sides of the last substep are forgotten; the particles that touch now are in the records.
    for (number, body) in model.bodies.iter().enumerate() {
        if state.bodies[number].asleep {
            continue;
        }
        for (obstacle, shape) in model.obstacles.iter().map(|o| &o.shape).enumerate() {
            let marked_near = &mut workspace.marked_near[number * model.obstacles.len() + obstacle];
            if !*marked_near {
                continue;
            }
            *marked_near = false;
            if let Some(row) = shape.side_row() {
                state.side[row][body.particles.clone()].fill(0);
            }
        }
    }
    for contact in &workspace.contacts {
        let Some(number) = model.body_of(contact.particle) else { continue };
        if state.bodies[number].asleep {
            deepest = deepest.max(-contact.gap);
            continue;
        }
        let met = obstacles.for_body(number, contact.obstacle);
        let [force, surface_velocity] = [contact.force, contact.surface_velocity].map(Vector::to_dvec3);
        let work = met.work(force, state.position[contact.particle].to_dvec3(), surface_velocity, dt.to_f64());
        recorder.counters.add_obstacle_work(work, surface_velocity.length());
        let depth = -(contact.gap + (velocity[contact.particle] - contact.surface_velocity).dot(contact.normal) * dt);
        let shape = &met.shape;
        let at = state.position[contact.particle];
        let Some(row) = shape.side_row() else {
            deepest = deepest.max(depth);
            continue;
        };
        if depth >= -narrow::rounding_margin(shape, at) {
            state.side[row][contact.particle] = contact_side(shape, at, contact.normal);
            workspace.marked_near[number * model.obstacles.len() + contact.obstacle] = true;
            deepest = deepest.max(depth);
        }
    }
    recorder.note_depth(deepest.to_f64());
}
