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

use super::workspace::{FoundContact, SamplesWorkspace};
use crate::math::{Aabb, Real, Vector};
use crate::physics::contact::bodies::{CandidateCell, CandidatePoint, Cell, WayOut, way_out};
use crate::physics::contact::narrow;
use crate::physics::contact::placed::Placed;
use crate::physics::kernels::bounds;
use crate::physics::model::{BodyModel, Edge, FIRST_EDGE_POINT, Frame, Model, ObstacleModel};
use crate::physics::report::Counters;
use crate::physics::step::substep::Substep;

/// Boxes are grown by this share of a cell, for places on its outside and for rounding error.
const MARGIN_SHARE: f64 = 1e-3;

/// A particle is deep in an obstacle where it is this many times as deep as contact lets it be.
const DEEP_RATIO: f64 = 2.0;

/// Boxes that look ahead are grown by this share of a cell, for what forces add to the motion within a substep.
const AHEAD_SHARE: f64 = 0.5;

/// Workspace for edges; empty where obstacles have none.
#[derive(Clone, Debug, Default)]
pub(super) struct EdgesWorkspace {
    /// Where the particles of the present body would be at the end of the substep, m.
    predicted: Vec<DVec3>,
    /// The points that may be in its cells then.
    candidates: Vec<CandidatePoint>,
    /// For each of them.
    points: Vec<EdgePoint>,
}

impl EdgesWorkspace {
    pub(super) fn new<R: Real>(model: &Model<R>) -> Self {
        let room = model.edge_room();
        let largest = model.bodies.iter().map(|body| body.particles.len()).max().unwrap_or(0);
        let predicted = Vec::with_capacity(if room > 0 { largest } else { 0 });
        Self { predicted, candidates: Vec::with_capacity(room), points: Vec::with_capacity(room) }
    }
}

/// A point on an edge.
#[derive(Clone, Copy, Debug)]
struct EdgePoint {
    /// Its number.
    sample: usize,
    /// Where it is when the substep begins, m.
    from: DVec3,
    /// The way out of the obstacle, of length 1, or zero.
    outward: DVec3,
}

/// An edge of an obstacle on its way through a substep, in the world.
#[derive(Clone, Copy, Debug)]
struct MovingEdge {
    /// Its ends at the beginning and at the end, m.
    ends: [[DVec3; 2]; 2],
}

impl MovingEdge {
    fn of<R: Real>(edge: &Edge, frame: &Frame<R>, obstacle: &ObstacleModel<R>) -> Self {
        let now = edge.ends.map(|end| frame.place(end));
        let then = obstacle.carry.map_or(now, |carry| now.map(|at| carry.apply(R::Vec3::from_dvec3(at)).to_dvec3()));
        Self { ends: [now, then] }
    }

    /// The box around it at the end.
    fn bounds(&self) -> Aabb<f64> {
        Aabb::around(self.ends[1])
    }

    /// Where the point at a share of its length is at the beginning and at the end, m.
    fn points(&self, share: f64) -> [DVec3; 2] {
        self.ends.map(|[from, to]| from + (to - from) * share)
    }

    /// The part of it that is in a box at the end, as shares of its length; empty where none is.
    fn clipped(&self, bounds: &Aabb<f64>) -> [f64; 2] {
        let [from, to] = self.ends[1];
        (0..3).fold([0.0, 1.0], |[first, last]: [f64; 2], axis| {
            let way = to[axis] - from[axis];
            let [low, high] = [bounds.min[axis] - from[axis], bounds.max[axis] - from[axis]];
            if way == 0.0 {
                return if low <= 0.0 && high >= 0.0 { [first, last] } else { [1.0, 0.0] };
            }
            let [a, b] = [low / way, high / way];
            [first.max(a.min(b)), last.min(a.max(b))]
        })
    }
}

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
        if met.edges.is_empty() {
            continue;
        }
        find_candidates(met, &around, plan.broad_phase, &mut workspace.edges);
        if workspace.edges.candidates.is_empty() {
            continue;
        }
        if workspace.edges.predicted.is_empty() {
            let dt = dt.to_f64();
            let at_end = position.iter().zip(velocity).map(|(at, v)| at.to_dvec3() + v.to_dvec3() * dt);
            workspace.edges.predicted.extend(at_end);
        }
        counters.narrow_tests += locate(body, &mut workspace.edges);
        add_contacts(substep, number, obstacle, velocity, workspace);
    }
    workspace.found_contacts.len() > before
}

/// The box around everything in a box of places that moves with velocities in another box for `dt`, at the end.
fn moved_bounds<R: Real>(at: Aabb<R>, velocity: Aabb<R>, dt: R) -> Aabb<f64> {
    let dt = dt.to_f64();
    Aabb {
        min: at.min.to_dvec3() + velocity.min.to_dvec3() * dt,
        max: at.max.to_dvec3() + velocity.max.to_dvec3() * dt,
    }
}

/// Lists the points on an obstacle's edges that are within a box at the end of the substep.
fn find_candidates<R: Real>(
    obstacle: &ObstacleModel<R>,
    around: &Aabb<f64>,
    broad_phase: bool,
    workspace: &mut EdgesWorkspace,
) {
    let EdgesWorkspace { candidates, points, .. } = workspace;
    candidates.clear();
    points.clear();
    let frame = Frame::of(&obstacle.shape);
    let [middle, half] = [around.center(), 0.5 * around.size()];
    let is_near = |ball: DVec3, radius: f64| {
        if !broad_phase {
            return true;
        }
        let now = frame.place(ball);
        let then = obstacle.carry.map_or(now, |carry| carry.apply(R::Vec3::from_dvec3(now)).to_dvec3());
        let reach = radius * (1.0 + MARGIN_SHARE) + MARGIN_SHARE * half.max_element();
        ((then - middle).abs() - half).max_element() <= reach
    };
    for edge in obstacle.edges.near(is_near) {
        let moving = MovingEdge::of(edge, &frame, obstacle);
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
            if around.holds(to) {
                #[expect(clippy::cast_possible_truncation, reason = "candidates are counted in 32 bits")]
                candidates.push(CandidatePoint::new(candidates.len() as u32, to));
                points.push(EdgePoint { sample: FIRST_EDGE_POINT + edge.first + place, from, outward });
            }
        }
    }
}

/// Finds the cells near the outside of a body that the candidates are in. Returns the number of tests.
fn locate<R: Real>(body: &BodyModel<R>, EdgesWorkspace { predicted, candidates, .. }: &mut EdgesWorkspace) -> u64 {
    let all = Aabb::around(candidates.iter().map(|candidate| candidate.position));
    let mut tests = 0;
    for &cell in &body.hull().outer_cells {
        let mut cell = CandidateCell::new(body, cell, predicted, body.lattice.grid.cell_size);
        if cell.bounds.overlaps(&all) {
            for candidate in &mut *candidates {
                tests += u64::from(cell.test(candidate));
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
    let SamplesWorkspace {
        edges: EdgesWorkspace { predicted, candidates, points }, found_pairs, found_contacts, ..
    } = workspace;
    let found = candidates.iter().zip(&*points).filter(|(candidate, _)| candidate.is_inside());
    let found = found.filter_map(|(candidate, point)| {
        if found_pairs.binary_search(&(point.sample, obstacle)).is_ok() {
            return None;
        }
        let corners = body.lattice.cells[candidate.cell as usize];
        let surface_velocity = (candidate.position - point.from) / dt;
        let weights = Cell::weights(candidate.cell_coordinates);
        let of_cell = corners.iter().zip(weights);
        let of_cell = of_cell.map(|(corner, weight)| velocity[*corner as usize].to_dvec3() * weight).sum::<DVec3>();
        let past = surface_velocity - of_cell;
        let outward = if point.outward == DVec3::ZERO { past.normalize_or_zero() } else { point.outward };
        let mut carriers = corners.iter().map(|corner| start + *corner as usize);
        if body.samples.is_none() && carriers.any(|particle| is_deep_inside(substep, number, particle)) {
            return None;
        }
        let cell = Cell(corners.map(|corner| predicted[corner as usize]));
        let WayOut { normal, depth, .. } = way_out(skin, body, candidate, &cell, Err(outward))?;
        let entered = -dt * past.dot(normal);
        if depth > size.max(2.0 * entered) {
            return None;
        }
        // With these weights the mean of the cell's particles, where they are now, is the point: no moment is left over.
        let now = Cell(corners.map(|corner| state.position[start + corner as usize].to_dvec3()));
        let place = now.locate(point.from, candidate.cell_coordinates, size).unwrap_or(candidate.cell_coordinates);
        Some(FoundContact {
            body: number,
            sample: point.sample,
            obstacle,
            carriers: corners.map(|corner| start + corner as usize),
            weights: Cell::weights(place),
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
        let has_inside = met.shape.side_row().is_none() && met.bounds.holds(at);
        let depth_limit = contact.depth_limit * R::from_f64(DEEP_RATIO);
        has_inside && narrow::meet(&met.shape, 0, at, R::Vec3::ZERO).is_some_and(|surface| surface.gap < -depth_limit)
    })
}

/// Whether a body whose places and velocities are in these boxes comes near an edge of an obstacle in the next `secs`.
pub(super) fn comes_near<R: Real>(
    model: &Model<R>,
    obstacles: &Placed<R>,
    number: usize,
    [at, velocity]: [Aabb<R>; 2],
    secs: R,
) -> bool {
    let body = &model.bodies[number];
    if body.modal.is_some() {
        return false;
    }
    let (now, then) = (moved_bounds(at, velocity, R::ZERO), moved_bounds(at, velocity, secs));
    let around = now.joined(then).grown(AHEAD_SHARE * body.lattice.grid.cell_size);
    let [middle, half] = [around.center(), 0.5 * around.size()];
    let met = (0..model.obstacles.len()).map(|obstacle| obstacles.for_body(number, obstacle));
    met.filter(|obstacle| !obstacle.edges.is_empty()).any(|obstacle| {
        let frame = Frame::of(&obstacle.shape);
        let carried = |at: DVec3| obstacle.carry.map_or(at, |carry| carry.apply(R::Vec3::from_dvec3(at)).to_dvec3());
        let is_near = |ball: DVec3, radius: f64| {
            let (from, to) = (frame.place(ball), carried(frame.place(ball)));
            let reach = radius * (1.0 + MARGIN_SHARE) + (to - from).length();
            ((to - middle).abs() - half).max_element() <= reach
        };
        obstacle.edges.near(is_near).any(|edge| {
            let MovingEdge { ends: [from, to] } = MovingEdge::of(edge, &frame, obstacle);
            Aabb::around(from.into_iter().chain(to)).overlaps(&around)
        })
    })
}
