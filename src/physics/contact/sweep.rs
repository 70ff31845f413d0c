//! Obstacles that were moved while time runs: they sweep from where they were to where they are now, and push what is
//! in their way. The substep sees a moving obstacle at the end of its way through that substep, with the rigid motion
//! that brings it there ([`Carry`]).

use glam::{DMat3, DQuat, DVec3};

use crate::math::{Aabb, Real, Vector};
use crate::physics::model::{Carry, Model, ObstacleModel, ObstacleShape, PlaneModel};
use crate::physics::state::State;

/// Simulated time in which a moved obstacle gets to its new place, s: a frame, so that one that is dragged follows the
/// hand, at the speed of the hand.
const SWEEP_SECS: f64 = 1.0 / 60.0;

/// An obstacle on its way.
#[derive(Clone, Debug)]
pub(crate) struct Sweep<R: Real> {
    obstacle: usize,
    now: Frame,
    to: Frame,
    left_secs: f64,
    /// The two before the last advance.
    before: (Frame, f64),
    /// What it is once it has arrived, as compiled.
    arrived: ObstacleModel<R>,
}

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

impl<R: Real> Sweep<R> {
    /// Whether it is this obstacle that is on its way.
    pub(crate) fn is_of(&self, obstacle: usize) -> bool {
        self.obstacle == obstacle
    }
}

/// The obstacles of `new` that are elsewhere than in `old`; `kept` names, for each, the one it was.
pub(crate) fn sweeps<R: Real>(old: &Model<R>, new: &Model<R>, kept: &[Option<usize>]) -> Vec<Sweep<R>> {
    let pairs = new.obstacles.iter().zip(kept).enumerate();
    pairs
        .filter_map(|(obstacle, (after, before))| {
            let before = &old.obstacles[(*before)?];
            let moved = before.shape != after.shape && same_form(&before.shape, &after.shape);
            let (now, to) = (Frame::of(&before.shape), Frame::of(&after.shape));
            let (left_secs, arrived) = (SWEEP_SECS, after.clone());
            moved.then_some(Sweep { obstacle, now, to, left_secs, before: (now, left_secs), arrived })
        })
        .collect()
}

/// Puts the moving obstacles of a fresh model back to where they still are.
pub(crate) fn begin<R: Real>(model: &mut Model<R>, sweeps: &[Sweep<R>]) {
    for sweep in sweeps {
        let obstacle = &mut model.obstacles[sweep.obstacle];
        place(obstacle, sweep.now);
        obstacle.bounds = around(sweep.now.center, sweep.arrived.bounds.size().length().to_f64());
    }
}

/// A box that holds everything so near to a point (m).
fn around<R: Real>(center: DVec3, reach: f64) -> Aabb<R> {
    let reach = DVec3::splat(reach);
    Aabb { min: R::Vec3::from_dvec3(center - reach), max: R::Vec3::from_dvec3(center + reach) }
}

/// Moves obstacles on by one substep of `dt_secs`; those that have arrived stand still from the next one on.
pub(crate) fn advance<R: Real>(model: &mut Model<R>, sweeps: &mut Vec<Sweep<R>>, dt_secs: f64) {
    sweeps.retain_mut(|sweep| {
        let obstacle = &mut model.obstacles[sweep.obstacle];
        if sweep.left_secs <= 0.0 {
            obstacle.clone_from(&sweep.arrived);
            return false;
        }
        sweep.before = (sweep.now, sweep.left_secs);
        let share = (dt_secs / sweep.left_secs).min(1.0);
        let next = if share < 1.0 { sweep.now.towards(sweep.to, share) } else { sweep.to };
        let turn = DMat3::from_quat(next.rotation) * DMat3::from_quat(sweep.now.rotation).transpose();
        let way = next.center - sweep.now.center;
        let reach = sweep.arrived.bounds.size().length().to_f64() + way.length();
        place(obstacle, next);
        // Roomy rather than exact: a rotating rectangle swings out of the boxes at both its ends.
        obstacle.bounds = around(next.center, reach);
        obstacle.carry = Some(Carry {
            from: R::Vec3::from_dvec3(sweep.now.center),
            to: R::Vec3::from_dvec3(next.center),
            turn: [turn.x_axis, turn.y_axis, turn.z_axis].map(R::Vec3::from_dvec3),
        });
        sweep.now = next;
        sweep.left_secs = if share < 1.0 { sweep.left_secs - dt_secs } else { 0.0 };
        true
    });
}

/// Takes the last advance back, to be followed by a shorter one.
pub(crate) fn take_back<R: Real>(sweeps: &mut [Sweep<R>]) {
    for sweep in sweeps {
        (sweep.now, sweep.left_secs) = sweep.before;
    }
}

/// Takes over on which side of a plane particles touch it. A plane that was put elsewhere at once keeps those that it
/// does not leave deeper than a contact may be.
pub(crate) fn keep_sides<R: Real>(
    old: &Model<R>,
    new: &Model<R>,
    kept: &[Option<usize>],
    sweeps: &[Sweep<R>],
    sides: &[Vec<i8>],
    state: &mut State<R>,
) {
    for (place, (obstacle, before)) in new.obstacles.iter().zip(kept).enumerate() {
        let before = before.map(|before| &old.obstacles[before].shape);
        let (ObstacleShape::Plane(plane), Some(ObstacleShape::Plane(was))) = (&obstacle.shape, before) else {
            continue;
        };
        let sweeps = sweeps.iter().any(|sweep| sweep.obstacle == place);
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
    matches!(
        (a, b),
        (ObstacleShape::Plane(_), ObstacleShape::Plane(_))
            | (ObstacleShape::Sphere { .. }, ObstacleShape::Sphere { .. })
    )
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
    }
}
