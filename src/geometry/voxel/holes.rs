//! Closes the small holes of a mesh: its enclosed volume is then known as for a closed mesh (Gauss).

use glam::DVec3;

use crate::geometry::TriMesh;
use crate::geometry::surface::{NO_TRIANGLE, Orientations, neighbours, orientations};
use crate::geometry::trimesh::DisjointSets;

/// The largest hole that is closed, as a share of its piece's surface; a larger one is an opening.
const MAX_HOLE_SHARE: f64 = 0.05;

/// The most that all holes of a piece may cover, as a share of its surface; if they cover more, all are openings.
const MAX_TOTAL_HOLE_SHARE: f64 = 0.25;

/// A mesh with its small holes closed; every piece faces as most of its surface does.
#[derive(Debug)]
pub(super) struct Patched {
    pub(super) whole: TriMesh,
    /// The triangles of it that close holes.
    pub(super) lids: Vec<[u32; 3]>,
    /// Only the closed pieces, if other pieces stay open.
    pub(super) closed: Option<TriMesh>,
    /// How many holes were closed.
    pub(super) holes: usize,
    /// The volume that the open pieces would enclose with flat lids on their openings, in the mesh's units.
    pub(super) lidded_volume: f64,
}

impl Patched {
    /// Closes the small holes of a mesh; none if no piece is closed then.
    pub(super) fn of(mesh: &TriMesh) -> Option<Self> {
        let weld = mesh.weld();
        let welded = mesh.triangles.iter().map(|corners| corners.map(|vertex| weld[vertex as usize]));
        let mut triangles: Vec<[u32; 3]> = welded.filter(|&[a, b, c]| a != b && b != c && c != a).collect();
        let neighbours = neighbours(&triangles);
        let Orientations { is_flipped, piece, is_orientable, .. } = orientations(&triangles, &neighbours);
        let mut areas = vec![[0.0; 2]; is_orientable.len()];
        for ((triangle, piece), is_flipped) in triangles.iter().zip(&piece).zip(&is_flipped) {
            areas[*piece as usize][usize::from(*is_flipped)] += area(&mesh.positions, *triangle);
        }
        let mut rim = Vec::new();
        for (((triangle, across), &piece), is_flipped) in
            triangles.iter_mut().zip(&neighbours).zip(&piece).zip(&is_flipped)
        {
            let [as_it_is, other] = areas[piece as usize];
            let is_flipped = is_flipped ^ (other > as_it_is);
            for edge in (0..3).filter(|edge| across[*edge] == NO_TRIANGLE) {
                let [from, to] = [triangle[edge], triangle[(edge + 1) % 3]];
                rim.push(if is_flipped { RimEdge { piece, from: to, to: from } } else { RimEdge { piece, from, to } });
            }
            if is_flipped {
                triangle.swap(1, 2);
            }
        }
        let mut positions = mesh.positions.clone();
        let caps = caps(&rim, &mut positions);
        let mut openings = vec![[0.0_f64; 2]; areas.len()];
        let holes = || caps.chunk_by(|(_, [.., one]), (_, [.., other])| one == other);
        for hole in holes() {
            let area: f64 = hole.iter().map(|(_, triangle)| area(&positions, *triangle)).sum();
            let [largest, all] = &mut openings[hole[0].0 as usize];
            (*largest, *all) = (largest.max(area), *all + area);
        }
        let is_closed = |piece: u32| {
            let [largest, all] = openings[piece as usize];
            let area: f64 = areas[piece as usize].iter().sum();
            is_orientable[piece as usize] && largest <= MAX_HOLE_SHARE * area && all <= MAX_TOTAL_HOLE_SHARE * area
        };
        let holes = holes().filter(|hole| is_closed(hole[0].0)).count();
        let of_pieces = piece.into_iter().zip(triangles);
        let (mut whole, rest): (Vec<_>, Vec<_>) = of_pieces.partition(|(piece, _)| is_closed(*piece));
        if whole.is_empty() {
            return None;
        }
        let closing = || caps.iter().copied().filter(|(piece, _)| is_closed(*piece));
        let lids = closing().map(|(_, triangle)| triangle).collect();
        whole.extend(closing());
        let of_openings = caps.iter().filter(|(piece, _)| !is_closed(*piece));
        let lidded_triangles = rest.iter().chain(of_openings).filter(|(piece, _)| is_orientable[*piece as usize]);
        let lidded_volume = enclosed_volume(&positions, lidded_triangles, areas.len());
        let mesh = |of_pieces: &[(u32, [u32; 3])], positions| {
            let triangles = of_pieces.iter().map(|(_, triangle)| *triangle).collect();
            TriMesh { positions, triangles }
        };
        let closed = (!rest.is_empty()).then(|| mesh(&whole, positions.clone()));
        whole.extend(rest);
        Some(Self { whole: mesh(&whole, positions), lids, closed, holes, lidded_volume })
    }
}

/// Returns a mesh with its small holes closed; none if a piece of it stays open.
pub fn patched(mesh: &TriMesh) -> Option<TriMesh> {
    let Patched { whole, closed, .. } = Patched::of(mesh)?;
    closed.is_none().then_some(whole)
}

/// An edge with a triangle on one side only, in that triangle's direction.
struct RimEdge {
    piece: u32,
    from: u32,
    to: u32,
}

/// Returns triangles with their pieces that close every hole: a fan about its middle, which is added to the positions.
fn caps(rim: &[RimEdge], positions: &mut Vec<DVec3>) -> Vec<(u32, [u32; 3])> {
    let mut holes = DisjointSets::new(rim.len());
    let of_edge = |(number, edge): (u32, &RimEdge)| [edge.from, edge.to].map(|vertex| (edge.piece, vertex, number));
    let mut ends: Vec<_> = (0..).zip(rim).flat_map(of_edge).collect();
    ends.sort_unstable();
    for same in ends.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        for end in same {
            holes.join(same[0].2, end.2);
        }
    }
    let mut edges: Vec<(u32, &RimEdge)> = (0..).zip(rim).map(|(number, edge)| (holes.root(number), edge)).collect();
    edges.sort_by_key(|(hole, _)| *hole);
    let mut caps = Vec::with_capacity(rim.len());
    for hole in edges.chunk_by(|a, b| a.0 == b.0) {
        let corner = |vertex: u32| positions[vertex as usize];
        // The mean of all edges weighted by their lengths, so that it does not matter how finely they are divided.
        let (sum, length) = hole.iter().fold((DVec3::ZERO, 0.0), |(sum, all), (_, edge)| {
            let [from, to] = [edge.from, edge.to].map(corner);
            let length = (to - from).length();
            (sum + 0.5 * length * (from + to), all + length)
        });
        let middle = u32::try_from(positions.len()).unwrap_or(NO_TRIANGLE);
        positions.push(if length > 0.0 { sum / length } else { corner(hole[0].1.from) });
        caps.extend(hole.iter().map(|(_, edge)| (edge.piece, [edge.to, edge.from, middle])));
    }
    caps
}

/// Returns the volume that closed pieces enclose together, whichever way each faces.
fn enclosed_volume<'a>(
    positions: &[DVec3],
    triangles: impl Iterator<Item = &'a (u32, [u32; 3])>,
    pieces: usize,
) -> f64 {
    let mut sixfold = vec![0.0_f64; pieces];
    for (piece, triangle) in triangles {
        let [a, b, c] = triangle.map(|vertex| positions[vertex as usize] - positions[0]);
        sixfold[*piece as usize] += a.dot(b.cross(c));
    }
    sixfold.into_iter().map(|six| six.abs() / 6.0).sum()
}

fn area(positions: &[DVec3], triangle: [u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
    0.5 * (b - a).cross(c - a).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::trimesh::tests::{boxed, together};
    use crate::geometry::voxel::tests::ball;

    fn volume(mesh: &TriMesh) -> f64 {
        (0..mesh.triangles.len()).map(|at| mesh.corners(at)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    /// A rod of 1 by 1 by 10 whose faces along it are of two triangles each, without some of them.
    fn rod_without(triangles: &[usize]) -> TriMesh {
        let whole = boxed(DVec3::ZERO, DVec3::new(1.0, 1.0, 10.0));
        let kept = (0..12).filter(|at| !triangles.contains(at));
        TriMesh { triangles: kept.map(|at| whole.triangles[at]).collect(), ..whole.clone() }
    }

    /// The triangles of an end of the rod, by their corners' third coordinate.
    fn ends(rod: &TriMesh, z: f64) -> Vec<usize> {
        (0..12).filter(|at| rod.corners(*at).iter().all(|corner| (corner.z - z).abs() < 0.5)).collect()
    }

    #[test]
    fn a_rod_without_its_ends_has_its_volume() {
        let whole = rod_without(&[]);
        let [near, far] = [0.0, 10.0].map(|z| ends(&whole, z));
        assert_eq!((near.len(), far.len()), (2, 2), "two triangles at each end");
        for without in [&near[..1], &near, &[near[0], far[1]], &[near.clone(), far].concat()] {
            let Patched { whole, closed, .. } = Patched::of(&rod_without(without)).expect("its holes are small");
            assert!((volume(&whole) - 10.0).abs() < 1e-12, "without {without:?}: {}", volume(&whole));
            assert!(whole.facts().closed && closed.is_none(), "without {without:?}: nothing is left open");
        }
    }

    #[test]
    fn a_hole_here_and_there_is_closed_and_many_are_not() {
        let ball = ball(DVec3::ZERO, 1.0, 24);
        let exact = volume(&ball);
        let without = |every: usize| {
            let kept = (0..ball.triangles.len()).filter(|at| at % every != 0);
            TriMesh { triangles: kept.map(|at| ball.triangles[at]).collect(), ..ball.clone() }
        };
        let few = Patched::of(&without(10)).expect("a tenth is missing");
        // At the poles several holes share a corner and are closed as one, which is not flat.
        assert!((volume(&few.whole) / exact - 1.0).abs() < 1e-5, "{} of {exact}", volume(&few.whole));
        assert!(few.holes > 50 && few.closed.is_none(), "each of its own: {}", few.holes);
        assert!(Patched::of(&without(3)).is_none(), "a third is missing");
    }

    #[test]
    fn what_is_wide_open_stays_so() {
        let whole = rod_without(&[]);
        let ends = [0.0, 10.0].map(|z| ends(&whole, z)).concat();
        let side = (0..12).find(|at| !ends.contains(at)).expect("one of eight");
        assert!(Patched::of(&rod_without(&[side])).is_none(), "half of a side is missing");
    }

    #[test]
    fn triangles_face_as_most_of_their_piece_does() {
        let solid = boxed(DVec3::ZERO, DVec3::splat(3.0));
        let mut cavity = boxed(DVec3::splat(1.0), DVec3::splat(2.0));
        for triangle in &mut cavity.triangles[3..] {
            triangle.swap(1, 2);
        }
        let mut mixed = together(&[solid, cavity]);
        mixed.triangles[5].swap(0, 1);
        let Patched { whole, closed, .. } = Patched::of(&mixed).expect("closed");
        assert!((volume(&whole) - 26.0).abs() < 1e-12, "a cube with a cavity: {}", volume(&whole));
        assert!(closed.is_none(), "all of it");
    }

    #[test]
    fn pieces_are_looked_at_one_by_one() {
        let near = rod_without(&[]);
        let sheet = TriMesh {
            positions: [[5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [6.0, 1.0, 0.0]].map(DVec3::from_array).to_vec(),
            triangles: vec![[0, 1, 2]],
        };
        let Patched { whole, closed, .. } = Patched::of(&together(&[near.clone(), sheet])).expect("the rod is closed");
        assert_eq!(whole.triangles.len(), 13, "the sheet is not closed by a second one");
        assert_eq!(closed.map(|rod| rod.triangles.len()), Some(12));
        // Two rods that share an edge: four triangles meet in it.
        let beside = boxed(DVec3::new(1.0, 1.0, 0.0), DVec3::new(2.0, 2.0, 10.0));
        let Patched { whole, closed, .. } = Patched::of(&together(&[near, beside])).expect("both are closed");
        assert!((volume(&whole) - 20.0).abs() < 1e-12 && closed.is_none(), "{}", volume(&whole));
    }
}
