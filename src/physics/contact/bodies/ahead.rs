//! Where bodies would be at the end of a substep, as far as they may meet anything there.

use glam::DVec3;

use super::looked::Way;
use super::near;
use super::workspace::BodiesWorkspace;
use crate::math::{Aabb, Real, Vector};
use crate::physics::contact::weighted::ModalBodies;
use crate::physics::kernels::bounds;
use crate::physics::step::substep::Substep;
use crate::physics::team;

/// Finds where everything that may meet anything would be at the end of the substep.
pub(super) fn look_ahead<R: Real>(
    substep: Substep<'_, R>,
    velocity: &[R::Vec3],
    modal: &mut impl ModalBodies,
    workspace: &mut BodiesWorkspace<R>,
) {
    let Substep { model, state, plan, dt, .. } = substep;
    let dt = dt.to_f64();
    find_needed(substep, velocity, modal, workspace);
    let speed = |body: usize, particle: usize| {
        if state.bodies[body].asleep { DVec3::ZERO } else { velocity[particle].to_dvec3() }
    };
    let BodiesWorkspace { ways, ahead, .. } = &mut *workspace;
    let needed = &*ways;
    team::by_part(plan.threads, [&mut ahead[..]], |part, [ahead]| {
        let first = model.bodies.partition_point(|body| body.particles.end <= part.start);
        let bodies = model.bodies.iter().enumerate().skip(first);
        let within = bodies.take_while(|(_, body)| body.particles.start < part.end);
        for (number, body) in within.filter(|(number, _)| needed[*number].is_needed) {
            for particle in body.particles.start.max(part.start)..body.particles.end.min(part.end) {
                ahead[particle - part.start] = state.position[particle].to_dvec3() + speed(number, particle) * dt;
            }
        }
    });
    let ahead = &*ahead;
    team::by_bodies(plan.threads, model, ways, |part, ways| {
        for ((number, way), body) in part.clone().zip(ways).zip(&model.bodies[part]) {
            if way.is_needed {
                let own = body.particles.clone();
                way.bounds = Aabb::<f64>::around(ahead[own.clone()].iter().copied());
                let sum = own.clone().fold(DVec3::ZERO, |sum, particle| sum + speed(number, particle));
                way.drift = sum * (1.0 / own.len() as f64);
            }
        }
    });
    workspace.boxes.clear();
    workspace.drifts.clear();
    for (number, way) in workspace.ways.iter().enumerate() {
        let (bounds, drift) =
            if modal.moves(number) { (modal.around(number), modal.drift(number)) } else { (way.bounds, way.drift) };
        workspace.boxes.push(bounds);
        workspace.drifts.push(drift);
    }
    for (number, body) in model.bodies.iter().enumerate() {
        if modal.moves(number) {
            let region = region_of_others(substep, workspace, number);
            let BodiesWorkspace { modal_now, ahead, .. } = &mut *workspace;
            let own = body.particles.clone();
            modal.look_ahead(number, &region, [&mut modal_now[own.clone()], &mut ahead[own]]);
        }
    }
    let BodiesWorkspace { neighbours, ahead, ways, .. } = workspace;
    neighbours.follow(plan.threads, model, ahead, |body| ways[body].is_needed || model.bodies[body].modal.is_some());
}

/// Finds which bodies may meet anything: those that are near themselves, and those whose boxes overlap. The boxes are
/// around where each may come at most, and no larger ones are asked for later, so that nobody is missed.
fn find_needed<R: Real>(
    substep: Substep<'_, R>,
    velocity: &[R::Vec3],
    modal: &mut impl ModalBodies,
    workspace: &mut BodiesWorkspace<R>,
) {
    let Substep { model, state, plan, dt, .. } = substep;
    let dt = dt.to_f64();
    // Where a modal body may meet, how far all others reach says where its points are looked for.
    let is_all = !plan.broad_phase || (0..model.bodies.len()).any(|body| modal.moves(body));
    let BodiesWorkspace { ways, .. } = workspace;
    ways.clear();
    ways.extend(model.bodies.iter().zip(&state.bodies).map(|(body, memory)| {
        let own = body.particles.clone();
        let bounds = if is_all {
            Aabb::empty()
        } else {
            let [at, by] = [&state.position, velocity].map(|of| bounds::<R>(plan.simd, &of[own.clone()]));
            let by = if memory.asleep { [DVec3::ZERO; 2] } else { [by.min, by.max].map(|v| v.to_dvec3() * dt) };
            Aabb { min: at.min.to_dvec3() + by[0], max: at.max.to_dvec3() + by[1] }
        };
        Way { is_needed: false, bounds, drift: DVec3::ZERO }
    }));
    if is_all {
        for (number, way) in ways.iter_mut().enumerate() {
            way.is_needed = !modal.moves(number);
        }
        return;
    }
    for second in 1..ways.len() {
        for first in 0..second {
            let pair = [first, second];
            let is_known = pair.iter().all(|body| ways[*body].is_needed);
            let moves = pair.iter().any(|body| !state.bodies[*body].asleep);
            if !is_known && moves && near::may_meet(model, state, pair) && are_near(ways, pair) {
                (ways[first].is_needed, ways[second].is_needed) = (true, true);
            }
        }
    }
    for body in near::near_themselves(model, state) {
        ways[body].is_needed = true;
    }
}

/// Whether two boxes overlap; one that is not a number is looked at in any case.
fn are_near(ways: &[Way], pair: [usize; 2]) -> bool {
    let [one, other] = pair.map(|body| ways[body].bounds);
    let apart = one.min.cmpgt(other.max) | other.min.cmpgt(one.max);
    !apart.any()
}

/// A box around all others that a body may meet; without a broad phase it may meet them anywhere.
fn region_of_others<R: Real>(substep: Substep<'_, R>, workspace: &BodiesWorkspace<R>, body: usize) -> Aabb<f64> {
    let Substep { model, state, plan, .. } = substep;
    if !plan.broad_phase {
        return Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
    }
    let others = (0..model.bodies.len()).filter(|other| *other != body && near::may_meet(model, state, [body, *other]));
    let near = others.filter(|other| near::overlap(workspace, true, [body, *other]));
    near.fold(Aabb::empty(), |region, other| region.joined(workspace.boxes[other]))
}
