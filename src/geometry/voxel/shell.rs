//! Surface and solid occupancy (SC): the cells that triangles touch, and what outside air cannot reach.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use fixedbitset::FixedBitSet;
use rayon::prelude::*;

use super::quantized_mesh::QuantizedMesh;
use super::{Cells, Grid, VoxelizeError, touch};
use crate::geometry::watch::CountedProgress;

/// Triangles that one task takes at a time.
pub(super) const CHUNK_TRIANGLES: usize = 512;

/// What is known of every cell of the padded grid, one bit each.
pub(super) struct Shell {
    grid: Grid,
    padded: Grid,
    /// A triangle touches the cell.
    touched: FixedBitSet,
    /// By axis: there is a wall on the cell's low face. The set is empty if that axis has no wall at all.
    walls: [FixedBitSet; 3],
    /// Air reaches the cell from outside.
    outside: FixedBitSet,
}

impl Shell {
    /// Marks what the triangles touch and floods the rest from outside.
    pub(super) fn new(quantized: &QuantizedMesh, progress: &CountedProgress<'_>) -> Result<Self, VoxelizeError> {
        let QuantizedMesh { grid, padded, ref triangles } = *quantized;
        let touched = AtomicBitSet::new(&padded);
        let walls = [const { OnceLock::new() }; 3];
        triangles.par_chunks(CHUNK_TRIANGLES).try_for_each(|chunk| {
            for triangle in chunk {
                touch::touched(triangle, |cell| touched.set(padded.index(cell)));
                touch::walls(triangle, |axis, cell| {
                    walls[axis].get_or_init(|| AtomicBitSet::new(&padded)).set(padded.index(cell));
                });
            }
            progress.advance().then_some(()).ok_or(VoxelizeError::Cancelled)
        })?;
        let walls = walls.map(|marks| marks.into_inner().map_or_else(FixedBitSet::new, AtomicBitSet::into_bit_set));
        let outside = FixedBitSet::with_capacity(padded.len());
        let mut shell = Self { grid, padded, touched: touched.into_bit_set(), walls, outside };
        shell.flood();
        Ok(shell)
    }

    /// The cells that a triangle touches. A triangle that lies between two cells fills the one that outside air cannot
    /// reach; if it reaches both, the lower one, unless the other one is filled anyway.
    pub(super) fn surface(&self) -> Cells {
        self.cells(|cell| self.touched[cell])
    }

    /// The surface and all that outside air cannot reach.
    pub(super) fn solid(&self) -> Cells {
        self.cells(|cell| !self.outside[cell])
    }

    fn cells(&self, is_filled: impl Fn(usize) -> bool) -> Cells {
        let mut filled = FixedBitSet::with_capacity(self.grid.len());
        for (at, cell) in self.grid.iter().enumerate() {
            filled.set(at, is_filled(self.padded.index(cell.map(|n| n + 1))));
        }
        for (axis, walls) in self.walls.iter().enumerate() {
            for cell in walls.ones().filter_map(|cell| self.behind_wall(axis, self.padded.cell(cell))) {
                filled.insert(self.grid.index(cell.map(|n| n - 1)));
            }
        }
        Cells { grid: self.grid, filled }
    }

    /// The cell that a wall fills, in the padded grid.
    fn behind_wall(&self, axis: usize, upper: [u32; 3]) -> Option<[u32; 3]> {
        let mut lower = upper;
        lower[axis] -= 1;
        let [at_lower, at_upper] = [lower, upper].map(|cell| self.padded.index(cell));
        let is_enclosed = |cell: usize| !self.touched[cell] && !self.outside[cell];
        if is_enclosed(at_lower) {
            Some(lower)
        } else if is_enclosed(at_upper) {
            Some(upper)
        } else if self.touched[at_lower] || self.touched[at_upper] {
            None
        } else {
            Some(if lower[axis] > 0 { lower } else { upper })
        }
    }

    /// Marks as outside every cell that a path through faces reaches from the padding without touched cells and walls. It
    /// takes a run along x at a time, as runs are far fewer.
    fn flood(&mut self) {
        let Self { padded, touched, walls, outside, .. } = self;
        let mut open = vec![[0, 0, 0]];
        while let Some([i, j, k]) = open.pop() {
            let row = padded.index([0, j, k]);
            let (mut first, mut last) = (row + i as usize, row + i as usize);
            let end = row + padded.dims[0] as usize;
            if outside[first] {
                continue;
            }
            while first > row && !walls[0].contains(first) && !touched[first - 1] {
                first -= 1;
            }
            while last + 1 < end && !walls[0].contains(last + 1) && !touched[last + 1] {
                last += 1;
            }
            outside.insert_range(first..last + 1);
            for (axis, up) in [(1, false), (1, true), (2, false), (2, true)] {
                let mut next = [0, j, k];
                next[axis] = if up { next[axis] + 1 } else { next[axis].wrapping_sub(1) };
                if next[axis] >= padded.dims[axis] {
                    continue;
                }
                let next_row = padded.index(next);
                let mut is_same_run = false;
                for here in first..=last {
                    let there = next_row + here - row;
                    let has_wall = walls[axis].contains(if up { there } else { here });
                    let is_open = !has_wall && !touched[there] && !outside[there];
                    if is_open && (!is_same_run || walls[0].contains(there)) {
                        open.push([u32::try_from(here - row).unwrap_or(u32::MAX), next[1], next[2]]);
                    }
                    is_same_run = is_open;
                }
            }
        }
    }
}

/// Cells that are marked from several threads. Setting bits commutes: the result does not depend on who comes first.
struct AtomicBitSet {
    cells: usize,
    blocks: Vec<AtomicUsize>,
}

impl AtomicBitSet {
    fn new(grid: &Grid) -> Self {
        let blocks = grid.len().div_ceil(usize::BITS as usize);
        Self { cells: grid.len(), blocks: std::iter::repeat_with(AtomicUsize::default).take(blocks).collect() }
    }

    fn set(&self, cell: usize) {
        let [block, bit] = [cell / usize::BITS as usize, cell % usize::BITS as usize];
        self.blocks[block].fetch_or(1 << bit, Ordering::Relaxed);
    }

    fn into_bit_set(self) -> FixedBitSet {
        FixedBitSet::with_capacity_and_blocks(self.cells, self.blocks.into_iter().map(AtomicUsize::into_inner))
    }
}
