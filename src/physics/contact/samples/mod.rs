//! Contact of points that eight particles carry with obstacles. On the original mesh of a model points of the mesh meet
//! obstacles in place of the body's particles, so that it stands on its feet and not on its cells.
//!
//! ```text
//!      ┌────┬────┐          near       which cells come near an obstacle in the substep, with boxes that are never too small
//!      │  ╭─┼─╮  │          find       where points, carried by the particles of their cells, meet its surface: the narrow
//!      ├──┼─┼─┼──┤                     phase is that of particles, moving obstacles and the sides of planes included
//!      │  │ │ │  │          (weighted) each is a contact of eight weighted particles with the effective mass 1 / Σ (w²/m): the
//!      └──●─┴─●──┘ points              force goes to them by their weights, so that the sum of forces and of moments stays
//!   ──────────────────  ground         as it is; all contacts of a body are solved together, in a fixed order
//!                           record     contacts, to be drawn and counted; touches go into the state
//! ```
//!
//! Obstacles that are narrower than a cell, and the edges of others, could pass between all these points. So points of theirs
//! meet the cells of bodies, whatever these meet obstacles with ([`edges`]): the place of a cell where such a point is becomes
//! a contact like the others.
//!
//! Most cells are far from all obstacles; how far is measured now and then, so that they need not be tested in every substep
//! (`clearance`).
//!
//! Pushing some points out may lead others in: the search is repeated with the velocities that contact leaves, until it finds
//! no more points or they hardly differ. Contact changes the velocities that forces predict, after contact between bodies did;
//! the implicit scheme has the same contacts among its equations. Places in cells and impulses are computed in double
//! precision, where points meet surfaces in that of the simulation; all by one thread, so the number of threads makes no
//! difference. Obstacles do work only by their motion, and the energy of springs is in the state: so
//! no energy comes from nowhere at any stiffness, see [`super::weighted`].

mod clearance;
mod edges;
mod find;
mod moving_edge;
mod near;
mod record;
mod workspace;

pub(in crate::physics) use near::comes_near;
pub use record::SampleContact;
pub(in crate::physics) use workspace::SamplesWorkspace;

use glam::DVec3;

use self::workspace::{FoundContact, PartedPoint};
use super::narrow;
use super::response;
use super::sides::contact_side;
use super::weighted::{
    self, ContactPlane, PARTING_SPEED_SHARE, PointConstraint, PointLaw, SpringBefore, Touching, WeightedConstraints,
};
use crate::math::{Real, Vector};
use crate::physics::model::plan::Stage;
use crate::physics::model::{BodyModel, FIRST_EDGE_POINT};
use crate::physics::report::{Counters, Recorder};
use crate::physics::state::touch::SampleTouch;
use crate::physics::step::substep::Substep;

/// How often the search is repeated for points that only the velocities after contact lead into an obstacle. Those found in the
/// last search are remembered on the side that they came from, and are pushed in the next substep.
pub(in crate::physics) const MAX_SEARCH_REPEATS: usize = 4;

/// The search for edges in cells is not repeated where contact moves no particle by more than this, in cells: a point that this
/// leads in is found in the next substep. Points of a mesh may not be missed: they would be on the other side of a plane.
const UNSEARCHED_WAY: f64 = 1e-3;

/// Changes the predicted velocities of all particles that carry points which meet obstacles within this substep.
pub(in crate::physics) fn meet<R: Real>(
    substep: Substep<'_, R>,
    velocity: &mut [R::Vec3],
    workspace: &mut SamplesWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    workspace.keep_sleeping_contacts(substep.state);
    for (number, body) in substep.model.bodies.iter().enumerate() {
        if !meets_by_points(substep, number, body) {
            continue;
        }
        workspace.forget_found();
        for round in 0..=MAX_SEARCH_REPEATS {
            recorder.enter(Stage::BroadPhase);
            let known = workspace.found_contacts.len();
            if !find_contacts(substep, number, velocity, workspace, &mut recorder.counters) {
                break;
            }
            recorder.enter(Stage::Contact);
            constrain(substep, number, known, velocity, workspace);
            if round == MAX_SEARCH_REPEATS {
                break;
            }
            let way = solve(substep, velocity, workspace) * substep.dt.to_f64();
            if body.samples.is_none() && way <= UNSEARCHED_WAY * body.lattice.grid.cell_size {
                break;
            }
        }
        record(substep, workspace, recorder);
    }
    workspace.sort();
}

/// Adds the contacts that bodies have with these velocities (m/s) of all particles, and that were not found before, to the
/// equations of the implicit integrator. Returns whether there are any.
pub(in crate::physics) fn find_constraints<R: Real>(
    substep: Substep<'_, R>,
    velocity: &[R::Vec3],
    workspace: &mut SamplesWorkspace<R>,
    equations: &mut WeightedConstraints,
    recorder: &mut Recorder<'_>,
) -> bool {
    let Substep { model, state, .. } = substep;
    let before = workspace.constraints.len();
    if before == 0 {
        workspace.first_equation = equations.all.len();
    }
    for (number, body) in model.bodies.iter().enumerate() {
        if !meets_by_points(substep, number, body) {
            continue;
        }
        recorder.enter(Stage::BroadPhase);
        let known = workspace.found_contacts.len();
        if !find_contacts(substep, number, velocity, workspace, &mut recorder.counters) {
            continue;
        }
        recorder.enter(Stage::Contact);
        let first = workspace.constraints.len();
        constrain(substep, number, known, velocity, workspace);
        for constraint in &workspace.constraints[first..] {
            equations.add(constraint, Touching::MeshAtObstacle(number), &workspace.movers, (model, state));
        }
    }
    workspace.constraints.len() > before
}

/// Takes over what the equations were solved for, where particles end with these velocities, m/s.
pub(in crate::physics) fn finish_constraints<R: Real>(
    substep: Substep<'_, R>,
    velocity: &[R::Vec3],
    workspace: &mut SamplesWorkspace<R>,
    equations: &WeightedConstraints,
    recorder: &mut Recorder<'_>,
) {
    let SamplesWorkspace { constraints, movers, first_equation, .. } = workspace;
    equations.finish::<R>(*first_equation, constraints, movers, velocity);
    record(substep, workspace, recorder);
    workspace.sort();
}

/// Whether a body may meet obstacles otherwise than by its particles.
fn meets_by_points<R: Real>(substep: Substep<'_, R>, number: usize, body: &BodyModel<R>) -> bool {
    !substep.state.bodies[number].asleep && (body.samples.is_some() || substep.points_are_near && body.modal.is_none())
}

/// Adds the contacts that a body has with these velocities (m/s) and that were not found before: of points of its mesh, and of
/// obstacles' edges with its cells. Returns whether there are any.
fn find_contacts<R: Real>(
    substep: Substep<'_, R>,
    number: usize,
    velocity: &[R::Vec3],
    workspace: &mut SamplesWorkspace<R>,
    counters: &mut Counters,
) -> bool {
    workspace.found_pairs.clear();
    let known = workspace.found_contacts.iter().filter(|found| found.body == number);
    workspace.found_pairs.extend(known.map(|found| (found.sample, found.obstacle)));
    workspace.found_pairs.sort_unstable();
    let samples = substep.model.bodies[number].samples.as_ref();
    let by_mesh =
        samples.is_some_and(|samples| find::find_contacts(substep, number, samples, velocity, workspace, counters));
    edges::find_contacts(substep, number, velocity, workspace, counters) || by_mesh
}

/// Makes constraints of the contacts that were found from place `first` on.
fn constrain<R: Real>(
    substep: Substep<'_, R>,
    number: usize,
    first: usize,
    velocity: &[R::Vec3],
    workspace: &mut SamplesWorkspace<R>,
) {
    let Substep { model, state, dt, .. } = substep;
    let (body, memory) = (&model.bodies[number], near::touches_of(state, number));
    let sum = body.particles.clone().fold(DVec3::ZERO, |sum, particle| sum + velocity[particle].to_dvec3());
    let drift = sum / body.particles.len() as f64;
    let mut kept = first;
    for place in first..workspace.found_contacts.len() {
        let found = workspace.found_contacts[place];
        let FoundContact { sample, obstacle, own, normal, gap, surface_velocity, .. } = found;
        let shares = workspace.movers.weigh_particles(substep, number, &own, velocity);
        let known = memory.binary_search_by_key(&(number, sample, obstacle), SampleTouch::place);
        let depth = -gap;
        let pressed = depth.min(known.map_or(0.0, |place| memory[place].depth_m));
        let leaving_speeds = workspace
            .movers
            .weighted_movers(shares)
            .map(|(mover, weight)| (mover.predicted_velocity - drift).dot(normal) * weight.signum());
        let spring = SpringBefore { depth, pressed, leaving_speed: leaving_speeds.fold(0.0, f64::max) };
        let at = ContactPlane { normal, surface_velocity };
        let law = law(substep, number, obstacle);
        let constraint = PointConstraint::new(&law, &workspace.movers, shares, at, spring, dt.to_f64());
        // A point whose particles are all held meets nothing.
        if let Some(constraint) = constraint {
            workspace.constraints.push(constraint);
            workspace.found_contacts[kept] = found;
            kept += 1;
        }
    }
    workspace.found_contacts.truncate(kept);
}

/// The law of a body's points at an obstacle.
fn law<R: Real>(substep: Substep<'_, R>, number: usize, obstacle: usize) -> PointLaw {
    let (body, met_obstacle) = (&substep.model.bodies[number], &substep.model.obstacles[obstacle]);
    let contact = body.contacts[obstacle].to_f64();
    PointLaw {
        stiffness: contact.stiffness,
        damping_ratio: 1.0,
        depth_limit: contact.depth_limit,
        load: body.body_contact.max_load,
        max_parting_speed: PARTING_SPEED_SHARE * body.size.to_f64(),
        friction: [met_obstacle.friction_static.to_f64(), met_obstacle.friction_dynamic.to_f64()],
    }
}

/// Solves all constraints of a body from zero impulses on, and writes the velocities that they leave. Returns by how much they
/// differ from those before at most, m/s.
fn solve<R: Real>(substep: Substep<'_, R>, velocity: &mut [R::Vec3], workspace: &mut SamplesWorkspace<R>) -> f64 {
    let SamplesWorkspace { constraints, movers, .. } = workspace;
    constraints.iter_mut().for_each(PointConstraint::reset);
    movers.forget_changes();
    weighted::solve(constraints, movers, &mut (), substep.dt.to_f64());
    let mut most = 0.0;
    for (mover, now) in movers.all.iter().zip(&movers.velocity).filter(|(mover, _)| mover.mobility > 0.0) {
        let velocity = &mut velocity[mover.particle as usize];
        most = f64::max(most, (*now - velocity.to_dvec3()).length());
        *velocity = R::Vec3::from_dvec3(*now);
    }
    most
}

/// Counts the work of parting points from obstacles, once the velocities at the end are known: contact of particles may have
/// changed them since.
pub(in crate::physics) fn count_parting_work<R: Real>(
    substep: Substep<'_, R>,
    velocity: &[R::Vec3],
    workspace: &SamplesWorkspace<R>,
    recorder: &mut Recorder<'_>,
) {
    let both = |particle: usize| substep.state.velocity[particle].to_dvec3() + velocity[particle].to_dvec3();
    let work = |point: &PartedPoint| {
        let mean = point.own.iter().map(|(carrier, weight)| both(carrier) * (0.5 * weight)).sum::<DVec3>();
        point.push.work(mean - point.surface_velocity)
    };
    recorder.counters.parting_work_j += workspace.parted.iter().map(work).sum::<f64>();
}

/// Records the contacts found, the touches at the end of the substep, and the work done.
fn record<R: Real>(substep: Substep<'_, R>, workspace: &mut SamplesWorkspace<R>, recorder: &mut Recorder<'_>) {
    let Substep { model, state, .. } = substep;
    let dt = substep.dt.to_f64();
    let SamplesWorkspace { found_contacts, constraints, movers, contacts, touches, parted, deepest, .. } = workspace;
    let has_friction = |obstacle: usize| response::has_friction(&model.obstacles[obstacle]);
    let counters = &mut recorder.counters;
    for (found, constraint) in found_contacts.iter().zip(constraints) {
        let &FoundContact { body: number, sample, obstacle, own, normal, gap, surface_velocity } = found;
        let force = constraint.impulse() / dt;
        counters.frictions += u64::from(force != DVec3::ZERO && has_friction(obstacle));
        let met = substep.obstacles.for_body(number, obstacle);
        counters.add_obstacle_work(met.work(force, own.place(state), surface_velocity, dt), surface_velocity.length());
        let part = |push| PartedPoint { own, surface_velocity, push };
        parted.extend(constraint.parting(movers, dt).map(part));
        contacts.push(SampleContact {
            body: number,
            sample,
            obstacle,
            own,
            normal,
            gap,
            surface_velocity,
            force,
            max_work_j: constraint.max_work(movers, dt),
        });
        let depth = -(gap + dt * constraint.relative_velocity(movers).dot(normal));
        let largest_coordinates = own.iter().map(|(carrier, _)| state.position[carrier]);
        let largest_coordinates = largest_coordinates.fold(R::Vec3::ZERO, |largest, at| largest.max(at).max(-at));
        let shape = &met.shape;
        let is_on_edge = sample >= FIRST_EDGE_POINT;
        let at = R::Vec3::from_dvec3(own.place(state));
        let side = if is_on_edge { 0 } else { contact_side(shape, at, R::Vec3::from_dvec3(normal)) };
        let margin = narrow::rounding_margin(shape, largest_coordinates).to_f64();
        let depth_m = constraint.pressed_at_end(movers, dt);
        if side != 0 && depth >= -margin || depth_m > 0.0 {
            touches.push(SampleTouch { body: number, sample, obstacle, side, depth_m });
        }
        *deepest = deepest.max(depth);
    }
}
