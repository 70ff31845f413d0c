//! Which cells of a body the edges of obstacles are in at the end of a substep, if nothing stops them.
//!
//! ```text
//!   ┌─────┬─────┐      particles would pass the wall on either side; a point on its edge is in a cell, and pushes the place of
//!   │     │     │      that cell where it is: the eight particles of the cell carry that place, as they carry a point of a
//!   └─────┼─────┘      body's mesh. It leads out of the body by the nearest side against the edge's own way out, as points of
//!         ║ wall       other bodies do
//! ```
//!
//! A point that is deeper than a cell, and than it can have come in the substep, has not come in by that side: it meets nothing.
//! So a body that an obstacle was put into is not torn apart at its edges. Nor does a cell meet edges while particles of it are
//! deep in an obstacle, as in a body that begins there: these push with all that their springs hold, and edges would add to it.

use glam::DVec3;

use super::moving_edge::{MARGIN_SHARE, edges_near, moved_bounds};
use super::workspace::{EdgePoint, EdgesWorkspace, FoundContact, SamplesWorkspace};
use crate::math::{Aabb, Real, Vector};
use crate::physics::contact::bodies::{
    CandidateCell, CandidatePoint, Cell, ExitDirection, INSIDE_TOLERANCE, InverseMap, PointExit, are_beyond,
    write_outcodes,
};
use crate::physics::contact::narrow;
use crate::physics::contact::weighted::WeightedParticles;
use crate::physics::kernels::bounds;
use crate::physics::model::{BodyModel, FIRST_EDGE_POINT, Frame, ObstacleModel};
use crate::physics::report::Counters;
use crate::physics::step::substep::Substep;

/// A particle is deep in an obstacle where it is this many times as deep as contact lets it be.
const DEEP_RATIO: f64 = 2.0;

/// Adds the contacts of obstacles' edges with the cells of a body, if its particles have these velocities, that were not found
/// before. Returns whether there are any.
pub(super) fn find_contacts<R: Real>(
    substep: Substep<'_, R>,
    number: usize,
    velocity: &[R::Vec3],
    workspace: &mut SamplesWorkspace<R>,
    counters: &mut Counters,
) -> bool {
    let Substep { model, state, plan, dt, .. } = substep;
    let body = &model.bodies[number];
    if body.modal.is_some() || !substep.points_are_near {
        return false;
    }
    let own = body.particles.clone();
    let (position, velocity) = (&state.position[own.clone()], &velocity[own]);
    let margin = MARGIN_SHARE * body.lattice.grid.cell_size;
    let around = moved_bounds(bounds::<R>(plan.simd, position), bounds::<R>(plan.simd, velocity), dt).grown(margin);
    let before = workspace.found_contacts.len();
    workspace.edges.predicted.clear();
    for obstacle in 0..model.obstacles.len() {
        let met = substep.obstacles.for_body(number, obstacle);
        if met.edges[number].is_empty() {
            continue;
        }
        let known = |sample| workspace.found_pairs.binary_search(&(sample, obstacle)).is_ok();
        find_candidates((met, number, known), &around, plan.broad_phase, &mut workspace.edges);
        if workspace.edges.candidates.is_empty() {
            continue;
        }
        if workspace.edges.predicted.is_empty() {
            let dt = dt.to_f64();
            let at_end = position.iter().zip(velocity).map(|(at, v)| at.to_dvec3() + v.to_dvec3() * dt);
            workspace.edges.predicted.extend(at_end);
            workspace.edges.deep.clear();
            workspace.edges.deep.resize(position.len(), None);
        }
        counters.narrow_tests += locate(body, &mut workspace.edges);
        add_contacts(substep, number, obstacle, velocity, workspace);
    }
    workspace.found_contacts.len() > before
}

/// Lists the points on an obstacle's edges for a body that are within a box at the end of the substep and not `known` to be
/// met.
fn find_candidates<R: Real>(
    (obstacle, body, known): (&ObstacleModel<R>, usize, impl Fn(usize) -> bool),
    around: &Aabb<f64>,
    broad_phase: bool,
    workspace: &mut EdgesWorkspace,
) {
    let EdgesWorkspace { candidates, points, .. } = workspace;
    candidates.clear();
    points.clear();
    let frame = Frame::of(&obstacle.shape);
    for (edge, moving) in edges_near((obstacle, body), &frame, broad_phase.then_some(around)) {
        if broad_phase && !moving.bounds().overlaps(around) {
            continue;
        }
        let [first, last] = if broad_phase { moving.clipped(around) } else { [0.0, 1.0] };
        let count = edge.count as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "shares of a count")]
        let [low, high] =
            [(first * count - 1.0).floor().max(0.0), (last * count + 1.0).clamp(0.0, count)].map(|at| at as usize);
        let outward = frame.direction(edge.outward);
        for place in low..high {
            let [from, to] = moving.points((place as f64 + 0.5) / count);
            let sample = FIRST_EDGE_POINT + edge.first + place;
            if around.holds(to) && !known(sample) {
                #[expect(clippy::cast_possible_truncation, reason = "candidates are counted in 32 bits")]
                candidates.push(CandidatePoint::new(candidates.len() as u32, to));
                points.push(EdgePoint { sample, from, outward });
            }
        }
    }
}

/// Finds the cells near the outside of a body that the candidates are in. Returns the number of tests.
fn locate<R: Real>(body: &BodyModel<R>, workspace: &mut EdgesWorkspace) -> u64 {
    let EdgesWorkspace { predicted, candidates, buckets, outcodes, .. } = workspace;
    let (all, size) =
        (Aabb::around(candidates.iter().map(|candidate| candidate.position)), body.lattice.grid.cell_size);
    buckets.sort(candidates, &all, size);
    // Most cells are far from the few points that an obstacle has near the body.
    let region = all.grown(2.0 * INSIDE_TOLERANCE * size);
    write_outcodes(&region, predicted.iter().copied(), outcodes);
    let mut tests = 0;
    for &cell in &body.hull().outer_cells {
        if are_beyond(&body.lattice.cells[cell as usize], outcodes) {
            continue;
        }
        let mut cell = CandidateCell::new(body, cell, predicted, size);
        let bounds = cell.bounds;
        if bounds.overlaps(&all) {
            for place in buckets.near(&bounds) {
                tests += u64::from(cell.test(&mut candidates[place]));
            }
        }
    }
    tests
}

/// Makes contacts of the candidates that are in cells and have a way out.
fn add_contacts<R: Real>(
    substep: Substep<'_, R>,
    number: usize,
    obstacle: usize,
    velocity: &[R::Vec3],
    workspace: &mut SamplesWorkspace<R>,
) {
    let Substep { model, state, dt, .. } = substep;
    let (body, dt) = (&model.bodies[number], dt.to_f64());
    let (start, size) = (body.particles.start, body.lattice.grid.cell_size);
    let skin = body.samples_among_bodies().and_then(|samples| samples.skin.as_ref());
    let SamplesWorkspace { edges: EdgesWorkspace { predicted, candidates, points, deep, .. }, found_contacts, .. } =
        workspace;
    let found = candidates.iter().zip(&*points).filter(|(candidate, _)| candidate.is_inside());
    let found = found.filter_map(|(candidate, point)| {
        let corners = body.lattice.cells[candidate.cell as usize];
        let surface_velocity = (candidate.position - point.from) / dt;
        let weights = Cell::weights(candidate.cell_coordinates);
        let of_cell = corners.iter().zip(weights);
        let of_cell = of_cell.map(|(corner, weight)| velocity[*corner as usize].to_dvec3() * weight).sum::<DVec3>();
        let past = surface_velocity - of_cell;
        let outward = if point.outward == DVec3::ZERO { past.normalize_or_zero() } else { point.outward };
        // Many points are in cells that share particles.
        let mut is_deep = |corner: &u32| {
            let particle = start + *corner as usize;
            *deep[*corner as usize].get_or_insert_with(|| is_deep_inside(substep, number, particle))
        };
        if body.samples.is_none() && corners.iter().any(&mut is_deep) {
            return None;
        }
        let cell = Cell(corners.map(|corner| predicted[corner as usize]));
        let direction = ExitDirection::Against(outward);
        let PointExit { normal, depth, .. } = PointExit::of(skin, body, candidate, &cell, direction)?;
        let entered = -dt * past.dot(normal);
        if depth > size.max(2.0 * entered) {
            return None;
        }
        // With these weights the mean of the cell's particles, where they are now, is the point: no moment is left over.
        let now = Cell(corners.map(|corner| state.position[start + corner as usize].to_dvec3()));
        let place = InverseMap::of(&now, size).place_near(point.from, candidate.cell_coordinates);
        Some(FoundContact {
            body: number,
            sample: point.sample,
            obstacle,
            own: WeightedParticles::of_cell(
                corners.map(|corner| start + corner as usize),
                Cell::weights(place.unwrap_or(candidate.cell_coordinates)),
            ),
            normal: -normal,
            gap: entered - depth,
            surface_velocity,
        })
    });
    found_contacts.extend(found);
}

/// Whether a particle of a body is deeper in an obstacle than contact lets it be.
fn is_deep_inside<R: Real>(substep: Substep<'_, R>, number: usize, particle: usize) -> bool {
    let at = substep.state.position[particle];
    substep.model.bodies[number].contacts.iter().enumerate().any(|(obstacle, contact)| {
        let met = substep.obstacles.for_body(number, obstacle);
        let depth = contact.depth_limit * R::from_f64(DEEP_RATIO);
        met.bounds.holds(at) && narrow::is_deeper(&met.shape, at, depth)
    })
}
