//! Contact of bodies with each other and with themselves: points of the outside of one against the deformed cells of
//! another, or of the same where these are not near at rest.
//!
//! ```text
//! near        which bodies come near each other in the substep, and into how many parts it has to be divided for that
//! itself      which bodies come near themselves: points and cells that belong together at rest are left out
//! find        which points would be inside which cells at its end (cell, inverse_map); pairs that are near are kept for a
//!             while (neighbours, stored_positions, buckets, outcode)
//! exit        the way out of a point: a distance field of the body at rest ([`crate::physics::model::Hull`]), or its mesh,
//!             carried along by the cell
//! surface_points
//!             the points that meet cells: particles of the outside or points of the mesh
//! (weighted)  each is a contact of nine or sixteen weighted particles with one effective mass; point and cell get opposite
//!             forces at the same place, so that momentum and angular momentum stay as they are; a spring with critical
//!             damping taken implicitly and Coulomb friction; all contacts are solved together, in a fixed order; how far
//!             each spring is pressed is in the state
//! points      workspace and results for the points of one body
//! pair        turns the points found into contacts, with the shares of particles and modal bodies in each
//! record      contacts, to be drawn and counted
//! ```
//!
//! A modal body moves as a whole: a contact does not weigh its particles but how the point, or the cell where it is, moves by
//! all of its modes ([`ModalBodies`]).
//!
//! Contact changes the velocities that forces predict, before obstacles do: obstacles have the last word, and no body is pushed
//! through the ground. The implicit scheme has the same contacts among its equations, with those of obstacles. All is computed
//! in double precision. Threads search for the points of different bodies in parallel, which does not change what is found; one
//! thread solves all contacts together, in the order of bodies and points.
//!
//! Follows Fisher and Lin, *Deformed distance fields for simulation of non-penetrating flexible bodies* (2001). Differs: the
//! distance at rest is exact for a body made of cubes and kept by cell, not by corner, as all corners of a slab of one cell
//! are on its outside; points are found where they would be at the end, so that a body that comes is stopped before it is
//! inside.

mod buckets;
mod cell;
mod exit;
mod find;
mod inverse_map;
mod itself;
mod law;
mod motion;
mod near;
mod neighbours;
mod outcode;
mod pair;
mod points;
mod predicted;
mod record;
mod stored_positions;
mod surface_points;
mod workspace;

pub(in crate::physics::contact) use buckets::{Buckets, CandidatePoint};
pub(in crate::physics::contact) use cell::{Cell, INSIDE_TOLERANCE};
pub(in crate::physics::contact) use exit::{ExitDirection, PointExit};
pub(in crate::physics::contact) use find::CandidateCell;
pub(in crate::physics::contact) use inverse_map::InverseMap;
pub(in crate::physics) use law::pair_law;
pub(in crate::physics) use near::parts;
pub(in crate::physics::contact) use outcode::{are_beyond, write_outcodes};
pub(in crate::physics) use points::BYTES_A_POINT;
pub use record::BodyContact;
pub(in crate::physics) use workspace::BodiesWorkspace;

use glam::DVec3;

use self::find::Search;
use self::pair::BodyPair;
use self::points::PointsWorkspace;
use super::weighted::{self, ModalBodies, Mover, PointConstraint, PointLaw, Touching, WeightedConstraints};
use crate::math::{Aabb, Real, Vector};
use crate::physics::kernels::bounds;
use crate::physics::model::plan::Stage;
use crate::physics::report::Recorder;
use crate::physics::state::press::Press;
use crate::physics::step::substep::Substep;
use crate::physics::team::{self, MIN_CONTACT_PARTICLES};

/// Changes the predicted velocities of all particles of bodies that meet each other within this substep.
pub(in crate::physics) fn meet<R: Real>(
    substep: Substep<'_, R>,
    velocity: &mut [R::Vec3],
    modal: &mut impl ModalBodies,
    workspace: &mut BodiesWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    find_contacts(substep, velocity, modal, workspace, recorder);
    let BodiesWorkspace { constraints, movers, .. } = &mut *workspace;
    weighted::solve(constraints, movers, modal, substep.dt.to_f64());
    for (mover, now) in movers.all.iter().zip(&movers.velocity) {
        if *now != mover.predicted_velocity {
            velocity[mover.particle as usize] = R::Vec3::from_dvec3(*now);
        }
    }
    for mover in movers.modal.all() {
        modal.apply_change(mover.body, &mover.change);
    }
    record_contacts(substep, workspace, recorder);
}

/// Finds the contacts of bodies that meet each other within this substep as constraints among the `equations` of the implicit
/// integrator, if every particle would have the `velocity` (m/s) without links. There are no modal bodies.
pub(in crate::physics) fn find_constraints<R: Real>(
    substep: Substep<'_, R>,
    velocity: &[R::Vec3],
    workspace: &mut BodiesWorkspace<R>,
    equations: &mut WeightedConstraints,
    recorder: &mut Recorder<'_>,
) {
    find_contacts(substep, velocity, &mut (), workspace, recorder);
    let BodiesWorkspace { constraints, movers, contacts, kept, .. } = workspace;
    let of_model = (substep.model, substep.state);
    for (contact, constraint) in contacts[*kept..].iter().zip(constraints) {
        equations.add(constraint, Touching::Bodies(contact.bodies), movers, of_model);
    }
}

/// Takes over what the equations were solved for: the impulses of contacts, and the velocities of particles, m/s.
pub(in crate::physics) fn finish_constraints<R: Real>(
    substep: Substep<'_, R>,
    velocity: &[R::Vec3],
    workspace: &mut BodiesWorkspace<R>,
    equations: &WeightedConstraints,
    recorder: &mut Recorder<'_>,
) {
    let BodiesWorkspace { constraints, movers, .. } = &mut *workspace;
    equations.finish::<R>(0, constraints, movers, velocity);
    record_contacts(substep, workspace, recorder);
}

/// Finds the contacts of bodies that meet each other within this substep, where all particles would have the `velocity` (m/s)
/// without them.
fn find_contacts<R: Real>(
    substep: Substep<'_, R>,
    velocity: &[R::Vec3],
    modal: &mut impl ModalBodies,
    workspace: &mut BodiesWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    let Substep { model, state, plan, .. } = substep;
    workspace.make_room(model);
    workspace.keep_sleeping_contacts(model, plan, state);
    recorder.enter(Stage::BroadPhase);
    predict_motion(substep, velocity, modal, workspace);
    workspace.kept = workspace.contacts.len();
    workspace.constraints.clear();
    workspace.movers.clear();
    find_pairs(substep, modal, workspace);
    find_points(substep, workspace, recorder);
    recorder.enter(Stage::Contact);
    constrain(substep, velocity, modal, workspace);
    recorder.counters.body_contacts += workspace.constraints.len() as u64;
}

/// Records the contacts that were found, with the forces that were solved for, and how far their springs are pressed.
fn record_contacts<R: Real>(substep: Substep<'_, R>, workspace: &mut BodiesWorkspace<R>, recorder: &mut Recorder<'_>) {
    let BodiesWorkspace { constraints, movers, contacts, presses, kept, pushed_pairs, .. } = &mut *workspace;
    let (dt, mut deepest) = (substep.dt.to_f64(), 0.0_f64);
    for (contact, constraint) in contacts[*kept..].iter_mut().zip(constraints) {
        contact.force = constraint.impulse() / dt;
        contact.max_work_j = constraint.max_work(movers, dt);
        let along = -(contact.gap + dt * constraint.relative_velocity(movers).dot(contact.normal));
        deepest = deepest.max(contact.nearer.map_or(along, |nearer| along.min(nearer)));
        let BodyContact { bodies, point, .. } = *contact;
        presses.push(Press { bodies, point, depth_m: constraint.pressed_at_end(movers, dt) });
    }
    presses.sort_unstable_by_key(Press::place);
    recorder.note_depth_between_bodies(deepest);
    // Contacts of a pair follow each other.
    for of_pair in contacts[*kept..].chunk_by(|one, next| one.bodies == next.bodies) {
        let (pair, has_pushed) = (of_pair[0].bodies, of_pair.iter().any(|contact| contact.force != DVec3::ZERO));
        if has_pushed && !pushed_pairs.contains(&pair) {
            pushed_pairs.push(pair);
        }
    }
    recorder.last.body_contacts = workspace.pushing_count();
}

/// Counts the work of parting bodies, once the velocities at the end are known: obstacles may have changed them since.
pub(in crate::physics) fn count_parting_work<R: Real>(
    substep: Substep<'_, R>,
    velocity: &[R::Vec3],
    workspace: &BodiesWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    let Substep { state, dt, .. } = substep;
    let mean = |mover: &Mover| {
        let particle = mover.particle as usize;
        let both = state.velocity[particle].to_dvec3() + velocity[particle].to_dvec3();
        if mover.mobility > 0.0 { both * 0.5 } else { mover.predicted_velocity }
    };
    let work = |constraint: &PointConstraint| constraint.parting_work(mean, &workspace.movers, dt.to_f64());
    recorder.counters.parting_work_j += workspace.constraints.iter().map(work).sum::<f64>();
}

/// Finds which bodies may meet each other or themselves.
fn find_pairs<R: Real>(substep: Substep<'_, R>, modal: &impl ModalBodies, workspace: &mut BodiesWorkspace<R>) {
    let Substep { model, state, plan, .. } = substep;
    workspace.pairs.clear();
    for second in 0..model.bodies.len() {
        for first in 0..second {
            let pair = [first, second];
            let moves = pair.iter().any(|body| !state.bodies[*body].asleep || modal.moves(*body));
            if moves && near::may_meet(model, state, pair) && boxes_overlap(workspace, plan.broad_phase, pair) {
                workspace.pairs.extend([[first, second], [second, first]]);
            }
        }
    }
    workspace.pairs.extend(near::near_themselves(model, state).map(|body| [body, body]));
    workspace.points.iter_mut().for_each(PointsWorkspace::clear);
    for [points, cells] in &workspace.pairs {
        workspace.points[*points].cell_bodies.push(*cells);
    }
}

/// Finds which points of each body meet which cells of others, or of itself.
fn find_points<R: Real>(substep: Substep<'_, R>, workspace: &mut BodiesWorkspace<R>, recorder: &mut Recorder<'_>) {
    let Substep { model, plan, state, .. } = substep;
    let BodiesWorkspace {
        predicted_positions, modal_positions, predicted_bodies, stored_positions, pairs, points, ..
    } = workspace;
    if plan.broad_phase {
        stored_positions.update_displacements(plan, model, predicted_positions);
        stored_positions.renew_outdated(model, pairs, predicted_positions);
    }
    let stored_positions = plan.broad_phase.then_some(&*stored_positions);
    let search = Search {
        model,
        state,
        modal_positions,
        positions: predicted_positions,
        bodies: predicted_bodies,
        stored_positions,
    };
    team::for_body_ranges(plan.threads, MIN_CONTACT_PARTICLES, model, (&mut points[..], ()), |these, points, ()| {
        for (number, points) in these.zip(points) {
            find::find_points(search, number, points);
        }
    });
    for points in &*points {
        points.count(&mut recorder.counters);
    }
}

/// Makes contacts of the points that were found, with the movers that they may change.
fn constrain<R: Real>(
    substep: Substep<'_, R>,
    velocity: &[R::Vec3],
    modal: &mut impl ModalBodies,
    workspace: &mut BodiesWorkspace<R>,
) {
    // Taken out, so that contacts may be added to the workspace meanwhile.
    let (pairs, points) = (std::mem::take(&mut workspace.pairs), std::mem::take(&mut workspace.points));
    for &[point_body, cell_body] in &pairs {
        let (inside_count, penetrations) = points[point_body].penetrations(cell_body);
        let damping_ratio = damping_ratio([point_body, cell_body], modal, inside_count);
        let law = PointLaw { damping_ratio, ..pair_law(substep.model, [point_body, cell_body]) };
        let pair = BodyPair { substep, point_body, cell_body, law, velocity };
        for penetration in penetrations {
            pair.add(penetration, modal, workspace);
        }
    }
    (workspace.pairs, workspace.points) = (pairs, points);
}

/// Keeps only the contacts of sleeping bodies: no others meet within this substep.
pub(in crate::physics) fn skip_contact<R: Real>(
    substep: Substep<'_, R>,
    workspace: &mut BodiesWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    workspace.keep_sleeping_contacts(substep.model, substep.plan, substep.state);
    recorder.last.body_contacts = workspace.pushing_count();
    recorder.note_depth_between_bodies(0.0);
}

/// Damping ratio of the springs of one body's points in another, of which `inside_count` are inside. Two modal bodies have no
/// particle that a spring could stop on its own: all points of one in the other are together damped as a single one would be.
fn damping_ratio(pair: [usize; 2], modal: &mut impl ModalBodies, inside_count: usize) -> f64 {
    if !pair.iter().all(|body| modal.moves(*body)) {
        return 1.0;
    }
    pair.map(|body| modal.damping_ratio(body)).into_iter().fold(1.0, f64::min) / (inside_count.max(1) as f64).sqrt()
}

/// Finds where everything would be at the end of the substep.
fn predict_motion<R: Real>(
    substep: Substep<'_, R>,
    velocity: &[R::Vec3],
    modal: &mut impl ModalBodies,
    workspace: &mut BodiesWorkspace<R>,
) {
    let Substep { model, state, plan, dt, .. } = substep;
    let dt = dt.to_f64();
    for (number, body) in workspace.predicted_bodies.iter_mut().enumerate() {
        body.is_modal = modal.moves(number);
    }
    let to = (&mut workspace.predicted_bodies[..], &mut workspace.predicted_positions[..]);
    team::for_body_ranges(plan.threads, MIN_CONTACT_PARTICLES, model, to, |these, bodies, predicted_positions| {
        let first = model.bodies[these.start].particles.start;
        for (number, of_body) in these.zip(bodies) {
            let body = &model.bodies[number];
            // A body that moves by its modes tells itself where it is.
            if of_body.is_modal {
                continue;
            }
            let mut sum = DVec3::ZERO;
            let own = &mut predicted_positions[body.particles.start - first..body.particles.end - first];
            for (particle, to) in body.particles.clone().zip(&mut *own) {
                let fast = if state.bodies[number].asleep { DVec3::ZERO } else { velocity[particle].to_dvec3() };
                *to = state.position[particle].to_dvec3() + fast * dt;
                sum += fast;
            }
            let drift = sum * (1.0 / body.particles.len() as f64);
            (of_body.bounds, of_body.drift) = (bounds::<f64>(plan.simd, own), drift);
        }
    });
    for (number, body) in workspace.predicted_bodies.iter_mut().enumerate().filter(|(_, body)| body.is_modal) {
        (body.bounds, body.drift) = (modal.motion_bounds(number), modal.drift(number));
    }
    for (number, body) in model.bodies.iter().enumerate() {
        if workspace.predicted_bodies[number].is_modal {
            let region = region_of_others(substep, workspace, number);
            let BodiesWorkspace { modal_positions, predicted_positions, .. } = &mut *workspace;
            let own = body.particles.clone();
            modal.predict_positions(
                number,
                &region,
                [&mut modal_positions[own.clone()], &mut predicted_positions[own]],
            );
        }
    }
}

/// A box around all others that a body may meet; without a broad phase it may meet them anywhere.
fn region_of_others<R: Real>(substep: Substep<'_, R>, workspace: &BodiesWorkspace<R>, body: usize) -> Aabb<f64> {
    let Substep { model, state, plan, .. } = substep;
    if !plan.broad_phase {
        return Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
    }
    let others = (0..model.bodies.len()).filter(|other| *other != body && near::may_meet(model, state, [body, *other]));
    let near = others.filter(|other| boxes_overlap(workspace, true, [body, *other]));
    near.fold(Aabb::empty(), |region, other| region.joined(workspace.predicted_bodies[other].bounds))
}

fn boxes_overlap<R: Real>(workspace: &BodiesWorkspace<R>, is_broad: bool, pair: [usize; 2]) -> bool {
    let [one, other] = pair.map(|body| &workspace.predicted_bodies[body].bounds);
    // A box that is not finite overlaps nothing, and the step is abandoned for it.
    let is_finite = |bounds: &Aabb<f64>| bounds.min.is_finite() && bounds.max.is_finite();
    is_finite(one) && is_finite(other) && (!is_broad || one.overlaps(other))
}
