//! A bag of triangles, not necessarily closed, connected or oriented, and facts about it.

use std::borrow::Cow;

use glam::DVec3;

use crate::math::Aabb;

/// A triangle mesh. Every index is below the number of positions, every position finite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    /// Vertex positions, m.
    pub positions: Vec<DVec3>,
    /// Triangles by vertex index, counter-clockwise from outside where the source says so.
    pub triangles: Vec<[u32; 3]>,
}

/// Facts about a mesh once vertices at exactly equal positions are taken as one. Triangles that then have two equal corners
/// bound nothing and are left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshFacts {
    /// Edges of exactly one triangle.
    pub boundary_edges: usize,
    /// Edges of more than two triangles.
    pub non_manifold_edges: usize,
    /// Every edge belongs to an even number of triangles, so that there is an inside.
    pub closed: bool,
    /// Connected pieces (triangles that share a vertex are connected).
    pub parts: usize,
    /// The piece of every triangle, numbered in the order of their first triangles.
    pub part_of_triangle: Vec<u32>,
}

impl TriMesh {
    /// The smallest box around the vertices that triangles use; empty without triangles.
    pub fn bounds(&self) -> Aabb<f64> {
        Aabb::around(self.triangles.iter().flatten().map(|&vertex| self.positions[vertex as usize]))
    }

    /// The corners of a triangle, m.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|vertex| self.positions[vertex as usize])
    }

    /// Whether no triangle has an area: all are thinner than 10⁻¹² of their length.
    pub fn is_degenerate(&self) -> bool {
        (0..self.triangles.len()).all(|triangle| {
            let [a, b, c] = self.corners(triangle);
            let longest = [b - a, c - b, a - c].into_iter().map(|edge| edge.abs().max_element()).fold(0.0, f64::max);
            if longest == 0.0 {
                return true;
            }
            // Scaled first: the square of a huge or tiny length may overflow or vanish.
            ((b - a) / longest).cross((c - a) / longest).length() <= 1e-12
        })
    }

    /// Edges, closedness and pieces.
    pub fn facts(&self) -> MeshFacts {
        let weld = self.weld();
        let welded = self.triangles.iter().map(|triangle| triangle.map(|vertex| weld[vertex as usize]));
        let mut pieces = DisjointSets::new(self.positions.len());
        let mut edges = Vec::with_capacity(3 * self.triangles.len());
        for [a, b, c] in welded.clone() {
            pieces.join(a, b);
            pieces.join(a, c);
            if a != b && b != c && c != a {
                edges.extend([[a, b], [b, c], [c, a]].map(|[from, to]| [from.min(to), from.max(to)]));
            }
        }
        edges.sort_unstable();
        let uses = || edges.chunk_by(|a, b| a == b).map(<[_]>::len);
        let (part_of_triangle, parts) = number(welded.map(|[a, _, _]| pieces.root(a)), self.positions.len());
        MeshFacts {
            boundary_edges: uses().filter(|&n| n == 1).count(),
            non_manifold_edges: uses().filter(|&n| n > 2).count(),
            closed: !edges.is_empty() && uses().all(|n| n % 2 == 0),
            parts,
            part_of_triangle,
        }
    }

    /// The mesh with every triangle once: of triangles with the same corners in the same turning direction, at exactly
    /// equal positions, the first stays. (In opposite directions they are the two sides of something, and both stay.)
    pub fn without_duplicates(&self) -> Cow<'_, Self> {
        let weld = self.weld();
        let key = |triangle: &u32| {
            let mut corners = self.triangles[*triangle as usize].map(|vertex| weld[vertex as usize]);
            let lowest = usize::from(corners[1] < corners[0]);
            let lowest = if corners[2] < corners[lowest] { 2 } else { lowest };
            corners.rotate_left(lowest);
            corners
        };
        let mut kept: Vec<u32> = (0..).take(self.triangles.len()).collect();
        kept.sort_by_cached_key(key);
        kept.dedup_by_key(|triangle| key(triangle));
        if kept.len() == self.triangles.len() {
            return Cow::Borrowed(self);
        }
        kept.sort_unstable();
        let triangles = kept.into_iter().map(|triangle| self.triangles[triangle as usize]).collect();
        Cow::Owned(Self { positions: self.positions.clone(), triangles })
    }

    /// For every vertex the first one (in a fixed order) at exactly the same position.
    pub(super) fn weld(&self) -> Vec<u32> {
        // Adding zero makes the two zeros one.
        let key = |&vertex: &u32| (self.positions[vertex as usize] + DVec3::ZERO).to_array().map(f64::to_bits);
        let mut order: Vec<u32> = (0..).take(self.positions.len()).collect();
        order.sort_by_cached_key(key);
        let mut weld = vec![0; order.len()];
        for same in order.chunk_by(|a, b| key(a) == key(b)) {
            for &vertex in same {
                weld[vertex as usize] = same[0];
            }
        }
        weld
    }
}

/// Numbers roots 0, 1, … in the order in which they first appear.
fn number(roots: impl Iterator<Item = u32>, roots_below: usize) -> (Vec<u32>, usize) {
    let mut names = vec![u32::MAX; roots_below];
    let mut count = 0;
    let numbered = roots
        .map(|root| {
            let name = &mut names[root as usize];
            if *name == u32::MAX {
                *name = count;
                count += 1;
            }
            *name
        })
        .collect();
    (numbered, count as usize)
}

/// Sets of numbers that only ever grow together (union–find with path halving); the root of a set is its smallest
/// number, whatever the order of the joins.
#[derive(Clone, Debug)]
pub(crate) struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    /// Puts every number below `len` into a set of its own.
    pub(crate) fn new(len: usize) -> Self {
        Self { parent: (0..).take(len).collect() }
    }

    /// The smallest number of the set.
    pub(crate) fn root(&mut self, mut number: u32) -> u32 {
        while self.parent[number as usize] != number {
            let grandparent = self.parent[self.parent[number as usize] as usize];
            self.parent[number as usize] = grandparent;
            number = grandparent;
        }
        number
    }

    /// Makes two sets one.
    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The twelve outward triangles of a box, each face with its own four vertices (all seams unwelded).
    pub(crate) fn boxed(min: DVec3, max: DVec3) -> TriMesh {
        let mut mesh = TriMesh::default();
        for axis in 0..3 {
            for high in [false, true] {
                let corner = |u: bool, v: bool| {
                    let mut at = DVec3::ZERO;
                    for (axis, high) in [(axis, high), ((axis + 1) % 3, u), ((axis + 2) % 3, v)] {
                        at[axis] = if high { max[axis] } else { min[axis] };
                    }
                    at
                };
                let base = u32::try_from(mesh.positions.len()).expect("small");
                mesh.positions
                    .extend([(false, false), (true, false), (true, true), (false, true)].map(|(u, v)| corner(u, v)));
                let [a, b, c, d] = [base, base + 1, base + 2, base + 3];
                mesh.triangles.extend(if high { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
            }
        }
        mesh
    }

    /// Several meshes as one.
    pub(crate) fn together(meshes: &[TriMesh]) -> TriMesh {
        let mut all = TriMesh::default();
        for mesh in meshes {
            let base = u32::try_from(all.positions.len()).expect("small");
            all.positions.extend(&mesh.positions);
            all.triangles.extend(mesh.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + base)));
        }
        all
    }

    fn unit_box() -> TriMesh {
        boxed(DVec3::ZERO, DVec3::ONE)
    }

    #[test]
    fn a_box_with_unwelded_seams_is_closed_and_one_part() {
        let facts = unit_box().facts();
        assert_eq!((facts.boundary_edges, facts.non_manifold_edges), (0, 0), "every edge has two triangles");
        assert_eq!((facts.closed, facts.parts), (true, 1), "one closed piece");
    }

    #[test]
    fn a_missing_triangle_opens_a_box() {
        let mut open = unit_box();
        open.triangles.pop();
        let facts = open.facts();
        assert_eq!((facts.boundary_edges, facts.closed), (3, false), "the hole has three edges");
    }

    #[test]
    fn a_fin_is_not_manifold() {
        let fin = TriMesh { positions: vec![DVec3::ZERO, DVec3::X, DVec3::splat(-1.0)], triangles: vec![[0, 1, 2]] };
        let facts = together(&[unit_box(), fin]).facts();
        assert_eq!(
            (facts.boundary_edges, facts.non_manifold_edges, facts.closed),
            (2, 1, false),
            "three share an edge"
        );
        assert_eq!(facts.parts, 1, "the fin touches the box");
    }

    #[test]
    fn parts_are_numbered_as_they_come() {
        let apart = together(&[unit_box(), boxed(DVec3::splat(2.0), DVec3::splat(3.0))]).facts();
        assert_eq!((apart.parts, apart.part_of_triangle[11], apart.part_of_triangle[12]), (2, 0, 1), "two boxes");
    }

    #[test]
    fn the_two_zeros_are_one_position() {
        let mut mesh = unit_box();
        for position in mesh.positions.iter_mut().step_by(2) {
            *position = DVec3::from_array(position.to_array().map(|x| if x == 0.0 { -0.0 } else { x }));
        }
        assert!(mesh.facts().closed, "-0 and 0 are the same place");
    }

    #[test]
    fn slivers_have_no_area_at_any_scale() {
        for scale in [1e-150, 1.0, 1e150] {
            let line = [0.0, 0.1, 0.3].map(|t| DVec3::new(1.0, 2.0, 3.0) * t * scale);
            let mut mesh = TriMesh { positions: line.to_vec(), triangles: vec![[0, 1, 2]] };
            assert!(mesh.is_degenerate(), "three points of a line at {scale}");
            mesh.positions[2].x += 0.1 * scale;
            assert!(!mesh.is_degenerate(), "a proper triangle at {scale}");
        }
        assert!(TriMesh::default().is_degenerate(), "nothing has no area");
    }

    #[test]
    fn a_triangle_counts_once_per_turning_direction() {
        let mut mesh = unit_box();
        let [a, b, c] = mesh.triangles[3];
        mesh.triangles.extend([[b, c, a], [c, a, b], [a, c, b]]);
        let distinct = mesh.without_duplicates();
        assert_eq!(distinct.triangles[..12], unit_box().triangles, "the first ones stay, in order");
        assert_eq!(distinct.triangles[12..], [[a, c, b]], "the other side is not a duplicate");
    }

    #[test]
    fn bounds_leave_out_vertices_that_no_triangle_uses() {
        let mut mesh = unit_box();
        mesh.positions.push(DVec3::splat(100.0));
        assert_eq!(mesh.bounds().max, DVec3::ONE, "the far vertex is not part of the surface");
    }
}
