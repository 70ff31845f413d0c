//! Obstacles that were put where a body is: by a typed value, by undo, by a new obstacle or a body put elsewhere.
//!
//! An obstacle that suddenly is inside a body would tear it apart. So the body meets the obstacle further back on a straight
//! way, where the two just do not touch. The obstacle comes from there to its place and moves the body out whole:
//!
//! ```text
//!   put here      met there      comes            is there
//!   ┌──┼──┐        │┌─────┐       │┌─────┐         │┌─────┐      way →
//!   │  │  │        ││     │       └│     │        ││     │      left = how far the obstacle that the body meets
//!   └──┼──┘        │└─────┘        │└────┘         │└─────┘             is behind the one that is drawn
//!    left = 0.5     left = 0.5      left = 0.2      left = 0
//! ```
//!
//! The obstacle takes the shortest way; a way down counts four times, as there may be a floor. A plane that carries a body
//! goes on carrying it. The obstacle speeds up and slows down by no more than `ACCELERATION`, and waits as long as it would
//! have to press harder than `MAX_PRESS_IN_WEIGHTS`: a body that cannot get out is left alone. All of this follows from the
//! state, so that a saved motion resumes bit for bit.

use glam::DVec3;

use super::approach::ACCELERATION;
use super::placed::Placed;
use super::record::ContactRecord;
use super::way_out::{MeetingPoints, PriorContact, WayOut, way_out};
use super::workspace::ContactWorkspace;
use crate::math::{Real, Vector};
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, MeshModel, Model, ObstacleModel, ObstacleShape, PlaneModel};
use crate::physics::state::State;
use crate::physics::state::moving::Approach;

/// An obstacle presses a body with at most this many times the body's weight. Where gravity is weaker than `ACCELERATION`,
/// the weight is taken with that.
const MAX_PRESS_IN_WEIGHTS: f64 = 3.0;

/// An obstacle that waits goes on when the press falls to this share of that.
const RELEASE_SHARE: f64 = 0.5;

/// Begins approaches after `state` was fitted to the obstacles of `new`: obstacles that suddenly are elsewhere than in `old`
/// come gently to the bodies they would be inside of. Those that sweep get there without an approach. `kept` names, for each
/// obstacle, the one it was; `placed` has the obstacles where they are now.
pub(in crate::physics) fn begin<R: Real>(
    old: &Placed<R>,
    new: &Model<R>,
    plan: &Plan,
    placed: &Placed<R>,
    kept: &[Option<usize>],
    sides: &[Vec<i8>],
    state: &mut State<R>,
) {
    let running = std::mem::take(&mut state.approaches);
    for (obstacle, (was, ObstacleModel { shape, .. })) in kept.iter().zip(placed.all()).enumerate() {
        let stays = stays(old, placed, kept, state, obstacle);
        for (number, body) in new.bodies.iter().enumerate().filter(|(_, body)| body.modal.is_none()) {
            let before = was.and_then(|was| running.iter().find(|a| (a.body, a.obstacle) == (number, was)));
            if stays {
                state.approaches.extend(before.map(|approach| Approach { obstacle, ..*approach }));
                continue;
            }
            let met = was.map(|was| &old.for_body(number, was).shape);
            let direction = before.map(|approach| approach.way);
            let touches = &state.touches;
            let prior = PriorContact { shape: met, obstacle: was.unwrap_or(obstacle), sides, touches, direction };
            let out = way_out(&MeetingPoints::new(new, plan, number, &state.position), shape, &prior);
            if let Some(WayOut { direction, length_m }) = out {
                let speed = before.map_or(0.0, |approach| approach.speed * approach.way.dot(direction).max(0.0));
                state.approaches.push(Approach {
                    body: number,
                    obstacle,
                    way: direction,
                    left_m: length_m,
                    speed,
                    waits: false,
                });
                keep_side(body, shape, direction, &prior, &mut state.side);
            }
        }
    }
    state.approaches.sort_by_key(|approach| (approach.body, approach.obstacle));
}

/// Whether an obstacle is where it was, or sweeps from there. `kept` names, for each obstacle, the one it was; none for a new
/// one.
pub(in crate::physics) fn stays<R: Real>(
    old: &Placed<R>,
    placed: &Placed<R>,
    kept: &[Option<usize>],
    state: &State<R>,
    obstacle: usize,
) -> bool {
    let sweeps = state.sweeps.iter().any(|sweep| sweep.obstacle == obstacle);
    let was = kept.get(obstacle).copied().flatten();
    was.is_some_and(|was| sweeps || is_same_place(&old.all()[was].shape, &placed.all()[obstacle].shape))
}

/// Begins approaches for a body that was put elsewhere, or now meets obstacles with other points: obstacles that it would be
/// inside of come gently to it.
pub(in crate::physics) fn begin_for<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    obstacles: &[ObstacleModel<R>],
    number: usize,
    state: &mut State<R>,
) {
    state.approaches.retain(|approach| approach.body != number);
    if model.bodies[number].modal.is_some() {
        return;
    }
    let points = MeetingPoints::new(model, plan, number, &state.position);
    for (obstacle, ObstacleModel { shape, .. }) in obstacles.iter().enumerate() {
        if let Some(WayOut { direction, length_m }) = way_out(&points, shape, &PriorContact::none()) {
            state.approaches.push(Approach {
                body: number,
                obstacle,
                way: direction,
                left_m: length_m,
                speed: 0.0,
                waits: false,
            });
        }
    }
    state.approaches.sort_by_key(|approach| (approach.body, approach.obstacle));
}

/// Lets the particles of a body go on touching a plane only on the side to which the plane moves the body out. `side` has the
/// state's rows.
fn keep_side<R: Real>(
    body: &BodyModel<R>,
    shape: &ObstacleShape<R>,
    direction: DVec3,
    prior: &PriorContact<'_, R>,
    side: &mut [Vec<i8>],
) {
    let ObstacleShape::Plane(plane) = shape else { return };
    let touched = |particle: usize| prior.touched(particle).is_some_and(|side| side.dot(direction) > 0.0);
    let kept = if plane.normal.to_dvec3().dot(direction) > 0.0 { 1 } else { -1 };
    for particle in body.particles.clone() {
        side[plane.side_row][particle] = if touched(particle) { kept } else { 0 };
    }
}

/// Advances the approaches by `secs`. An obstacle waits if the contacts found in that time press too hard.
pub(in crate::physics) fn advance<R: Real>(
    model: &Model<R>,
    workspace: &ContactWorkspace<R>,
    secs: f64,
    state: &mut State<R>,
) {
    for approach in &mut state.approaches {
        let body = &model.bodies[approach.body];
        let (speed, distance_m) = approach.next(body, secs);
        approach.left_m -= distance_m;
        let own = |contact: &&ContactRecord<R>| {
            contact.obstacle == approach.obstacle && body.particles.contains(&contact.particle)
        };
        let contacts = workspace.contacts.iter().filter(own);
        let press: f64 = contacts.map(|c| c.force.dot(c.normal).to_f64().max(0.0)).sum();
        let on_mesh = workspace.samples.contacts.iter();
        let on_mesh = on_mesh.filter(|c| (c.body, c.obstacle) == (approach.body, approach.obstacle));
        let press = press + on_mesh.map(|c| c.force.dot(c.normal).max(0.0)).sum::<f64>();
        let mass = body.particle_mass.to_f64() * body.particles.len() as f64;
        let weight = mass * (ACCELERATION * body.size.to_f64()).max(model.gravity.length().to_f64());
        approach.waits = press > MAX_PRESS_IN_WEIGHTS * weight * if approach.waits { RELEASE_SHARE } else { 1.0 };
        approach.speed = if approach.waits { 0.0 } else { speed };
    }
    state.approaches.retain(|approach| approach.left_m > 0.0);
}

fn is_same_place<R: Real>(a: &ObstacleShape<R>, b: &ObstacleShape<R>) -> bool {
    match (a, b) {
        (ObstacleShape::Plane(a), ObstacleShape::Plane(b)) => PlaneModel { side_row: b.side_row, ..*a } == *b,
        (ObstacleShape::Mesh(a), ObstacleShape::Mesh(b)) => MeshModel { side_row: b.side_row, ..a.clone() } == *b,
        _ => a == b,
    }
}
