//! Which points of one body are inside which cells of another at the end of a substep, if nothing stops them.
//!
//! ```text
//! bodies      the boxes of two bodies overlap, where they would be at the end
//! neighbours  points on the outside of one body that are near cells of the other: kept until bodies have moved
//! cells       is the point in the box around the cell, in slabs that lean as it does, in the cell itself
//! way out     the shortest of the six along the axes of the cell that lead against the point's own outward direction; in a
//!             body that meets others with its mesh, the way to that mesh, and none outside it
//! ```
//!
//! In contact of a body with itself only the cells near its outside are tested, and none that touches a cell around the point
//! ([`super::itself`]).
//!
//! A point has an outward direction of its own: away from the middle of the cells around it. It is pushed out only against
//! that, so that a slab of one cell is not pushed on through another that it is more than half way into, and the edge of a
//! cube on a cube is not pushed off sideways. The points of a body that is mostly inside another would be pushed every way at
//! once, so they all leave the same way: from the middle of the other body to that of their own. Where the way to the nearest
//! place of a mesh leads on through it, the point is let out straight back.

use glam::DVec3;

use super::ahead::Ahead;
use super::buckets::Seen;
use super::cell::{Cell, Slabs, TOLERANCE, outside};
use super::neighbours::{Neighbours, around, looked_at};
use super::outside::Outside;
use super::points::{Found, Met, PointsWorkspace};
use crate::math::{Aabb, Real};
use crate::physics::model::{BodyModel, Model, Skin, WayThrough};

/// A point outside a cell by no more than this, in cells, counts as inside it, and is looked for in no other.
const NOTHING: f64 = 1e-9;

/// A way out leads against the outward direction of a point where the dot product of the two is below this.
const AGAINST: f64 = -0.2;

/// A body is mostly inside another where more than this share of its points is.
const MOST: f64 = 0.5;

/// Everything that the search for points needs, as it would be at the end of the substep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look<'a, R: Real> {
    pub(super) model: &'a Model<R>,
    /// Positions of all particles, m.
    pub(super) ahead: &'a [DVec3],
    pub(super) bodies: &'a [Ahead],
    /// Which points are near which cells; without, every point is looked for in every cell.
    pub(super) neighbours: Option<&'a Neighbours>,
}

/// Finds which points of the body `number` are inside which of all bodies whose cells they may be in.
pub(super) fn find_points<R: Real>(look: Look<'_, R>, number: usize, workspace: &mut PointsWorkspace) {
    for place in 0..workspace.cells.len() {
        let of = [number, workspace.cells[place]];
        find(look, of, workspace);
        let inside = workspace.seen.iter().filter(|seen| seen.is_inside()).count();
        workspace.found.extend(ways_out(look, of, &workspace.seen, inside));
        workspace.met.push(Met { inside, until: workspace.found.len() });
    }
}

/// Finds the points of one body of a pair that are in cells of the other.
fn find<R: Real>(look: Look<'_, R>, of: [usize; 2], workspace: &mut PointsWorkspace) {
    let Look { model, ahead, neighbours, .. } = look;
    let [points, cells] = of.map(|number| &model.bodies[number]);
    let PointsWorkspace { lists, seen, buckets, looks, .. } = workspace;
    let outside = Outside::of(model, of);
    let [own_points, own] = [points, cells].map(|body| &ahead[body.particles.clone()]);
    let cell_size = cells.lattice.grid.cell_size;
    let mut tests = 0;
    let see = |point: u32| Seen::of(point, outside.place(point, own_points));
    if let Some(neighbours) = neighbours {
        let list = lists.list(model, (of, outside), neighbours, seen, buckets);
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
        seen.extend(outside.numbers().map(see));
        let is_itself = of[0] == of[1];
        for number in looked_at(cells, is_itself) {
            let mut cell = Candidate::new(cells, number, own, cell_size);
            let low = cells.lattice.low(number);
            for seen in &mut *seen {
                if !(is_itself && outside.touch(seen.point, low)) {
                    tests += u64::from(cell.look(seen));
                }
            }
        }
    }
    let all_tests = (outside.count() * cells.lattice.cells.len()) as u64;
    looks.points += seen.len() as u64;
    looks.tests += tests;
    looks.tests_saved += all_tests - tests.min(all_tests);
}

/// Returns the ways out of the points that are inside, in their order; `inside` is how many there are.
fn ways_out<R: Real>(
    look: Look<'_, R>,
    [of_points, of_cells]: [usize; 2],
    seen: &[Seen],
    inside: usize,
) -> impl Iterator<Item = Found> {
    let Look { model, ahead, bodies, .. } = look;
    let [points, cells] = [of_points, of_cells].map(|number| &model.bodies[number]);
    let outside = Outside::of(model, [of_points, of_cells]);
    let is_itself = of_points == of_cells;
    let is_in = !is_itself && inside as f64 > MOST * outside.count() as f64;
    // Of two bodies in the same place the later one in the list leaves upwards.
    let upwards = if of_points > of_cells { DVec3::Y } else { DVec3::NEG_Y };
    let apart = || bodies[of_points].bounds.center() - bodies[of_cells].bounds.center();
    let away = is_in.then(|| apart().try_normalize().unwrap_or(upwards));
    let skin = cells.samples_among_bodies().filter(|_| !is_itself).and_then(|samples| samples.skin.as_ref());
    seen.iter().filter(|seen| seen.is_inside()).filter_map(move |seen| {
        let carriers = cells.lattice.cells[seen.cell as usize];
        let cell = Cell(carriers.map(|corner| ahead[cells.particles.start + corner as usize]));
        let outward = || outside.outward(points, seen.point, seen.ahead, &ahead[points.particles.clone()]);
        let (normal, depth, nearer) = if let Some(skin) = skin {
            let (normal, depth) = through_skin(skin, cells, seen, &cell, away.ok_or_else(outward))?;
            (normal, depth, None)
        } else {
            let sides = sides(&cell, seen.at, &cells.hull().ways[seen.cell as usize]);
            let (normal, depth) = match away {
                Some(away) => way_along(sides, away),
                None => way_out(sides, outward())?,
            };
            let nearer = sides.map(|(_, depth)| depth).into_iter().filter(|other| *other < depth).reduce(f64::min);
            (normal, depth, nearer)
        };
        Some(Found { point: seen.point, carriers, at: seen.at, normal, depth, nearer })
    })
}

/// Returns the normal of a body's mesh where a point in one of its cells may leave, and how deep the point is inside along that
/// normal, m. The way is the given one (`Ok`), else the shortest if it leads against the point's outward direction (`Err`),
/// else straight back from that direction. None where the point is outside the mesh.
fn through_skin<R: Real>(
    skin: &Skin,
    body: &BodyModel<R>,
    seen: &Seen,
    cell: &Cell,
    away: Result<DVec3, DVec3>,
) -> Option<(DVec3, f64)> {
    let grid = &body.lattice.grid;
    let at_rest = grid.corner(body.lattice.low(seen.cell)) + seen.at * grid.cell_size;
    let shortest = skin.way_out(at_rest)?;
    let slopes = cell.slopes(seen.at);
    // A way in the body at rest is deformed with the cell, and so are its layers, which are thinner where the cell is.
    let (back, layers) = (slopes.inverse(), slopes.inverse().transpose() * grid.cell_size);
    let carried = |WayThrough { normal, depth }| {
        let across = layers * normal;
        let per_metre = across.length();
        (across * (1.0 / per_metre), depth / per_metre)
    };
    let along = |way: DVec3| skin.way_along(at_rest, (back * way).try_normalize()?).map(carried);
    match away {
        Ok(away) => along(away).or_else(|| Some(carried(shortest))),
        Err(outward) => {
            let (normal, depth) = carried(shortest);
            if leads_out(normal, outward) { Some((normal, depth)) } else { along(-outward) }
        }
    }
}

/// A cell that points may be in.
struct Candidate {
    number: u32,
    cell: Cell,
    /// The box around it, m.
    around: Aabb<f64>,
    /// The slabs around it, once a point is in the box.
    slabs: Option<Slabs>,
    /// Its size at rest, m.
    size: f64,
}

impl Candidate {
    /// A cell of a body whose particles are at `own`, m.
    fn new<R: Real>(body: &BodyModel<R>, number: u32, own: &[DVec3], size: f64) -> Self {
        let around = around(body, number, own).grown(TOLERANCE * size);
        let cell = Cell(body.lattice.cells[number as usize].map(|corner| own[corner as usize]));
        Self { number, cell, around, slabs: None, size }
    }

    /// Tests whether a point is in the cell, and less far outside it than of any before. Returns whether it could be.
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

/// Whether a way out leads against the outward direction of a point.
fn leads_out(normal: DVec3, outward: DVec3) -> bool {
    outward == DVec3::ZERO || outward.dot(normal) < AGAINST
}

/// The normal of the nearest side of a body by which a point may leave, and how deep the point is there, m.
fn way_out(sides: [(DVec3, f64); 6], outward: DVec3) -> Option<(DVec3, f64)> {
    let mut best: Option<(DVec3, f64)> = None;
    for (normal, depth) in sides {
        if leads_out(normal, outward) && best.is_none_or(|(_, least)| depth < least) {
            best = Some((normal, depth));
        }
    }
    best
}

/// The same for the side whose normal is closest to a direction.
fn way_along([first, others @ ..]: [(DVec3, f64); 6], along: DVec3) -> (DVec3, f64) {
    let better =
        |best: (DVec3, f64), side: (DVec3, f64)| if side.0.dot(along) > best.0.dot(along) { side } else { best };
    others.into_iter().fold(first, better)
}

/// The normals of the six sides by which a point in a cell may leave a body, and how deep the point is there, m. At rest the
/// sides are along the axes of the cell, `ways` cells away; they are deformed as the cell is at the place.
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
