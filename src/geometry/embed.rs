//! Points inside cells: trilinear weights. A point of a mesh moves with the eight particles of one cell. Knows only
//! the lattice at rest.

use std::collections::VecDeque;

use glam::DVec3;
use rayon::prelude::*;

use super::Lattice;
use super::places::Places;

/// No cell of the lattice.
const NO_CELL: u32 = u32::MAX;

/// A point as a mean of the eight particles of a cell: Σ weight · particle. Exact for affine motion, the identity at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Embedding {
    /// The cell, an index into [`Lattice::cells`].
    pub cell: u32,
    /// Its particles.
    pub particles: [u32; 8],
    /// Their weights: they add up to one; where the point is outside the cell some are negative (extrapolation).
    pub weights: [f64; 8],
    /// How far the point lies outside the cell along the worst axis, in cells; 0 inside.
    pub outside: f64,
}

/// How the weights of an embedding change along two tangents of a surface, per metre.
///
/// With `a = Σ along[0] · particle` and `b = Σ along[1] · particle` the deformed normal is the direction of `a × b`: it is
/// the normal at rest under the cofactor matrix of the deformation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalEmbedding {
    /// The weights' derivatives along the first and the second tangent, 1/m.
    pub along: [[f64; 8]; 2],
}

/// Finds the cells of points.
#[derive(Debug)]
pub struct Embedder<'a> {
    lattice: &'a Lattice,
    /// The filled cells.
    cells: Places,
    /// For every cell of the grid a filled cell nearby, as a lattice cell; computed once a point is far from all of them.
    nearby: std::sync::OnceLock<Vec<u32>>,
}

impl<'a> Embedder<'a> {
    /// Prepares the search in a lattice.
    pub fn new(lattice: &'a Lattice) -> Self {
        Self { lattice, cells: lattice.places(), nearby: std::sync::OnceLock::new() }
    }

    /// The embedding of a point given in the grid's coordinates (m): in the filled cell that contains it, else in the
    /// nearest one (of equally near ones the first). Beyond [`SEARCH_REACH`] cells a near one is taken, not the nearest.
    ///
    /// `None` only for a lattice without cells or a point that is not finite.
    pub fn embed(&self, point: DVec3) -> Option<Embedding> {
        let grid = self.lattice.grid;
        let place = (point - grid.origin) / grid.cell_size;
        if !place.is_finite() {
            return None;
        }
        let cell = self.nearest(place)?;
        let particles = self.lattice.cells[cell as usize];
        let low = self.lattice.corners[particles[0] as usize];
        let inner = place - DVec3::from_array(low.map(f64::from));
        let outside = (inner - inner.clamp(DVec3::ZERO, DVec3::ONE)).abs().max_element();
        Some(Embedding { cell, particles, weights: weights(inner), outside })
    }

    /// Embeds many points, in parallel.
    pub fn embed_all(&self, points: &[DVec3]) -> Option<Vec<Embedding>> {
        points.par_iter().map(|&point| self.embed(point)).collect()
    }

    /// Returns the embedding of a unit normal at a point, so that it turns with the point's cell.
    pub fn embed_normal(&self, embedding: &Embedding, point: DVec3, normal: DVec3) -> NormalEmbedding {
        let grid = self.lattice.grid;
        let low = self.lattice.corners[embedding.particles[0] as usize];
        let inner = (point - grid.corner(low)) / grid.cell_size;
        // (a, b, normal) is right-handed: a × b = normal.
        let (a, b) = normal.any_orthonormal_pair();
        let per_metre = 1.0 / grid.cell_size;
        NormalEmbedding { along: [a, b].map(|tangent| weight_derivatives(inner, tangent * per_metre)) }
    }

    /// The nearest filled cell to a point given in cells from the grid's origin.
    fn nearest(&self, place: DVec3) -> Option<u32> {
        let dims = self.lattice.grid.dims;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped into the grid")]
        let home = [0, 1, 2].map(|axis| place[axis].clamp(0.0, f64::from(dims[axis] - 1)) as u32);
        if let Some(cell) = self.cells.number(self.lattice.grid.index(home)) {
            return Some(cell);
        }
        let mut best: Option<(f64, u32)> = None;
        for reach in 1..=SEARCH_REACH {
            // Cells `reach` layers away or more are at least `reach` - 1 from the home cell, and so from the point.
            if best.is_some_and(|(distance, _)| distance < f64::from(reach - 1).powi(2)) {
                break;
            }
            self.search_layer(home, reach, place, &mut best);
        }
        best.map(|(_, cell)| cell).or_else(|| {
            let nearby = self.nearby.get_or_init(|| self.spread());
            Some(nearby[self.lattice.grid.index(home)]).filter(|&cell| cell != NO_CELL)
        })
    }

    /// Looks through the cells exactly `reach` layers around `home`.
    fn search_layer(&self, home: [u32; 3], reach: u32, place: DVec3, best: &mut Option<(f64, u32)>) {
        let dims = self.lattice.grid.dims;
        let range = |axis: usize| home[axis].saturating_sub(reach)..=(home[axis] + reach).min(dims[axis] - 1);
        for (k, j) in range(2).flat_map(|k| range(1).map(move |j| (k, j))) {
            for i in range(0) {
                let cell = [i, j, k];
                if (0..3).all(|axis| home[axis].abs_diff(cell[axis]) < reach) {
                    continue;
                }
                let Some(cell_index) = self.cells.number(self.lattice.grid.index(cell)) else { continue };
                let low = DVec3::from_array(cell.map(f64::from));
                let distance = (place - place.clamp(low, low + DVec3::ONE)).length_squared();
                if best.is_none_or(|(least, _)| distance < least) {
                    *best = Some((distance, cell_index));
                }
            }
        }
    }

    /// Lets filled cells claim the cells around them, layer by layer.
    fn spread(&self) -> Vec<u32> {
        let grid = self.lattice.grid;
        let mut claimed = vec![NO_CELL; grid.len()];
        let mut front: VecDeque<[u32; 3]> = self.cells.iter().map(|place| grid.cell(place)).collect();
        for (number, place) in (0..).zip(self.cells.iter()) {
            claimed[place] = number;
        }
        while let Some(cell) = front.pop_front() {
            let owner = claimed[grid.index(cell)];
            for next in grid.around(cell) {
                let claim = &mut claimed[grid.index(next)];
                if *claim == NO_CELL {
                    *claim = owner;
                    front.push_back(next);
                }
            }
        }
        claimed
    }
}

/// How many layers of cells around a point are searched for the very nearest filled one.
pub const SEARCH_REACH: u32 = 4;

/// The trilinear weights of a point given in the cell's own coordinates, 0..1; bit 0 of the place is x, bit 1 y, bit 2 z.
fn weights(inner: DVec3) -> [f64; 8] {
    let [x, y, z] = [0, 1, 2].map(|axis| [1.0 - inner[axis], inner[axis]]);
    [0, 1, 2, 3, 4, 5, 6, 7].map(|place| x[place & 1] * y[place >> 1 & 1] * z[place >> 2])
}

/// The derivative of the weights along a direction, both in the cell's own coordinates.
fn weight_derivatives(inner: DVec3, direction: DVec3) -> [f64; 8] {
    let [x, y, z] = [0, 1, 2].map(|axis| [1.0 - inner[axis], inner[axis]]);
    let sign = [-1.0, 1.0];
    [0, 1, 2, 3, 4, 5, 6, 7].map(|place| {
        let (i, j, k) = (place & 1, place >> 1 & 1, place >> 2);
        direction.x * sign[i] * y[j] * z[k] + direction.y * x[i] * sign[j] * z[k] + direction.z * x[i] * y[j] * sign[k]
    })
}

#[cfg(test)]
mod tests {
    use glam::DMat3;

    use super::*;
    use crate::geometry::voxel::Cells;
    use crate::math::rng::Rng;

    const U: [[i32; 3]; 7] = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [2, 1, 0], [0, 2, 0], [2, 2, 0]];

    fn lattice(list: &[[i32; 3]], size: f64) -> Lattice {
        Lattice::new(&Cells::from_list(list, size).expect("a small list"))
    }

    fn sum(particles: [u32; 8], weights: [f64; 8], position: impl Fn(usize) -> DVec3) -> DVec3 {
        particles.iter().zip(weights).map(|(&particle, weight)| position(particle as usize) * weight).sum()
    }

    fn points(rng: &mut Rng, reach: f64) -> Vec<DVec3> {
        let mut at = || rng.between(-reach, reach);
        (0..200).map(|_| DVec3::new(at(), at(), at())).collect()
    }

    #[test]
    fn points_inside_and_outside_stay_at_rest_and_follow_affine_motion() {
        let lattice = lattice(&U, 0.4);
        let embedder = Embedder::new(&lattice);
        let stretch = DMat3::from_cols_array(&[1.2, 0.1, 0.0, -0.3, 0.8, 0.2, 0.1, 0.0, 1.5]);
        let moved = |x: DVec3| stretch * x + DVec3::new(3.0, -2.0, 1.0);
        for point in points(&mut Rng::new(1), 1.5) {
            let Embedding { particles, weights, .. } = embedder.embed(point).expect("finite");
            let rest = sum(particles, weights, |particle| lattice.rest_position(particle));
            assert!((rest - point).length() < 1e-12, "identity at rest: {point} became {rest}");
            let after = sum(particles, weights, |particle| moved(lattice.rest_position(particle)));
            assert!((after - moved(point)).length() < 1e-12, "affine motion is exact at {point}");
        }
    }

    #[test]
    fn normals_turn_with_the_cofactors_of_the_motion() {
        let lattice = lattice(&U, 0.4);
        let embedder = Embedder::new(&lattice);
        let mirror_and_shear = DMat3::from_cols_array(&[-1.2, 0.1, 0.0, -0.3, 0.8, 0.2, 0.1, 0.0, 1.5]);
        for motion in [DMat3::IDENTITY, mirror_and_shear] {
            let cofactors = motion.determinant() * motion.inverse().transpose();
            for point in points(&mut Rng::new(2), 0.9) {
                let normal = (point + DVec3::splat(2.0)).normalize();
                let embedding = embedder.embed(point).expect("finite");
                let NormalEmbedding { along } = embedder.embed_normal(&embedding, point, normal);
                let [a, b] = along.map(|weights| {
                    sum(embedding.particles, weights, |particle| motion * lattice.rest_position(particle))
                });
                assert!((a.cross(b) - cofactors * normal).length() < 1e-11, "normal {normal} at {point}");
            }
        }
    }

    #[test]
    fn a_point_takes_the_cell_that_contains_it_or_the_nearest() {
        let lattice = lattice(&[&U[..], &[[14, 2, 0]]].concat(), 1.0);
        let embedder = Embedder::new(&lattice);
        let box_distance = |cell: usize, point: DVec3| {
            let low = lattice.rest_position(lattice.cells[cell][0] as usize);
            (point - point.clamp(low, low + DVec3::ONE)).length()
        };
        for point in points(&mut Rng::new(3), 9.0) {
            let embedding = embedder.embed(point).expect("finite");
            let least = (0..lattice.cells.len()).map(|cell| box_distance(cell, point)).fold(f64::INFINITY, f64::min);
            let found = box_distance(embedding.cell as usize, point);
            // Far from all cells a near one is enough.
            assert!(found <= least + 1e-9 || least > 2.9 && found < 1.5 * least, "{point}: {found} against {least}");
            assert_eq!(embedding.outside == 0.0, found == 0.0, "inside or not, {point}");
        }
    }

    #[test]
    fn what_has_no_place_has_no_embedding() {
        let lattice = lattice(&[[0, 0, 0]], 1.0);
        let embedder = Embedder::new(&lattice);
        assert_eq!(embedder.embed(DVec3::NAN), None, "nowhere");
        assert!(embedder.embed(DVec3::splat(1e9)).is_some(), "far away is somewhere");
        assert_eq!(embedder.embed_all(&[DVec3::ZERO, DVec3::INFINITY]), None, "all or none");
    }
}
