//! Which bodies come near each other or themselves in a substep, and into how many parts that divides it.
//!
//! Compares boxes around the motion of whole bodies. Where none overlap, nothing else is tested, and the substep is taken as
//! if there were one body only. Where two do, the substep is divided so that no point travels more than half a cell relative
//! to what it may meet, and a sleeping body is woken by one that comes. Whether a body is near itself is tested only once its
//! particles may have moved far enough for that ([`super::itself`]).

use super::itself;
use super::motion::Motion;
use super::points::PointsWorkspace;
use super::workspace::BodiesWorkspace;
use crate::math::{Aabb, Real, Vector};
use crate::physics::model::plan::Plan;
use crate::physics::model::{BodyModel, Model};
use crate::physics::state::State;
use crate::physics::state::sleep;
use crate::physics::stepping::speeds::Speeds;
use crate::physics::team::{self, MIN_CONTACT_PARTICLES};

/// In a part of a substep points travel no further, relative to what they may meet, than this share of the smaller cell, or of
/// the thickness of a mesh that is thinner.
const MAX_TRAVEL_SHARE: f64 = 0.5;

/// No part of a mesh is taken to be thinner than this, in cells.
const MIN_THICKNESS_SHARE: f64 = 0.1;

/// Boxes are grown by this share of the smaller cell, for what forces add to the motion within a substep.
const AHEAD_SHARE: f64 = 0.25;

/// Most parts that a substep is divided into for that: at 1 ms and cells of 1 cm bodies are caught that meet at 1280 m/s.
const MAX_PARTS: u32 = 256;

/// Returns into how many parts the coming substep of `secs` has to be divided so that bodies that come near each other or
/// themselves do not travel past each other in one; none where none do. Wakes sleeping bodies where a moving one comes.
pub(in crate::physics) fn parts<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    secs: f64,
    state: &mut State<R>,
    speeds: &Speeds<R>,
    workspace: &mut BodiesWorkspace<R>,
) -> Option<u32> {
    plan.between_bodies?;
    if !state.bodies.iter().any(|memory| sleep::moves(model, plan, memory)) {
        return None;
    }
    update_self_proximity(model, plan, secs, state, &speeds.relative, workspace);
    let (mut longest, mut are_near) = (0.0_f64, false);
    for number in near_themselves(model, state) {
        are_near = true;
        let body = &model.bodies[number];
        let travel = speeds.relative[number] * secs;
        longest = longest.max(travel / (MAX_TRAVEL_SHARE * body.lattice.grid.cell_size));
    }
    let secs = R::from_f64(secs);
    let motions = &mut workspace.motions;
    motions.clear();
    if model.bodies.len() > 1 {
        motions.resize(model.bodies.len(), Motion::nowhere());
        team::by_bodies(plan.threads, model, motions, |these, motions| {
            for (body, motion) in these.zip(motions) {
                *motion = Motion::of((model, plan, state), body, speeds.velocity_bounds[body], secs);
            }
        });
    }
    for second in 1..model.bodies.len() {
        for first in 0..second {
            let pair = [first, second];
            let moves = pair.iter().any(|body| sleep::moves(model, plan, &state.bodies[*body]));
            if !moves || !may_meet(model, state, pair) {
                continue;
            }
            let [one, other] = pair.map(|body| &motions[body]);
            let cell = pair.map(|body| model.bodies[body].lattice.grid.cell_size);
            let cell = cell[0].min(cell[1]);
            if !one.bounds.grown(R::from_f64(AHEAD_SHARE * cell)).overlaps(&other.bounds) {
                continue;
            }
            are_near = true;
            wake(model, plan, state, pair);
            let thickness = pair.map(|body| thickness(&model.bodies[body]));
            let apart = |a: &Aabb<R>, b: &Aabb<R>| (a.max - b.min).max(R::Vec3::ZERO);
            let travel =
                apart(&one.velocity, &other.velocity).max(apart(&other.velocity, &one.velocity)).length() * secs;
            longest = longest.max(travel.to_f64() / (MAX_TRAVEL_SHARE * thickness[0].min(thickness[1])));
        }
    }
    if !are_near {
        return None;
    }
    if !plan.is_divided() {
        return Some(1);
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count from zero up, saturating")]
    let by_travel = (libm::ceil(longest) as u32).clamp(1, MAX_PARTS);
    Some(by_travel)
}

/// Returns the least thickness of a body that others might pass through, m: that of a cell, or of a mesh that is thinner.
fn thickness<R: Real>(body: &BodyModel<R>) -> f64 {
    let cell = body.lattice.grid.cell_size;
    let skin = body.samples_among_bodies().and_then(|samples| samples.skin.as_ref());
    skin.map_or(cell, |skin| skin.thickness().clamp(MIN_THICKNESS_SHARE * cell, cell))
}

/// Whether two bodies meet at all: neither has fallen out of the scene, and both are set to meet others.
pub(super) fn may_meet<R: Real>(model: &Model<R>, state: &State<R>, pair: [usize; 2]) -> bool {
    pair.iter().all(|body| model.bodies[*body].meets_others() && !state.bodies[*body].gone)
}

/// Bodies that are near themselves and meet themselves. A knotted body does not: its parts have to pass each other for recovery
/// to undo the knot.
pub(super) fn near_themselves<R: Real>(model: &Model<R>, state: &State<R>) -> impl Iterator<Item = usize> {
    let bodies = model.bodies.iter().zip(&state.bodies).enumerate();
    let are_near = bodies.filter(|(_, (body, memory))| {
        body.meets_itself() && memory.near_itself && !memory.asleep && memory.knotted_nanos == 0 && !memory.stuck
    });
    are_near.map(|(number, _)| number)
}

/// Tests which bodies are near themselves. Looks only at bodies whose particles may, in the coming substep of `secs`, have moved
/// past each other by as much as the last look allowed.
fn update_self_proximity<R: Real>(
    model: &Model<R>,
    plan: &Plan,
    secs: f64,
    state: &mut State<R>,
    relative_speeds: &[f64],
    workspace: &mut BodiesWorkspace<R>,
) {
    // Where there is no room for contact yet, a look makes its own.
    workspace.points.resize_with(model.bodies.len(), PointsWorkspace::default);
    let position = &state.position;
    let of_bodies = (&mut state.bodies[..], &mut workspace.points[..]);
    team::for_body_ranges(
        plan.threads,
        MIN_CONTACT_PARTICLES,
        model,
        (of_bodies, ()),
        |these, (memories, points), ()| {
            for ((number, memory), points) in these.zip(memories).zip(points) {
                let body = &model.bodies[number];
                if !body.meets_itself() || memory.asleep {
                    continue;
                }
                let travel = relative_speeds[number] * secs / body.lattice.grid.cell_size;
                memory.apart -= travel;
                if memory.apart.is_nan() || memory.apart <= 0.0 {
                    let position = &position[body.particles.clone()];
                    (memory.near_itself, memory.apart) = itself::check(body, position, travel, points);
                }
            }
        },
    );
}

/// Wakes the one of two bodies that sleeps where the other moves.
fn wake<R: Real>(model: &Model<R>, plan: &Plan, state: &mut State<R>, [first, second]: [usize; 2]) {
    for [sleeper, other] in [[first, second], [second, first]] {
        let comes = sleep::moves(model, plan, &state.bodies[other]) && state.bodies[other].still_substeps == 0;
        if comes && !sleep::moves(model, plan, &state.bodies[sleeper]) {
            state.bodies[sleeper].wake();
        }
    }
}
