//! Queries of one triangle: its point nearest to another, and where a line crosses it.

use glam::DVec3;

/// The feature of a triangle that is nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Feature {
    Face,
    /// The edge from the corner of this number to the next.
    Edge(usize),
    Corner(usize),
}

/// How far beyond its edges a line still crosses a triangle, over its size: no line slips between two triangles.
const EDGE_TOLERANCE: f64 = 1e-9;

/// The point of a triangle nearest to `at` (Ericson, *Real-Time Collision Detection*, 5.1.5).
pub(super) fn nearest([a, b, c]: [DVec3; 3], at: DVec3) -> (DVec3, Feature) {
    let (ab, ac, ap) = (b - a, c - a, at - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, Feature::Corner(0));
    }
    let bp = at - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (b, Feature::Corner(1));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + ab * (d1 / (d1 - d3)), Feature::Edge(0));
    }
    let cp = at - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (c, Feature::Corner(2));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + ac * (d2 / (d2 - d6)), Feature::Edge(2));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return (b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), Feature::Edge(1));
    }
    let over = 1.0 / (va + vb + vc);
    (a + ab * (vb * over) + ac * (vc * over), Feature::Face)
}

/// The t at which the line `from + t displacement` crosses a triangle (Möller and Trumbore); none if it misses or is
/// parallel.
pub(super) fn crossing([a, b, c]: [DVec3; 3], from: DVec3, displacement: DVec3) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let p = displacement.cross(ac);
    let determinant = ab.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let offset = from - a;
    let u = offset.dot(p) / determinant;
    let q = offset.cross(ab);
    let v = displacement.dot(q) / determinant;
    (u >= -EDGE_TOLERANCE && v >= -EDGE_TOLERANCE && u + v <= 1.0 + EDGE_TOLERANCE).then(|| ac.dot(q) / determinant)
}
