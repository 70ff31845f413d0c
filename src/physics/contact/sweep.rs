//! Obstacles that were moved while time runs: they sweep from where they were to where they are now, and push what is
//! in their way. The substep sees a moving obstacle at the end of its way through that substep, with the rigid motion
//! that brings it there ([`Carry`]).

use std::mem::discriminant;
use std::sync::Arc;

use glam::{DMat3, DQuat, DVec3};

use super::placed::Placed;
use crate::math::{Aabb, FRAME_SECS, Real, Vector};
use crate::physics::model::{Carry, MeshModel, Model, ObstacleModel, ObstacleShape, OrientedModel, PlaneModel};
use crate::physics::state::State;
use crate::physics::state::moving::Sweep;

/// Simulated time in which a moved obstacle gets to its new place, s: a frame, so that one that is dragged follows the
/// hand, at the speed of the hand.
const SWEEP_SECS: f64 = FRAME_SECS;

/// Place and orientation of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Frame {
    center: DVec3,
    rotation: DQuat,
}

impl Frame {
    fn of<R: Real>(shape: &ObstacleShape<R>) -> Self {
        match shape {
            ObstacleShape::Plane(plane) => {
                let [x, z] = plane.axes.map(Vector::to_dvec3);
                let rotation = DQuat::from_mat3(&DMat3::from_cols(x, plane.normal.to_dvec3(), z));
                Self { center: plane.center.to_dvec3(), rotation }
            }
            ObstacleShape::Sphere { center, .. } => Self { center: center.to_dvec3(), rotation: DQuat::IDENTITY },
            ObstacleShape::Oriented(OrientedModel { center, axes, .. })
            | ObstacleShape::Mesh(MeshModel { center, axes, .. }) => {
                let [x, y, z] = axes.map(Vector::to_dvec3);
                Self { center: center.to_dvec3(), rotation: DQuat::from_mat3(&DMat3::from_cols(x, y, z)) }
            }
        }
    }

    /// Part of the way to another frame; the rotation by normalised linear interpolation, which needs no sine.
    fn towards(self, to: Self, share: f64) -> Self {
        let near = if self.rotation.dot(to.rotation) < 0.0 { -to.rotation } else { to.rotation };
        let mixed = self.rotation * (1.0 - share) + near * share;
        let length = mixed.length_squared().sqrt();
        let rotation = if length > 0.0 { mixed * (1.0 / length) } else { to.rotation };
        Self { center: self.center + (to.center - self.center) * share, rotation }
    }
}

impl Sweep {
    /// The time that a sweep takes, s.
    pub const SECS: f64 = SWEEP_SECS;

    fn now(&self) -> Frame {
        Frame { center: self.center, rotation: self.rotation }
    }

    /// Where it is after the next `secs`, and the time that is left then.
    fn next<R: Real>(&self, arrived: &ObstacleModel<R>, secs: f64) -> (Frame, f64) {
        let to = Frame::of(&arrived.shape);
        let share = (secs / self.left_secs).min(1.0);
        if share < 1.0 { (self.now().towards(to, share), self.left_secs - secs) } else { (to, 0.0) }
    }

    /// The obstacle as it meets bodies in the next `secs`; where they are none, as it stands now. `arrived` is what it is
    /// once it is there.
    pub(super) fn place<R: Real>(&self, arrived: &ObstacleModel<R>, secs: f64) -> ObstacleModel<R> {
        let mut obstacle = arrived.clone();
        let size = arrived.bounds.size().length().to_f64();
        if secs <= 0.0 {
            place(&mut obstacle, self.now());
            obstacle.bounds = around(self.center, size);
            return obstacle;
        }
        let (next, _) = self.next(arrived, secs);
        let turn = DMat3::from_quat(next.rotation) * DMat3::from_quat(self.rotation).transpose();
        let way = next.center - self.center;
        place(&mut obstacle, next);
        // Roomy rather than exact: a rotating rectangle swings out of the boxes at both its ends.
        obstacle.bounds = around(next.center, size + way.length());
        obstacle.carry = Some(Carry {
            from: R::Vec3::from_dvec3(self.center),
            to: R::Vec3::from_dvec3(next.center),
            turn: [turn.x_axis, turn.y_axis, turn.z_axis].map(R::Vec3::from_dvec3),
        });
        obstacle
    }
}

/// The obstacles of `new` that are elsewhere than they were among `old`; `kept` names, for each, the one it was.
pub(in crate::physics) fn sweeps<R: Real>(old: &Placed<R>, new: &Model<R>, kept: &[Option<usize>]) -> Vec<Sweep> {
    let pairs = new.obstacles.iter().zip(kept).enumerate();
    pairs
        .filter_map(|(obstacle, (after, before))| {
            let before = &old.all()[(*before)?];
            let moved = before.shape != after.shape && same_form(&before.shape, &after.shape);
            let Frame { center, rotation } = Frame::of(&before.shape);
            moved.then_some(Sweep { obstacle, center, rotation, left_secs: SWEEP_SECS })
        })
        .collect()
}

/// Counts `secs` that have passed; obstacles that are there stand still from now on.
pub(in crate::physics) fn pass<R: Real>(model: &Model<R>, secs: f64, state: &mut State<R>) {
    state.sweeps.retain_mut(|sweep| {
        let (next, left_secs) = sweep.next(&model.obstacles[sweep.obstacle], secs);
        (sweep.center, sweep.rotation, sweep.left_secs) = (next.center, next.rotation, left_secs);
        left_secs > 0.0
    });
}

/// A box that holds everything so near to a point (m).
fn around<R: Real>(center: DVec3, reach: f64) -> Aabb<R> {
    let reach = DVec3::splat(reach);
    Aabb { min: R::Vec3::from_dvec3(center - reach), max: R::Vec3::from_dvec3(center + reach) }
}

/// Takes over on which side of a plane particles touch it. A plane that was put elsewhere at once keeps those that it
/// does not leave deeper than a contact may be.
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

fn place<R: Real>(obstacle: &mut ObstacleModel<R>, frame: Frame) {
    match &mut obstacle.shape {
        ObstacleShape::Plane(plane) => {
            let turned = DMat3::from_quat(frame.rotation);
            plane.center = R::Vec3::from_dvec3(frame.center);
            plane.axes = [turned.x_axis, turned.z_axis].map(R::Vec3::from_dvec3);
            plane.normal = R::Vec3::from_dvec3(turned.y_axis);
        }
        ObstacleShape::Sphere { center, .. } => *center = R::Vec3::from_dvec3(frame.center),
        ObstacleShape::Oriented(OrientedModel { center, axes, .. })
        | ObstacleShape::Mesh(MeshModel { center, axes, .. }) => {
            let turned = DMat3::from_quat(frame.rotation);
            *center = R::Vec3::from_dvec3(frame.center);
            *axes = [turned.x_axis, turned.y_axis, turned.z_axis].map(R::Vec3::from_dvec3);
        }
    }
}
