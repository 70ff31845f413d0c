//! How a mesh is to be filled with cells, and why it cannot be.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Which cells of the grid are filled (GC §12.2, SC).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OccupancyChoice {
    /// Chosen by what the mesh is like, above all whether it is closed.
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

/// The finest grid: cells along the longest extent.
pub const MAX_DIVISIONS: u32 = 256;

/// How a mesh is filled with cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VoxelizeOptions {
    /// Cells along the longest extent, 1 to [`MAX_DIVISIONS`].
    pub divisions: u32,
    /// Which cells are filled.
    pub occupancy: OccupancyChoice,
    /// Which components are kept.
    pub keep: Keep,
}

impl Default for VoxelizeOptions {
    fn default() -> Self {
        Self { divisions: 20, occupancy: OccupancyChoice::Auto, keep: Keep::Largest }
    }
}

/// Why a mesh cannot be filled with cells.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum VoxelizeError {
    /// No surface.
    #[error("the model has no triangles; a surface is needed")]
    NoTriangles,
    /// Only points and lines.
    #[error("no triangle of the model has an area; a surface is needed")]
    NoArea,
    /// No divisions, or more than [`MAX_DIVISIONS`].
    #[error("{0} divisions are not possible; a number from 1 to {MAX_DIVISIONS} is needed")]
    Divisions(u32),
    /// The extent is too large or too small for floating-point numbers.
    #[error("the model's longest extent is {0:e}; a surface of some size is needed, between about 1e-300 and 1e308")]
    Extent(f64),
    /// Centre occupancy found nothing inside.
    #[error(
        "no cell of {0} divisions has its centre inside the model; use solid or surface occupancy or more divisions"
    )]
    NoCells(u32),
    /// Cancelled by the caller.
    #[error("filling the model with cells was cancelled")]
    Cancelled,
}
