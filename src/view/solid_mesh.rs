//! The mesh of an obstacle, for drawing and for picking.

use glam::Vec3;

use super::Ray;

/// A mesh about the origin, in units of its length. Two are equal only if they are one in memory: they never change.
#[derive(Clone, Debug, Default)]
pub struct SolidMesh {
    /// The corners of the triangles, three per triangle, counter-clockwise seen from outside. An open mesh has both its
    /// sides here.
    pub corners: Vec<SolidCorner>,
    /// The edges at which its outline may run.
    pub edges: Vec<SolidEdge>,
    /// Half the size of the box around it.
    pub half_extents: Vec3,
}

/// A corner of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidCorner {
    /// Where it is.
    pub position: Vec3,
    /// The normal: that of the triangle at a sharp edge, a mean at a smooth one.
    pub normal: Vec3,
}

/// An edge between two triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidEdge {
    /// Its ends.
    pub ends: [Vec3; 2],
    /// The normals of the two triangles; at a rim the second is the first turned around.
    pub normals: [Vec3; 2],
}

impl PartialEq for SolidMesh {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl SolidMesh {
    /// The distance along a ray, in the mesh's own axes and unit, at which a triangle is first met.
    pub fn hit(&self, ray: &Ray) -> Option<f32> {
        let (origin, way) = (ray.origin, ray.direction);
        let hits = self.corners.chunks_exact(3).filter_map(|corners| {
            let [a, b, c] = [0, 1, 2].map(|corner| corners[corner].position);
            let (ab, ac) = (b - a, c - a);
            let p = way.cross(ac);
            let determinant = ab.dot(p);
            if determinant == 0.0 {
                return None;
            }
            let offset = origin - a;
            let u = offset.dot(p) / determinant;
            let q = offset.cross(ab);
            let v = way.dot(q) / determinant;
            let t = ac.dot(q) / determinant;
            (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0).then_some(t)
        });
        hits.min_by(f32::total_cmp)
    }

    /// The edges between triangles that an eye sees from outside and triangles that it does not, in the mesh's own axes and
    /// unit.
    pub fn silhouette(&self, eye: Vec3) -> impl Iterator<Item = [Vec3; 2]> {
        let is_seen = move |edge: &&SolidEdge| {
            let [one, other] = edge.normals.map(|normal| normal.dot(eye - edge.ends[0]) > 0.0);
            one != other
        };
        self.edges.iter().filter(is_seen).map(|edge| edge.ends)
    }
}
