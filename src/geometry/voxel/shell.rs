//! Surface and solid occupancy (SC): the cells that triangles touch, and what outside air cannot reach.

use std::sync::atomic::{AtomicU8, Ordering};

use rayon::prelude::*;

use super::quantized_mesh::QuantizedMesh;
use super::{Cells, Grid, VoxelizeError, touch};
use crate::geometry::watch::Pieces;

/// Triangles that one task takes at a time.
pub(super) const CHUNK: usize = 512;

const TOUCHED: u8 = 1;
/// A wall on the low face of the cell, one bit an axis.
const WALL: [u8; 3] = [2, 4, 8];
const OUTSIDE: u8 = 16;

/// Every cell of the padded grid: touched, walled off from its lower neighbours, reached from outside.
pub(super) struct Shell {
    grid: Grid,
    padded: Grid,
    flags: Vec<u8>,
}

impl Shell {
    /// Marks what the triangles touch and floods the rest from outside.
    pub(super) fn new(quantized: &QuantizedMesh, pieces: &Pieces<'_>) -> Result<Self, VoxelizeError> {
        let QuantizedMesh { grid, padded, ref triangles } = *quantized;
        let flags: Vec<AtomicU8> = std::iter::repeat_with(AtomicU8::default).take(padded.len()).collect();
        // Setting bits commutes: the result does not depend on who comes first.
        let set = |cell: [u32; 3], bit: u8| flags[padded.index(cell)].fetch_or(bit, Ordering::Relaxed);
        triangles.par_chunks(CHUNK).try_for_each(|chunk| {
            for triangle in chunk {
                touch::touched(triangle, |cell| {
                    set(cell, TOUCHED);
                });
                touch::walls(triangle, |axis, cell| {
                    set(cell, WALL[axis]);
                });
            }
            pieces.advance().then_some(()).ok_or(VoxelizeError::Cancelled)
        })?;
        let mut shell = Self { grid, padded, flags: flags.into_iter().map(AtomicU8::into_inner).collect() };
        shell.flood();
        Ok(shell)
    }

    /// The cells that a triangle touches. A triangle that lies between two cells fills the one that outside air cannot
    /// reach; if it reaches both, the lower one, unless the other one is filled anyway.
    pub(super) fn surface(&self) -> Cells {
        self.cells(|flags| flags & TOUCHED != 0)
    }

    /// The surface and all that outside air cannot reach.
    pub(super) fn solid(&self) -> Cells {
        self.cells(|flags| flags & OUTSIDE == 0)
    }

    fn cells(&self, is_filled: impl Fn(u8) -> bool) -> Cells {
        let inner = |cell: [u32; 3]| cell.map(|n| n + 1);
        let mut filled: Vec<bool> =
            self.grid.iter().map(|cell| is_filled(self.flags[self.padded.index(inner(cell))])).collect();
        for (cell, &flags) in self.padded.iter().zip(&self.flags) {
            for axis in (0..3).filter(|&axis| flags & WALL[axis] != 0) {
                if let Some(cell) = self.behind_wall(axis, cell) {
                    filled[self.grid.index(cell.map(|n| n - 1))] = true;
                }
            }
        }
        Cells { grid: self.grid, filled }
    }

    /// The cell that a wall fills, in the padded grid.
    fn behind_wall(&self, axis: usize, upper: [u32; 3]) -> Option<[u32; 3]> {
        let mut lower = upper;
        lower[axis] -= 1;
        let flags = |cell: [u32; 3]| self.flags[self.padded.index(cell)];
        let is_enclosed = |cell: [u32; 3]| flags(cell) & (TOUCHED | OUTSIDE) == 0;
        if is_enclosed(lower) {
            Some(lower)
        } else if is_enclosed(upper) {
            Some(upper)
        } else if (flags(lower) | flags(upper)) & TOUCHED != 0 {
            None
        } else {
            Some(if lower[axis] > 0 { lower } else { upper })
        }
    }

    /// Reaches every cell that a path through faces leads to from the padding, around touched cells and walls.
    fn flood(&mut self) {
        let dims = self.padded.dims;
        let mut open = vec![[0, 0, 0]];
        self.flags[0] |= OUTSIDE;
        while let Some(cell) = open.pop() {
            let walls = self.flags[self.padded.index(cell)];
            for axis in 0..3 {
                for up in [false, true] {
                    let mut next = cell;
                    next[axis] = if up { cell[axis] + 1 } else { cell[axis].wrapping_sub(1) };
                    if next[axis] >= dims[axis] {
                        continue;
                    }
                    let flags = &mut self.flags[self.padded.index(next)];
                    let wall = if up { *flags } else { walls } & WALL[axis];
                    if wall == 0 && *flags & (TOUCHED | OUTSIDE) == 0 {
                        *flags |= OUTSIDE;
                        open.push(next);
                    }
                }
            }
        }
    }
}
