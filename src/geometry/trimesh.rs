//! A bag of triangles: no promise of being closed, connected or oriented.

use glam::DVec3;

/// A triangle mesh. Every index is below the number of positions, every position finite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    /// Vertex positions, m.
    pub positions: Vec<DVec3>,
    /// Triangles by vertex index, counter-clockwise from outside where the source says so.
    pub triangles: Vec<[u32; 3]>,
}
