//! Divides the surface of a mesh into small pieces, each of which counts for one cell.

use glam::DVec3;

use super::Grid;
use crate::geometry::TriMesh;

/// The longest edge of a piece that is a sample of a cell's contents, in cells; longer if there would be too many pieces.
pub(super) const MAX_SAMPLE_EDGE: f64 = 0.5;

/// A sliver may have longer edges: a piece whose area is below this share of the square of that length.
const SLIVER: f64 = 1.0 / 16.0;

/// The most squares of that length in a surface, with a few samples each. A surface that lies on itself a thousand times has
/// no more samples than one that does not.
const MAX_SQUARES: f64 = 1e6;

/// Divides the triangles of a mesh.
pub(in crate::geometry) struct Divider<'a> {
    mesh: &'a TriMesh,
    grid: Grid,
    max_squared_edge: f64,
    open: Vec<[DVec3; 3]>,
}

impl<'a> Divider<'a> {
    /// Prepares to divide a mesh within a grid into pieces whose edges are at most `longest` cells.
    pub(in crate::geometry) fn new(mesh: &'a TriMesh, grid: &Grid, longest: f64) -> Self {
        let max_squared_edge = (area(mesh, grid) / MAX_SQUARES).max(longest * longest);
        Self { mesh, grid: *grid, max_squared_edge, open: Vec::new() }
    }

    /// Calls `found` with the cell of the grid and the area of every piece of a triangle, in squares of cells.
    pub(in crate::geometry) fn pieces(&mut self, triangle: usize, mut found: impl FnMut([u32; 3], f64)) {
        let dims = self.grid.dims;
        self.triangles(triangle, |[a, b, c]| {
            let middle = ((a + b + c) / 3.0).to_array();
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the grid; saturating")]
            let cell = std::array::from_fn(|axis| (middle[axis] as u32).min(dims[axis] - 1));
            found(cell, 0.5 * (b - a).cross(c - a).length());
        });
    }

    /// Calls `found` with the corners of every piece of a triangle, in cells from the grid's origin.
    pub(super) fn triangles(&mut self, triangle: usize, mut found: impl FnMut([DVec3; 3])) {
        let Self { mesh, grid, max_squared_edge, ref mut open } = *self;
        open.push(mesh.corners(triangle).map(|corner| (corner - grid.origin) / grid.cell_size));
        while let Some([a, b, c]) = open.pop() {
            let area = 0.5 * (b - a).cross(c - a).length();
            let [ab, bc, ca] = [b - a, c - b, a - c].map(DVec3::length_squared);
            let longest = ab.max(bc).max(ca);
            if longest > max_squared_edge && area > SLIVER * max_squared_edge {
                // The corner across from the longest edge comes first.
                let [tip, from, to] = if bc >= longest {
                    [a, b, c]
                } else if ca >= longest {
                    [b, c, a]
                } else {
                    [c, a, b]
                };
                let middle = 0.5 * (from + to);
                open.extend([[tip, from, middle], [tip, middle, to]]);
            } else if area > 0.0 {
                found([a, b, c]);
            }
        }
    }
}

/// The area of a mesh, in squares of cells.
pub(super) fn area(mesh: &TriMesh, grid: &Grid) -> f64 {
    let of = |[a, b, c]: [DVec3; 3]| 0.5 * ((b - a) / grid.cell_size).cross((c - a) / grid.cell_size).length();
    (0..mesh.triangles.len()).map(|triangle| of(mesh.corners(triangle))).sum()
}

/// Returns the filled cells that take an empty one's contents: those that share a face with it, else an edge, else a corner.
pub(in crate::geometry) fn receiving_cells(
    grid: &Grid,
    cell: [u32; 3],
    is_filled: impl Fn(usize) -> bool,
) -> impl Iterator<Item = usize> + Clone {
    let (mut places, mut count, mut nearest) = ([0; 26], 0, 4);
    for near in grid.around(cell) {
        let (axes, place) = ((0..3).filter(|&axis| near[axis] != cell[axis]).count(), grid.index(near));
        if axes == 0 || axes > nearest || !is_filled(place) {
            continue;
        }
        if axes < nearest {
            (nearest, count) = (axes, 0);
        }
        places[count] = place;
        count += 1;
    }
    places.into_iter().take(count)
}
