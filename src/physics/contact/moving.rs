//! Pose of a moving obstacle: on its way to where it was moved, and by a motion of its own.

use glam::{DMat3, DQuat, DVec3};

use crate::math::{Aabb, FRAME_SECS, Real, RigidMotion, Vector};
use crate::physics::model::{Carry, MeshModel, ObstacleModel, ObstacleShape, OrientedModel, grown_for_rounding};
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
    let stands = Pose::of(&arrived.shape);
    let motion = arrived.motion.as_ref();
    let now = sweep.map_or(stands, Sweep::now).after(motion, time_secs);
    if secs <= 0.0 {
        place(&mut obstacle.shape, now);
        obstacle.bounds = swept_bounds(&obstacle.shape, now, now);
        return obstacle;
    }
    let next = sweep.map_or(stands, |sweep| sweep.next(arrived, secs).0).after(motion, time_secs + secs);
    let turn = DMat3::from_quat(next.rotation) * DMat3::from_quat(now.rotation).transpose();
    place(&mut obstacle.shape, next);
    obstacle.bounds = swept_bounds(&obstacle.shape, now, next);
    obstacle.carry = Some(Carry {
        from: R::Vec3::from_dvec3(now.center),
        to: R::Vec3::from_dvec3(next.center),
        turn: [turn.x_axis, turn.y_axis, turn.z_axis].map(R::Vec3::from_dvec3),
    });
    obstacle
}

/// A point that passes a turning obstacle in a substep may come from this many times the obstacle's reach away.
const LONGEST_PASS: f64 = 32.0;

/// The box that the straight path of a point crosses if the point meets an obstacle that goes from one pose to the next, where
/// `shape` is.
///
/// Past the obstacle such a path is bent: a point that meets it at `p`, with a share `s` of its path behind it, is
/// `(1 - s) (way + (turn - 1) from)` away from `p`, where `from` is where it began, seen from the middle.
fn swept_bounds<R: Real>(shape: &ObstacleShape<R>, now: Pose, next: Pose) -> Aabb<R> {
    let half = shape.half_extents();
    let turned = 2.0 * (next.rotation * now.rotation.inverse()).xyz().length();
    let bounds = Aabb::<f64>::around([now.center, next.center].into_iter().flat_map(|at| [at - half, at + half]));
    let Aabb { min, max } = grown_for_rounding(bounds).grown(half.length() * (LONGEST_PASS * turned).min(2.0));
    Aabb { min: R::Vec3::from_dvec3(min), max: R::Vec3::from_dvec3(max) }
}

fn place<R: Real>(shape: &mut ObstacleShape<R>, pose: Pose) {
    match shape {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use crate::physics::Simulation;
    use crate::physics::contact::broad::path_bounds;
    use crate::physics::contact::narrow::mesh::NearestPointCache;
    use crate::physics::contact::placed::Placed;
    use crate::physics::contact::swept_point::SweptPoint;
    use crate::scene::obstacle::{Capsule, Cuboid, Cylinder, Mesh, Motion, Oscillate, Plane, Sphere, Turn};
    use crate::scene::{self, Body, Obstacle, Scene};

    const SECS: f64 = 1e-2;

    /// An obstacle of each kind with a motion of its own, in a simulation.
    fn moving(motion: Motion) -> Simulation<f64> {
        let rotation_deg = [20.0, 50.0, -70.0];
        let shapes = [
            scene::ObstacleShape::Plane(Plane { half_extents: [0.4, 0.1], rotation_deg, ..Plane::default() }),
            scene::ObstacleShape::Sphere(Sphere { radius: 0.3, ..Sphere::default() }),
            scene::ObstacleShape::Box(Cuboid { half_extents: [0.5, 0.05, 0.2], rotation_deg, ..Cuboid::default() }),
            scene::ObstacleShape::Capsule(Capsule {
                radius: 0.1,
                half_height: 0.4,
                rotation_deg,
                ..Capsule::default()
            }),
            scene::ObstacleShape::Cylinder(Cylinder {
                radius: 0.4,
                half_height: 0.1,
                rotation_deg,
                ..Cylinder::default()
            }),
            scene::ObstacleShape::Mesh(Mesh { path: "builtin:comb.obj".to_owned(), rotation_deg, ..Mesh::default() }),
        ];
        let obstacle = |shape| Obstacle { shape, motion: Some(motion), ..Obstacle::default() };
        let scene = Scene {
            bodies: vec![Body::default()],
            obstacles: shapes.into_iter().map(obstacle).collect(),
            ..Scene::default()
        };
        Simulation::from_scene(&scene, "".as_ref()).expect("a sound scene")
    }

    /// Turns, slow and fast, and a swing.
    fn motions() -> [Motion; 4] {
        let turn = |turns_per_sec| Motion::Turn(Turn { axis: [1.0, 2.0, -0.5], turns_per_sec });
        [
            turn(0.01),
            turn(-0.5),
            turn(8.0),
            Motion::Oscillate(Oscillate { axis: [0.0, 1.0, 1.0], amplitude: 2.0, period_secs: 0.5 }),
        ]
    }

    /// How many of `count` points that start about `far` (m) away meet an obstacle, and how many of those outside its box. Those
    /// from a metre away go by on short paths, the others come to the middle.
    fn meetings(simulation: &Simulation<f64>, [count, far]: [u32; 2], shrunk_by: f64) -> [usize; 2] {
        let (model, mut state) = (simulation.model(), simulation.state().clone());
        let (mut placed, mut rng) = (Placed::now(model, &state), Rng::new(11));
        let mut caches = vec![NearestPointCache::default(); model.mesh_count()];
        let mut met_outside = [0; 2];
        for round in 0..count {
            state.time_secs = rng.between(0.0, 9.0);
            if round % 16 == 0 {
                placed.place(model, &state, SECS);
            }
            for obstacle in placed.all() {
                let mut beside = |far: f64| {
                    let near = DVec3::from([0; 3].map(|_| rng.between(-0.6, 0.6)));
                    Pose::of(&obstacle.shape).center + near * far
                };
                let from = beside(f64::from(far));
                let to = if far == 1 { from + 0.1 * (beside(1.0) - from) } else { beside(1.0) };
                let point = SweptPoint { from, path: to - from, side: 0, largest_coordinates: None };
                if point.meet(obstacle, SECS, &mut caches).is_some() {
                    let bounds = obstacle.bounds.grown(-shrunk_by);
                    let is_outside = !path_bounds::<f64>(from, to - from).overlaps(&bounds);
                    met_outside = [met_outside[0] + 1, met_outside[1] + usize::from(is_outside)];
                }
            }
        }
        met_outside
    }

    #[test]
    fn a_point_that_meets_a_moving_obstacle_crosses_its_box() {
        for (motion, far) in motions().into_iter().zip([20, 20, 2, 20]) {
            let simulation = moving(motion);
            for far in [1, far] {
                let [met, outside] = meetings(&simulation, [4000, far], 0.0);
                assert!(met > 300 && outside == 0, "{motion:?}, from {far} m: {outside} of {met} outside");
            }
        }
    }

    #[test]
    fn boxes_that_are_too_small_are_found_out() {
        let [met, outside] = meetings(&moving(motions()[0]), [4000, 1], 0.1);
        assert!(outside > 5, "{outside} of {met}");
    }

    #[test]
    fn the_box_around_an_obstacle_that_moves_is_hardly_larger_than_around_one_that_stands() {
        let sizes = |motion| {
            let simulation = moving(motion);
            let mut placed = Placed::now(simulation.model(), simulation.state());
            placed.place(simulation.model(), simulation.state(), 1e-3);
            placed.all().iter().map(|obstacle| obstacle.bounds.size().length()).collect::<Vec<f64>>()
        };
        let standing = sizes(Motion::Turn(Turn { turns_per_sec: 1e-9, ..Turn::default() }));
        let [slow, faster, _, swing] = motions();
        for motion in [slow, faster, swing] {
            for (moving, standing) in sizes(motion).into_iter().zip(&standing) {
                assert!(moving < 1.3 * standing, "{motion:?}: {moving} m, standing {standing} m");
            }
        }
    }
}
