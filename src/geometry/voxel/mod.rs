//! From a surface to the cells of a grid (GC §12, SC).

pub mod grid;

use serde::{Deserialize, Serialize};

pub use grid::{Cells, CellsError, Grid};

/// Which cells of the grid are filled (GC §12.2, SC).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OccupancyChoice {
    /// By whether the mesh is closed.
    #[default]
    Auto,
    /// Cells whose centre a ray finds inside (odd parity).
    Centre,
    /// Cells that a triangle touches.
    Surface,
    /// Surface cells and everything that outside air cannot reach.
    Solid,
}

/// Which connected components of cells are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Keep {
    /// All of them.
    All,
    /// The one with the most cells.
    #[default]
    Largest,
}
