//! Rest: a body that has come to rest sleeps, and costs nothing until something wakes it.
//!
//! ```text
//! still    for 0.5 s no particle was faster than 1e-3 body sizes a second
//! at rest  still, and none is further than 1e-5 body sizes from where it was then, nor than 1 % of a free fall
//! asleep   velocities are zero; no forces, no contact, no motion; its contacts stay known to be shown
//! awake    by a body or an obstacle that moves and comes near, a hand, new parameters, settings or obstacles, a throw,
//!          another place or another motion; never a body that has fallen out of the scene
//! ```
//!
//! The speed alone would take the top of a flight or the end of a swing for rest; the displacement since the body was first
//! still tells them apart, and the free fall does so where gravity is weak. A body whose damping is strong for its stiffness
//! creeps home slowly: the displacement allowed shrinks by the factor by which its relaxation time exceeds that of the
//! watch. Everything is counted in substeps and kept in the [`State`], so that a saved motion goes on bit for bit, sleep
//! included. A drift slower than 2e-5 body sizes a second is stopped: it cannot be seen.

use crate::math::{Aabb, FRAME_SECS, Real, Vector};
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, LatticeConstants, Model, ObstacleModel};
use crate::physics::state::{BodyMemory, State};
use crate::physics::stepping::checks;

/// How long a body must be still, simulated s.
pub(crate) const STILL_SECS: f64 = 0.5;

/// Speed up to which a particle is still, body sizes a second.
const MAX_STILL_SPEED: f64 = 1e-3;

/// How far particles of a body at rest may be from where they were when it was first still, body sizes.
const MAX_REST_DISPLACEMENT: f64 = 1e-5;

/// The same as a share of a free fall of [`STILL_SECS`].
const FREE_FALL_SHARE: f64 = 0.01;

/// Simulated time between two checks of the displacement, s.
const CHECK_INTERVAL_SECS: f64 = FRAME_SECS;

/// The bodies that are awake.
pub(in crate::physics) fn awake<'a, R: Real>(
    model: &'a Model<R>,
    memory: &'a [BodyMemory],
) -> impl Iterator<Item = &'a BodyModel<R>> {
    model.bodies.iter().zip(memory).filter(|(_, memory)| !memory.asleep).map(|(body, _)| body)
}

/// Bodies that sleep.
pub(in crate::physics) fn asleep_count<R: Real>(state: &State<R>) -> usize {
    state.bodies.iter().filter(|memory| memory.asleep).count()
}

/// Whether there is nothing to do for particles: there are bodies, and all of them sleep.
pub(in crate::physics) fn are_all_asleep<R: Real>(state: &State<R>) -> bool {
    !state.bodies.is_empty() && state.bodies.iter().all(|memory| memory.asleep)
}

/// Substeps for which a body is still before it sleeps.
pub(in crate::physics) fn min_still_substeps(plan: &Plan) -> u64 {
    checks::substeps_in(plan, STILL_SECS, libm::ceil)
}

/// Whether a body moves: its particles are awake, or it is a modal body that is not at rest. An obstacle that moves by itself
/// lets no modal body rest.
pub(in crate::physics) fn moves<R: Real>(model: &Model<R>, plan: &Plan, memory: &BodyMemory) -> bool {
    if !memory.is_modal {
        return !memory.asleep;
    }
    let rests = || plan.sleeping && !model.has_moving_obstacle() && memory.still_substeps > min_still_substeps(plan);
    !memory.gone && !rests()
}

/// Puts every body to sleep that has been at rest for long enough, after a substep; but not one that is `grabbed`, nor one
/// that is `touching` a body that is not ready: bodies that touch fall asleep together.
pub(in crate::physics) fn put_to_sleep<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    grabbed: Option<usize>,
    touching: &(impl Iterator<Item = [usize; 2]> + Clone),
    state: &mut State<R>,
) {
    let (min_still_substeps, substeps_between_checks) =
        (min_still_substeps(plan), checks::substeps_in(plan, CHECK_INTERVAL_SECS, libm::ceil));
    for (number, body) in model.bodies.iter().enumerate() {
        if state.bodies[number].asleep {
            continue;
        }
        let own = body.particles.clone();
        if grabbed == Some(number) || !is_still(body, &state.velocity[own.clone()]) {
            state.bodies[number].still_substeps = 0;
            continue;
        }
        let still_for = state.bodies[number].still_substeps;
        let done = still_for >= min_still_substeps;
        if still_for > 0 && !done && !still_for.is_multiple_of(substeps_between_checks) {
            state.bodies[number].still_substeps += 1;
            continue;
        }
        let displacement = max_displacement::<R>(&state.position[own.clone()], &state.anchor[own.clone()]);
        if still_for == 0 || displacement > max_rest_displacement(model, body, done) {
            state.anchor[own.clone()].copy_from_slice(&state.position[own]);
            state.bodies[number].still_substeps = 1;
        } else if done {
            // Ready: it is put to sleep below, unless it waits for another.
            state.bodies[number].still_substeps = min_still_substeps + 1;
        } else {
            state.bodies[number].still_substeps += 1;
        }
    }
    wait_for_others(min_still_substeps, touching, state);
    for (body, memory) in model.bodies.iter().zip(&mut state.bodies) {
        if !memory.asleep && memory.still_substeps > min_still_substeps {
            (memory.asleep, memory.still_substeps) = (true, min_still_substeps);
            state.velocity[body.particles.clone()].fill(R::Vec3::ZERO);
        }
    }
}

/// Wakes every body near an obstacle that moves by itself, and keeps it awake. Obstacles are placed for the coming substep.
pub(in crate::physics) fn wake_near_moving<R: Real>(
    model: &Model<R>,
    placed: &[ObstacleModel<R>],
    state: &mut State<R>,
) {
    for (number, body) in model.bodies.iter().enumerate() {
        if state.bodies[number].is_modal {
            continue;
        }
        let position = &state.position[body.particles.clone()];
        let is_near = |obstacle: &ObstacleModel<R>| {
            let around = obstacle.bounds.grown(obstacle.bounds.size().length() * R::from_f64(0.5));
            position.iter().any(|at| Aabb { min: *at, max: *at }.overlaps(&around))
        };
        if placed.iter().any(|obstacle| obstacle.motion.is_some() && is_near(obstacle)) {
            state.bodies[number].wake();
        }
    }
}

/// Whether a body keeps those that touch it awake. A modal body that could rest does not: it waits for them itself.
fn keeps_others_awake(memory: &BodyMemory, min_still_substeps: u64) -> bool {
    let still_for = memory.still_substeps;
    if memory.is_modal {
        !memory.gone && still_for < min_still_substeps
    } else {
        !memory.asleep && still_for <= min_still_substeps
    }
}

/// Whether a modal body may not rest yet as a body that is `touching` it is not ready.
pub(in crate::physics) fn must_wait_for_others(
    body: usize,
    mut touching: impl Iterator<Item = [usize; 2]>,
    bodies: &[BodyMemory],
    min_still_substeps: u64,
) -> bool {
    touching.any(|pair| {
        pair.contains(&body)
            && pair.iter().any(|other| *other != body && keeps_others_awake(&bodies[*other], min_still_substeps))
    })
}

/// Keeps bodies awake that are ready to sleep but touch one that is not, and so on along all that touch.
fn wait_for_others<R: Real>(
    min_still_substeps: u64,
    touching: &(impl Iterator<Item = [usize; 2]> + Clone),
    state: &mut State<R>,
) {
    loop {
        let mut has_changed = false;
        for [one, other] in touching.clone() {
            for [body, other] in [[one, other], [other, one]] {
                let is_kept_awake = keeps_others_awake(&state.bodies[other], min_still_substeps);
                let memory = &mut state.bodies[body];
                if is_kept_awake && !memory.asleep && memory.still_substeps > min_still_substeps {
                    (memory.still_substeps, has_changed) = (min_still_substeps, true);
                }
            }
        }
        if !has_changed {
            return;
        }
    }
}

fn is_still<R: Real>(body: &BodyModel<R>, velocity: &[R::Vec3]) -> bool {
    let fastest = R::from_f64(MAX_STILL_SPEED) * body.size;
    // In a body that moves, the first particles usually decide.
    velocity.iter().all(|v| v.dot(*v) <= fastest * fastest)
}

fn max_displacement<R: Real>(position: &[R::Vec3], anchor: &[R::Vec3]) -> f64 {
    position.iter().zip(anchor).fold(R::ZERO, |most, (now, anchor)| most.max((*now - *anchor).length())).to_f64()
}

/// The relaxation time of damped links, s; the longest where links differ by cell.
fn relaxation_secs<R: Real>(body: &BodyModel<R>) -> f64 {
    let of = |LatticeConstants { stiffness, damping }: LatticeConstants| {
        let [stiffness, damping] = [stiffness, damping].map(|by_family| by_family.iter().sum::<f64>());
        if damping > 0.0 { damping / stiffness } else { 0.0 }
    };
    body.lattices().map(of).fold(0.0, f64::max)
}

/// How far a particle of a body at rest may be from its anchor, m; `at_last` also less than gravity would have moved it.
fn max_rest_displacement<R: Real>(model: &Model<R>, body: &BodyModel<R>, at_last: bool) -> f64 {
    let displacement = MAX_REST_DISPLACEMENT * body.size.to_f64() / (relaxation_secs(body) / STILL_SECS).max(1.0);
    let fallen = FREE_FALL_SHARE * 0.5 * model.gravity.length().to_f64() * STILL_SECS * STILL_SECS;
    if at_last && fallen > 0.0 { displacement.min(fallen) } else { displacement }
}
