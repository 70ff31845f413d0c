//! Centre occupancy (GC §12.2): a cell is filled where a ray along x to its centre crosses the surface an odd number of
//! times.
//!
//! Triangles are rasterised to the columns of cells. A centre that lies exactly on a triangle's edge, as seen along x, is
//! moved by a vanishing amount, the same for every triangle (+y, and far less +z: Edelsbrunner and Mücke, "Simulation of
//! Simplicity", 1990), so that shared edges and vertices count once. A centre on the surface itself counts as behind it.

use std::sync::atomic::{AtomicI16, Ordering};

use rayon::prelude::*;

use super::quantized_mesh::{CELL, Point, QuantizedMesh};
use super::shell::CHUNK;
use super::touch::{cross, minus};
use super::{Cells, Grid, VoxelizeError};
use crate::geometry::watch::Pieces;

/// What rays found.
pub(super) struct Parity {
    /// The cells whose centre is inside.
    pub(super) cells: Cells,
    /// The cells that closed surfaces wind around more than once, an even number of times: parity leaves them empty.
    pub(super) overlaps: usize,
}

/// Sends a ray through every column of cells.
pub(super) fn parity(quantized: &QuantizedMesh, pieces: &Pieces<'_>) -> Result<Parity, VoxelizeError> {
    let QuantizedMesh { grid, padded, ref triangles } = *quantized;
    let crossings = crossings(triangles, &padded, pieces)?;
    let mut filled = Vec::with_capacity(grid.len());
    let mut overlaps = 0;
    let [nx, ny, nz] = grid.dims;
    for (k, j) in (1..=nz).flat_map(|k| (1..=ny).map(move |j| (k, j))) {
        let row = padded.index([1, j, k]);
        let mut winding = 0_i16;
        for &crossing in &crossings[row..row + nx as usize] {
            winding = winding.wrapping_add(crossing);
            filled.push(winding % 2 != 0);
            overlaps += usize::from(winding != 0 && winding % 2 == 0);
        }
    }
    Ok(Parity { cells: Cells { grid, filled }, overlaps })
}

/// What rays along x through the columns of a padded grid cross: for every cell how many surfaces are entered less those
/// left between the centre before it and its own.
pub(super) fn crossings(
    triangles: &[[Point; 3]],
    padded: &Grid,
    pieces: &Pieces<'_>,
) -> Result<Vec<i16>, VoxelizeError> {
    let crossings: Vec<AtomicI16> = std::iter::repeat_with(AtomicI16::default).take(padded.len()).collect();
    triangles.par_chunks(CHUNK).try_for_each(|chunk| {
        for triangle in chunk {
            // Adding commutes: the result does not depend on who comes first. Wrapping keeps the parity.
            cross_columns(triangle, |cell, sign| {
                crossings[padded.index(cell)].fetch_add(sign, Ordering::Relaxed);
            });
        }
        pieces.advance().then_some(()).ok_or(VoxelizeError::Cancelled)
    })?;
    Ok(crossings.into_iter().map(AtomicI16::into_inner).collect())
}

/// Calls `found` for every column whose ray crosses the triangle: with the first cell (of the padded grid) whose centre is
/// not before the crossing, and +1 where the ray enters, −1 where it leaves.
fn cross_columns(&[a, b, c]: &[Point; 3], mut found: impl FnMut([u32; 3], i16)) {
    const HALF: i64 = CELL / 2;
    let normal = cross(minus(b, a), minus(c, a));
    if normal[0] == 0 {
        return;
    }
    // Seen along x, turn left: the normal then points along +x.
    let (b, c, normal, sign) = if normal[0] > 0 { (b, c, normal, -1) } else { (c, b, normal.map(|n| -n), 1) };
    let edges = [(a, b), (b, c), (c, a)];
    let low = a[2].min(b[2]).min(c[2]);
    let high = a[2].max(b[2]).max(c[2]);
    for k in ceil_div(low - HALF, CELL)..=(high - HALF).div_euclid(CELL) {
        let z = k * CELL + HALF;
        let (mut first, mut last) = (i64::MIN, i64::MAX);
        for (p, q) in edges {
            let (dy, dz) = (q[1] - p[1], q[2] - p[2]);
            // On the edge itself the vanishing shift decides.
            let least = i64::from(!(dz < 0 || (dz == 0 && dy > 0)));
            // Left of the edge: dy (z − p_z) − dz (y − p_y) ≥ least, with y = j CELL + HALF.
            let free = dy * (z - p[2]) - dz * (HALF - p[1]) - least;
            let slope = dz * CELL;
            if slope > 0 {
                last = last.min(free.div_euclid(slope));
            } else if slope < 0 {
                first = first.max(ceil_div(-free, -slope));
            } else if free < 0 {
                last = i64::MIN;
            }
        }
        for j in first..=last {
            let y = j * CELL + HALF;
            let [nx, ny, nz] = normal.map(i128::from);
            let rise = ny * i128::from(y - a[1]) + nz * i128::from(z - a[2]);
            // The crossing is at a_x − rise / nx; the first centre i CELL + HALF not before it.
            let i = ceil_div_wide(i128::from(a[0] - HALF) * nx - rise, nx * i128::from(CELL));
            if let (Ok(i), Ok(j), Ok(k)) = (u32::try_from(i), u32::try_from(j), u32::try_from(k)) {
                found([i, j, k], sign);
            }
        }
    }
}

/// The quotient rounded up; `b` is positive.
fn ceil_div(a: i64, b: i64) -> i64 {
    -(-a).div_euclid(b)
}

fn ceil_div_wide(a: i128, b: i128) -> i128 {
    -(-a).div_euclid(b)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::TriMesh;
    use crate::geometry::trimesh::tests::{boxed, together};
    use crate::math::rng::Rng;

    fn inside(mesh: &TriMesh, divisions: u32) -> Parity {
        let quantized = QuantizedMesh::new(mesh, divisions).expect("a mesh");
        parity(&quantized, &Pieces::new(&(), 1, [0.0, 1.0])).expect("not cancelled")
    }

    #[test]
    fn shared_edges_and_vertices_under_a_centre_count_once() {
        // Seen along x, the edges of an octahedron and two of its vertices lie on the middle column of an odd grid.
        let tips = [DVec3::X, DVec3::Y, DVec3::Z];
        let positions = tips.into_iter().chain(tips.map(|tip| -tip)).collect();
        let sides = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
        let mesh = TriMesh { positions, triangles: sides.to_vec() };
        for divisions in [3, 9, 33] {
            let Parity { cells, .. } = inside(&mesh, divisions);
            for (cell, &filled) in cells.grid.iter().zip(&cells.filled) {
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
            // A far needle keeps the grid of both the same.
            let frame = |mesh: TriMesh| {
                let bounds = boxed(DVec3::ZERO, DVec3::splat(8.0));
                let corners = TriMesh { triangles: vec![[0, 0, 0], [14, 14, 14], [23, 23, 23]], ..bounds };
                together(&[mesh, boxed(DVec3::ZERO, DVec3::ZERO), corners])
            };
            let low = inside(&frame(prism(wall(0.0), cut)), n).cells;
            let high = inside(&frame(prism(cut, wall(8.0))), n).cells;
            assert_eq!(low.grid.dims, [n; 3], "the frame holds the grid");
            assert_eq!(low.grid, high.grid, "one grid");
            for (at, (a, b)) in low.filled.iter().zip(&high.filled).enumerate() {
                assert_ne!(a, b, "cell {at} belongs to one of them: {cut:?}");
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
