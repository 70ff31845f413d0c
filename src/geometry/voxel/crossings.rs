//! Finds where rays along x through the centres of a grid's cells cross a mesh.
//!
//! Triangles are rasterised to the columns of cells. A centre that lies exactly on a triangle's edge, as seen along x, is
//! moved by a vanishing amount, the same for every triangle (+y, and far less +z: Edelsbrunner and Mücke, "Simulation of
//! Simplicity", 1990), so that shared edges and vertices count once. A centre on the surface itself counts as behind it.

use rayon::prelude::*;

use super::pieces::area;
use super::quantized_mesh::{Point, QuantizedMesh, STEPS_PER_CELL};
use super::shell::CHUNK_TRIANGLES;
use super::touch::{cross, minus};
use super::{Grid, VoxelizeError};
use crate::geometry::watch::{CancelOnly, CountedProgress};
use crate::geometry::{TriMesh, Watch};

/// Chunks of triangles to take before crossings at the same place are merged.
const CHUNKS_PER_MERGE: usize = 64;

/// The most crossings of rays with the surface, along an axis.
const MAX_CROSSINGS: f64 = 3e7;

/// Fewer crossings than this are not worth merging.
const MIN_CROSSINGS_TO_MERGE: usize = 1 << 20;

/// The surfaces that a ray crosses between two neighbouring cell centres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Crossing {
    /// The ray.
    row: u32,
    /// The first cell along the ray whose centre is not before the surfaces.
    pub(super) cell: u16,
    /// Surfaces entered less surfaces left; it wraps, which keeps the parity.
    pub(super) winding_change: i16,
}

/// The crossings of all rays.
#[derive(Debug)]
pub(super) struct Crossings {
    /// The number of rays along y and z.
    rays: [u32; 2],
    /// Where the crossings of every ray begin, and the end of the last.
    starts: Vec<u32>,
    /// Sorted by ray and then along it, at most one at each place.
    all: Vec<Crossing>,
}

impl Crossings {
    /// Finds the crossings of rays along x, y and z through cells `steps` times finer than a grid's, and returns the finer
    /// grid too. If the surface is so large that there would be too many crossings, the cells are coarser, but still `least`
    /// times finer. The axes of each direction are rotated so that the rays run along the first. Reports no progress.
    pub(super) fn along_axes(
        mesh: &TriMesh,
        grid: &Grid,
        mut steps: u32,
        least: u32,
        watch: &dyn Watch,
    ) -> Result<([Self; 3], Grid), VoxelizeError> {
        let area = area(mesh, grid);
        while steps > least && area * f64::from(steps).powi(2) > MAX_CROSSINGS {
            steps = (steps / 2).max(least);
        }
        let dims = grid.dims.map(|n| n * steps);
        let fine = Grid { cell_size: grid.cell_size / f64::from(steps), dims, origin: grid.origin };
        let mut quantized = QuantizedMesh::within(mesh, fine);
        let silent = CancelOnly(watch);
        let mut along = |axis: usize| {
            if axis > 0 {
                for corner in quantized.triangles.iter_mut().flatten() {
                    corner.rotate_left(1);
                }
            }
            let mut dims = dims;
            dims.rotate_left(axis);
            let chunks = quantized.triangles.len().div_ceil(CHUNK_TRIANGLES);
            Self::new(&quantized.triangles, dims, &CountedProgress::new(&silent, chunks, [0.0, 1.0]))
        };
        Ok(([along(0)?, along(1)?, along(2)?], fine))
    }

    /// Finds the crossings of rays along x through a grid of `dims` cells; the triangles are in coordinates of the padded
    /// grid. The result does not depend on the number of threads.
    pub(super) fn new(
        triangles: &[[Point; 3]],
        dims: [u32; 3],
        progress: &CountedProgress<'_>,
    ) -> Result<Self, VoxelizeError> {
        let rays = [dims[1], dims[2]];
        let (mut all, mut least) = (Vec::new(), 0);
        for block in triangles.chunks(CHUNKS_PER_MERGE * CHUNK_TRIANGLES) {
            let of_block: Vec<Vec<Crossing>> = block
                .par_chunks(CHUNK_TRIANGLES)
                .map(|chunk| {
                    let mut found = Vec::new();
                    for triangle in chunk {
                        cross_columns(triangle, |[i, j, k], winding_change| {
                            // From the padded grid to the grid itself.
                            let (cell, row) = (u16::try_from(i - 1).unwrap_or(u16::MAX), j - 1 + rays[0] * (k - 1));
                            found.push(Crossing { row, cell, winding_change });
                        });
                    }
                    progress.advance().then_some(found).ok_or(VoxelizeError::Cancelled)
                })
                .collect::<Result<_, _>>()?;
            all.extend(of_block.into_iter().flatten());
            if all.len() > MIN_CROSSINGS_TO_MERGE + 2 * least {
                merge_crossings(&mut all);
                least = all.len();
            }
        }
        merge_crossings(&mut all);
        let mut starts = vec![0; rays.iter().map(|&n| n as usize).product::<usize>() + 1];
        for crossing in &all {
            starts[crossing.row as usize + 1] += 1;
        }
        let mut before = 0;
        for start in &mut starts {
            before += *start;
            *start = before;
        }
        Ok(Self { rays, starts, all })
    }

    /// Returns the crossings of the ray through the centres of the cells (·, j, k).
    pub(super) fn of_ray(&self, j: u32, k: u32) -> &[Crossing] {
        let row = (j + self.rays[0] * k) as usize;
        &self.all[self.starts[row] as usize..self.starts[row + 1] as usize]
    }
}

/// Sorts crossings and merges those at the same place.
fn merge_crossings(all: &mut Vec<Crossing>) {
    all.par_sort_unstable();
    all.dedup_by(|next, kept| {
        let is_same = (next.row, next.cell) == (kept.row, kept.cell);
        if is_same {
            kept.winding_change = kept.winding_change.wrapping_add(next.winding_change);
        }
        is_same
    });
}

/// Divides the cells along a ray into spans with one winding number of their centres. Calls `found` with the first cell of
/// the span, the one after its last, and the winding number.
pub(super) fn winding_spans(of_ray: &[Crossing], cells: u32, mut found: impl FnMut(u32, u32, i16)) {
    let (mut from, mut winding) = (0, 0_i16);
    for crossing in of_ray {
        let at = u32::from(crossing.cell);
        if from < at {
            found(from, at, winding);
        }
        (from, winding) = (at, winding.wrapping_add(crossing.winding_change));
    }
    if from < cells {
        found(from, cells, winding);
    }
}

/// Calls `found` for every column whose ray crosses the triangle: with the first cell (of the padded grid) whose centre is
/// not before the crossing, and +1 where the ray enters, −1 where it leaves.
fn cross_columns(&[a, b, c]: &[Point; 3], mut found: impl FnMut([u32; 3], i16)) {
    const HALF: i64 = STEPS_PER_CELL / 2;
    let normal = cross(minus(b, a), minus(c, a));
    if normal[0] == 0 {
        return;
    }
    // Seen along x, turn left: the normal then points along +x.
    let (b, c, normal, sign) = if normal[0] > 0 { (b, c, normal, -1) } else { (c, b, normal.map(|n| -n), 1) };
    let edges = [(a, b), (b, c), (c, a)];
    let low = a[2].min(b[2]).min(c[2]);
    let high = a[2].max(b[2]).max(c[2]);
    for k in ceil_div(low - HALF, STEPS_PER_CELL)..=(high - HALF).div_euclid(STEPS_PER_CELL) {
        let z = k * STEPS_PER_CELL + HALF;
        let (mut first, mut last) = (i64::MIN, i64::MAX);
        for (p, q) in edges {
            let (dy, dz) = (q[1] - p[1], q[2] - p[2]);
            // On the edge itself the vanishing shift decides.
            let least = i64::from(!(dz < 0 || (dz == 0 && dy > 0)));
            // Left of the edge: dy (z − p_z) − dz (y − p_y) ≥ least, with y = j STEPS_PER_CELL + HALF.
            let free = dy * (z - p[2]) - dz * (HALF - p[1]) - least;
            let slope = dz * STEPS_PER_CELL;
            if slope > 0 {
                last = last.min(free.div_euclid(slope));
            } else if slope < 0 {
                first = first.max(ceil_div(-free, -slope));
            } else if free < 0 {
                last = i64::MIN;
            }
        }
        for j in first..=last {
            let y = j * STEPS_PER_CELL + HALF;
            let [nx, ny, nz] = normal.map(i128::from);
            let rise = ny * i128::from(y - a[1]) + nz * i128::from(z - a[2]);
            // The crossing is at a_x − rise / nx; the first centre i STEPS_PER_CELL + HALF not before it.
            let i = ceil_div_wide(i128::from(a[0] - HALF) * nx - rise, nx * i128::from(STEPS_PER_CELL));
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
