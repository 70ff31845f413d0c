//! Finds where cells lose detail of a model (SC, limitations a and b): parts thinner than a cell, and parts nearer than a
//! cell to something else, which move as one with it.
//!
//! Thickness and the width of a gap are measured along the axis that the surface faces most. A ray through a piece of the
//! surface leaves the inside, or the outside, on its other side; the length of that span times the normal's component along
//! the axis is the thickness of a body with parallel sides.

use std::collections::BTreeMap;

use glam::DVec3;

use super::crossings::{Crossing, Crossings, winding_spans};
use super::holes::Patched;
use super::pieces::{Divider, area};
use super::shell::CHUNK_TRIANGLES;
use super::{Grid, VoxelizeError};
use crate::geometry::{TriMesh, Watch};

/// Steps of thickness in a cell, if the surface is not too large.
const MAX_RAYS_PER_CELL: u32 = 8;

/// About the number of pieces of a surface: fewer if edges would be below half a cell, more if its triangles are small.
const TARGET_PIECES: f64 = 3e4;

/// The largest distance between a crossing of a ray and the middle of the piece that it belongs to, steps.
const CROSSING_TOLERANCE: f64 = 2.0;

/// What cells lose of a piece of the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lost {
    /// The model behind the piece is thinner than a cell, or there is none.
    pub thin: bool,
    /// Another part of the model is in the piece's cell, or something in front of the piece is nearer than a cell.
    pub joined: bool,
}

/// What cells lose of a surface.
#[derive(Clone, Debug)]
pub struct LostDetail {
    /// The surface in small pieces, in the model's coordinates.
    pub pieces: TriMesh,
    /// What is lost in each.
    pub lost: Vec<Lost>,
    /// The share of the surface that is thin.
    pub thin_share: f64,
    /// The share that is joined.
    pub joined_share: f64,
}

impl LostDetail {
    /// Finds the lost detail of a mesh within a grid.
    pub fn of(mesh: &TriMesh, grid: &Grid, watch: &dyn Watch) -> Result<Self, VoxelizeError> {
        let rays = Rays::new(mesh, grid, watch)?;
        let longest = (area(mesh, grid) / TARGET_PIECES).sqrt().max(0.5);
        let mut divider = Divider::new(mesh, grid, longest);
        let part_of = mesh.facts().part_of_triangle;
        let (mut corners, mut parts) = (Vec::new(), Vec::new());
        // The only part in a cell, or none where there are several.
        let mut only_part: BTreeMap<usize, Option<u32>> = BTreeMap::new();
        for (triangle, &part) in part_of.iter().enumerate() {
            if triangle % CHUNK_TRIANGLES == 0 && watch.cancelled() {
                return Err(VoxelizeError::Cancelled);
            }
            divider.triangles(triangle, |piece| {
                let found = only_part.entry(cell_of(grid, &piece)).or_insert(Some(part));
                *found = found.filter(|found| *found == part);
                corners.push(piece);
                parts.push(part);
            });
        }
        let lost: Vec<Lost> = corners
            .iter()
            .map(|piece| {
                let Lost { thin, joined } = rays.find_lost(piece);
                Lost { thin, joined: joined || only_part.get(&cell_of(grid, piece)) == Some(&None) }
            })
            .collect();
        let size = |[a, b, c]: &[DVec3; 3]| (*b - *a).cross(*c - *a).length();
        let all: f64 = corners.iter().map(size).sum();
        let share = |is_lost: fn(&Lost) -> bool| {
            let of = corners.iter().zip(&lost).filter(|(_, lost)| is_lost(lost)).map(|(piece, _)| size(piece));
            of.sum::<f64>() / all.max(f64::MIN_POSITIVE)
        };
        let (thin_share, joined_share) = (share(|lost| lost.thin), share(|lost| lost.joined));
        Ok(Self { pieces: welded(&corners, grid), lost, thin_share, joined_share })
    }
}

fn cell_of(grid: &Grid, [a, b, c]: &[DVec3; 3]) -> usize {
    let middle = ((*a + *b + *c) / 3.0).to_array();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the grid; saturating")]
    grid.index(std::array::from_fn(|axis| (middle[axis] as u32).min(grid.dims[axis] - 1)))
}

/// Makes a mesh of triangles given in cells of the grid; corners at exactly equal places become one vertex.
fn welded(corners: &[[DVec3; 3]], grid: &Grid) -> TriMesh {
    let positions = corners.as_flattened().iter().map(|corner| grid.origin + *corner * grid.cell_size);
    let numbers = (0..).step_by(3).take(corners.len());
    let soup = TriMesh {
        positions: positions.collect(),
        triangles: numbers.map(|first| [first, first + 1, first + 2]).collect(),
    };
    let weld = soup.weld();
    let (mut positions, mut number) = (Vec::new(), vec![0; weld.len()]);
    for (place, at) in soup.positions.iter().enumerate() {
        if weld[place] as usize == place {
            number[place] = u32::try_from(positions.len()).unwrap_or(u32::MAX);
            positions.push(*at);
        }
    }
    let corner = |vertex: u32| number[weld[vertex as usize] as usize];
    TriMesh { positions, triangles: soup.triangles.iter().map(|triangle| triangle.map(corner)).collect() }
}

/// The crossings of rays along all axes, `steps` rays to the edge of a cell.
struct Rays {
    steps: u32,
    dims: [u32; 3],
    along: [Crossings; 3],
}

impl Rays {
    fn new(mesh: &TriMesh, grid: &Grid, watch: &dyn Watch) -> Result<Self, VoxelizeError> {
        let patched = Patched::of(mesh);
        let mesh = patched.as_ref().map_or(mesh, |patched| &patched.whole);
        let (along, fine) = Crossings::along_axes(mesh, grid, MAX_RAYS_PER_CELL, 2, watch)?;
        Ok(Self { steps: fine.dims[0] / grid.dims[0], dims: fine.dims, along })
    }

    /// Looks behind a piece and in front of it; its corners are in cells.
    fn find_lost(&self, [a, b, c]: &[DVec3; 3]) -> Lost {
        let normal = (*b - *a).cross(*c - *a).normalize_or_zero().abs();
        let axis = usize::from(normal.y > normal.x);
        let axis = if normal.z > normal[axis] { 2 } else { axis };
        let middle = (*a + *b + *c) / 3.0 * f64::from(self.steps);
        let [j, k] = [1, 2].map(|next| {
            let across = (axis + next) % 3;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the grid; saturating")]
            let step = middle[across] as u32;
            step.min(self.dims[across] - 1)
        });
        let ray = self.along[axis].of_ray(j, k);
        let length = |steps: f64| steps * normal[axis] / f64::from(self.steps);
        let is_below = |length: Option<f64>| length.is_some_and(|length| length < 1.0 - 0.5 / f64::from(self.steps));
        let [inside, outside] = span_lengths(ray, self.dims[axis], middle[axis]).map(|steps| steps.map(length));
        Lost { thin: inside.is_none() || is_below(inside), joined: is_below(outside) }
    }
}

/// Returns how long a ray is inside, and in a gap between surfaces, next to a place on it, steps; the longer span of two.
fn span_lengths(ray: &[Crossing], cells: u32, place: f64) -> [Option<f64>; 2] {
    let total = ray.iter().fold(0_i16, |sum, crossing| sum.wrapping_add(crossing.winding_change));
    let mut found = [None, None];
    winding_spans(ray, cells, |first, end, winding| {
        let is_inside = if total == 0 { winding != 0 } else { winding % 2 != 0 };
        let is_gap = !is_inside && first > 0 && end < cells;
        let [first, end] = [first, end].map(f64::from);
        let is_near = (first - place).abs() <= CROSSING_TOLERANCE || (end - place).abs() <= CROSSING_TOLERANCE;
        if is_near && (is_inside || is_gap) {
            let longest = &mut found[usize::from(!is_inside)];
            *longest = Some(longest.map_or(end - first, |other: f64| other.max(end - first)));
        }
    });
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::trimesh::tests::together;
    use crate::geometry::voxel::tests::{ball, run, sheet, solid_box};
    use crate::geometry::voxel::{Keep, OccupancyChoice};

    fn lost_detail(mesh: &TriMesh, divisions: u32) -> LostDetail {
        let filled = run(mesh, divisions, OccupancyChoice::Auto, Keep::All);
        LostDetail::of(mesh, &filled.cells.grid, &()).expect("nobody stops it")
    }

    /// The middles of the pieces of which something is lost.
    fn middles(found: &LostDetail, is_lost: fn(&Lost) -> bool) -> Vec<DVec3> {
        let middle = |at: usize| found.pieces.corners(at).into_iter().sum::<DVec3>() / 3.0;
        (0..found.lost.len()).filter(|at| is_lost(&found.lost[*at])).map(middle).collect()
    }

    #[test]
    fn a_thick_body_loses_nothing_and_a_sheet_all() {
        for mesh in [ball(DVec3::ZERO, 1.0, 32), solid_box([0.0; 3], [2.0, 1.0, 1.0])] {
            let found = lost_detail(&mesh, 8);
            assert!(found.thin_share < 0.01 && found.joined_share < 0.01, "{found:?}");
        }
        let found = lost_detail(&sheet(), 8);
        assert!((found.thin_share - 1.0).abs() < 1e-9, "{}", found.thin_share);
        let plate = lost_detail(&solid_box([0.0; 3], [2.0, 0.1, 2.0]), 8);
        assert!(plate.thin_share > 0.9, "all but its edges: {}", plate.thin_share);
        let thick = lost_detail(&solid_box([0.0; 3], [2.0, 0.26, 2.0]), 8);
        assert!(thick.thin_share < 0.01, "a cell and a little more: {}", thick.thin_share);
    }

    #[test]
    fn a_thin_leg_is_marked_where_it_is() {
        let table =
            together(&[solid_box([0.0, 1.0, 0.0], [2.0, 1.5, 2.0]), solid_box([0.9, 0.0, 0.9], [1.0, 1.0, 1.0])]);
        let found = lost_detail(&table, 8);
        let thin = middles(&found, |lost| lost.thin);
        assert!(thin.len() > 20 && thin.iter().all(|middle| middle.y <= 1.0), "the leg alone: {thin:?}");
    }

    #[test]
    fn what_is_nearer_than_a_cell_is_joined_and_what_is_farther_is_not() {
        let apart = |gap: f64| {
            lost_detail(
                &together(&[
                    solid_box([0.0; 3], [2.0, 1.0, 1.0]),
                    solid_box([2.0 + gap, 0.0, 0.0], [4.0 + gap, 1.0, 1.0]),
                ]),
                12,
            )
        };
        let near = apart(0.1);
        let joined = middles(&near, |lost| lost.joined);
        assert!(joined.len() > 10 && joined.iter().all(|middle| (middle.x - 2.05).abs() < 0.4), "{joined:?}");
        assert!(joined.iter().any(|middle| (middle.x - 2.0).abs() < 1e-9), "the faces that look at each other");
        assert!(apart(0.9).joined_share < 1e-9, "more than two cells apart");
        let stacked = lost_detail(
            &together(&[solid_box([0.0; 3], [2.0, 1.0, 1.0]), solid_box([0.0, 0.9, 0.0], [2.0, 2.0, 1.0])]),
            8,
        );
        assert!(stacked.joined_share > 0.05, "they cross: {}", stacked.joined_share);
    }

    #[test]
    fn pieces_cover_the_surface() {
        let mesh = solid_box([0.0; 3], [2.0, 1.0, 1.0]);
        let found = lost_detail(&mesh, 8);
        let size = |mesh: &TriMesh| {
            let of = |[a, b, c]: [DVec3; 3]| 0.5 * (b - a).cross(c - a).length();
            (0..mesh.triangles.len()).map(|at| of(mesh.corners(at))).sum::<f64>()
        };
        assert!((size(&found.pieces) / 10.0 - 1.0).abs() < 1e-9, "{}", size(&found.pieces));
        assert_eq!(found.pieces.triangles.len(), found.lost.len());
        assert!(found.pieces.positions.len() < found.lost.len(), "neighbours share corners");
    }
}
