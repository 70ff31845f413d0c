//! Centre occupancy (GC §12.2): a cell is filled where a ray along x to its centre crosses the surface an odd number of
//! times.

use fixedbitset::FixedBitSet;

use super::crossings::{Crossings, winding_spans};
use super::quantized_mesh::QuantizedMesh;
use super::{Cells, VoxelizeError};
use crate::geometry::watch::CountedProgress;

/// What rays found.
pub(super) struct ParityFill {
    /// The cells whose centre is inside.
    pub(super) cells: Cells,
    /// The number of cells with an even winding number other than zero: parity leaves them empty.
    pub(super) overlaps: usize,
}

/// Sends a ray through every column of cells.
pub(super) fn fill_by_parity(
    quantized: &QuantizedMesh,
    progress: &CountedProgress<'_>,
) -> Result<ParityFill, VoxelizeError> {
    let QuantizedMesh { grid, ref triangles, .. } = *quantized;
    let crossings = Crossings::new(triangles, grid.dims, progress)?;
    let mut filled = FixedBitSet::with_capacity(grid.len());
    let mut overlaps = 0;
    let [nx, ny, nz] = grid.dims;
    for (k, j) in (0..nz).flat_map(|k| (0..ny).map(move |j| (k, j))) {
        let row = grid.index([0, j, k]);
        winding_spans(crossings.of_ray(j, k), nx, |first, end, winding| {
            if winding % 2 != 0 {
                filled.insert_range(row + first as usize..row + end as usize);
            } else if winding != 0 {
                overlaps += (end - first) as usize;
            }
        });
    }
    Ok(ParityFill { cells: Cells { grid, filled }, overlaps })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::TriMesh;
    use crate::geometry::trimesh::tests::{boxed, together};
    use crate::math::rng::Rng;

    fn inside(mesh: &TriMesh, divisions: u32) -> ParityFill {
        let quantized = QuantizedMesh::new(mesh, divisions).expect("a mesh");
        fill_by_parity(&quantized, &CountedProgress::new(&(), 1, [0.0, 1.0])).expect("not cancelled")
    }

    #[test]
    fn shared_edges_and_vertices_under_a_centre_count_once() {
        // Seen along x, the edges of an octahedron and two of its vertices lie on the middle column of an odd grid.
        let tips = [DVec3::X, DVec3::Y, DVec3::Z];
        let positions = tips.into_iter().chain(tips.map(|tip| -tip)).collect();
        let sides = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
        let mesh = TriMesh { positions, triangles: sides.to_vec() };
        for divisions in [3, 9, 33] {
            let ParityFill { cells, .. } = inside(&mesh, divisions);
            for (at, cell) in cells.grid.iter().enumerate() {
                let filled = cells.filled[at];
                let middle = cells.grid.corner(cell) + DVec3::splat(cells.grid.cell_size * 0.5);
                let reach = middle.abs().element_sum();
                assert!((reach - 1.0).abs() < 1e-9 || filled == (reach < 1.0), "{cell:?} of {divisions}");
            }
        }
    }

    #[test]
    fn neighbouring_solids_share_out_every_cell() {
        // Two wedges that meet in a skew plane through cell centres: each cell belongs to exactly one.
        let mut rng = Rng::new(5);
        for _ in 0..20 {
            let n = 8;
            let mut at = || libm::floor(rng.between(0.0, 9.0)) + 0.5;
            let cut = [[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [0.0, 8.0]].map(|[y, z]| DVec3::new(at() - 0.5, y, z));
            let prism = |near: [DVec3; 4], far: [DVec3; 4]| {
                let positions = near.into_iter().chain(far).collect();
                let mut triangles = vec![[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]];
                for i in 0..4 {
                    let j = (i + 1) % 4;
                    triangles.extend([[i, i + 4, j], [j, i + 4, j + 4]]);
                }
                TriMesh { positions, triangles }
            };
            let wall = |x: f64| cut.map(|corner| DVec3::new(x, corner.y, corner.z));
            // Degenerate triangles at corners of the box keep the grid of both the same.
            let frame = |mesh: TriMesh| {
                let bounds = boxed(DVec3::ZERO, DVec3::splat(8.0));
                let corners = TriMesh { triangles: vec![[0, 0, 0], [14, 14, 14], [23, 23, 23]], ..bounds };
                together(&[mesh, boxed(DVec3::ZERO, DVec3::ZERO), corners])
            };
            let low = inside(&frame(prism(wall(0.0), cut)), n).cells;
            let high = inside(&frame(prism(cut, wall(8.0))), n).cells;
            assert_eq!(low.grid.dims, [n; 3], "the frame holds the grid");
            assert_eq!(low.grid, high.grid, "one grid");
            for at in 0..low.grid.len() {
                assert_ne!(low.filled[at], high.filled[at], "cell {at} belongs to one of them: {cut:?}");
            }
        }
    }

    #[test]
    fn overlapping_solids_are_noticed_and_cavities_are_not_overlaps() {
        let solid = |low: f64, high: f64| boxed(DVec3::splat(low), DVec3::splat(high));
        let overlap = inside(&together(&[solid(0.0, 3.0), solid(1.0, 4.0)]), 4);
        assert_eq!((overlap.overlaps, overlap.cells.count()), (8, 27 + 27 - 16), "parity leaves the overlap out");
        let mut cavity = solid(1.0, 3.0);
        for triangle in &mut cavity.triangles {
            triangle.swap(0, 1);
        }
        let hollow = inside(&together(&[solid(0.0, 4.0), cavity]), 4);
        assert_eq!((hollow.overlaps, hollow.cells.count()), (0, 64 - 8), "a hollow box");
    }
}
