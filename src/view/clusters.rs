//! Finds the triangles of a skin that a line of sight may meet, without a look at each of them.
//!
//! A cluster holds the triangles whose first corner has the same first particle: those of one cell of the body. Its
//! particles bound its triangles however the body is deformed. For a corner p with weights w that sum to 1,
//!
//! ```text
//! p − m = Σ w (x − m)    so    |p − m| ≤ (Σ |w|) · h
//! ```
//!
//! where m is the middle and h the half size of the box around the particles x. Nothing has to be kept up to date while the
//! body moves. A pick costs a few comparisons for every particle of the surface, and tests a few dozen triangles.

use std::ops::Range;

use glam::Vec3;

use super::{Ray, SkinVertex};
use crate::math::Aabb;

/// The triangles of a skin, grouped by the particles that carry them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Clusters {
    all: Vec<Cluster>,
    /// Indices of triangles in the skin, cluster by cluster.
    triangles: Vec<u32>,
    /// The particles that carry the clusters, cluster by cluster.
    particles: Vec<u32>,
}

/// Triangles that lie within the box around a few particles, enlarged by a factor.
#[derive(Clone, Debug, PartialEq)]
struct Cluster {
    triangles: Range<usize>,
    particles: Range<usize>,
    /// The factor: the largest sum of |weights| of a corner. It is 1 for corners inside the cell, more for corners outside.
    box_scale: f32,
}

impl Clusters {
    /// Groups the triangles of a skin.
    pub(super) fn new(vertices: &[SkinVertex], triangles: &[[u32; 3]]) -> Self {
        let carrier = |triangle: u32| vertices[triangles[triangle as usize][0] as usize].particles[0];
        let mut order: Vec<u32> = (0..).take(triangles.len()).collect();
        order.sort_by_key(|&triangle| carrier(triangle));
        let mut made = Self::default();
        for group in order.chunk_by(|&a, &b| carrier(a) == carrier(b)) {
            let corners = || group.iter().flat_map(|&triangle| triangles[triangle as usize]);
            let first = made.particles.len();
            let mut box_scale = 1.0_f32;
            let mut carriers: Vec<u32> = Vec::new();
            for vertex in corners().map(|corner| &vertices[corner as usize]) {
                carriers.extend(vertex.carriers().map(|(particle, _)| particle));
                box_scale = box_scale.max(vertex.position.iter().map(|weight| weight.abs()).sum());
            }
            carriers.sort_unstable();
            carriers.dedup();
            made.particles.extend(carriers);
            let begin = made.triangles.len();
            made.triangles.extend(group);
            made.all.push(Cluster {
                triangles: begin..made.triangles.len(),
                particles: first..made.particles.len(),
                box_scale,
            });
        }
        made
    }

    /// Returns the triangles that a line of sight may meet; it misses all others.
    ///
    /// # Panics
    /// When the skin names a particle that is not there.
    pub(super) fn hit_candidates<'a>(
        &'a self,
        particles: &'a [[f32; 3]],
        ray: &'a Ray,
    ) -> impl Iterator<Item = u32> + 'a {
        let place = |&particle: &u32| Vec3::from(particles[particle as usize]);
        let meets = move |cluster: &&Cluster| {
            let around = Aabb::<f32>::around(self.particles[cluster.particles.clone()].iter().map(place));
            let (middle, half) = (around.center(), around.size() * (0.5 * cluster.box_scale));
            // The margin keeps rounding errors from losing a surface that is as flat as its box.
            let margin = Vec3::splat(1e-5 * (middle.abs() + half).max_element());
            ray.meets_box(&Aabb { min: middle - half - margin, max: middle + half + margin })
        };
        let met = self.all.iter().filter(meets);
        met.flat_map(|cluster| self.triangles[cluster.triangles.clone()].iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    /// A vertex of a cell that spans particles `cell * 8 ..`, at a place within it or a little outside.
    fn vertex(cell: u32, at: Vec3) -> SkinVertex {
        let weight = |corner: usize| {
            let along = |axis: usize| if corner >> axis & 1 == 1 { at[axis] } else { 1.0 - at[axis] };
            along(0) * along(1) * along(2)
        };
        SkinVertex {
            particles: std::array::from_fn(|corner| cell * 8 + u32::try_from(corner).expect("eight corners")),
            position: std::array::from_fn(weight),
            ..SkinVertex::default()
        }
    }

    #[test]
    fn no_triangle_that_is_met_is_left_out_however_the_cells_are_deformed() {
        let mut rng = Rng::new(3);
        let mut number = |low: f32, high: f32| low + (high - low) * (rng.next_u64() % 10_000) as f32 / 10_000.0;
        let cells = 60;
        let particles: Vec<[f32; 3]> = (0..cells * 8).map(|_| std::array::from_fn(|_| number(-2.0, 2.0))).collect();
        let mut vertices = Vec::new();
        for cell in 0..cells {
            for _ in 0..9 {
                let at = Vec3::new(number(-0.6, 1.6), number(-0.6, 1.6), number(-0.6, 1.6));
                vertices.push(vertex(cell, at));
            }
        }
        let triangles: Vec<[u32; 3]> = (0..cells * 3).map(|t| [t * 3, t * 3 + 1, t * 3 + 2]).collect();
        let clusters = Clusters::new(&vertices, &triangles);
        let mut met = 0;
        for _ in 0..200 {
            let origin = Vec3::new(number(-6.0, 6.0), number(-6.0, 6.0), 6.0);
            let aim = Vec3::new(number(-2.0, 2.0), number(-2.0, 2.0), number(-2.0, 2.0));
            let ray = Ray { origin, direction: (aim - origin).normalize() };
            let near: Vec<u32> = clusters.hit_candidates(&particles, &ray).collect();
            for (number, triangle) in (0..).zip(&triangles) {
                let corners = triangle.map(|corner| vertices[corner as usize].place(&particles));
                if ray.hit_triangle(corners).is_some() {
                    met += 1;
                    assert!(near.contains(&number), "triangle {number} is met by {ray:?} and was left out");
                }
            }
        }
        assert!(met > 100, "the check meets triangles: {met}");
    }

    #[test]
    fn a_line_of_sight_through_a_body_looks_at_few_of_its_triangles() {
        let side = 40_u32;
        let mut particles = Vec::new();
        let mut vertices = Vec::new();
        for cell in 0..side * side {
            let low = [(cell % side) as f32, 0.0, (cell / side) as f32];
            particles.extend(
                (0..8_usize)
                    .map(|corner| std::array::from_fn::<f32, 3, _>(|axis| low[axis] + (corner >> axis & 1) as f32)),
            );
            vertices.extend([0.1, 0.5, 0.9].map(|at| vertex(cell, Vec3::new(at, 0.5, at * at))));
        }
        let triangles: Vec<[u32; 3]> = (0..side * side).map(|cell| [cell * 3, cell * 3 + 1, cell * 3 + 2]).collect();
        let clusters = Clusters::new(&vertices, &triangles);
        let down = Ray { origin: Vec3::new(20.3, 9.0, 20.4), direction: Vec3::NEG_Y };
        assert_eq!(clusters.hit_candidates(&particles, &down).count(), 1, "straight down: the one in the cell below");
        let slanted = Ray { origin: Vec3::new(0.5, 9.0, 20.4), direction: Vec3::new(1.0, -0.4, 0.0).normalize() };
        let looked_at = clusters.hit_candidates(&particles, &slanted).count();
        assert!((1..40).contains(&looked_at), "slanted: those along its way, of 1600: {looked_at}");
    }

    #[test]
    fn every_triangle_is_in_one_cluster() {
        let vertices: Vec<SkinVertex> = (0..12).map(|number| vertex(number % 4, Vec3::splat(0.5))).collect();
        let triangles = [[0, 1, 2], [4, 5, 6], [1, 2, 3], [8, 9, 10]];
        let clusters = Clusters::new(&vertices, &triangles);
        let mut all = clusters.triangles.clone();
        all.sort_unstable();
        assert_eq!(all, [0, 1, 2, 3], "none is lost and none is there twice");
        assert_eq!(clusters.all.len(), 2, "those of cell 0 and the one of cell 1");
    }
}
