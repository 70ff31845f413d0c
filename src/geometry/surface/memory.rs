//! How much memory a surface takes.

use glam::DVec3;

use super::Surface;
use super::orient::BYTES_PER_TRIANGLE;

impl Surface {
    /// The bytes that a surface takes.
    pub fn bytes(&self) -> u64 {
        let Self { positions, triangles, neighbours, normals, corner_normals, on_rim, tree, field, .. } = self;
        let vectors = positions.capacity() + normals.capacity() + corner_normals.capacity();
        let of_corners = triangles.capacity() + neighbours.capacity();
        let own = vectors * size_of::<DVec3>() + of_corners * size_of::<[u32; 3]>() + on_rim.capacity();
        (own + tree.bytes() + field.bytes()) as u64
    }

    /// The most bytes taken besides the surface while it was made: its mesh, a copy of the triangles' corners, and their
    /// edges.
    pub fn bytes_while_made(&self) -> u64 {
        let mesh = self.positions.len() * size_of::<DVec3>() + self.triangles.len() * size_of::<[u32; 3]>();
        let triangle = size_of::<[DVec3; 3]>() + BYTES_PER_TRIANGLE;
        (mesh + self.triangles.len() * triangle) as u64
    }
}
