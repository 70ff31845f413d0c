//! Which points of one body are inside which cells of another at the end of a substep, if nothing stops them.
//!
//! ```text
//! bodies   the boxes of two bodies overlap, where they would be at the end
//! points   those of the one's outside that are in the overlap, sorted into buckets
//! cells    those of the other whose box meets a bucket: is the point in that box, is it in the cell
//! way out  along the six axes of the cell, of those that lead against the point's own outside the shortest
//! ```
//!
//! A point has an outside of its own: away from the middle of the cells around it. It is pushed out only against that, so
//! that a slab of one cell is not pushed on through another that it is more than half way into, and the edge of a cube on
//! a cube is not pushed off sideways.

use glam::DVec3;

use super::buckets::{NONE, Seen};
use super::cell::{Cell, outside};
use super::workspace::BodiesWorkspace;
use crate::math::{Aabb, Real};
use crate::physics::model::{BodyModel, Model};
use crate::physics::report::Counters;

/// A point on the face between two cells is in either, though rounding puts it outside both by less than this, in cells.
const TOLERANCE: f64 = 1e-4;

/// A point that is outside a cell by no more than this is as good as in it, and looked for in no other.
const NOTHING: f64 = 1e-9;

/// The way out leads against the outside of a point where their directions' product is below this.
const AGAINST: f64 = -0.2;

/// A point of a body in a cell of another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// The point: a local number.
    pub(super) point: u32,
    /// The cell's particles: local numbers.
    pub(super) carriers: [u32; 8],
    /// The place in the cell.
    pub(super) at: DVec3,
    /// Unit normal out of the cell's body.
    pub(super) normal: DVec3,
    /// How deep the point is inside along the normal, m.
    pub(super) depth: f64,
}

/// Finds the points of one body of a pair that are inside the other, and tells of each, in their order.
pub(super) fn find<R: Real>(
    model: &Model<R>,
    [of_points, of_cells]: [usize; 2],
    is_broad: bool,
    workspace: &mut BodiesWorkspace<R>,
    counters: &mut Counters,
) {
    let [points, cells] = [of_points, of_cells].map(|number| &model.bodies[number]);
    let BodiesWorkspace { ahead, boxes, seen, buckets, .. } = workspace;
    let Some(hull) = &points.among_bodies.hull else { return };
    let cell_size = cells.lattice.grid.cell_size;
    let other = boxes[of_cells].grown(TOLERANCE * cell_size);
    seen.clear();
    seen.extend((0..).zip(&hull.points).filter_map(|(point, particle)| {
        let ahead = ahead[points.particles.start + *particle as usize];
        let seen = Seen { point, ahead, cell: NONE, at: DVec3::ZERO, outside: f64::INFINITY };
        (!is_broad || holds(&other, ahead)).then_some(seen)
    }));
    let all_tests = (hull.points.len() * cells.lattice.cells.len()) as u64;
    let mut tests = 0;
    if !seen.is_empty() {
        let bounds = Aabb::<f64>::around(seen.iter().map(|seen| seen.ahead));
        if is_broad {
            buckets.sort(seen, &bounds, cell_size);
        }
        let own = &ahead[cells.particles.clone()];
        for (number, corners) in (0..).zip(&cells.lattice.cells) {
            let cell = Cell(corners.map(|corner| own[corner as usize]));
            let around = Aabb::<f64>::around(cell.0).grown(TOLERANCE * cell_size);
            if !is_broad {
                (0..seen.len()).for_each(|place| look(&mut seen[place], number, &cell, &around, cell_size, &mut tests));
            } else if around.overlaps(&bounds) {
                buckets.near(&around).for_each(|place| {
                    look(&mut seen[place], number, &cell, &around, cell_size, &mut tests);
                });
            }
        }
    }
    counters.narrow_tests += tests;
    counters.narrow_tests_saved += all_tests - tests.min(all_tests);
}

/// The ways out of the points that were found, in their order.
pub(super) fn ways_out<R: Real>(
    model: &Model<R>,
    [of_points, of_cells]: [usize; 2],
    seen: &[Seen],
    ahead: &[DVec3],
) -> impl Iterator<Item = Found> {
    let [points, cells] = [of_points, of_cells].map(|number| &model.bodies[number]);
    seen.iter().filter(|seen| seen.cell != NONE).filter_map(move |seen| {
        let carriers = cells.lattice.cells[seen.cell as usize];
        let cell = Cell(carriers.map(|corner| ahead[cells.particles.start + corner as usize]));
        let [hull, ways] = [points, cells].map(|body| body.among_bodies.hull.as_deref());
        let (hull, ways) = (hull?, &ways?.ways[seen.cell as usize]);
        let out = outward(points, hull.around(seen.point as usize), seen.ahead, &ahead[points.particles.clone()]);
        let (normal, depth) = way_out(&cell, seen.at, ways, out)?;
        let point = hull.points[seen.point as usize];
        Some(Found { point, carriers, at: seen.at, normal, depth })
    })
}

fn holds(bounds: &Aabb<f64>, point: DVec3) -> bool {
    point.cmpge(bounds.min).all() && point.cmple(bounds.max).all()
}

/// Looks whether a point is in a cell, and further inside than in any before.
fn look(seen: &mut Seen, number: u32, cell: &Cell, around: &Aabb<f64>, cell_size: f64, tests: &mut u64) {
    if seen.outside == 0.0 || !holds(around, seen.ahead) {
        return;
    }
    *tests += 1;
    let Some(at) = cell.locate(seen.ahead, DVec3::splat(0.5), cell_size) else { return };
    let beyond = outside(at);
    if beyond <= TOLERANCE && beyond < seen.outside {
        (seen.cell, seen.at, seen.outside) = (number, at, if beyond <= NOTHING { 0.0 } else { beyond });
    }
}

/// The direction from the middle of the cells around a point to it; nothing where they are all around it.
fn outward<R: Real>(body: &BodyModel<R>, around: &[u32], point: DVec3, ahead: &[DVec3]) -> DVec3 {
    let corners = around.iter().flat_map(|cell| body.lattice.cells[*cell as usize]);
    let sum = corners.fold(DVec3::ZERO, |sum, corner| sum + ahead[corner as usize]);
    (point - sum / (8.0 * around.len() as f64)).normalize_or_zero()
}

/// The normal of the nearest side of a body that a point of a cell may leave it by, and how deep it is there, m. The sides are
/// at rest along the axes of the cell, so many cells away, and are carried along as the cell is deformed at the place.
fn way_out(cell: &Cell, at: DVec3, ways: &[u32; 6], outward: DVec3) -> Option<(DVec3, f64)> {
    // How the place changes with the point: the normals of the cell's layers, longer where these are thinner.
    let layers = cell.slopes(at).inverse().transpose();
    let mut best: Option<(DVec3, f64)> = None;
    for axis in 0..3 {
        let across = layers.col(axis);
        let per_metre = across.length();
        for (way, towards, left) in [(2 * axis, -1.0, at[axis]), (2 * axis + 1, 1.0, 1.0 - at[axis])] {
            let normal = across * (towards / per_metre);
            let depth = (f64::from(ways[way]) + left) / per_metre;
            let leads_out = outward == DVec3::ZERO || outward.dot(normal) < AGAINST;
            if leads_out && best.is_none_or(|(_, least)| depth < least) {
                best = Some((normal, depth));
            }
        }
    }
    best
}
