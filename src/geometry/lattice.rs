//! From filled cells to particles and links (S3, S4; GC §3, §11).

use glam::DVec3;

use super::voxel::{Cells, Grid};

/// The particles and links of a body at rest. A grid corner is one particle however many cells meet there; no link
/// exists twice.
#[derive(Clone, Debug)]
pub struct Lattice {
    /// The grid the cells came from.
    pub grid: Grid,
    /// The grid corner of every particle, x fastest, ascending.
    pub corners: Vec<[u32; 3]>,
    /// Links by family (structural, shear, bending), each as (lower, higher) particle, ascending.
    pub links: [Vec<[u32; 2]>; 3],
    /// The particles of every filled cell; bit 0 of the place is x, bit 1 y, bit 2 z.
    pub cells: Vec<[u32; 8]>,
}

impl Lattice {
    /// Builds the lattice of a set of cells.
    pub fn new(cells: &Cells) -> Self {
        todo!()
    }

    /// The position of a particle at rest, in the grid's coordinates, m.
    pub fn rest_position(&self, particle: usize) -> DVec3 {
        self.grid.corner(self.corners[particle])
    }
}
