//! Contact of bodies with each other and with themselves: points of the outside of one against the deformed cells of
//! another, or of the same where these are not near at rest.
//!
//! ```text
//! near        which bodies come near each other in the substep, and into how many parts it has to be divided for that
//! itself      which come near themselves: what belongs together at rest is left out
//! find        which points would be inside which cells at its end, and the way out: a distance field of the body at rest
//!             ([`crate::physics::model::Hull`]), carried along by the cell (cell); which are near is kept for a while (neighbours, buckets)
//! (weighted)  each is a contact of nine weighted particles with one effective mass: the same force on the point as, turned
//!             about, on the cell, where the point is: momentum and angular momentum stay as they are; a spring with critical
//!             damping taken implicitly and Coulomb friction, all contacts together, in a fixed order; how far each is pressed
//!             is in the state
//! meeting     what is found, as contacts: who has which share in each
//! record      what met, to be drawn and counted
//! ```
//!
//! A modal body moves as a whole: what a contact weighs of it is not a particle but how the point, or the cell where it is,
//! moves by all of its modes ([`ModalBodies`]).
//!
//! It changes the velocities that forces predict, before obstacles do: they have the last word, and nobody is pushed through
//! the ground. All is worked out in double precision and by one thread, so any number of them comes to the same.
//!
//! Follows Fisher and Lin, *Deformed distance fields for simulation of non-penetrating flexible bodies* (2001). Differs: the
//! distance at rest is exact for a body made of cubes and kept by cell, not by corner, as all corners of a slab of one cell
//! are on its outside; points are found where they would be at the end, so that what comes is stopped before it is inside.

mod buckets;
mod cell;
mod find;
mod itself;
mod law;
mod meeting;
mod motion;
mod near;
mod neighbours;
mod record;
mod workspace;

pub(in crate::physics) use law::pair_law;
pub(in crate::physics) use near::parts;
pub use record::BodyContact;
pub(in crate::physics) use workspace::BodiesWorkspace;

use glam::DVec3;

use self::buckets::Seen;
use self::meeting::Meeting;
use super::weighted::{self, ModalBodies, Mover, PointConstraint, PointLaw};
use crate::math::{Aabb, Real, Vector};
use crate::physics::kernels::bounds;
use crate::physics::model::plan::Stage;
use crate::physics::report::Recorder;
use crate::physics::state::press::Press;
use crate::physics::step::substep::Substep;

/// Changes the predicted velocities of all particles of bodies that meet each other within this substep.
pub(in crate::physics) fn meet<R: Real>(
    substep: Substep<'_, R>,
    velocity: &mut [R::Vec3],
    modal: &mut impl ModalBodies,
    workspace: &mut BodiesWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    let Substep { model, state, plan, .. } = substep;
    workspace.make_room(model);
    workspace.keep_of_sleepers(model, plan, state);
    recorder.enter(Stage::BroadPhase);
    look_ahead(substep, velocity, modal, workspace);
    let kept = workspace.contacts.len();
    workspace.constraints.clear();
    workspace.movers.clear();
    for second in 0..model.bodies.len() {
        for first in 0..second {
            let pair = [first, second];
            let moves = pair.iter().any(|body| !state.bodies[*body].asleep || modal.moves(*body));
            if moves && near::may_meet(model, state, pair) && overlap(workspace, plan.broad_phase, pair) {
                meet_in(substep, [first, second], velocity, modal, workspace, recorder);
                meet_in(substep, [second, first], velocity, modal, workspace, recorder);
            }
        }
    }
    for body in near::near_themselves(model, state) {
        meet_in(substep, [body, body], velocity, modal, workspace, recorder);
    }
    let BodiesWorkspace { constraints, movers, contacts, presses, moved, .. } = &mut *workspace;
    let (dt, mut deepest) = (substep.dt.to_f64(), 0.0_f64);
    recorder.counters.body_contacts += constraints.len() as u64;
    weighted::solve(constraints, movers, modal, dt);
    for (contact, constraint) in contacts[kept..].iter_mut().zip(constraints) {
        contact.force = constraint.impulse() / dt;
        let along = -(contact.gap + dt * constraint.past(movers).dot(contact.normal));
        deepest = deepest.max(contact.nearer.map_or(along, |nearer| along.min(nearer)));
        let BodyContact { bodies, particle, .. } = *contact;
        presses.push(Press { bodies, particle, depth_m: constraint.pressed_at_end(movers, dt) });
    }
    presses.sort_unstable_by_key(Press::place);
    recorder.note_depth_between_bodies(deepest);
    for (mover, now) in movers.all.iter().zip(&movers.velocity) {
        if *now != mover.before {
            let (particle, after) = (mover.particle as usize, R::Vec3::from_dvec3(*now));
            velocity[particle] = after;
            moved.push((particle, after));
        }
    }
    for mover in movers.modal.all() {
        modal.take(mover.body, &mover.change);
    }
    // Contacts of a pair follow each other.
    for of_pair in workspace.contacts[kept..].chunk_by(|one, next| one.bodies == next.bodies) {
        let (pair, has_pushed) = (of_pair[0].bodies, of_pair.iter().any(|contact| contact.force != DVec3::ZERO));
        if has_pushed && !workspace.met.contains(&pair) {
            workspace.met.push(pair);
        }
    }
    recorder.last.body_contacts = workspace.pushing();
}

/// Counts the work of parting bodies, once the velocities at the end are known: obstacles may have changed them since.
pub(in crate::physics) fn count_parting<R: Real>(
    substep: Substep<'_, R>,
    velocity: &[R::Vec3],
    workspace: &BodiesWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    let Substep { state, dt, .. } = substep;
    let mean = |mover: &Mover| {
        let particle = mover.particle as usize;
        let both = state.velocity[particle].to_dvec3() + velocity[particle].to_dvec3();
        if mover.mobility > 0.0 { both * 0.5 } else { mover.before }
    };
    let work = |constraint: &PointConstraint| constraint.parting_work(mean, &workspace.movers, dt.to_f64());
    recorder.counters.parting_work_j += workspace.constraints.iter().map(work).sum::<f64>();
}

/// Finds which points of one body meet which cells of another, or of the same, and writes the contacts down.
fn meet_in<R: Real>(
    substep: Substep<'_, R>,
    ordered: [usize; 2],
    velocity: &[R::Vec3],
    modal: &mut impl ModalBodies,
    workspace: &mut BodiesWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    let Substep { model, plan, .. } = substep;
    recorder.enter(Stage::BroadPhase);
    find::find(model, ordered, plan.broad_phase, workspace, &mut recorder.counters);
    recorder.enter(Stage::Contact);
    let damping_ratio = damping_ratio(ordered, modal, &workspace.seen);
    let law = PointLaw { damping_ratio, ..pair_law(model, ordered) };
    // Taken out, so that what is found may be written down beside it.
    let (seen, ahead) = (std::mem::take(&mut workspace.seen), std::mem::take(&mut workspace.ahead));
    let boxes = std::mem::take(&mut workspace.boxes);
    let [of_point, of_cell] = ordered;
    let meeting = Meeting { substep, of_point, of_cell, law, velocity };
    for found in find::ways_out(model, ordered, &seen, &ahead, &boxes) {
        meeting.add(&found, modal, workspace);
    }
    (workspace.seen, workspace.ahead, workspace.boxes) = (seen, ahead, boxes);
}

/// Bodies meet nobody within this substep but in their sleep.
pub(in crate::physics) fn keep_apart<R: Real>(
    substep: Substep<'_, R>,
    workspace: &mut BodiesWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    workspace.keep_of_sleepers(substep.model, substep.plan, substep.state);
    recorder.last.body_contacts = workspace.pushing();
    recorder.note_depth_between_bodies(0.0);
}

/// Damping of the springs of one body's points in another over the critical one. Bodies that both move as wholes have no particle
/// that a spring could stop for itself: together all of one's points in the other are damped as one is.
fn damping_ratio(pair: [usize; 2], modal: &mut impl ModalBodies, seen: &[Seen]) -> f64 {
    if !pair.iter().all(|body| modal.moves(*body)) {
        return 1.0;
    }
    let met = seen.iter().filter(|seen| seen.is_inside()).count().max(1);
    pair.map(|body| modal.damping_ratio(body)).into_iter().fold(1.0, f64::min) / (met as f64).sqrt()
}

/// Finds where everything would be at the end of the substep.
fn look_ahead<R: Real>(
    substep: Substep<'_, R>,
    velocity: &[R::Vec3],
    modal: &mut impl ModalBodies,
    workspace: &mut BodiesWorkspace<R>,
) {
    let Substep { model, state, plan, dt, .. } = substep;
    let dt = dt.to_f64();
    workspace.boxes.clear();
    workspace.drifts.clear();
    for (number, body) in model.bodies.iter().enumerate() {
        if modal.moves(number) {
            workspace.boxes.push(modal.around(number));
            workspace.drifts.push(modal.drift(number));
            continue;
        }
        let mut sum = DVec3::ZERO;
        for particle in body.particles.clone() {
            let at = state.position[particle].to_dvec3();
            let fast = if state.bodies[number].asleep { DVec3::ZERO } else { velocity[particle].to_dvec3() };
            workspace.ahead[particle] = at + fast * dt;
            sum += fast;
        }
        workspace.boxes.push(bounds::<f64>(plan.simd, &workspace.ahead[body.particles.clone()]));
        workspace.drifts.push(sum * (1.0 / body.particles.len() as f64));
    }
    for (number, body) in model.bodies.iter().enumerate() {
        if modal.moves(number) {
            let region = region_of_others(substep, workspace, number);
            let BodiesWorkspace { modal_now, ahead, .. } = &mut *workspace;
            let own = body.particles.clone();
            modal.look_ahead(number, &region, [&mut modal_now[own.clone()], &mut ahead[own]]);
        }
    }
    workspace.neighbours.follow(plan.simd, model, &workspace.ahead);
}

/// A box around all others that a body may meet; without a broad phase it may meet them anywhere.
fn region_of_others<R: Real>(substep: Substep<'_, R>, workspace: &BodiesWorkspace<R>, body: usize) -> Aabb<f64> {
    let Substep { model, state, plan, .. } = substep;
    if !plan.broad_phase {
        return Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
    }
    let others = (0..model.bodies.len()).filter(|other| *other != body && near::may_meet(model, state, [body, *other]));
    let near = others.filter(|other| overlap(workspace, true, [body, *other]));
    near.fold(Aabb::empty(), |region, other| region.joined(workspace.boxes[other]))
}

fn overlap<R: Real>(workspace: &BodiesWorkspace<R>, is_broad: bool, pair: [usize; 2]) -> bool {
    let [one, other] = pair.map(|body| &workspace.boxes[body]);
    // What is not a number overlaps nothing, and the step is abandoned for it.
    let is_finite = |bounds: &Aabb<f64>| bounds.min.is_finite() && bounds.max.is_finite();
    is_finite(one) && is_finite(other) && (!is_broad || one.overlaps(other))
}
