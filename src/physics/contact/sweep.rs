//! Moving obstacles. One that was moved while time runs sweeps from where it was to where it is now. One with a motion of
//! its own moves about where it stands or sweeps. Both push bodies in their way. A substep sees a moving obstacle at the end
//! of its way through that substep, with the rigid motion that brings it there.

use std::mem::discriminant;
use std::sync::Arc;

use super::moving::Pose;
use super::placed::Placed;
use crate::math::{Real, Vector};
use crate::physics::model::{MeshModel, Model, ObstacleShape, PlaneModel};
use crate::physics::state::State;
use crate::physics::state::moving::Sweep;

/// Returns the sweeps of obstacles of `new` that are elsewhere than they were among `old`; `kept` names, for each, the one it
/// was. An obstacle with a motion of its own goes on from where it is with its new motion. `state` belongs to the model
/// `before`.
pub(in crate::physics) fn sweeps<R: Real>(
    old: &Placed<R>,
    before: &Model<R>,
    new: &Model<R>,
    kept: &[Option<usize>],
    state: &State<R>,
) -> Vec<Sweep> {
    let pairs = new.obstacles.iter().zip(kept).enumerate();
    pairs
        .filter_map(|(obstacle, (after, was))| {
            let was = (*was)?;
            let (placed, model) = (&old.all()[was], &before.obstacles[was]);
            let sweeps = state.sweeps.iter().any(|sweep| sweep.obstacle == was);
            let moved = sweeps || model.motion != after.motion || model.shape != after.shape;
            let from = Pose::of(&placed.shape).before(after.motion.as_ref(), state.time_secs);
            let moved = moved && same_form(&placed.shape, &after.shape);
            moved.then_some(Sweep { obstacle, center: from.center, rotation: from.rotation, left_secs: Sweep::SECS })
        })
        .collect()
}

/// Advances the sweeps by `secs`; obstacles that have arrived stand still from now on.
pub(in crate::physics) fn advance<R: Real>(model: &Model<R>, secs: f64, state: &mut State<R>) {
    state.sweeps.retain_mut(|sweep| {
        let (next, left_secs) = sweep.next(&model.obstacles[sweep.obstacle], secs);
        (sweep.center, sweep.rotation, sweep.left_secs) = (next.center, next.rotation, left_secs);
        left_secs > 0.0
    });
}

/// Takes over on which side of a plane or an open mesh particles touch it. A plane that was put elsewhere at once keeps the
/// side of particles that are then no deeper than a contact may be.
pub(in crate::physics) fn keep_sides<R: Real>(
    old: &Placed<R>,
    new: &Model<R>,
    kept: &[Option<usize>],
    sides: &[Vec<i8>],
    state: &mut State<R>,
) {
    for (place, (obstacle, before)) in new.obstacles.iter().zip(kept).enumerate() {
        let before = before.map(|before| &old.all()[before].shape);
        let sweeps = state.sweeps.iter().any(|sweep| sweep.obstacle == place);
        if let (ObstacleShape::Mesh(mesh), Some(ObstacleShape::Mesh(was))) = (&obstacle.shape, before) {
            let stayed = MeshModel { side_row: mesh.side_row, ..was.clone() } == *mesh;
            if let (Some(row), Some(row_before), true) = (mesh.side_row, was.side_row, sweeps || stayed) {
                state.side[row].clone_from(&sides[row_before]);
            }
        }
        let (ObstacleShape::Plane(plane), Some(ObstacleShape::Plane(was))) = (&obstacle.shape, before) else {
            continue;
        };
        state.side[plane.side_row].clone_from(&sides[was.side_row]);
        let stayed = PlaneModel { side_row: plane.side_row, ..*was } == *plane;
        if sweeps || stayed {
            continue;
        }
        for body in &new.bodies {
            let deepest = -body.contacts[place].depth_limit;
            for particle in body.particles.clone() {
                let side = &mut state.side[plane.side_row][particle];
                let distance = (state.position[particle] - plane.center).dot(plane.normal);
                let gap = if *side > 0 { distance } else { -distance };
                if gap < deepest {
                    *side = 0;
                }
            }
        }
    }
}

fn same_form<R: Real>(a: &ObstacleShape<R>, b: &ObstacleShape<R>) -> bool {
    match (a, b) {
        (ObstacleShape::Plane(_), ObstacleShape::Plane(_))
        | (ObstacleShape::Sphere { .. }, ObstacleShape::Sphere { .. }) => true,
        (ObstacleShape::Oriented(a), ObstacleShape::Oriented(b)) => discriminant(&a.form) == discriminant(&b.form),
        (ObstacleShape::Mesh(a), ObstacleShape::Mesh(b)) => Arc::ptr_eq(&a.surface, &b.surface),
        _ => false,
    }
}
