//! Which points of one body are inside which cells of another at the end of a substep, if nothing stops them.
//!
//! ```text
//! bodies      the boxes of two bodies overlap, where they would be at the end
//! neighbours  points on the outside of one body that are near cells of the other: kept until bodies have moved
//! cells       is the point in the box around the cell, in slabs that lean as it does, in the cell itself
//! exit        the shortest of the six along the axes of the cell that lead against the point's own outward direction; in a
//!             body that meets others with its mesh, the way to that mesh, and none outside it
//! ```
//!
//! In contact of a body with itself only the cells near its outside are tested, and none that touches a cell around the point
//! ([`super::itself`]).

use glam::DVec3;

use super::buckets::CandidatePoint;
use super::cell::{Cell, INSIDE_TOLERANCE, distance_outside};
use super::exit::{ExitDirection, PointExit};
use super::inverse_map::{InverseMap, Slabs};
use super::neighbours::{candidate_cells, cell_bounds};
use super::points::{PairResult, Penetration, PointsWorkspace};
use super::predicted::PredictedBody;
use super::stored_positions::StoredPositions;
use super::surface_points::SurfacePoints;
use crate::math::{Aabb, Real, Vector};
use crate::physics::model::{BodyModel, Model};
use crate::physics::state::State;
use crate::physics::state::press::Press;

/// A point outside a cell by no more than this, in cells, counts as inside it, and is looked for in no other.
const ROUNDING_TOLERANCE: f64 = 1e-9;

/// A body is mostly inside another where more than this share of its points is.
const MOSTLY_INSIDE_SHARE: f64 = 0.5;

/// Everything that the search for points needs, as it would be at the end of the substep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Search<'a, R: Real> {
    pub(super) model: &'a Model<R>,
    /// The state when it begins.
    pub(super) state: &'a State<R>,
    /// Where particles of modal bodies are then, m.
    pub(super) modal_positions: &'a [DVec3],
    /// Positions of all particles, m.
    pub(super) positions: &'a [DVec3],
    pub(super) bodies: &'a [PredictedBody],
    /// What neighbour lists are made from; without, every point is looked for in every cell.
    pub(super) stored_positions: Option<&'a StoredPositions>,
}

impl<R: Real> Search<'_, R> {
    /// Where a particle of a body is when the substep begins, m.
    fn position_now(&self, body: usize, particle: usize) -> DVec3 {
        if self.bodies[body].is_modal {
            self.modal_positions[particle]
        } else {
            self.state.position[particle].to_dvec3()
        }
    }
}

/// Finds which points of the body `number` are inside which of all bodies whose cells they may be in.
pub(super) fn find_points<R: Real>(search: Search<'_, R>, number: usize, workspace: &mut PointsWorkspace) {
    for place in 0..workspace.cell_bodies.len() {
        let pair = [number, workspace.cell_bodies[place]];
        find_points_in_cells(search, pair, workspace);
        let inside_count = workspace.candidates.iter().filter(|candidate| candidate.is_inside()).count();
        workspace.penetrations.extend(penetrations(search, pair, &workspace.candidates, inside_count));
        workspace.pair_results.push(PairResult { inside_count, penetrations_end: workspace.penetrations.len() });
    }
}

/// Finds the points of one body of a pair that are in cells of the other.
fn find_points_in_cells<R: Real>(search: Search<'_, R>, pair: [usize; 2], workspace: &mut PointsWorkspace) {
    let Search { model, positions, stored_positions, .. } = search;
    let [points, cells] = pair.map(|number| &model.bodies[number]);
    let PointsWorkspace { lists, candidates, buckets, counts, .. } = workspace;
    let surface_points = SurfacePoints::of(model, pair);
    let [own_points, own] = [points, cells].map(|body| &positions[body.particles.clone()]);
    let cell_size = cells.lattice.grid.cell_size;
    let mut tests = 0;
    let candidate = |point: u32| CandidatePoint::new(point, surface_points.position(point, own_points));
    if let Some(stored_positions) = stored_positions {
        let list = lists.updated_list(model, (pair, surface_points), stored_positions, candidates, buckets);
        candidates.clear();
        candidates.extend(list.points.iter().map(|point| candidate(*point)));
        for (number, places) in list.by_cell() {
            let mut cell = CandidateCell::new(cells, number, own, cell_size);
            for place in places {
                tests += u64::from(cell.test(&mut candidates[place as usize]));
            }
        }
    } else {
        candidates.clear();
        candidates.extend(surface_points.numbers().map(candidate));
        let is_itself = pair[0] == pair[1];
        for number in candidate_cells(cells, is_itself) {
            let mut cell = CandidateCell::new(cells, number, own, cell_size);
            let low = cells.lattice.low(number);
            for candidate in &mut *candidates {
                if !(is_itself && surface_points.touch(candidate.point, low)) {
                    tests += u64::from(cell.test(candidate));
                }
            }
        }
    }
    let all_tests = (surface_points.count() * cells.lattice.cells.len()) as u64;
    counts.points += candidates.len() as u64;
    counts.tests += tests;
    counts.tests_saved += all_tests - tests.min(all_tests);
}

/// Returns the penetrations of the points that are inside, in their order; `inside_count` is how many there are.
fn penetrations<R: Real>(
    search: Search<'_, R>,
    [point_body, cell_body]: [usize; 2],
    candidates: &[CandidatePoint],
    inside_count: usize,
) -> impl Iterator<Item = Penetration> {
    let Search { model, state, positions, bodies, .. } = search;
    let [points, cells] = [point_body, cell_body].map(|number| &model.bodies[number]);
    let surface_points = SurfacePoints::of(model, [point_body, cell_body]);
    let is_itself = point_body == cell_body;
    let is_mostly_inside = !is_itself && inside_count as f64 > MOSTLY_INSIDE_SHARE * surface_points.count() as f64;
    // Of two bodies in the same place the later one in the list leaves upwards.
    let upwards = if point_body > cell_body { DVec3::Y } else { DVec3::NEG_Y };
    let apart = || bodies[point_body].bounds.center() - bodies[cell_body].bounds.center();
    let away = is_mostly_inside.then(|| apart().try_normalize().unwrap_or(upwards));
    let skin = cells.samples_among_bodies().filter(|_| !is_itself).and_then(|samples| samples.skin.as_ref());
    candidates.iter().filter(|candidate| candidate.is_inside()).filter_map(move |candidate| {
        let carriers = cells.lattice.cells[candidate.cell as usize];
        let cell = Cell(carriers.map(|corner| positions[cells.particles.start + corner as usize]));
        let outward = || {
            surface_points.outward(points, candidate.point, candidate.position, &positions[points.particles.clone()])
        };
        let direction = away.map_or_else(|| ExitDirection::Against(outward()), ExitDirection::Along);
        let PointExit { normal, depth, nearer } = PointExit::of(skin, cells, candidate, &cell, direction)?;
        let (point, own) = surface_points.carried(candidate.point, points.particles.start);
        let now = Cell(carriers.map(|corner| search.position_now(cell_body, cells.particles.start + corner as usize)));
        let at = own.mean(|particle| search.position_now(point_body, particle));
        let place = InverseMap::of(&now, cells.lattice.grid.cell_size).place_near(at, candidate.cell_coordinates);
        if place.is_none() && is_itself {
            // A body that turned itself by contact with itself would not come to rest.
            return None;
        }
        let known = state.presses.binary_search_by_key(&(point_body, point, cell_body), Press::place);
        Some(Penetration {
            point: candidate.point,
            carriers,
            weights: Cell::weights(place.unwrap_or(candidate.cell_coordinates)),
            pressed: known.map_or(0.0, |place| state.presses[place].depth_m),
            normal,
            depth,
            nearer,
        })
    })
}

/// A cell that points may be in.
pub(in crate::physics::contact) struct CandidateCell<'a> {
    number: u32,
    corners: &'a [u32; 8],
    /// Where the particles of its body are, m.
    own: &'a [DVec3],
    /// The box around it, m.
    pub(in crate::physics::contact) bounds: Aabb<f64>,
    /// What finds places in it, and the slabs around it, once a point is in the box.
    shape: Option<(InverseMap, Slabs)>,
    /// Its size at rest, m.
    size: f64,
}

impl<'a> CandidateCell<'a> {
    /// A cell of a body whose particles are at `own`, m.
    pub(in crate::physics::contact) fn new<R: Real>(
        body: &'a BodyModel<R>,
        number: u32,
        own: &'a [DVec3],
        size: f64,
    ) -> Self {
        let bounds = cell_bounds(body, number, own).grown(INSIDE_TOLERANCE * size);
        Self { number, corners: &body.lattice.cells[number as usize], own, bounds, shape: None, size }
    }

    /// Tests whether a point is in the cell, and less far outside it than of any before. Returns whether it could be.
    pub(in crate::physics::contact) fn test(&mut self, candidate: &mut CandidatePoint) -> bool {
        if candidate.distance_outside == 0.0 || !self.bounds.holds(candidate.position) {
            return false;
        }
        let (map, slabs) = self.shape.get_or_insert_with(|| {
            let cell = Cell(self.corners.map(|corner| self.own[corner as usize]));
            let map = InverseMap::of(&cell, self.size);
            (map, Slabs::around(&cell, &map))
        });
        if !slabs.contain(candidate.position) {
            return true;
        }
        if let Some(at) = map.place_inside(candidate.position) {
            let beyond = distance_outside(at);
            if beyond <= INSIDE_TOLERANCE && beyond < candidate.distance_outside {
                (candidate.cell, candidate.cell_coordinates, candidate.distance_outside) =
                    (self.number, at, if beyond <= ROUNDING_TOLERANCE { 0.0 } else { beyond });
            }
        }
        true
    }
}
