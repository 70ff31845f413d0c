//! Pose of a moving obstacle: on its way to where it was moved, and by a motion of its own.

use glam::{DMat3, DQuat, DVec3};

use crate::math::{Aabb, FRAME_SECS, Real, RigidMotion, Vector};
use crate::physics::model::{Carry, MeshModel, ObstacleModel, ObstacleShape, OrientedModel};
use crate::physics::state::moving::Sweep;

/// Simulated time in which a moved obstacle gets to its new place, s: a frame, so that a dragged obstacle follows the hand
/// at the speed of the hand.
const SWEEP_SECS: f64 = FRAME_SECS;

/// Place and orientation of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pose {
    pub(super) center: DVec3,
    pub(super) rotation: DQuat,
}

impl Pose {
    pub(super) fn of<R: Real>(shape: &ObstacleShape<R>) -> Self {
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

    /// The pose after a motion of its own for `secs`.
    fn after(self, motion: Option<&RigidMotion>, secs: f64) -> Self {
        let Some(motion) = motion else { return self };
        let (way, turn) = motion.at(secs);
        Self { center: self.center + way, rotation: turn * self.rotation }
    }

    /// The pose that it would have without that motion.
    pub(super) fn before(self, motion: Option<&RigidMotion>, secs: f64) -> Self {
        let Some(motion) = motion else { return self };
        let (way, turn) = motion.at(secs);
        Self { center: self.center - way, rotation: turn.inverse() * self.rotation }
    }

    /// Goes a share of the way to another pose; the rotation by normalised linear interpolation, which needs no sine.
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

    fn now(&self) -> Pose {
        Pose { center: self.center, rotation: self.rotation }
    }

    /// Returns the pose after the next `secs`, and the time that is left then.
    pub(super) fn next<R: Real>(&self, arrived: &ObstacleModel<R>, secs: f64) -> (Pose, f64) {
        let to = Pose::of(&arrived.shape);
        let share = (secs / self.left_secs).min(1.0);
        if share < 1.0 { (self.now().towards(to, share), self.left_secs - secs) } else { (to, 0.0) }
    }
}

/// Returns an obstacle that sweeps or moves by itself as bodies meet it in the `secs` after `time_secs`; where `secs` is zero,
/// as it stands at that time. `arrived` is the obstacle at the end of its sweep, without any motion of its own.
pub(super) fn placed<R: Real>(
    sweep: Option<&Sweep>,
    arrived: &ObstacleModel<R>,
    time_secs: f64,
    secs: f64,
) -> ObstacleModel<R> {
    let mut obstacle = arrived.clone();
    let size = arrived.bounds.size().length().to_f64();
    let stands = Pose::of(&arrived.shape);
    let motion = arrived.motion.as_ref();
    let now = sweep.map_or(stands, Sweep::now).after(motion, time_secs);
    if secs <= 0.0 {
        place(&mut obstacle, now);
        obstacle.bounds = around(now.center, size);
        return obstacle;
    }
    let next = sweep.map_or(stands, |sweep| sweep.next(arrived, secs).0).after(motion, time_secs + secs);
    let turn = DMat3::from_quat(next.rotation) * DMat3::from_quat(now.rotation).transpose();
    let way = next.center - now.center;
    place(&mut obstacle, next);
    // Roomy rather than exact: a rotating rectangle swings out of the boxes at both its ends.
    obstacle.bounds = around(next.center, size + way.length());
    obstacle.carry = Some(Carry {
        from: R::Vec3::from_dvec3(now.center),
        to: R::Vec3::from_dvec3(next.center),
        turn: [turn.x_axis, turn.y_axis, turn.z_axis].map(R::Vec3::from_dvec3),
    });
    obstacle
}

/// Returns a box around everything within `reach` (m) of a point.
fn around<R: Real>(center: DVec3, reach: f64) -> Aabb<R> {
    let reach = DVec3::splat(reach);
    Aabb { min: R::Vec3::from_dvec3(center - reach), max: R::Vec3::from_dvec3(center + reach) }
}

fn place<R: Real>(obstacle: &mut ObstacleModel<R>, pose: Pose) {
    match &mut obstacle.shape {
        ObstacleShape::Plane(plane) => {
            let turned = DMat3::from_quat(pose.rotation);
            plane.center = R::Vec3::from_dvec3(pose.center);
            plane.axes = [turned.x_axis, turned.z_axis].map(R::Vec3::from_dvec3);
            plane.normal = R::Vec3::from_dvec3(turned.y_axis);
        }
        ObstacleShape::Sphere { center, .. } => *center = R::Vec3::from_dvec3(pose.center),
        ObstacleShape::Oriented(OrientedModel { center, axes, .. })
        | ObstacleShape::Mesh(MeshModel { center, axes, .. }) => {
            let turned = DMat3::from_quat(pose.rotation);
            *center = R::Vec3::from_dvec3(pose.center);
            *axes = [turned.x_axis, turned.y_axis, turned.z_axis].map(R::Vec3::from_dvec3);
        }
    }
}
