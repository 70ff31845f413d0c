//! Which points of one body are inside which cells of another at the end of a substep, if nothing stops them.
//!
//! ```text
//! bodies      the boxes of two bodies overlap, where they would be at the end
//! neighbours  those of the one's outside that are near cells of the other: kept until bodies have moved
//! cells       is the point in the box around the cell, is it in the cell
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
use super::cell::{Cell, TOLERANCE, outside};
use super::looked::{Found, Search};
use super::neighbours::{Neighbours, around, looked_at};
use super::workspace::BodiesWorkspace;
use crate::math::{Aabb, Real};
use crate::physics::model::{BodyModel, Model};
use crate::physics::report::Counters;
use crate::physics::step::substep::Substep;
use crate::physics::team::{self, Halves};

/// A point that is outside a cell by no more than this is as good as in it, and looked for in no other.
const NOTHING: f64 = 1e-9;

/// The way out leads against the outside of a point where their directions' product is below this.
const AGAINST: f64 = -0.2;

/// A body is for the most part inside another where this share of its points is.
const MOST: f64 = 0.5;

/// Lists what has to be looked for of a pair: in the broad phase the points that are near ([`super::neighbours`]), else all.
pub(super) fn list<R: Real>(model: &Model<R>, of: [usize; 2], is_broad: bool, workspace: &mut BodiesWorkspace<R>) {
    let BodiesWorkspace { ahead, neighbours, seen, searches, buckets, .. } = workspace;
    let points = &model.bodies[of[0]];
    let hull = points.hull();
    let see = |point: u32| Seen::of(point, ahead[points.particles.start + hull.points[point as usize] as usize]);
    let first = seen.len();
    let list = is_broad.then(|| {
        let list = neighbours.list(model, of, buckets);
        seen.extend(neighbours.points(list).iter().map(|point| see(*point)));
        list
    });
    if list.is_none() {
        seen.extend((0..).zip(&hull.points).map(|(point, _)| see(point)));
    }
    searches.push(Search { of, points: first..seen.len(), list, tests: 0 });
}

/// Looks for all points that are listed, by the threads of the plan, and counts what was saved.
pub(super) fn look_for_all<R: Real>(
    substep: Substep<'_, R>,
    workspace: &mut BodiesWorkspace<R>,
    counters: &mut Counters,
) {
    let Substep { model, plan, .. } = substep;
    let BodiesWorkspace { ahead, neighbours, seen, found, searches, boxes, .. } = workspace;
    found.clear();
    found.resize(seen.len(), None);
    let all = All { model, ahead, neighbours, boxes };
    team::share(plan.threads, Looks { all: &all, searches, first: 0, seen, found });
    for Search { of, points, tests, .. } in searches {
        let [hull, cells] = [model.bodies[of[0]].hull().points.len(), model.bodies[of[1]].lattice.cells.len()];
        let all_tests = (hull * cells) as u64;
        counters.points_looked_for += points.len() as u64;
        counters.narrow_tests += *tests;
        counters.narrow_tests_saved += all_tests - (*tests).min(all_tests);
    }
}

/// What is read to look for points.
struct All<'a, R: Real> {
    model: &'a Model<R>,
    ahead: &'a [DVec3],
    neighbours: &'a Neighbours,
    boxes: &'a [Aabb<f64>],
}

/// Searches that follow one another, with their points, of which the first has this place among all.
struct Looks<'a, R: Real> {
    all: &'a All<'a, R>,
    searches: &'a mut [Search],
    first: usize,
    seen: &'a mut [Seen],
    found: &'a mut [Option<Found>],
}

/// Fewer points are not shared out.
const FEWEST_POINTS: usize = 64;

impl<R: Real> Halves for Looks<'_, R> {
    fn pieces(&self) -> usize {
        self.searches.len().min(self.seen.len() / FEWEST_POINTS).max(1)
    }

    fn halve(self) -> [Self; 2] {
        let Self { all, searches, first, seen, found } = self;
        let middle = first + seen.len() / 2;
        let half = searches.partition_point(|search| search.points.end <= middle).clamp(1, searches.len() - 1);
        let begin = searches[half].points.start;
        let (one, other) = searches.split_at_mut(half);
        let (one_seen, other_seen) = seen.split_at_mut(begin - first);
        let (one_found, other_found) = found.split_at_mut(begin - first);
        [
            Self { all, searches: one, first, seen: one_seen, found: one_found },
            Self { all, searches: other, first: begin, seen: other_seen, found: other_found },
        ]
    }

    fn work(self) {
        for search in self.searches {
            let points = search.points.start - self.first..search.points.end - self.first;
            let seen = &mut self.seen[points.clone()];
            search.tests = self.all.look(search, seen);
            self.all.ways_out(search.of, seen, &mut self.found[points]);
        }
    }
}

impl<R: Real> All<'_, R> {
    /// Looks for the points of a search in the cells that they may be in. Says how often one was looked for in one.
    fn look(&self, search: &Search, seen: &mut [Seen]) -> u64 {
        let [points, cells] = search.of.map(|number| &self.model.bodies[number]);
        let own = &self.ahead[cells.particles.clone()];
        let cell_size = cells.lattice.grid.cell_size;
        let mut tests = 0;
        if let Some(list) = search.list {
            for of_cell in self.neighbours.pairs(list).chunk_by(|one, next| one.cell == next.cell) {
                let cell = Candidate::new(cells, of_cell[0].cell, own, cell_size);
                for neighbour in of_cell {
                    tests += u64::from(cell.look(&mut seen[neighbour.place as usize]));
                }
            }
            return tests;
        }
        let is_itself = search.of[0] == search.of[1];
        for number in looked_at(cells, is_itself) {
            let cell = Candidate::new(cells, number, own, cell_size);
            let low = cells.lattice.low(number);
            for seen in &mut *seen {
                if !(is_itself && points.hull().surroundings[seen.point as usize].touch(low)) {
                    tests += u64::from(cell.look(seen));
                }
            }
        }
        tests
    }

    /// The ways out of the points that are inside.
    fn ways_out(&self, [of_points, of_cells]: [usize; 2], seen: &[Seen], found: &mut [Option<Found>]) {
        let [points, cells] = [of_points, of_cells].map(|number| &self.model.bodies[number]);
        let (ahead, boxes) = (self.ahead, self.boxes);
        let inside = seen.iter().filter(|seen| seen.is_inside()).count();
        let is_itself = of_points == of_cells;
        let is_in = !is_itself && inside as f64 > MOST * points.hull().points.len() as f64;
        // Of two in the same place the later one in the list leaves upwards.
        let upwards = if of_points > of_cells { DVec3::Y } else { DVec3::NEG_Y };
        let away =
            is_in.then(|| (boxes[of_points].center() - boxes[of_cells].center()).try_normalize().unwrap_or(upwards));
        let way_out_of = |seen: &Seen| {
            let carriers = cells.lattice.cells[seen.cell as usize];
            let cell = Cell(carriers.map(|corner| ahead[cells.particles.start + corner as usize]));
            let (hull, ways) = (points.hull(), &cells.hull().ways[seen.cell as usize]);
            let own =
                || outward(points, hull.around(seen.point as usize), seen.ahead, &ahead[points.particles.clone()]);
            let sides = sides(&cell, seen.at, ways);
            let (normal, depth) = match away {
                Some(away) => way_along(sides, away),
                None => way_out(sides, own())?,
            };
            let point = hull.points[seen.point as usize];
            let nearer = sides.map(|(_, depth)| depth).into_iter().filter(|other| *other < depth).reduce(f64::min);
            Some(Found { point, carriers, at: seen.at, normal, depth, nearer })
        };
        for (seen, found) in seen.iter().zip(found).filter(|(seen, _)| seen.is_inside()) {
            *found = way_out_of(seen);
        }
    }
}

/// A cell that points may be in.
struct Candidate {
    number: u32,
    cell: Cell,
    /// The box around it, m.
    around: Aabb<f64>,
    /// At rest, m.
    size: f64,
}

impl Candidate {
    /// A cell of a body whose particles are there, m.
    fn new<R: Real>(body: &BodyModel<R>, number: u32, own: &[DVec3], size: f64) -> Self {
        let around = around(body, number, own).grown(TOLERANCE * size);
        let cell = Cell(body.lattice.cells[number as usize].map(|corner| own[corner as usize]));
        Self { number, cell, around, size }
    }

    /// Looks whether a point is in the cell, and further inside than in any before. Says whether it could be.
    fn look(&self, seen: &mut Seen) -> bool {
        if seen.outside == 0.0 || !self.around.holds(seen.ahead) {
            return false;
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
