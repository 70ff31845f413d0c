//! Which points and cells of one body meet: those that do not belong together at rest.
//!
//! ```text
//!    +───+───+───+───+───+
//!    │ a │ a │ b │ c │ c │      the point ● is a corner of the cells a, and b touch one of these: it is kept from them by
//!    +───●───+───+───+───+      links. It meets all others, c.
//!    │ a │ a │ b │ c │ c │
//! ```
//!
//! At rest no cell c is nearer to the point than a cell size. So a body is not near itself as long as it is deformed alike all
//! over: with `x = A X + u` and the least stretch σ of A, no point and cell of it that meet are nearer than `σ − 2 max |u|`, in
//! cell sizes. Only where this bound does not tell are points and cells tested one by one.

use glam::{DMat3, DVec3};

use super::buckets::CandidatePoint;
use super::cell::{Cell, distance_outside};
use super::inverse_map::InverseMap;
use super::points::PointsWorkspace;
use crate::math::{Aabb, Real, Vector};
use crate::physics::model::BodyModel;

/// A body is near itself where a point is within some distance of a cell: at least this, in cells.
const MIN_NEAR_DISTANCE: f64 = 0.5;

/// That distance exceeds how far particles move past each other in a substep by this, for what forces add to it, in cells.
const AHEAD_CELLS: f64 = 0.3;

/// Largest such distance, in cells: less than the distance at rest. A point that moves further in a substep may be caught late,
/// inside.
const MAX_NEAR_DISTANCE: f64 = 0.8;

/// Larger distances are not measured, in cells.
const MAX_MEASURED_DISTANCE: f64 = 1.0;

/// About this many particles are used to find how a body is deformed as a whole.
const FITTED_PARTICLES: usize = 300;

/// Whether a body at these positions (m) is near itself, and how far its particles may move past each other until the next
/// look, in cells; they move by `displacement` in a substep.
pub(super) fn check<R: Real>(
    body: &BodyModel<R>,
    position: &[R::Vec3],
    displacement: f64,
    workspace: &mut PointsWorkspace,
) -> (bool, f64) {
    let near = (AHEAD_CELLS + displacement).clamp(MIN_NEAR_DISTANCE, MAX_NEAR_DISTANCE);
    let distance = match distance_lower_bound(body, position) {
        Some(distance) if distance > near => distance,
        _ => measured_distance(body, position, workspace),
    };
    let is_near = distance <= near;
    (is_near, if is_near { near } else { distance } - AHEAD_CELLS)
}

/// Returns a lower bound of the distance between points and cells that meet, in cells; a good one where a body is deformed much
/// alike all over, none where it is flat.
fn distance_lower_bound<R: Real>(body: &BodyModel<R>, position: &[R::Vec3]) -> Option<f64> {
    let (size, corners) = (body.lattice.grid.cell_size, &body.lattice.corners);
    let corner = |particle: usize| DVec3::from(corners[particle].map(f64::from));
    let some = || {
        (0..position.len()).step_by(1 + position.len() / FITTED_PARTICLES).map(|p| (position[p].to_dvec3(), corner(p)))
    };
    let mean = 1.0 / some().count() as f64;
    let sum = some().fold([DVec3::ZERO; 2], |[at, was], (x, corner)| [at + x, was + corner]);
    let [middle, middle_at_rest] = sum.map(|sum| sum * mean);
    let (mut now, mut at_rest) = (DMat3::ZERO, DMat3::ZERO);
    for (x, was) in some().map(|(x, corner)| (x - middle, corner - middle_at_rest)) {
        now += DMat3::from_cols(x * was.x, x * was.y, x * was.z);
        at_rest += DMat3::from_cols(was * was.x, was * was.y, was * was.z);
    }
    let stretch = now * at_rest.try_inverse()?;
    let off = position.iter().zip(corners).fold(0.0_f64, |off, (at, corner)| {
        let was = DVec3::from(corner.map(f64::from)) - middle_at_rest;
        off.max((at.to_dvec3() - middle - stretch * was).length_squared())
    });
    // Gershgorin's bound of the least eigenvalue.
    let squared = (stretch.transpose() * stretch).to_cols_array_2d();
    let least = (0..3).map(|axis| 2.0 * squared[axis][axis] - squared[axis].iter().map(|of| of.abs()).sum::<f64>());
    let least = least.fold(f64::INFINITY, f64::min).max(0.0).sqrt();
    let distance = (least - 2.0 * off.sqrt()) / size;
    distance.is_finite().then_some(distance)
}

/// Returns the same distance, measured point by point and cell by cell, up to [`MAX_MEASURED_DISTANCE`].
fn measured_distance<R: Real>(body: &BodyModel<R>, position: &[R::Vec3], workspace: &mut PointsWorkspace) -> f64 {
    let (hull, size) = (body.hull(), body.lattice.grid.cell_size);
    let PointsWorkspace { candidates, buckets, sorted, .. } = workspace;
    let at = |particle: u32| position[particle as usize].to_dvec3();
    candidates.clear();
    candidates.extend((0..).zip(&hull.points).map(|(point, particle)| CandidatePoint::new(point, at(*particle))));
    let bounds = Aabb::<f64>::around(candidates.iter().map(|candidate| candidate.position));
    if !(bounds.min.is_finite() && bounds.max.is_finite()) {
        return MAX_MEASURED_DISTANCE;
    }
    buckets.sort(candidates, &bounds, size);
    sorted.clear();
    sorted.extend(buckets.order().iter().map(|place| {
        let CandidatePoint { point, position, .. } = candidates[*place];
        (position, hull.surroundings[point as usize])
    }));
    let mut least = MAX_MEASURED_DISTANCE;
    // A point comes near one of these cells before it comes near one further inside.
    for number in hull.outer_cells.iter().copied().filter(|cell| hull.cells_to_outside[*cell as usize].contains(&0)) {
        let cell = Cell(body.lattice.cells[number as usize].map(at));
        let (around, low) = (Aabb::<f64>::around(cell.0), body.lattice.low(number));
        let within = around.grown(least * size);
        let mut map = None;
        for (point, surroundings) in buckets.rows(&within).flat_map(|row| &sorted[row]) {
            // Most points near a cell belong to it, and this test costs the least.
            if surroundings.contains(low) {
                continue;
            }
            let boxed = (*point - point.clamp(around.min, around.max)).abs().max_element() / size;
            if boxed >= least {
                continue;
            }
            let place = map.get_or_insert_with(|| InverseMap::of(&cell, size)).place(*point);
            least = least.min(place.map_or(boxed, distance_outside).max(boxed));
        }
    }
    least
}
