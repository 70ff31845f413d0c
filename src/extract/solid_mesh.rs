//! The meshes of obstacles as things to draw, with creases at sharp edges.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::geometry::Surface;
use crate::view::{SolidCorner, SolidEdge, SolidMesh};

/// The cosine of the angle below which faces meet smoothly.
const MIN_SMOOTH_COSINE: f64 = 0.8;

/// How far apart the two sides of an open mesh are drawn, over its length: at one place each would shade the other.
const SHEET_THICKNESS: f32 = 0.004;

/// Meshes that have been drawn, kept so that each is made once.
#[derive(Debug, Default)]
pub struct SolidMeshes {
    made: Vec<(Arc<Surface>, Arc<SolidMesh>)>,
}

impl SolidMeshes {
    /// The mesh of a surface.
    pub(super) fn get(&mut self, surface: &Arc<Surface>) -> Arc<SolidMesh> {
        if let Some((_, mesh)) = self.made.iter().find(|(known, _)| Arc::ptr_eq(known, surface)) {
            return Arc::clone(mesh);
        }
        // Only this list still has the surfaces whose obstacles are gone.
        self.made.retain(|(known, _)| Arc::strong_count(known) > 1);
        let mesh = Arc::new(mesh(surface));
        self.made.push((Arc::clone(surface), Arc::clone(&mesh)));
        mesh
    }
}

fn mesh(surface: &Surface) -> SolidMesh {
    let (positions, triangles, normals) = (surface.positions(), surface.triangles(), surface.normals());
    let at = |vertex: u32| positions[vertex as usize].as_vec3();
    let mut around: Vec<(u32, u32)> = Vec::with_capacity(3 * triangles.len());
    for (number, triangle) in (0..).zip(triangles) {
        around.extend(triangle.map(|vertex| (vertex, number)));
    }
    around.sort_unstable();
    let area = |[a, b, c]: [u32; 3]| {
        let [a, b, c] = [a, b, c].map(|vertex| positions[vertex as usize]);
        (b - a).cross(c - a).length()
    };
    let normal = |triangle: u32, vertex: u32| -> Vec3 {
        let own = normals[triangle as usize];
        let first = around.partition_point(|(other, _)| *other < vertex);
        let there = around[first..].iter().take_while(|(other, _)| *other == vertex);
        let faces = there.map(|(_, face)| *face as usize).filter(|face| normals[*face].dot(own) > MIN_SMOOTH_COSINE);
        let sum: DVec3 = faces.map(|face| normals[face] * area(triangles[face])).sum();
        sum.try_normalize().unwrap_or(own).as_vec3()
    };
    let mut mesh = SolidMesh { half_extents: surface.half_extents().as_vec3(), ..SolidMesh::default() };
    for (number, triangle) in (0..).zip(triangles) {
        let corners = triangle.map(|vertex| SolidCorner { position: at(vertex), normal: normal(number, vertex) });
        mesh.corners.extend(corners);
        if !surface.is_closed() {
            let behind = normals[number as usize].as_vec3() * -SHEET_THICKNESS;
            let [a, b, c] =
                corners.map(|corner| SolidCorner { position: corner.position + behind, normal: -corner.normal });
            mesh.corners.extend([a, c, b]);
        }
    }
    for (number, (triangle, across)) in (0..).zip(triangles.iter().zip(surface.neighbours())) {
        for edge in 0..3 {
            let ends = [triangle[edge], triangle[(edge + 1) % 3]].map(at);
            let own = normals[number].as_vec3();
            match across[edge] as usize {
                other if other < number => {}
                other => {
                    let beyond = normals.get(other).map_or(-own, |normal| normal.as_vec3());
                    mesh.edges.push(SolidEdge { ends, normals: [own, beyond] });
                }
            }
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::TriMesh;

    #[test]
    fn a_sheet_folded_sharply_has_two_sides_a_crease_and_a_rim() {
        let [a, b, c, d] = [DVec3::ZERO, DVec3::Z, DVec3::X, DVec3::Y];
        let sheet = TriMesh { positions: vec![a, b, c, d], triangles: vec![[0, 1, 2], [1, 0, 3]] };
        let surface = Arc::new(Surface::new(&sheet).expect("a surface"));
        let mut meshes = SolidMeshes::default();
        let mesh = meshes.get(&surface);
        assert!(Arc::ptr_eq(&mesh, &meshes.get(&surface)), "it is made once");
        assert_eq!((mesh.corners.len(), mesh.edges.len()), (12, 5), "both sides, four rims and a crease");
        let upright = |corner: &SolidCorner| corner.normal.abs().max_element() > 0.999;
        assert!(mesh.corners.iter().all(upright), "no normal is a mean over the crease");
    }
}
