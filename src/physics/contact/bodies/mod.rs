//! Contact of bodies with each other and with themselves: points of the outside of one against the deformed cells of
//! another, or of the same where these are not near at rest.
//!
//! ```text
//! near        which bodies come near each other in the substep, and into how many parts it has to be divided for that
//! ahead       where those would be at its end
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
//! the ground. All is worked out in double precision. Threads share what is found of each pair by itself; what is found is
//! written down and solved for in the order of the pairs by one of them, so any number comes to the same.
//!
//! Follows Fisher and Lin, *Deformed distance fields for simulation of non-penetrating flexible bodies* (2001). Differs: the
//! distance at rest is exact for a body made of cubes and kept by cell, not by corner, as all corners of a slab of one cell
//! are on its outside; points are found where they would be at the end, so that what comes is stopped before it is inside.

mod ahead;
mod buckets;
mod cell;
mod find;
mod itself;
mod law;
mod looked;
mod meeting;
mod motion;
mod near;
mod neighbours;
mod record;
mod workspace;

pub(in crate::physics) use law::pair_law;
pub(in crate::physics) use looked::BYTES_A_POINT;
pub(in crate::physics) use near::parts;
pub use record::BodyContact;
pub(in crate::physics) use workspace::BodiesWorkspace;

use glam::DVec3;

use self::ahead::look_ahead;
use self::buckets::Seen;
use self::looked::{Found, Search};
use self::meeting::Meeting;
use super::weighted::{self, ModalBodies, Mover, PointConstraint, PointLaw};
use crate::math::{Real, Vector};
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
    list_pairs(substep, modal, workspace);
    recorder.enter(Stage::Contact);
    find::look_for_all(substep, workspace, &mut recorder.counters);
    // Taken out, so that what is found may be written down beside it.
    let (searches, found) = (std::mem::take(&mut workspace.searches), std::mem::take(&mut workspace.found));
    for search in &searches {
        meet_in(substep, search, &found[search.points.clone()], velocity, modal, workspace);
    }
    (workspace.searches, workspace.found) = (searches, found);
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
    for mover in &movers.all {
        if mover.velocity != mover.before {
            let (particle, after) = (mover.particle as usize, R::Vec3::from_dvec3(mover.velocity));
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

/// Lists the pairs of bodies that may meet, and bodies that may meet themselves, with the points that are looked for.
fn list_pairs<R: Real>(substep: Substep<'_, R>, modal: &mut impl ModalBodies, workspace: &mut BodiesWorkspace<R>) {
    let Substep { model, state, plan, .. } = substep;
    let mut pairs = std::mem::take(&mut workspace.pairs);
    pairs.clear();
    for second in 0..model.bodies.len() {
        for first in 0..second {
            let pair = [first, second];
            let moves = pair.iter().any(|body| !state.bodies[*body].asleep || modal.moves(*body));
            if moves && near::may_meet(model, state, pair) && near::overlap(workspace, plan.broad_phase, pair) {
                pairs.extend([[first, second], [second, first]]);
            }
        }
    }
    pairs.extend(near::near_themselves(model, state).map(|body| [body, body]));
    for pair in pairs.iter().filter(|_| plan.broad_phase) {
        workspace.neighbours.forget_old(model, *pair, &workspace.ahead);
    }
    workspace.searches.clear();
    workspace.seen.clear();
    for pair in &pairs {
        find::list(model, *pair, plan.broad_phase, workspace);
    }
    workspace.pairs = pairs;
}

/// Writes down the contacts of points of one body with cells of another, or of the same, as they were found.
fn meet_in<R: Real>(
    substep: Substep<'_, R>,
    search: &Search,
    found: &[Option<Found>],
    velocity: &[R::Vec3],
    modal: &mut impl ModalBodies,
    workspace: &mut BodiesWorkspace<R>,
) {
    let damping_ratio = damping_ratio(search.of, modal, &workspace.seen[search.points.clone()]);
    let law = PointLaw { damping_ratio, ..pair_law(substep.model, search.of) };
    let [of_point, of_cell] = search.of;
    let meeting = Meeting { substep, of_point, of_cell, law, velocity };
    for found in found.iter().flatten() {
        meeting.add(found, modal, workspace);
    }
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
