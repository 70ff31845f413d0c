//! Which triangles of a mesh share an edge, and turning them so that neighbours face the same way and closed pieces
//! outwards.

use glam::DVec3;

use crate::geometry::TriMesh;

/// No triangle.
pub(super) const NONE: u32 = u32::MAX;

/// What it takes to orient a triangle, beside itself and its neighbours: its edges, the piece that it is of and whether it is
/// turned, bytes.
pub(super) const BYTES_A_TRIANGLE: usize = 3 * size_of::<Edge>() + size_of::<u32>() + size_of::<bool>();

/// Triangles over welded vertices, and the neighbour beyond every edge: edge e runs from corner e to the next one.
#[derive(Clone, Debug)]
pub(super) struct Oriented {
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) neighbours: Vec<[u32; 3]>,
    /// Every edge has two triangles, which all face the same way: there is an inside.
    pub(super) is_closed: bool,
    /// Pieces that no edge joins.
    pieces: usize,
}

/// A closed mesh of one piece with all its triangles facing outwards; none of another one.
pub(in crate::geometry) fn facing_outwards(mesh: &TriMesh) -> Option<TriMesh> {
    let weld = mesh.weld();
    let triangles = mesh.triangles.iter().map(|corners| corners.map(|vertex| weld[vertex as usize])).collect();
    let Oriented { triangles, is_closed, pieces, .. } = orient(&mesh.positions, triangles);
    (is_closed && pieces == 1).then(|| TriMesh { positions: mesh.positions.clone(), triangles })
}

/// Turns triangles over welded vertices.
pub(super) fn orient(positions: &[DVec3], mut triangles: Vec<[u32; 3]>) -> Oriented {
    let mut edges = edges(&triangles);
    edges.sort_unstable();
    let mut neighbours = vec![[NONE; 3]; triangles.len()];
    let mut is_closed = true;
    for same in edges.chunk_by(|a, b| a.ends == b.ends) {
        match same {
            [a, b] => {
                neighbours[a.triangle as usize][a.side as usize] = b.triangle;
                neighbours[b.triangle as usize][b.side as usize] = a.triangle;
            }
            _ => is_closed = false,
        }
    }
    let Turns { turned, piece, pieces, is_orientable, is_consistent } = turns(&triangles, &neighbours);
    for ((triangle, across), _) in triangles.iter_mut().zip(&mut neighbours).zip(&turned).filter(|(_, turned)| **turned)
    {
        triangle.swap(1, 2);
        across.swap(0, 2);
    }
    is_closed &= is_orientable;
    if is_closed {
        let mut volumes = vec![0.0; pieces];
        for (triangle, piece) in triangles.iter().zip(&piece) {
            let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
            volumes[*piece as usize] += a.dot(b.cross(c));
        }
        if is_consistent {
            // A cavity is a piece that faces inwards, so only all of them together may be turned.
            let total: f64 = volumes.iter().sum();
            volumes.fill(total);
        }
        for ((triangle, across), piece) in triangles.iter_mut().zip(&mut neighbours).zip(&piece) {
            if volumes[*piece as usize] < 0.0 {
                triangle.swap(1, 2);
                across.swap(0, 2);
            }
        }
    }
    Oriented { triangles, neighbours, is_closed, pieces }
}

/// An edge of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    /// Its vertices, ascending.
    ends: [u32; 2],
    triangle: u32,
    /// Which of the triangle's edges it is.
    side: u8,
}

fn edges(triangles: &[[u32; 3]]) -> Vec<Edge> {
    let of = |(number, triangle): (u32, &[u32; 3])| {
        let [a, b, c] = *triangle;
        [(0, [a, b]), (1, [b, c]), (2, [c, a])].map(|(side, [from, to])| {
            let ends = [from.min(to), from.max(to)];
            Edge { ends, triangle: number, side }
        })
    };
    (0..).zip(triangles).flat_map(of).collect()
}

/// Which triangles have to be turned to face as the first of their piece does.
struct Turns {
    turned: Vec<bool>,
    piece: Vec<u32>,
    pieces: usize,
    /// No piece is one-sided.
    is_orientable: bool,
    /// Nothing had to be turned.
    is_consistent: bool,
}

fn turns(triangles: &[[u32; 3]], neighbours: &[[u32; 3]]) -> Turns {
    let count = triangles.len();
    let mut found = Turns {
        turned: vec![false; count],
        piece: vec![NONE; count],
        pieces: 0,
        is_orientable: true,
        is_consistent: true,
    };
    let mut waiting = Vec::new();
    for seed in 0..count {
        if found.piece[seed] != NONE {
            continue;
        }
        let piece = u32::try_from(found.pieces).unwrap_or(NONE);
        found.pieces += 1;
        found.piece[seed] = piece;
        waiting.push(seed);
        while let Some(here) = waiting.pop() {
            for edge in 0..3 {
                let other = neighbours[here][edge] as usize;
                if other >= count {
                    continue;
                }
                // Two that face the same way run along their common edge in opposite directions.
                let [from, to] = [triangles[here][edge], triangles[here][(edge + 1) % 3]];
                let same = (0..3).any(|e| [triangles[other][e], triangles[other][(e + 1) % 3]] == [from, to]);
                let turned = found.turned[here] ^ same;
                if found.piece[other] == NONE {
                    (found.piece[other], found.turned[other]) = (piece, turned);
                    found.is_consistent &= !turned;
                    waiting.push(other);
                } else if found.turned[other] != turned {
                    found.is_orientable = false;
                }
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::trimesh::tests::{boxed, together};

    #[test]
    fn one_closed_piece_is_turned_outwards_and_nothing_else_is() {
        let whole = boxed(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0));
        let mut mixed = whole.clone();
        mixed.triangles.iter_mut().step_by(2).for_each(|triangle| triangle.swap(1, 2));
        let turned = facing_outwards(&mixed).expect("one closed piece");
        let six: f64 = (0..12).map(|triangle| turned.corners(triangle)).map(|[a, b, c]| a.dot(b.cross(c))).sum();
        assert!((six / 36.0 - 1.0).abs() < 1e-12, "six times its volume: {six}");
        let open = TriMesh { triangles: whole.triangles[1..].to_vec(), ..whole.clone() };
        assert_eq!(facing_outwards(&open), None, "there is no outside");
        assert_eq!(facing_outwards(&together(&[whole, boxed(DVec3::splat(5.0), DVec3::splat(6.0))])), None);
    }
}
