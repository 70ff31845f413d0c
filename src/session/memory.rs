//! The memory that a scene needs, known from the number of its cells before any particle is made. Refuses a scene that needs
//! more than is free.

use std::path::Path;
use std::sync::Arc;

use super::SessionError;
use crate::geometry::Surface;
use crate::machine::free_memory;
use crate::physics::memory::{Size, bytes};
use crate::physics::{Scheme, SchemeCost, Simulation};
use crate::scene::body::CubeShape;
use crate::scene::resolve::{Outline, resolve};
use crate::scene::{ContactOn, Material, MovesBy, Obstacle, ObstacleShape, Scene, Shape};
use crate::view::SkinVertex;

/// The memory of the program itself and of everything small, bytes.
const PROGRAM_BYTES: u64 = 10 << 20;
/// The memory of a skin vertex: itself, its triangles, their edges and folds, its position in double precision, bytes.
const SKIN_VERTEX_BYTES: u64 = size_of::<SkinVertex>() as u64 + 2 * 12 + 3 * 8 + 3 * 16 + 24;
/// The memory of a vertex of a mesh that bodies meet: its position and normal, two triangles with the neighbours beyond
/// their edges and the boxes around them, bytes. And that of the grid of distances to the whole mesh.
const CONTACT_MESH_VERTEX_BYTES: u64 = 49 + 2 * (2 * 12 + 24 + 28);
const DISTANCE_GRID_BYTES: u64 = 1 << 20;
/// Schemes whose costs differ by less than this factor count as equally cheap: obstacles change the cost of a large body in
/// another way than that of the small sample.
const SIMILAR_COST_FACTOR: f64 = 1.3;
/// Cells along an edge of the small sample that shows which scheme a large body of its material needs.
const SAMPLE_CELLS: u32 = 3;

/// Returns the bytes that a scene with bodies of these sizes takes without a window while a scheme is at work. The pictures
/// on its models are not included: they are in memory before the sizes of the bodies are known.
pub(super) fn needed_bytes(scene: &Scene, outlines: &[Outline], scheme: Option<Scheme>) -> u64 {
    let has_sides = |shape: &ObstacleShape| matches!(shape, ObstacleShape::Plane(_) | ObstacleShape::Mesh(_));
    let planes = scene.obstacles.iter().filter(|obstacle| has_sides(&obstacle.shape)).count();
    let is_mesh = |obstacle: &&Obstacle| matches!(obstacle.shape, ObstacleShape::Mesh(_));
    let meshes = scene.obstacles.iter().filter(is_mesh).count();
    let with_mesh = scene
        .bodies
        .iter()
        .zip(outlines)
        .filter(|(body, outline)| body.contact_on == ContactOn::Mesh && outline.mesh_vertices > 0);
    let contact_meshes = with_mesh.clone().filter(|(body, _)| body.collides && scene.bodies.len() > 1);
    let contact_mesh_bytes: u64 = contact_meshes
        .map(|(_, outline)| outline.mesh_vertices as u64 * CONTACT_MESH_VERTEX_BYTES + DISTANCE_GRID_BYTES)
        .sum();
    let on_mesh = with_mesh.map(|(_, outline)| outline.counts.surface).sum();
    let size = Size { obstacles: scene.obstacles.len(), planes, meshes, on_mesh, scheme };
    let counts: Vec<_> = outlines.iter().map(|outline| outline.counts).collect();
    let vertices = |outline: &Outline| outline.mesh_vertices.max(outline.counts.surface) as u64;
    let of_bodies = bytes(&counts, size)
        + modes_bytes(scene, outlines)
        + outlines.iter().map(vertices).sum::<u64>() * SKIN_VERTEX_BYTES;
    // The models of obstacles are read one after another, before there is a body.
    let surfaces = surfaces(scene);
    let lasting: u64 = surfaces.iter().map(|surface| surface.bytes()).sum();
    let while_made = surfaces.iter().map(|surface| surface.bytes_while_made()).max().unwrap_or(0);
    PROGRAM_BYTES + lasting + contact_mesh_bytes + while_made.max(of_bodies)
}

/// The memory of the modes of bodies that are to move by them, with the rows of their outer points, which others meet. The
/// memory for finding the modes is checked when they are sought.
fn modes_bytes(scene: &Scene, outlines: &[Outline]) -> u64 {
    let modal = scene.bodies.iter().zip(outlines).filter(|(body, _)| body.moves_by == MovesBy::Modes);
    let own = modal.map(|(body, Outline { counts, .. })| {
        let [shapes, rows] = [(counts.particles, size_of::<[f32; 3]>()), (counts.surface, size_of::<[f64; 3]>())]
            .map(|(points, bytes)| (points * bytes) as u64);
        (shapes + rows) * u64::from(body.mode_count)
    });
    own.sum()
}

/// The surfaces of mesh obstacles that have been read; a shared surface counts once.
fn surfaces(scene: &Scene) -> Vec<Arc<Surface>> {
    let mut found: Vec<Arc<Surface>> = Vec::new();
    for obstacle in &scene.obstacles {
        let ObstacleShape::Mesh(mesh) = &obstacle.shape else { continue };
        let new = mesh.surface().filter(|surface| !found.iter().any(|known| Arc::ptr_eq(known, surface)));
        found.extend(new);
    }
    found
}

/// Refuses a scene that needs more memory than is free. Of the schemes that may be at work the one that needs most counts.
pub(super) fn check_memory(scene: &Scene, outlines: &[Outline]) -> Result<(), SessionError> {
    let by = cheapest_schemes(scene, outlines).into_iter().map(|scheme| needed_bytes(scene, outlines, Some(scheme)));
    let needed = by.max().unwrap_or_else(|| needed_bytes(scene, outlines, None));
    match free_memory() {
        Some(free) if needed > free.bytes => Err(SessionError::Memory { needed, free: free.bytes, whose: free.whose }),
        _ => Ok(()),
    }
}

/// The schemes that may be at work: those that cost about as little as the cheapest, judged by small bodies of the same
/// materials and cells.
fn cheapest_schemes(scene: &Scene, outlines: &[Outline]) -> Vec<Scheme> {
    let mut sample = scene.clone();
    for (body, outline) in sample.bodies.iter_mut().zip(outlines) {
        let cell = outline.grid.cell_size;
        let longest = outline.grid.dims.into_iter().max().unwrap_or(1);
        let cells = longest.min(SAMPLE_CELLS);
        body.shape = Shape::Cube(CubeShape { cells, size: f64::from(cells) * cell });
        body.pins.clear();
        body.pinned_cells.clear();
        if let Material::Solid(solid) = &mut body.material {
            // The damping of a solid depends on the body's size.
            solid.damping_ratio *= f64::from(longest) / f64::from(cells);
        }
    }
    let small = sample.bodies.iter().map(|body| resolve(&body.shape, Path::new(""), &()));
    // A cube of a few cells can be made.
    let Ok(small) = small.collect::<Result<Vec<_>, _>>() else { return Vec::new() };
    let of_small: Vec<_> = small.iter().map(|jelly| jelly.outline().counts).collect();
    let lattices: Vec<_> = small.into_iter().map(|jelly| jelly.lattice).collect();
    let counts: Vec<_> = outlines.iter().map(|outline| outline.counts).collect();
    let simulation = Simulation::<f32>::new(&sample, &lattices);
    let costs = simulation.plan().scheme_costs.iter();
    let costs: Vec<SchemeCost> = costs.map(|cost| cost.of_bodies(&counts, &of_small)).collect();
    let least = costs.iter().map(|cost| cost.cost_per_sec).fold(f64::INFINITY, f64::min);
    let cheap = costs.into_iter().filter(|cost| cost.cost_per_sec <= SIMILAR_COST_FACTOR * least);
    cheap.map(|cost| cost.scheme).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::voxel::OccupancyChoice;
    use crate::scene::body::ModelShape;
    use crate::scene::resolve::fill;
    use crate::scene::{Body, Obstacle};

    #[test]
    fn the_scheme_at_work_is_among_those_that_are_counted() {
        let mut not_sure = 0;
        for (divisions, occupancy, is_met) in [10, 25, 40].into_iter().flat_map(|divisions| {
            [OccupancyChoice::Surface, OccupancyChoice::Auto]
                .into_iter()
                .flat_map(move |occupancy| [false, true].map(|is_met| (divisions, occupancy, is_met)))
        }) {
            let path = "builtin:spot.obj".to_owned();
            let shape = Shape::Model(ModelShape { path, divisions, occupancy, ..ModelShape::default() });
            let obstacles = if is_met { vec![Obstacle::default()] } else { Vec::new() };
            let scene = Scene { bodies: vec![Body { shape, ..Body::default() }], obstacles, ..Scene::default() };
            let jelly = resolve(&scene.bodies[0].shape, Path::new(""), &()).expect("a model");
            let outlines = [fill(&scene.bodies[0].shape, Path::new(""), &()).expect("a model").outline()];
            let scheme = Simulation::<f32>::new(&scene, &[jelly.lattice]).plan().scheme;
            let counted = cheapest_schemes(&scene, &outlines);
            assert!(counted.contains(&scheme), "{divisions} {occupancy:?} {is_met}: {scheme:?} is not in {counted:?}");
            not_sure += usize::from(counted.len() > 1);
        }
        assert!(not_sure <= 6, "{not_sure} of 12 with more than one");
    }
}
