//! What voxelization found, in numbers and in words.

use rayon::prelude::*;
use serde::Serialize;

use super::components::Components;
use super::quantized_mesh::{QuantizedMesh, STEPS_PER_CELL};
use super::shell::CHUNK_TRIANGLES;
use super::{OccupancyChoice, touch};
use crate::geometry::trimesh::MeshFacts;

/// The result of voxelizing a mesh. Field names are the keys of the JSON report.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct VoxelReport {
    /// Vertices of the mesh.
    pub vertices: usize,
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Edges of exactly one triangle, once equal positions are one vertex.
    pub boundary_edges: usize,
    /// Edges of more than two triangles.
    pub non_manifold_edges: usize,
    /// Every edge belongs to an even number of triangles.
    pub closed: bool,
    /// Connected pieces of the mesh.
    pub parts: usize,
    /// Cells along the longest extent, as asked.
    pub divisions: u32,
    /// Cells of the grid along x, y, z.
    pub dims: [u32; 3],
    /// The edge of a cell, in the units of the mesh.
    pub cell_size_m: f64,
    /// The occupancy used; never `auto`.
    pub occupancy: OccupancyChoice,
    /// Why that occupancy.
    pub why: String,
    /// Filled cells that were kept.
    pub cells: usize,
    /// Particles of the kept cells.
    pub particles: usize,
    /// Links of the kept cells.
    pub links: usize,
    /// Groups of filled cells that share no particle, before some were dropped.
    pub components: usize,
    /// Filled cells that were not kept.
    pub dropped_cells: usize,
    /// Parts of the mesh that are apart there but share a component of kept cells with another part.
    pub joined_parts: usize,
    /// Parts of the mesh whose box is thinner than a cell along x, y or z. (A thin part that lies askew is not counted.)
    pub thin_parts: usize,
    /// The volume that a density applies to, in the units of the mesh: that of the kept cells, or of what is in them once
    /// they are sampled.
    pub volume_m3: f64,
    /// Samples inside the mesh or on it; none where cells count as full.
    pub samples: usize,
    /// Kept cells that count as fuller than they are.
    pub raised_cells: usize,
    /// What a person should know before using the result, a sentence each.
    pub warnings: Vec<String>,
}

/// Which parts of the mesh lie in which components of cells: (part, component), ascending.
pub(super) fn parts_in_components(
    quantized: &QuantizedMesh,
    facts: &MeshFacts,
    components: &Components,
) -> Vec<[u32; 2]> {
    let grid = quantized.grid;
    let component = |cell: [u32; 3]| {
        let inner = cell.map(|n| n.wrapping_sub(1));
        let is_in_grid = (0..3).all(|axis| inner[axis] < grid.dims[axis]);
        if is_in_grid { components.of(inner) } else { None }
    };
    let chunks =
        quantized.triangles.par_chunks(CHUNK_TRIANGLES).zip(facts.part_of_triangle.par_chunks(CHUNK_TRIANGLES));
    let mut pairs: Vec<[u32; 2]> = chunks
        .flat_map_iter(|(triangles, parts)| {
            let mut pairs = Vec::new();
            for (triangle, &part) in triangles.iter().zip(parts) {
                let mut add = |cell| {
                    let pair = component(cell).map(|component| [part, component]);
                    pairs.extend(pair.filter(|pair| pairs.last() != Some(pair)));
                };
                touch::touched(triangle, &mut add);
                touch::walls(triangle, |axis, upper| {
                    let mut lower = upper;
                    lower[axis] -= 1;
                    add(lower);
                    add(upper);
                });
            }
            pairs
        })
        .collect();
    pairs.par_sort_unstable();
    pairs.dedup();
    pairs
}

/// Parts that share a component with another part.
pub(super) fn joined_parts(pairs: &[[u32; 2]], parts: usize, components: usize) -> usize {
    let mut guests = vec![0_u32; components];
    for &[_, component] in pairs {
        guests[component as usize] += 1;
    }
    let mut is_joined = vec![false; parts];
    for &[part, component] in pairs {
        is_joined[part as usize] |= guests[component as usize] > 1;
    }
    is_joined.into_iter().filter(|&joined| joined).count()
}

/// Parts of the mesh whose box is thinner than a cell along an axis.
pub(super) fn thin_parts(quantized: &QuantizedMesh, facts: &MeshFacts) -> usize {
    let mut boxes = vec![[[i64::MAX; 3], [i64::MIN; 3]]; facts.parts];
    for (triangle, &part) in quantized.triangles.iter().zip(&facts.part_of_triangle) {
        let [low, high] = &mut boxes[part as usize];
        for corner in triangle {
            for axis in 0..3 {
                low[axis] = low[axis].min(corner[axis]);
                high[axis] = high[axis].max(corner[axis]);
            }
        }
    }
    let is_thin = |[low, high]: &&[[i64; 3]; 2]| (0..3).any(|axis| high[axis] - low[axis] < STEPS_PER_CELL - 1);
    boxes.iter().filter(is_thin).count()
}
