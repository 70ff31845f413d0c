//! Contact of bodies with each other: points of the outside of one against the deformed cells of another.
//!
//! ```text
//! near        which bodies come near each other in the substep, and into how many parts it has to be divided for that
//! find        which points would be inside which cells at its end, and the way out: a distance field of the body at rest
//!             ([`crate::physics::model::Hull`]), carried along by the cell (cell); points are sorted into a grid (buckets)
//! constraint  each is a contact of nine weighted particles with one effective mass: the same force on the point as, turned
//!             about, on the cell, where the point is: momentum and angular momentum stay as they are
//! solve       a spring with critical damping taken implicitly and Coulomb friction, all contacts together, in a fixed order;
//!             how far each is pressed is in the state
//! record      what met, to be drawn and counted
//! ```
//!
//! It changes the velocities that forces predict, before obstacles do: they have the last word, and nobody is pushed through
//! the ground. All is worked out in double precision and by one thread, so any number of them comes to the same.
//!
//! Follows Fisher and Lin, *Deformed distance fields for simulation of non-penetrating flexible bodies* (2001). Differs: the
//! distance at rest is exact for a body made of cubes and kept by cell, not by corner, as all corners of a slab of one cell
//! are on its outside; points are found where they would be at the end, so that what comes is stopped before it is inside.

mod buckets;
mod cell;
mod constraint;
mod find;
mod law;
mod near;
mod record;
mod solve;
mod workspace;

pub(in crate::physics) use law::PairLaw;
pub(in crate::physics) use near::parts;
pub use record::BodyContact;
pub(in crate::physics) use workspace::BodiesWorkspace;

use glam::DVec3;

use self::buckets::NONE;
use self::cell::Cell;
use self::constraint::{Mover, PointConstraint, SpringBefore};
use self::find::Found;
use crate::math::{Aabb, Real, Vector};
use crate::physics::model::plan::Stage;
use crate::physics::report::Recorder;
use crate::physics::state::press::Press;
use crate::physics::step::substep::Substep;

/// Changes the predicted velocities of all particles of bodies that meet each other within this substep.
pub(in crate::physics) fn meet<R: Real>(
    substep: Substep<'_, R>,
    velocity: &mut [R::Vec3],
    workspace: &mut BodiesWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    let Substep { model, state, plan, .. } = substep;
    workspace.keep_of_sleepers(state);
    recorder.enter(Stage::BroadPhase);
    look_ahead(substep, velocity, workspace);
    let kept = workspace.contacts.len();
    workspace.constraints.clear();
    for second in 1..model.bodies.len() {
        for first in 0..second {
            let (pair, dt) = ([first, second], substep.dt.to_f64());
            let both_asleep = pair.iter().all(|body| state.bodies[*body].asleep);
            if both_asleep || !near::may_meet(model, state, pair) || !overlap(workspace, plan.broad_phase, pair) {
                continue;
            }
            let law = PairLaw::of(model, pair);
            for ordered in [[first, second], [second, first]] {
                recorder.enter(Stage::BroadPhase);
                find::find(model, ordered, plan.broad_phase, workspace, &mut recorder.counters);
                recorder.enter(Stage::Contact);
                // Taken out, so that what is found may be written down beside it.
                let (seen, ahead) = (std::mem::take(&mut workspace.seen), std::mem::take(&mut workspace.ahead));
                let boxes = std::mem::take(&mut workspace.boxes);
                for found in find::ways_out(model, ordered, &seen, &ahead, &boxes) {
                    add(substep, ordered, &law, &found, velocity, dt, workspace);
                }
                (workspace.seen, workspace.ahead, workspace.boxes) = (seen, ahead, boxes);
            }
        }
    }
    let BodiesWorkspace { constraints, movers, contacts, presses, mover_of, moved, .. } = &mut *workspace;
    let (dt, mut deepest) = (substep.dt.to_f64(), 0.0_f64);
    solve::solve(constraints, movers, dt);
    for (contact, constraint) in contacts[kept..].iter_mut().zip(constraints) {
        contact.force = constraint.impulse() / dt;
        deepest = deepest.max(-(contact.gap + dt * constraint.past(movers).dot(contact.normal)));
        let from = |mover: &Mover| {
            if mover.mobility > 0.0 { state.velocity[mover.particle as usize].to_dvec3() } else { mover.before }
        };
        recorder.counters.parting_work_j += constraint.parting_work(from, movers, dt);
        let BodyContact { bodies, particle, .. } = *contact;
        presses.push(Press { bodies, particle, depth_m: constraint.pressed_at_end(movers, dt) });
    }
    presses.sort_unstable_by_key(Press::place);
    recorder.note_depth_between_bodies(deepest);
    for mover in movers.drain(..) {
        mover_of[mover.particle as usize] = NONE;
        if mover.velocity != mover.before {
            let (particle, after) = (mover.particle as usize, R::Vec3::from_dvec3(mover.velocity));
            velocity[particle] = after;
            moved.push((particle, after));
        }
    }
    recorder.last.body_contacts = workspace.pushing();
}

/// Bodies meet nobody within this substep but in their sleep.
pub(in crate::physics) fn keep_apart<R: Real>(
    substep: Substep<'_, R>,
    workspace: &mut BodiesWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    workspace.keep_of_sleepers(substep.state);
    recorder.last.body_contacts = workspace.pushing();
    recorder.note_depth_between_bodies(0.0);
}

/// Finds where everything would be at the end of the substep.
fn look_ahead<R: Real>(substep: Substep<'_, R>, velocity: &[R::Vec3], workspace: &mut BodiesWorkspace<R>) {
    let Substep { model, state, dt, .. } = substep;
    let dt = dt.to_f64();
    workspace.boxes.clear();
    for (number, body) in model.bodies.iter().enumerate() {
        let mut bounds = Aabb::<f64>::empty();
        for particle in body.particles.clone() {
            let at = state.position[particle].to_dvec3();
            let way = if state.bodies[number].asleep { DVec3::ZERO } else { velocity[particle].to_dvec3() * dt };
            workspace.ahead[particle] = at + way;
            bounds = bounds.include(at + way);
        }
        workspace.boxes.push(bounds);
    }
}

fn overlap<R: Real>(workspace: &BodiesWorkspace<R>, is_broad: bool, pair: [usize; 2]) -> bool {
    let [one, other] = pair.map(|body| &workspace.boxes[body]);
    // What is not a number overlaps nothing, and the step is abandoned for it.
    let is_finite = |bounds: &Aabb<f64>| bounds.min.is_finite() && bounds.max.is_finite();
    is_finite(one) && is_finite(other) && (!is_broad || one.overlaps(other))
}

/// Writes a contact down, with the particles that it may move.
fn add<R: Real>(
    substep: Substep<'_, R>,
    [of_point, of_cell]: [usize; 2],
    law: &PairLaw,
    found: &Found,
    velocity: &[R::Vec3],
    dt: f64,
    workspace: &mut BodiesWorkspace<R>,
) {
    let Substep { model, state, .. } = substep;
    let [points, cells] = [of_point, of_cell].map(|number| &model.bodies[number]);
    let particle = points.particles.start + found.point as usize;
    let carriers = found.carriers.map(|corner| cells.particles.start + corner as usize);
    // The weights that make the point of the cell's particles where they are now: with them no moment is left over.
    let now = Cell(carriers.map(|carrier| state.position[carrier].to_dvec3()));
    let place = now.locate(state.position[particle].to_dvec3(), found.at, cells.lattice.grid.cell_size);
    let weights = Cell::weights(place.unwrap_or(found.at));
    let mut movers = [0; 9];
    movers[0] = mover(substep, of_point, particle, velocity, workspace);
    for (mover_at, carrier) in movers[1..].iter_mut().zip(carriers) {
        *mover_at = mover(substep, of_cell, carrier, velocity, workspace);
    }
    let mut all = [1.0; 9];
    all[1..].iter_mut().zip(weights).for_each(|(all, weight)| *all = -weight);
    let speed_of = |place: usize| workspace.movers[movers[place] as usize].before * all[place];
    let past = (0..9).fold(DVec3::ZERO, |sum, place| sum + speed_of(place));
    let depth = found.depth + dt * past.dot(found.normal);
    let known = state.presses.binary_search_by_key(&(particle, of_cell), Press::place);
    let pressed = depth.min(known.map_or(0.0, |place| state.presses[place].depth_m));
    let (spring, gap) = (SpringBefore { depth, pressed }, -depth);
    let Some(constraint) = PointConstraint::new(law, (movers, &workspace.movers), all, found.normal, spring, dt) else {
        return;
    };
    workspace.constraints.push(constraint);
    let (normal, force) = (found.normal, DVec3::ZERO);
    let bodies = [of_point, of_cell];
    workspace.contacts.push(BodyContact { bodies, particle, carriers, weights, normal, gap, force });
}

/// The place of a particle among the movers, where it is put if it is not there.
fn mover<R: Real>(
    substep: Substep<'_, R>,
    body: usize,
    particle: usize,
    velocity: &[R::Vec3],
    workspace: &mut BodiesWorkspace<R>,
) -> u32 {
    let place = &mut workspace.mover_of[particle];
    if *place == NONE {
        let (model, local) = (&substep.model.bodies[body], particle - substep.model.bodies[body].particles.start);
        let is_asleep = substep.state.bodies[body].asleep;
        let is_held = model.is_pinned(local) || is_asleep;
        let mobility = if is_held { 0.0 } else { 1.0 / model.mass(local).to_f64() };
        let before = if is_asleep { DVec3::ZERO } else { velocity[particle].to_dvec3() };
        #[expect(clippy::cast_possible_truncation, reason = "particles are counted in 32 bits")]
        let (next, particle) = (workspace.movers.len() as u32, particle as u32);
        *place = next;
        workspace.movers.push(Mover { particle, mobility, before, velocity: before });
    }
    *place
}
