//! A surface carried by particles: eight indices and weights a vertex.
//!
//! ```text
//! position = Σ position[i] · x[particles[i]]
//! normal   = (Σ tangent_u[i] · x[particles[i]]) × (Σ tangent_v[i] · x[particles[i]])      outward, then made unit
//! scalar   = Σ position[i] · s[particles[i]]
//! ```
//!
//! One layout serves the outer faces of cells (weight 1 at one particle, tangents between its neighbours, GC §3.2)
//! and a mesh embedded in a lattice (trilinear weights and their derivatives). It never changes while a body moves,
//! so that only particles are uploaded a frame.

use glam::Vec3;

/// A vertex of a [`Skin`]. Unused slots name particle 0 with weight 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SkinVertex {
    /// Indices into the particles of all bodies.
    pub particles: [u32; 8],
    /// Weights of the position; they sum to 1.
    pub position: [f32; 8],
    /// Weights of the first tangent; they sum to 0.
    pub tangent_u: [f32; 8],
    /// Weights of the second tangent; they sum to 0.
    pub tangent_v: [f32; 8],
}

/// A surface carried by particles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skin {
    /// The vertices; a point with several normals is several vertices.
    pub vertices: Vec<SkinVertex>,
    /// Triangles by vertex index, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Skin {
    /// The position and unit normal of every vertex: what the graphics card computes, for export, picking and tests.
    ///
    /// # Panics
    /// When the skin names a particle that is not there.
    pub fn evaluate(&self, particles: &[[f32; 3]]) -> Vec<(Vec3, Vec3)> {
        self.vertices.iter().map(|vertex| vertex.evaluate(particles)).collect()
    }

    /// Every edge of its triangles once, as (lower, higher) vertex, ascending.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let of_triangle = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
        let mut edges: Vec<[u32; 2]> = self.triangles.iter().flat_map(of_triangle).collect();
        for edge in &mut edges {
            edge.sort_unstable();
        }
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// One more than the highest particle it names: how many particles it needs.
    pub fn particles_needed(&self) -> usize {
        self.vertices.iter().flat_map(|vertex| vertex.particles).max().map_or(0, |highest| highest as usize + 1)
    }
}

impl SkinVertex {
    /// Where it is, m.
    ///
    /// # Panics
    /// When it names a particle that is not there.
    pub fn place(&self, particles: &[[f32; 3]]) -> Vec3 {
        self.sum(&self.position, particles)
    }

    fn evaluate(&self, particles: &[[f32; 3]]) -> (Vec3, Vec3) {
        let normal = self.sum(&self.tangent_u, particles).cross(self.sum(&self.tangent_v, particles));
        (self.place(particles), normal.normalize_or_zero())
    }

    fn sum(&self, weights: &[f32; 8], particles: &[[f32; 3]]) -> Vec3 {
        let terms = self.particles.iter().zip(weights);
        terms.fold(Vec3::ZERO, |sum, (&index, &weight)| sum + Vec3::from(particles[index as usize]) * weight)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vertex_follows_its_particles_and_its_normal_turns_with_them() {
        let vertex = SkinVertex {
            particles: [0, 1, 2, 0, 0, 0, 0, 0],
            position: [0.5, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            tangent_u: [-1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            tangent_v: [-1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        };
        let skin = Skin { vertices: vec![vertex], triangles: Vec::new() };
        assert_eq!(skin.particles_needed(), 3, "three particles are named");
        let (position, normal) = skin.evaluate(&[[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0]])[0];
        assert_eq!((position, normal), (Vec3::X, Vec3::Z), "half way, facing the viewer");
        let (_, turned) = skin.evaluate(&[[0.0; 3], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]])[0];
        assert_eq!(turned, Vec3::X, "turned with its particles");
    }
}
