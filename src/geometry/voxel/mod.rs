//! From a surface to the cells of a grid (GC §12, SC).
//!
//! ```text
//!   mesh ─► quantized ─┬─► centre: rays along x ──────────┐
//!                      └─► shell: touched cells, flood ───┴─► components ─► cells + report ─► contents
//! ```

mod centre;
mod choice;
mod components;
mod contents;
mod crossings;
pub mod grid;
mod holes;
mod lost_detail;
mod options;
pub(super) mod pieces;
mod quantized_mesh;
mod report;
mod shell;
mod touch;

use super::lattice::LatticeCounts;
use super::{TriMesh, Watch};
use choice::Filled;
use components::Components;
use contents::contents;
pub use contents::{Contents, MIN_CELL_SHARE, SHEET_SHARE};
pub use grid::{Cells, CellsError, Grid, lowest};
pub use holes::patched;
pub use lost_detail::{Lost, LostDetail};
pub use options::{Keep, MAX_DIVISIONS, OccupancyChoice, VoxelizeError, VoxelizeOptions};
use quantized_mesh::QuantizedMesh;
pub use report::VoxelReport;

/// A mesh as cells, in the mesh's own coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Voxelization {
    /// The filled cells.
    pub cells: Cells,
    /// What voxelization found.
    pub report: VoxelReport,
}

impl Voxelization {
    /// Finds how full the cells are by sampling the mesh they were made of, and updates the report.
    pub fn sample(&mut self, mesh: &TriMesh, watch: &dyn Watch) -> Result<Contents, VoxelizeError> {
        let found = contents(mesh, &self.cells, &self.report, watch)?;
        let report = &mut self.report;
        report.volume_m3 = found.volume_cells() * self.cells.grid.cell_size.powi(3);
        (report.samples, report.raised_cells) = (found.samples, found.raised);
        Ok(found)
    }
}

/// Fills a mesh with cubic cells. The result does not depend on the number of threads.
///
/// An axis-aligned shape whose faces all lie on cell boundaries gives exactly its own cells under `Centre` and `Solid`.
pub fn voxelize(mesh: &TriMesh, options: &VoxelizeOptions, watch: &dyn Watch) -> Result<Voxelization, VoxelizeError> {
    let VoxelizeOptions { divisions, occupancy, keep } = *options;
    if !(1..=MAX_DIVISIONS).contains(&divisions) {
        return Err(VoxelizeError::Divisions(divisions));
    }
    if mesh.triangles.is_empty() {
        return Err(VoxelizeError::NoTriangles);
    }
    let distinct = mesh.without_duplicates();
    let duplicates = mesh.triangles.len() - distinct.triangles.len();
    let (whole, mesh) = (mesh, distinct.as_ref());
    let quantized = QuantizedMesh::new(mesh, divisions)?;
    if mesh.is_degenerate() {
        return Err(VoxelizeError::NoArea);
    }
    let facts = mesh.facts();
    let Filled { mut cells, used, why, mut warnings } = choice::fill(mesh, &quantized, &facts, occupancy, watch)?;
    let mut components = Components::new(&cells);
    let found = components.sizes.len();
    if found == 0 {
        return Err(VoxelizeError::NoCells(divisions));
    }
    let dropped_cells = components.drop_unkept(keep, &mut cells);
    let pairs = report::parts_in_components(&quantized, &facts, &components);
    let joined_parts = report::joined_parts(&pairs, facts.parts, found);
    let thin_parts = report::thin_parts(&quantized, &facts);
    let absent_parts = facts.parts - pairs.chunk_by(|a, b| a[0] == b[0]).count();
    if dropped_cells > 0 {
        warnings.push(format!(
            "the cells fall into {found} components; the largest was kept and {dropped_cells} cells were dropped"
        ));
    }
    let parts_warning = |count: usize, one: &str, many: &str| match (count, facts.parts) {
        (_, 1) => format!("the mesh {one}"),
        (1, parts) => format!("1 of {parts} parts of the mesh {one}"),
        (_, parts) => format!("{count} of {parts} parts of the mesh {many}"),
    };
    if duplicates > 0 {
        warnings.push(format!("triangles that repeat another one were left out: {duplicates}"));
    }
    if absent_parts > 0 {
        warnings.push(parts_warning(absent_parts, "has no cell in the result", "have no cell in the result"));
    }
    if joined_parts > 0 {
        warnings.push(parts_warning(
            joined_parts,
            "is joined to another",
            "are joined to others by cells that share particles",
        ));
    }
    if thin_parts > 0 {
        warnings.push(parts_warning(thin_parts, "is thinner than a cell", "are thinner than a cell"));
    }
    let counts = LatticeCounts::of(&cells);
    watch.progress(1.0);
    let report = VoxelReport {
        vertices: whole.positions.len(),
        triangles: whole.triangles.len(),
        boundary_edges: facts.boundary_edges,
        non_manifold_edges: facts.non_manifold_edges,
        closed: facts.closed,
        parts: facts.parts,
        divisions,
        dims: quantized.grid.dims,
        cell_size_m: quantized.grid.cell_size,
        occupancy: used,
        why,
        cells: cells.count(),
        particles: counts.particles,
        links: counts.links.iter().sum(),
        components: found,
        dropped_cells,
        joined_parts,
        thin_parts,
        volume_m3: cells.count() as f64 * quantized.grid.cell_size.powi(3),
        samples: 0,
        raised_cells: 0,
        warnings,
    };
    Ok(Voxelization { cells, report })
}

#[cfg(test)]
mod tests;
