//! Finds the triangles of a mesh that share an edge, and turns them so that neighbours face the same way and closed pieces
//! outwards.

use glam::DVec3;

/// No triangle.
pub(in crate::geometry) const NO_TRIANGLE: u32 = u32::MAX;

/// The bytes that orienting takes for a triangle, besides itself and its neighbours: its edges, its piece and whether it is
/// turned.
pub(super) const BYTES_PER_TRIANGLE: usize = 3 * size_of::<Edge>() + size_of::<u32>() + size_of::<bool>();

/// Triangles over welded vertices, and the neighbour beyond every edge: edge e runs from corner e to the next one.
#[derive(Clone, Debug)]
pub(super) struct Oriented {
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) neighbours: Vec<[u32; 3]>,
    /// Every edge has two triangles, which all face the same way: there is an inside.
    pub(super) is_closed: bool,
}

/// Turns triangles over welded vertices.
pub(super) fn orient(positions: &[DVec3], mut triangles: Vec<[u32; 3]>) -> Oriented {
    let mut neighbours = neighbours(&triangles);
    let has_rim = neighbours.as_flattened().contains(&NO_TRIANGLE);
    let Orientations { is_flipped, piece, is_orientable, is_consistent } = orientations(&triangles, &neighbours);
    for ((triangle, across), _) in
        triangles.iter_mut().zip(&mut neighbours).zip(&is_flipped).filter(|(_, is_flipped)| **is_flipped)
    {
        triangle.swap(1, 2);
        across.swap(0, 2);
    }
    let is_closed = !has_rim && is_orientable.iter().all(|is_orientable| *is_orientable);
    if is_closed {
        let mut volumes = vec![0.0; is_orientable.len()];
        for (triangle, piece) in triangles.iter().zip(&piece) {
            let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
            volumes[*piece as usize] += a.dot(b.cross(c));
        }
        if is_consistent.iter().all(|is_consistent| *is_consistent) {
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
    Oriented { triangles, neighbours, is_closed }
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

/// Returns the triangle beyond every edge, if it is one; vertices are welded, and edge e runs from corner e to the next.
pub(in crate::geometry) fn neighbours(triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut edges = edges(triangles);
    edges.sort_unstable();
    let mut neighbours = vec![[NO_TRIANGLE; 3]; triangles.len()];
    for same in edges.chunk_by(|a, b| a.ends == b.ends) {
        if let [a, b] = same {
            neighbours[a.triangle as usize][a.side as usize] = b.triangle;
            neighbours[b.triangle as usize][b.side as usize] = a.triangle;
        }
    }
    neighbours
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

/// The pieces of a mesh that are connected by edges, and the triangles to turn so that they face as the first of their piece
/// does.
pub(in crate::geometry) struct Orientations {
    pub(in crate::geometry) is_flipped: Vec<bool>,
    /// The piece of every triangle.
    pub(in crate::geometry) piece: Vec<u32>,
    /// Which pieces have two sides.
    pub(in crate::geometry) is_orientable: Vec<bool>,
    /// Which pieces needed no turning.
    is_consistent: Vec<bool>,
}

/// Finds the pieces and turns of triangles over welded vertices, given the neighbours beyond their edges.
pub(in crate::geometry) fn orientations(triangles: &[[u32; 3]], neighbours: &[[u32; 3]]) -> Orientations {
    let count = triangles.len();
    let mut found = Orientations {
        is_flipped: vec![false; count],
        piece: vec![NO_TRIANGLE; count],
        is_orientable: vec![],
        is_consistent: vec![],
    };
    let mut waiting = Vec::new();
    for seed in 0..count {
        if found.piece[seed] != NO_TRIANGLE {
            continue;
        }
        let number = found.is_orientable.len();
        let piece = u32::try_from(number).unwrap_or(NO_TRIANGLE);
        found.is_orientable.push(true);
        found.is_consistent.push(true);
        found.piece[seed] = piece;
        waiting.push(seed);
        while let Some(here) = waiting.pop() {
            for edge in 0..3 {
                let other = neighbours[here][edge] as usize;
                if other >= count {
                    continue;
                }
                // Two triangles that face the same way run along their common edge in opposite directions.
                let [from, to] = [triangles[here][edge], triangles[here][(edge + 1) % 3]];
                let same = (0..3).any(|e| [triangles[other][e], triangles[other][(e + 1) % 3]] == [from, to]);
                let is_flipped = found.is_flipped[here] ^ same;
                if found.piece[other] == NO_TRIANGLE {
                    (found.piece[other], found.is_flipped[other]) = (piece, is_flipped);
                    found.is_consistent[number] &= !is_flipped;
                    waiting.push(other);
                } else if found.is_flipped[other] != is_flipped {
                    found.is_orientable[number] = false;
                }
            }
        }
    }
    found
}
