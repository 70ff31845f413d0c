//! A mesh laid into its grid, in whole numbers. On a grid of 1/1024 of a cell every question that follows (does this
//! triangle touch that cell, is this centre inside) has an exact answer, and a face meant to lie on a cell boundary
//! lies on it in spite of the rounding in its file.

use glam::DVec3;

use super::{Grid, VoxelizeError};
use crate::geometry::TriMesh;

/// Steps of the whole-number coordinates along a cell.
pub(super) const STEPS_PER_CELL: i64 = 1 << 10;

/// A point in steps of 1/[`STEPS_PER_CELL`] cells. The grid is padded: its origin stands one cell from zero along each
/// axis.
pub(super) type Point = [i64; 3];

/// Triangles in the whole-number coordinates of a padded grid.
pub(super) struct QuantizedMesh {
    /// The grid that covers the mesh.
    pub(super) grid: Grid,
    /// The grid with one more layer of cells on every side.
    pub(super) padded: Grid,
    /// The corners of every triangle.
    pub(super) triangles: Vec<[Point; 3]>,
}

impl QuantizedMesh {
    /// Lays a mesh into cells of its longest extent / `divisions`: the grid is centred on the mesh's box and
    /// covers it with as few cells as possible.
    pub(super) fn new(mesh: &TriMesh, divisions: u32) -> Result<Self, VoxelizeError> {
        let bounds = mesh.bounds();
        // Halved first: the sum of two huge numbers may overflow.
        let centre = bounds.min * 0.5 + bounds.max * 0.5;
        let extent = bounds.max - bounds.min;
        let longest = extent.max_element();
        let cell_size = longest / f64::from(divisions);
        if !(extent.is_finite() && cell_size.is_normal()) {
            return Err(VoxelizeError::Extent(longest));
        }
        // An extent longer than n cells by up to a step, from rounding in the file, is n cells.
        let whole_cells = |extent: f64| libm::ceil(extent / cell_size - 1.0 / STEPS_PER_CELL as f64).max(1.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 1 and divisions")]
        let dims = extent.to_array().map(|extent| whole_cells(extent) as u32);
        let middle = DVec3::from_array(dims.map(f64::from)) * 0.5;
        let grid = Grid { origin: centre - middle * cell_size, cell_size, dims };
        let padded = Grid { origin: grid.origin - DVec3::splat(cell_size), cell_size, dims: dims.map(|n| n + 2) };
        let place = |position: DVec3| (position - centre) / cell_size + middle;
        Ok(Self { grid, padded, triangles: triangles(mesh, dims, place) })
    }

    /// Lays a mesh into a grid that covers it.
    pub(super) fn within(mesh: &TriMesh, grid: Grid) -> Self {
        let Grid { origin, cell_size, dims } = grid;
        let padded = Grid { origin: origin - DVec3::splat(cell_size), cell_size, dims: dims.map(|n| n + 2) };
        let place = |position: DVec3| (position - origin) / cell_size;
        Self { grid, padded, triangles: triangles(mesh, dims, place) }
    }

    /// Returns the mesh together with another that its grid covers.
    pub(super) fn with(&self, other: &TriMesh) -> Self {
        let Self { triangles: more, .. } = Self::within(other, self.grid);
        Self { triangles: [&self.triangles[..], &more].concat(), grid: self.grid, padded: self.padded }
    }

    /// Whether the mesh has no thickness along some axis.
    pub(super) fn is_flat(&self) -> bool {
        let mut corners = self.triangles.iter().flatten();
        let Some(&first) = corners.next() else { return true };
        (0..3).any(|axis| corners.clone().all(|corner| corner[axis] == first[axis]))
    }
}

/// The corners of a mesh's triangles; `place` gives a position in cells of the grid.
fn triangles(mesh: &TriMesh, dims: [u32; 3], place: impl Fn(DVec3) -> DVec3) -> Vec<[Point; 3]> {
    let quantize = |position: DVec3| {
        let steps = (place(position) + DVec3::ONE) * STEPS_PER_CELL as f64;
        [0, 1, 2].map(|axis| whole(steps[axis]).clamp(STEPS_PER_CELL, (i64::from(dims[axis]) + 1) * STEPS_PER_CELL))
    };
    let quantized: Vec<Point> = mesh.positions.iter().map(|&position| quantize(position)).collect();
    mesh.triangles.iter().map(|triangle| triangle.map(|vertex| quantized[vertex as usize])).collect()
}

#[expect(clippy::cast_possible_truncation, reason = "vertices that no triangle uses may lie anywhere; they saturate")]
fn whole(steps: f64) -> i64 {
    libm::round(steps) as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::trimesh::tests::boxed;

    fn place(max: DVec3, divisions: u32) -> QuantizedMesh {
        QuantizedMesh::new(&boxed(DVec3::ZERO, max), divisions).expect("a box")
    }

    #[test]
    fn the_grid_covers_the_box_and_is_centred_on_it() {
        let quantized = place(DVec3::new(2.0, 0.9, 0.0), 4);
        assert_eq!(quantized.grid.dims, [4, 2, 1], "half a metre a cell, at least one");
        let origin = DVec3::new(0.0, -0.05, -0.25);
        assert!((quantized.grid.origin - origin).length() < 1e-15, "the rest is shared by both sides");
        assert!(quantized.is_flat(), "no thickness along z");
    }

    #[test]
    fn an_extent_of_whole_cells_is_not_rounded_up() {
        for (third, expected) in [(1.0 / 3.0, 1), (0.333_334, 1), (0.333_333, 1), (0.34, 2)] {
            assert_eq!(place(DVec3::new(1.0, third, third), 3).grid.dims[1], expected, "an extent of {third}");
        }
    }

    #[test]
    fn a_boundary_in_the_model_is_a_boundary_of_cells_at_any_scale() {
        for scale in [1e-30, 0.1, 1e30] {
            let quantized = place(DVec3::new(0.3, 0.1, 0.2) * scale, 3);
            assert!(
                quantized.triangles.iter().flatten().flatten().all(|step| step % STEPS_PER_CELL == 0),
                "on it at {scale}"
            );
        }
    }

    #[test]
    fn extents_that_are_no_numbers_are_refused() {
        for (low, high) in [(-1e308, 1e308), (0.0, 0.0), (0.0, 1e-320)] {
            let mesh = boxed(DVec3::splat(low), DVec3::splat(high));
            assert!(matches!(QuantizedMesh::new(&mesh, 20), Err(VoxelizeError::Extent(_))), "from {low} to {high}");
        }
    }
}
