//! Chooses the occupancy (the way to fill a mesh with cells) by what the mesh is like, and says why.

use super::centre::{self, ParityFill};
use super::components::Components;
use super::holes::Patched;
use super::quantized_mesh::QuantizedMesh;
use super::shell::{self, Shell};
use super::{Cells, OccupancyChoice, VoxelizeError, report};
use crate::geometry::trimesh::MeshFacts;
use crate::geometry::watch::CountedProgress;
use crate::geometry::{TriMesh, Watch};

/// The share of the solid cells, in percent, that may lie far from every cell of centre occupancy; if more do, the automatic
/// choice is solid. Lost legs and horns exceed it, the lost tip of a tail does not.
const MAX_FAR_PERCENT: f64 = 2.0;

/// The filled cells before any component is dropped, and how they were chosen.
pub(super) struct Filled {
    pub(super) cells: Cells,
    /// Never `Auto`.
    pub(super) used: OccupancyChoice,
    pub(super) why: String,
    pub(super) warnings: Vec<String>,
}

/// Fills a mesh with the requested occupancy, or chooses one.
pub(super) fn fill(
    mesh: &TriMesh,
    quantized: &QuantizedMesh,
    facts: &MeshFacts,
    occupancy: OccupancyChoice,
    watch: &dyn Watch,
) -> Result<Filled, VoxelizeError> {
    let chunks = quantized.triangles.len().div_ceil(shell::CHUNK_TRIANGLES);
    let shell = |from: f64| Shell::new(quantized, &CountedProgress::new(watch, chunks, [from, 0.9]));
    // Holes that are small for the model are closed first, so that air does not get in even if they are larger than a cell.
    let fill_solid = || {
        let patched = if facts.closed { None } else { Patched::of(mesh).filter(|patched| patched.holes > 0) };
        let Some(Patched { whole, lids, .. }) = patched else { return Ok((shell(0.0)?.solid(), "")) };
        let whole = quantized.with(&TriMesh { triangles: lids, ..whole });
        let chunks = whole.triangles.len().div_ceil(shell::CHUNK_TRIANGLES);
        let solid = Shell::new(&whole, &CountedProgress::new(watch, chunks, [0.0, 0.9]))?.solid();
        Ok((solid, ", once its small holes are closed"))
    };
    let parity = || centre::fill_by_parity(quantized, &CountedProgress::new(watch, chunks, [0.0, 0.4]));
    let filled = |used, cells, why: String| Filled { cells, used, why, warnings: Vec::new() };
    let asked = || "asked for".to_owned();
    match occupancy {
        OccupancyChoice::Surface => Ok(filled(occupancy, shell(0.0)?.surface(), asked())),
        OccupancyChoice::Solid => {
            let (solid, how) = fill_solid()?;
            Ok(filled(occupancy, solid, format!("asked for{how}")))
        }
        OccupancyChoice::Centre => {
            let mut filled = filled(occupancy, parity()?.cells, asked());
            if !facts.closed {
                let open = "the mesh is not closed, so that counting crossings may leave streaks; solid does not";
                filled.warnings.push(open.to_owned());
            }
            Ok(filled)
        }
        OccupancyChoice::Auto if quantized.is_flat() => {
            let why = "the mesh is flat: the cells that it touches";
            Ok(filled(OccupancyChoice::Surface, shell(0.0)?.surface(), why.to_owned()))
        }
        OccupancyChoice::Auto if !facts.closed => {
            let (solid, how) = fill_solid()?;
            let opening = opening(facts);
            let why = format!("the mesh is open ({opening}): the cells that it touches and what they enclose{how}");
            Ok(filled(OccupancyChoice::Solid, solid, why))
        }
        OccupancyChoice::Auto => {
            let inside = parity()?;
            let solid = shell(0.4)?.solid();
            Ok(match centre_fails(quantized, facts, &inside, &solid) {
                None => {
                    let why = "the mesh is closed: the cells whose centre is inside";
                    filled(OccupancyChoice::Centre, inside.cells, why.to_owned())
                }
                Some(reason) => {
                    let why = format!("{reason}: the cells that the mesh touches and what they enclose");
                    filled(OccupancyChoice::Solid, solid, why)
                }
            })
        }
    }
}

/// Returns why centre occupancy would misrepresent a closed mesh; none if it would not.
fn centre_fails(quantized: &QuantizedMesh, facts: &MeshFacts, inside: &ParityFill, solid: &Cells) -> Option<String> {
    let components = Components::new(&inside.cells);
    if components.sizes.is_empty() {
        return Some("the mesh is closed but so thin that no cell has its centre inside".to_owned());
    }
    if inside.overlaps > 0 {
        return Some("the mesh is closed but passes through itself, where counting crossings leaves holes".to_owned());
    }
    let pairs = report::parts_in_components(quantized, facts, &components);
    let lost = facts.parts - pairs.chunk_by(|a, b| a[0] == b[0]).count();
    if lost > 0 {
        return Some(format!("the mesh is closed but {lost} of its {} parts hold no cell's centre", facts.parts));
    }
    if components.sizes.len() > Components::new(solid).sizes.len() {
        return Some("the mesh is closed but so thin in places that the cells inside fall apart".to_owned());
    }
    let far = far_cells(&inside.cells, solid);
    let share = 100.0 * far as f64 / solid.count() as f64;
    if share > MAX_FAR_PERCENT {
        Some(format!("the mesh is closed but {share:.0} % of it is too thin to hold a cell's centre"))
    } else {
        None
    }
}

/// Counts the filled cells of `all` that share no particle with a filled cell of `some`.
fn far_cells(some: &Cells, all: &Cells) -> usize {
    let is_far = |cell: &[u32; 3]| all.grid.around(*cell).all(|near| !some.is_filled(near));
    all.iter().filter(is_far).count()
}

fn opening(facts: &MeshFacts) -> String {
    match facts.boundary_edges {
        0 => "edges with an odd number of triangles".to_owned(),
        1 => "1 boundary edge".to_owned(),
        n => format!("{n} boundary edges"),
    }
}
