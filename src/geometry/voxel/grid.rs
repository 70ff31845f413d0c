//! A box of cubic cells, and which of them are filled.

use glam::DVec3;

/// A box of cubic cells.
///
/// ```text
///   y            cell (i, j, k) spans origin + cell_size · [(i, j, k), (i+1, j+1, k+1)]
///   │  z         index = i + nx (j + ny k): x runs fastest
///   │ ╱
///   └──── x
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// The lowest corner, m.
    pub origin: DVec3,
    /// The edge of a cell, m.
    pub cell_size: f64,
    /// Cells along x, y, z.
    pub dims: [u32; 3],
}

impl Grid {
    /// The number of cells in the box.
    pub fn len(&self) -> usize {
        self.dims.iter().map(|&n| n as usize).product()
    }

    /// Whether the box has no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The index of a cell.
    pub fn index(&self, [i, j, k]: [u32; 3]) -> usize {
        let [nx, ny, _] = self.dims.map(|n| n as usize);
        i as usize + nx * (j as usize + ny * k as usize)
    }

    /// The position of a grid corner; corner (0, 0, 0) is the origin.
    pub fn corner(&self, [i, j, k]: [u32; 3]) -> DVec3 {
        self.origin + self.cell_size * DVec3::new(f64::from(i), f64::from(j), f64::from(k))
    }
}

/// The filled cells of a grid: the shape of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    /// The box.
    pub grid: Grid,
    /// One flag a cell, by [`Grid::index`].
    pub filled: Vec<bool>,
}
