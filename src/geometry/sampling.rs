//! Chooses a few points in each cell that stand for all of a mesh's surface: the outermost ones, spread over the
//! surface in the cell.
//!
//! ```text
//! candidates  all vertices, and points between them on the triangles, no further apart than a third of a cell
//! samples     in each cell the point furthest out, away from the cells around it (if these are on all sides, the furthest
//!             both ways along every axis), then repeatedly the one furthest from those taken, until there are eight or
//!             all are near one
//! ```
//!
//! The first point of a cell is a corner of the surface, such as a hoof or an ear's tip, if there is one: it touches first.
//! The order is that of the cells and of the mesh's file: the same mesh in the same cells has the same points.

use glam::DVec3;

use super::embed::Embedder;
use super::places::Places;
use super::{Lattice, TriMesh};

/// The most points of a cell.
pub const MAX_SAMPLES_PER_CELL: usize = 8;

/// The largest spacing of the candidates, in cells.
const CANDIDATE_SPACING: f64 = 1.0 / 3.0;

/// Bins along the edge of a cell; each holds at most one point that is not a vertex.
const BINS: usize = 4;

/// The least distance between points taken in a cell, in cells.
const MIN_SAMPLE_DISTANCE: f64 = 0.15;

/// A point further from its cell than this, in cells, belongs to a part of the mesh without cells.
const MAX_DISTANCE_OUTSIDE: f64 = 1.0;

/// The directions along the axes.
const AXES: [DVec3; 6] = [DVec3::NEG_X, DVec3::X, DVec3::NEG_Y, DVec3::Y, DVec3::NEG_Z, DVec3::Z];

/// A point of a surface, carried by a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceSample {
    /// The cell, an index into [`Lattice::cells`].
    pub cell: u32,
    /// The weights of its particles: they add up to one; some are negative where the point is outside the cell.
    pub weights: [f64; 8],
}

/// Returns the samples of a mesh in a lattice, by cell; the mesh is in the grid's coordinates (m).
pub fn surface_samples(mesh: &TriMesh, lattice: &Lattice) -> Vec<SurfaceSample> {
    let mut candidates = Candidates::new(lattice);
    let mut is_used = vec![false; mesh.positions.len()];
    mesh.triangles.iter().flatten().for_each(|vertex| is_used[*vertex as usize] = true);
    for (position, _) in mesh.positions.iter().zip(&is_used).filter(|(_, is_used)| **is_used) {
        candidates.add_vertex(*position);
    }
    for triangle in 0..mesh.triangles.len() {
        candidates.add_between(mesh.corners(triangle));
    }
    candidates.select()
}

/// A point that may be taken.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    cell: u32,
    at: DVec3,
    weights: [f64; 8],
}

/// All points that may be taken.
struct Candidates<'a> {
    lattice: &'a Lattice,
    embedder: Embedder<'a>,
    /// Which cells of the grid are filled.
    cells: Places,
    cell_size: f64,
    points: Vec<Candidate>,
    /// For every cell, the bins in it that hold a point.
    bins: Vec<u64>,
}

impl<'a> Candidates<'a> {
    fn new(lattice: &'a Lattice) -> Self {
        let (cell_size, bins) = (lattice.grid.cell_size, vec![0; lattice.cells.len()]);
        Self { lattice, embedder: Embedder::new(lattice), cells: lattice.places(), cell_size, points: Vec::new(), bins }
    }

    fn add_vertex(&mut self, at: DVec3) {
        let Some(point) = self.candidate(at) else { return };
        self.bins[point.cell as usize] |= bin(&point.weights);
        self.points.push(point);
    }

    /// Adds points of a triangle between its corners, in rows that begin at the corner across from its shortest edge.
    fn add_between(&mut self, corners: [DVec3; 3]) {
        let across = |corner: usize| corners[(corner + 1) % 3].distance(corners[(corner + 2) % 3]);
        let tip = (1..3).fold(0, |least, corner| if across(corner) < across(least) { corner } else { least });
        let [from, one, other] = [0, 1, 2].map(|next| corners[(tip + next) % 3]);
        let rows = self.parts(from.distance(one).max(from.distance(other)));
        for row in 1..=rows {
            let share = f64::from(row) / f64::from(rows);
            let [start, end] = [one, other].map(|corner| from.lerp(corner, share));
            let parts = self.parts(start.distance(end));
            for part in 0..=parts {
                let is_corner = row == rows && (part == 0 || part == parts);
                if !is_corner {
                    self.add_if_bin_is_empty(start.lerp(end, f64::from(part) / f64::from(parts)));
                }
            }
        }
    }

    /// Returns the number of parts into which a length (m) is divided, at least one.
    fn parts(&self, length: f64) -> u32 {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a count of at least one, saturating"
        )]
        let parts = (length / (CANDIDATE_SPACING * self.cell_size)).ceil().max(1.0) as u32;
        parts
    }

    fn add_if_bin_is_empty(&mut self, at: DVec3) {
        let Some(point) = self.candidate(at) else { return };
        let (bins, own) = (&mut self.bins[point.cell as usize], bin(&point.weights));
        if *bins & own == 0 {
            *bins |= own;
            self.points.push(point);
        }
    }

    fn candidate(&self, at: DVec3) -> Option<Candidate> {
        let embedding = self.embedder.embed(at).filter(|embedding| embedding.outside <= MAX_DISTANCE_OUTSIDE)?;
        Some(Candidate { cell: embedding.cell, at, weights: embedding.weights })
    }

    /// Takes points of every cell and returns them by cell.
    fn select(mut self) -> Vec<SurfaceSample> {
        // The sort is stable: within a cell points stay in the mesh's order.
        self.points.sort_by_key(|point| point.cell);
        let least = MIN_SAMPLE_DISTANCE * self.cell_size;
        let (mut samples, mut distance) = (Vec::new(), Vec::new());
        for of_cell in self.points.chunk_by(|one, next| one.cell == next.cell) {
            distance.clear();
            distance.resize(of_cell.len(), f64::INFINITY);
            let outward = outward(self.lattice, &self.cells, of_cell[0].cell);
            let directions = if outward == DVec3::ZERO { &AXES[..] } else { &[outward] };
            let outermost =
                directions.iter().map(|direction| largest(of_cell.iter().map(|point| point.at.dot(*direction))));
            let mut take = |place: usize, distance: &mut [f64]| {
                let Candidate { cell, at, weights } = of_cell[place];
                samples.push(SurfaceSample { cell, weights });
                for (distance, point) in distance.iter_mut().zip(of_cell) {
                    *distance = distance.min(point.at.distance_squared(at));
                }
            };
            let mut count = 0;
            for place in outermost {
                if distance[place] >= least * least {
                    take(place, &mut distance);
                    count += 1;
                }
            }
            while count < MAX_SAMPLES_PER_CELL {
                let place = largest(distance.iter().copied());
                if distance[place] < least * least {
                    break;
                }
                take(place, &mut distance);
                count += 1;
            }
        }
        samples
    }
}

/// Returns the index of the largest number, the first of equal ones.
fn largest(of: impl Iterator<Item = f64>) -> usize {
    let larger = |best: (usize, f64), next: (usize, f64)| if next.1 > best.1 { next } else { best };
    of.enumerate().fold((0, f64::NEG_INFINITY), larger).0
}

/// Returns the way out from the filled cells around a cell; zero if there are as many on either side.
fn outward(lattice: &Lattice, cells: &Places, cell: u32) -> DVec3 {
    let (low, dims) = (lattice.low(cell), lattice.grid.dims);
    let around = (0..27_u32).filter_map(|number| {
        let step = [number % 3, number / 3 % 3, number / 9];
        let next: [u32; 3] = std::array::from_fn(|axis| (low[axis] + step[axis]).wrapping_sub(1));
        let is_there = (0..3).all(|axis| next[axis] < dims[axis]) && cells.contains(lattice.grid.index(next));
        is_there.then(|| DVec3::ONE - DVec3::from_array(step.map(f64::from)))
    });
    around.sum()
}

/// The bin of a cell that a point with these weights is in, as one bit of 64.
fn bin(weights: &[f64; 8]) -> u64 {
    let along = |axis: usize| (0..8).filter(|place| place >> axis & 1 == 1).map(|place| weights[place]).sum::<f64>();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped into the cell")]
    let [x, y, z] = [0, 1, 2].map(|axis| (along(axis) * BINS as f64).clamp(0.0, BINS as f64 - 1.0) as usize);
    1 << (x + BINS * (y + BINS * z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::voxel::Cells;

    /// A cube of cells of 1 m, from −n/2 to n/2.
    fn block(n: u32) -> Lattice {
        Lattice::new(&Cells::cube(n, 1.0).expect("a cube"))
    }

    fn at(lattice: &Lattice, sample: &SurfaceSample) -> DVec3 {
        let particles = lattice.cells[sample.cell as usize];
        particles.iter().zip(sample.weights).map(|(p, weight)| lattice.rest_position(*p as usize) * weight).sum()
    }

    fn box_mesh(half: DVec3) -> TriMesh {
        let positions = (0..8).map(|corner| {
            let sign = |axis: usize| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
            half * DVec3::new(sign(0), sign(1), sign(2))
        });
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        TriMesh { positions: positions.collect(), triangles }
    }

    #[test]
    fn a_box_of_two_triangles_a_side_is_sampled_all_over() {
        let (lattice, half) = (block(4), DVec3::new(1.9, 1.8, 1.7));
        let mesh = box_mesh(half);
        let samples = surface_samples(&mesh, &lattice);
        let places: Vec<DVec3> = samples.iter().map(|sample| at(&lattice, sample)).collect();
        for place in &places {
            let off = (half - place.abs()).min_element();
            assert!(off.abs() < 1e-9, "{place} is on the surface");
        }
        for corner in &mesh.positions {
            assert!(places.iter().any(|place| place.distance(*corner) < 1e-9), "the corner {corner} is taken");
        }
        for of_cell in samples.chunk_by(|a, b| a.cell == b.cell) {
            assert!(of_cell.len() <= MAX_SAMPLES_PER_CELL, "no more than eight");
        }
        assert!(samples.is_sorted_by_key(|sample| sample.cell), "by cell");
        // Nowhere on the surface is far from all of them.
        for (u, v) in (0..50).flat_map(|u| (0..50).map(move |v| (u, v))) {
            let [u, v] = [u, v].map(|n| f64::from(n) / 24.5 - 1.0);
            for spot in [DVec3::new(u, v, 1.0), DVec3::new(u, -1.0, v), DVec3::new(1.0, u, v)] {
                let nearest = places.iter().map(|place| place.distance(spot * half)).fold(f64::INFINITY, f64::min);
                assert!(nearest < 0.6, "{spot} is {nearest} cells from the nearest");
            }
        }
    }

    #[test]
    fn of_many_vertices_in_a_cell_the_outermost_are_taken() {
        let lattice = block(1);
        let mut rng = crate::math::rng::Rng::new(5);
        let mut positions: Vec<DVec3> = (0..3000)
            .map(|_| DVec3::new(rng.between(-0.3, 0.3), rng.between(-0.3, 0.3), rng.between(-0.3, 0.3)))
            .collect();
        positions[1234] = DVec3::new(0.0, -0.45, 0.0);
        let triangles = (0..1000).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
        let samples = surface_samples(&TriMesh { positions, triangles }, &lattice);
        assert_eq!(samples.len(), MAX_SAMPLES_PER_CELL, "eight of 3000");
        let lowest = samples.iter().map(|sample| at(&lattice, sample).y).fold(f64::INFINITY, f64::min);
        assert!((lowest + 0.45).abs() < 1e-12, "the tip is one of them, not {lowest}");
    }

    #[test]
    fn what_no_cell_holds_and_no_triangle_uses_is_left_out() {
        let lattice = block(2);
        let far = DVec3::splat(9.0);
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, far, far + DVec3::X, far + DVec3::Y, DVec3::splat(-0.9)];
        let mesh = TriMesh { positions, triangles: vec![[0, 1, 2], [3, 4, 5]] };
        let samples = surface_samples(&mesh, &lattice);
        assert!(!samples.is_empty(), "the near triangle");
        for sample in &samples {
            let place = at(&lattice, sample);
            assert!(place.z.abs() < 1e-12 && place.x + place.y < 1.0 + 1e-12, "{place} is on it");
        }
        assert_eq!(samples, surface_samples(&mesh, &lattice), "always the same");
    }
}
