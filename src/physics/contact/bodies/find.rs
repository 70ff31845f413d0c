//! Which points of one body are inside which cells of another at the end of a substep, if nothing stops them.
//!
//! ```text
//! bodies      the boxes of two bodies overlap, where they would be at the end
//! neighbours  those of the one's outside that are near cells of the other: kept until bodies have moved
//! cells       is the point in the box around the cell, in slabs that lean as it does, in the cell itself
//! way out     along the six axes of the cell, of those that lead against the point's own outside the shortest
//! ```
//!
//! Of a body and itself only the cells near its outside are looked at, and no cell that touches one around the point
//! ([`super::itself`]).
//!
//! A point has an outside of its own: away from the middle of the cells around it. It is pushed out only against that, so
//! that a slab of one cell is not pushed on through another that it is more than half way into, and the edge of a cube on
//! a cube is not pushed off sideways. Of a body that is for the most part inside another that would be every way at once: its
//! points all leave the same way, by which its middle is away from that of the other.

use glam::DVec3;

use super::buckets::Seen;
use super::cell::{Cell, Slabs, TOLERANCE, outside};
use super::neighbours::{Neighbours, around, looked_at};
use super::points::PointsWorkspace;
use super::workspace::Ahead;
use crate::math::{Aabb, Real};
use crate::physics::model::{BodyModel, Model};

/// A point that is outside a cell by no more than this is as good as in it, and looked for in no other.
const NOTHING: f64 = 1e-9;

/// The way out leads against the outside of a point where their directions' product is below this.
const AGAINST: f64 = -0.2;

/// A body is for the most part inside another where this share of its points is.
const MOST: f64 = 0.5;

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
    /// How far it is to a nearer side that it does not leave by, m.
    pub(super) nearer: Option<f64>,
}

/// Finds the points of one body of a pair that are inside the other: in the broad phase of those that are near
/// ([`super::neighbours`]), else of all. Particles would be `ahead` at the end of the substep, m.
pub(super) fn find<R: Real>(
    model: &Model<R>,
    of: [usize; 2],
    neighbours: Option<&Neighbours>,
    ahead: &[DVec3],
    workspace: &mut PointsWorkspace,
) {
    let [points, cells] = of.map(|number| &model.bodies[number]);
    let PointsWorkspace { lists, seen, buckets, looks, .. } = workspace;
    let hull = points.hull();
    let own = &ahead[cells.particles.clone()];
    let cell_size = cells.lattice.grid.cell_size;
    let mut tests = 0;
    let see = |point: u32| Seen::of(point, ahead[points.particles.start + hull.points[point as usize] as usize]);
    if let Some(neighbours) = neighbours {
        let list = lists.list(model, of, neighbours, seen, buckets);
        seen.clear();
        seen.extend(list.points.iter().map(|point| see(*point)));
        for (number, places) in list.by_cell() {
            let mut cell = Candidate::new(cells, number, own, cell_size);
            for place in places {
                tests += u64::from(cell.look(&mut seen[place as usize]));
            }
        }
    } else {
        seen.clear();
        seen.extend((0..).zip(&hull.points).map(|(point, _)| see(point)));
        let is_itself = of[0] == of[1];
        for number in looked_at(cells, is_itself) {
            let mut cell = Candidate::new(cells, number, own, cell_size);
            let low = cells.lattice.low(number);
            for seen in &mut *seen {
                if !(is_itself && hull.surroundings[seen.point as usize].touch(low)) {
                    tests += u64::from(cell.look(seen));
                }
            }
        }
    }
    let all_tests = (hull.points.len() * cells.lattice.cells.len()) as u64;
    looks.points += seen.len() as u64;
    looks.tests += tests;
    looks.tests_saved += all_tests - tests.min(all_tests);
}

/// The ways out of the points that were found, in their order, `inside` of them; `bodies` are as they would be at the end.
pub(super) fn ways_out<R: Real>(
    model: &Model<R>,
    [of_points, of_cells]: [usize; 2],
    seen: &[Seen],
    inside: usize,
    ahead: &[DVec3],
    bodies: &[Ahead],
) -> impl Iterator<Item = Found> {
    let [points, cells] = [of_points, of_cells].map(|number| &model.bodies[number]);
    let is_itself = of_points == of_cells;
    let is_in = !is_itself && inside as f64 > MOST * points.hull().points.len() as f64;
    // Of two in the same place the later one in the list leaves upwards.
    let upwards = if of_points > of_cells { DVec3::Y } else { DVec3::NEG_Y };
    let away = is_in.then(|| {
        (bodies[of_points].bounds.center() - bodies[of_cells].bounds.center()).try_normalize().unwrap_or(upwards)
    });
    seen.iter().filter(|seen| seen.is_inside()).filter_map(move |seen| {
        let carriers = cells.lattice.cells[seen.cell as usize];
        let cell = Cell(carriers.map(|corner| ahead[cells.particles.start + corner as usize]));
        let (hull, ways) = (points.hull(), &cells.hull().ways[seen.cell as usize]);
        let own = || outward(points, hull.around(seen.point as usize), seen.ahead, &ahead[points.particles.clone()]);
        let sides = sides(&cell, seen.at, ways);
        let (normal, depth) = match away {
            Some(away) => way_along(sides, away),
            None => way_out(sides, own())?,
        };
        let point = hull.points[seen.point as usize];
        let nearer = sides.map(|(_, depth)| depth).into_iter().filter(|other| *other < depth).reduce(f64::min);
        Some(Found { point, carriers, at: seen.at, normal, depth, nearer })
    })
}

/// A cell that points may be in.
struct Candidate {
    number: u32,
    cell: Cell,
    /// The box around it, m.
    around: Aabb<f64>,
    /// Those around it, once a point is in the box.
    slabs: Option<Slabs>,
    /// At rest, m.
    size: f64,
}

impl Candidate {
    /// A cell of a body whose particles are there, m.
    fn new<R: Real>(body: &BodyModel<R>, number: u32, own: &[DVec3], size: f64) -> Self {
        let around = around(body, number, own).grown(TOLERANCE * size);
        let cell = Cell(body.lattice.cells[number as usize].map(|corner| own[corner as usize]));
        Self { number, cell, around, slabs: None, size }
    }

    /// Looks whether a point is in the cell, and further inside than in any before. Says whether it could be.
    fn look(&mut self, seen: &mut Seen) -> bool {
        if seen.outside == 0.0 || !self.around.holds(seen.ahead) {
            return false;
        }
        let slabs = self.slabs.get_or_insert_with(|| self.cell.slabs());
        if !slabs.hold(seen.ahead) {
            return true;
        }
        if let Some(at) = self.cell.locate(seen.ahead, DVec3::splat(0.5), self.size) {
            let beyond = outside(at);
            if beyond <= TOLERANCE && beyond < seen.outside {
                (seen.cell, seen.at, seen.outside) = (self.number, at, if beyond <= NOTHING { 0.0 } else { beyond });
            }
        }
        true
    }
}

/// The direction from the middle of the cells around a point to it; nothing where they are all around it.
fn outward<R: Real>(body: &BodyModel<R>, around: &[u32], point: DVec3, ahead: &[DVec3]) -> DVec3 {
    let corners = around.iter().flat_map(|cell| body.lattice.cells[*cell as usize]);
    let sum = corners.fold(DVec3::ZERO, |sum, corner| sum + ahead[corner as usize]);
    (point - sum / (8.0 * around.len() as f64)).normalize_or_zero()
}

/// The normal of the nearest side of a body that a point may leave it by, and how deep it is there, m.
fn way_out(sides: [(DVec3, f64); 6], outward: DVec3) -> Option<(DVec3, f64)> {
    let leads_out = |normal: DVec3| outward == DVec3::ZERO || outward.dot(normal) < AGAINST;
    let mut best: Option<(DVec3, f64)> = None;
    for (normal, depth) in sides {
        if leads_out(normal) && best.is_none_or(|(_, least)| depth < least) {
            best = Some((normal, depth));
        }
    }
    best
}

/// The same of the side that leads along a direction the most.
fn way_along([first, others @ ..]: [(DVec3, f64); 6], along: DVec3) -> (DVec3, f64) {
    let better =
        |best: (DVec3, f64), side: (DVec3, f64)| if side.0.dot(along) > best.0.dot(along) { side } else { best };
    others.into_iter().fold(first, better)
}

/// The normals of a body's six sides as a point of a cell may leave by them, and how deep it is there, m. The sides are at
/// rest along the axes of the cell, so many cells away, and are carried along as the cell is deformed at the place.
fn sides(cell: &Cell, at: DVec3, ways: &[u32; 6]) -> [(DVec3, f64); 6] {
    // How the place changes with the point: the normals of the cell's layers, longer where these are thinner.
    let layers = cell.slopes(at).inverse().transpose();
    std::array::from_fn(|way| {
        let (axis, is_up) = (way / 2, way % 2 == 1);
        let across = layers.col(axis);
        let per_metre = across.length();
        let (towards, left) = if is_up { (1.0, 1.0 - at[axis]) } else { (-1.0, at[axis]) };
        (across * (towards / per_metre), (f64::from(ways[way]) + left) / per_metre)
    })
}
