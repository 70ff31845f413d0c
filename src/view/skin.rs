//! A surface carried by particles: eight indices and weights per vertex.
//!
//! ```text
//! position = Σ position[i] · x[particles[i]]
//! normal   = (Σ tangent_u[i] · x[particles[i]]) × (Σ tangent_v[i] · x[particles[i]])      outward, then made unit
//! scalar   = Σ position[i] · s[particles[i]]
//! ```
//!
//! One layout serves both the outer faces of cells (weight 1 at one particle, tangents between its neighbours, GC §3.2) and
//! a mesh embedded in a lattice (trilinear weights and their derivatives). It never changes while a body moves: only
//! particles are uploaded per frame.

use std::ops::Range;

use glam::Vec3;

use super::clusters::Clusters;
use super::{Ray, SkinTextures, SkinVertex};

/// Stands for a missing corner.
pub const NO_CORNER: u32 = u32::MAX;

/// A surface carried by particles. Its edges, folds and clusters are computed once, when it is made, so that the window
/// never walks the mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skin {
    vertices: Vec<SkinVertex>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    folds: Vec<[u32; 4]>,
    clusters: Clusters,
    is_painted: bool,
    textures: Option<SkinTextures>,
}

impl Skin {
    /// Makes a skin from vertices (a point with several normals is several vertices) and triangles by vertex,
    /// counter-clockwise seen from outside.
    ///
    /// # Panics
    /// When a triangle names a vertex that is not there.
    pub fn new(vertices: Vec<SkinVertex>, triangles: Vec<[u32; 3]>) -> Self {
        let (edges, folds) = (edges(&triangles), folds(&vertices, &triangles));
        let clusters = Clusters::new(&vertices, &triangles);
        let is_painted = vertices.iter().any(|vertex| vertex.tint != [0; 4]);
        Self { vertices, triangles, edges, folds, clusters, is_painted, textures: None }
    }

    /// Adds pictures: the colours of the vertices are multiplied by them.
    ///
    /// # Panics
    /// When the pictures are for other numbers of vertices or triangles.
    pub fn with_textures(self, textures: SkinTextures) -> Self {
        assert!(textures.fits(self.vertices.len(), self.triangles.len()), "textures of another skin");
        Self { textures: Some(textures), ..self }
    }

    /// The pictures on it.
    pub fn textures(&self) -> Option<&SkinTextures> {
        self.textures.as_ref()
    }

    /// Whether any vertex has a colour of its own.
    pub fn is_painted(&self) -> bool {
        self.is_painted
    }

    /// The vertices.
    pub fn vertices(&self) -> &[SkinVertex] {
        &self.vertices
    }

    /// The triangles by vertex, counter-clockwise from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Every edge of its triangles once, as (lower, higher) vertex, ascending.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// Every edge of the surface once: its two ends and the far corners of its two triangles, by vertex. Vertices at one
    /// place count as one. The last corner is [`NO_CORNER`] if the edge does not have exactly two triangles.
    ///
    /// The silhouette runs along an edge if the eye sees both far corners on the same side of it.
    pub fn folds(&self) -> &[[u32; 4]] {
        &self.folds
    }

    /// The nearest triangle that a line of sight meets, and the distance to it, m.
    ///
    /// # Panics
    /// When the skin names a particle that is not there.
    pub fn hit(&self, particles: &[[f32; 3]], ray: &Ray) -> Option<(usize, f32)> {
        let hit = |triangle: u32| {
            let corners = self.triangles[triangle as usize].map(|vertex| &self.vertices[vertex as usize]);
            Some((triangle as usize, ray.hit_triangle(corners.map(|vertex| vertex.place(particles)))?))
        };
        self.clusters.hit_candidates(particles, ray).filter_map(hit).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The position and unit normal of every vertex, as the graphics card computes them: for export, picking and tests.
    ///
    /// # Panics
    /// When the skin names a particle that is not there.
    pub fn evaluate(&self, particles: &[[f32; 3]]) -> Vec<(Vec3, Vec3)> {
        self.vertices.iter().map(|vertex| vertex.evaluate(particles)).collect()
    }

    /// The range from the lowest to the highest particle that carries the skin.
    pub fn particle_range(&self) -> Range<usize> {
        let slots = self.vertices.iter().flat_map(|vertex| vertex.particles.into_iter().zip(vertex.position));
        let carrying = slots.filter(|&(_, weight)| weight != 0.0).map(|(particle, _)| particle as usize);
        carrying.fold(0..0, |range, particle| {
            if range.is_empty() {
                particle..particle + 1
            } else {
                range.start.min(particle)..range.end.max(particle + 1)
            }
        })
    }

    /// The number of particles it needs: one more than the highest index it names.
    pub fn particles_needed(&self) -> usize {
        self.vertices.iter().flat_map(|vertex| vertex.particles).max().map_or(0, |highest| highest as usize + 1)
    }
}

fn edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let of_triangle = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
    let mut edges: Vec<[u32; 2]> = triangles.iter().flat_map(of_triangle).collect();
    for edge in &mut edges {
        edge.sort_unstable();
    }
    edges.sort_unstable();
    edges.dedup();
    edges
}

fn folds(vertices: &[SkinVertex], triangles: &[[u32; 3]]) -> Vec<[u32; 4]> {
    let place = welded(vertices);
    let of_triangle = |&[a, b, c]: &[u32; 3]| [[a, b, c], [b, c, a], [c, a, b]];
    let mut sides: Vec<([u32; 2], [u32; 3])> = triangles
        .iter()
        .flat_map(of_triangle)
        .map(|[a, b, far]| {
            let ends = [a, b].map(|vertex| place[vertex as usize]);
            ([ends[0].min(ends[1]), ends[0].max(ends[1])], [a, b, far])
        })
        .collect();
    sides.sort_unstable();
    let fold = |group: &[([u32; 2], [u32; 3])]| {
        let [a, b, far] = group[0].1;
        let other = if let [_, (_, other)] = group { other[2] } else { NO_CORNER };
        [a, b, far, other]
    };
    sides.chunk_by(|a, b| a.0 == b.0).map(fold).collect()
}

/// For every vertex, the first vertex with the same particles and weights, which is always at the same place.
fn welded(vertices: &[SkinVertex]) -> Vec<u32> {
    let carriers = |vertex: u32| {
        let SkinVertex { particles, position, .. } = &vertices[vertex as usize];
        // Slots without a weight carry nothing.
        let slot =
            |slot: usize| if position[slot] == 0.0 { (0, 0) } else { (particles[slot], position[slot].to_bits()) };
        std::array::from_fn::<(u32, u32), 8, _>(slot)
    };
    let mut order: Vec<u32> = (0..).take(vertices.len()).collect();
    order.sort_by_cached_key(|&vertex| (carriers(vertex), vertex));
    let mut first = vec![0; order.len()];
    for group in order.chunk_by(|&a, &b| carriers(a) == carriers(b)) {
        for &vertex in group {
            first[vertex as usize] = group[0];
        }
    }
    first
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on(particle: u32) -> SkinVertex {
        SkinVertex {
            particles: [particle, 0, 0, 0, 0, 0, 0, 0],
            position: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            ..SkinVertex::default()
        }
    }

    #[test]
    fn an_edge_knows_its_two_triangles_also_across_a_crease() {
        // Two triangles over the corners 0, 1, 2 and 2, 1, 3. Each has vertices of its own at their common edge.
        let mut crease = [0, 1, 2, 2, 1, 3].map(on);
        // Neither tangents nor slots without a weight matter.
        crease[3].particles[1] = 7;
        crease[4].tangent_u = [1.0; 8];
        let skin = Skin::new(crease.to_vec(), vec![[0, 1, 2], [3, 4, 5]]);
        assert_eq!(skin.edges().len(), 6, "drawn as six edges");
        assert_eq!(skin.folds().len(), 5, "but the surface has five");
        let shared: Vec<_> = skin.folds().iter().filter(|fold| fold[3] != NO_CORNER).collect();
        assert_eq!(shared, [&[1, 2, 0, 5]], "the one between both, with the corner of either");
        let fan = Skin::new([0, 1, 2, 3, 4].map(on).to_vec(), vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
        let crowded = fan.folds().iter().find(|fold| fold[..2] == [0, 1]);
        assert_eq!(crowded, Some(&[0, 1, 2, NO_CORNER]), "where three meet there are not two sides");
    }

    #[test]
    fn a_vertex_follows_its_particles_and_its_normal_turns_with_them() {
        let vertex = SkinVertex {
            particles: [0, 1, 2, 0, 0, 0, 0, 0],
            position: [0.5, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            tangent_u: [-1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            tangent_v: [-1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            ..SkinVertex::default()
        };
        let skin = Skin::new(vec![vertex], Vec::new());
        assert_eq!(skin.particles_needed(), 3, "three particles are named");
        let (position, normal) = skin.evaluate(&[[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0]])[0];
        assert_eq!((position, normal), (Vec3::X, Vec3::Z), "half way, facing the viewer");
        let (_, turned) = skin.evaluate(&[[0.0; 3], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]])[0];
        assert_eq!(turned, Vec3::X, "turned with its particles");
    }
}
