//! How a point that is inside a body leaves it: by a side of its cells, or through its mesh.
//!
//! A point has an outward direction of its own: away from the middle of the cells around it. It is pushed out only against
//! that, so that a slab of one cell is not pushed on through another that it is more than half way into, and the edge of a
//! cube on a cube is not pushed off sideways. The points of a body that is mostly inside another would be pushed every way at
//! once, so they all leave the same way: from the middle of the other body to that of their own. Where the way to the nearest
//! place of a mesh leads on through it, the point is let out straight back.

use glam::DVec3;

use super::buckets::CandidatePoint;
use super::cell::Cell;
use crate::math::Real;
use crate::physics::model::{BodyModel, MeshPenetration, Skin};

/// A way out leads against the outward direction of a point where the dot product of the two is below this.
const MAX_OUTWARD_COSINE: f64 = -0.2;

/// How a point leaves a body.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics::contact) struct PointExit {
    /// Unit normal out of the body.
    pub(in crate::physics::contact) normal: DVec3,
    /// How deep the point is inside along the normal, m.
    pub(in crate::physics::contact) depth: f64,
    /// How far it is to a nearer side, m, by which it does not leave.
    pub(super) nearer: Option<f64>,
}

/// Where a point is to leave.
#[derive(Clone, Copy, Debug)]
pub(in crate::physics::contact) enum ExitDirection {
    /// As near to this direction as there is a side.
    Along(DVec3),
    /// By the nearest side that leads against this outward direction of the point; by any where it is zero.
    Against(DVec3),
}

impl PointExit {
    /// How a point in a `cell` of a body leaves it. None where there is no such way, or where the point is outside the body's
    /// `skin`.
    pub(in crate::physics::contact) fn of<R: Real>(
        skin: Option<&Skin>,
        body: &BodyModel<R>,
        candidate: &CandidatePoint,
        cell: &Cell,
        direction: ExitDirection,
    ) -> Option<Self> {
        if let Some(skin) = skin {
            let (normal, depth) = through_skin(skin, body, candidate, cell, direction)?;
            return Some(Self { normal, depth, nearer: None });
        }
        let sides = sides(cell, candidate.cell_coordinates, &body.hull().cells_to_outside[candidate.cell as usize]);
        let (normal, depth) = match direction {
            ExitDirection::Along(away) => side_along(sides, away),
            ExitDirection::Against(outward) => nearest_side(sides, outward)?,
        };
        let nearer = sides.map(|(_, depth)| depth).into_iter().filter(|other| *other < depth).reduce(f64::min);
        Some(Self { normal, depth, nearer })
    }
}

/// Returns the normal of a body's mesh where a point in one of its cells may leave, and how deep the point is inside along that
/// normal, m. Against the point's outward direction it is the shortest way if that leads against it, else the way straight back.
/// None where the point is outside the mesh.
fn through_skin<R: Real>(
    skin: &Skin,
    body: &BodyModel<R>,
    candidate: &CandidatePoint,
    cell: &Cell,
    direction: ExitDirection,
) -> Option<(DVec3, f64)> {
    let grid = &body.lattice.grid;
    let at_rest = grid.corner(body.lattice.low(candidate.cell)) + candidate.cell_coordinates * grid.cell_size;
    let shortest = skin.penetration(at_rest)?;
    let jacobian = cell.jacobian(candidate.cell_coordinates);
    // A way in the body at rest is deformed with the cell, and so are its layers, which are thinner where the cell is.
    let (back, layers) = (jacobian.inverse(), jacobian.inverse().transpose() * grid.cell_size);
    let carried = |MeshPenetration { normal, depth }| {
        let across = layers * normal;
        let per_metre = across.length();
        (across * (1.0 / per_metre), depth / per_metre)
    };
    let along = |way: DVec3| skin.penetration_along(at_rest, (back * way).try_normalize()?).map(carried);
    match direction {
        ExitDirection::Along(away) => along(away).or_else(|| Some(carried(shortest))),
        ExitDirection::Against(outward) => {
            let (normal, depth) = carried(shortest);
            if leads_out(normal, outward) { Some((normal, depth)) } else { along(-outward) }
        }
    }
}

/// Whether a way out leads against the outward direction of a point.
fn leads_out(normal: DVec3, outward: DVec3) -> bool {
    outward == DVec3::ZERO || outward.dot(normal) < MAX_OUTWARD_COSINE
}

/// The normal of the nearest side of a body by which a point may leave, and how deep the point is there, m.
fn nearest_side(sides: [(DVec3, f64); 6], outward: DVec3) -> Option<(DVec3, f64)> {
    let mut best: Option<(DVec3, f64)> = None;
    for (normal, depth) in sides {
        if leads_out(normal, outward) && best.is_none_or(|(_, least)| depth < least) {
            best = Some((normal, depth));
        }
    }
    best
}

/// The same for the side whose normal is closest to a direction.
fn side_along([first, others @ ..]: [(DVec3, f64); 6], along: DVec3) -> (DVec3, f64) {
    let better =
        |best: (DVec3, f64), side: (DVec3, f64)| if side.0.dot(along) > best.0.dot(along) { side } else { best };
    others.into_iter().fold(first, better)
}

/// The normals of the six sides by which a point in a cell may leave a body, and how deep the point is there, m. At rest the
/// sides are along the axes of the cell, `ways` cells away; they are deformed as the cell is at the place.
fn sides(cell: &Cell, at: DVec3, ways: &[u32; 6]) -> [(DVec3, f64); 6] {
    // How the place changes with the point: the normals of the cell's layers, longer where these are thinner.
    let layers = cell.jacobian(at).inverse().transpose();
    std::array::from_fn(|way| {
        let (axis, is_up) = (way / 2, way % 2 == 1);
        let across = layers.col(axis);
        let per_metre = across.length();
        let (towards, left) = if is_up { (1.0, 1.0 - at[axis]) } else { (-1.0, at[axis]) };
        (across * (towards / per_metre), (f64::from(ways[way]) + left) / per_metre)
    })
}
