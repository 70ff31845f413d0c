//! The coarsest grid, solved for exactly (Cholesky).

use glam::DVec3;

use super::colours::Colours;
use super::grid::Grid;

/// A pivot below this share of its diagonal is rounding error: only pinned particles belong to its row.
const PIVOT_TOLERANCE: f64 = 1e-12;

/// The factor of a symmetric matrix, by rows: the lower triangle.
#[derive(Clone, Debug)]
pub(super) struct CoarsestSolver {
    factor: Vec<f64>,
    /// The solution, as numbers.
    values: Vec<f64>,
}

impl CoarsestSolver {
    /// Allocates room for a grid of this many corners.
    pub(super) fn new(corners: usize) -> Self {
        let rows = 3 * corners;
        Self { factor: vec![0.0; rows * rows], values: vec![0.0; rows] }
    }

    /// Factorises the matrix of a grid.
    pub(super) fn factorise(&mut self, grid: &Grid) {
        let Self { factor, values } = self;
        let rows = values.len();
        factor.fill(0.0);
        for number in 0..grid.corners.len() {
            for (column, block) in grid.row(number) {
                for (i, j) in (0..9).map(|place| (place / 3, place % 3)) {
                    factor[(3 * number + i) * rows + 3 * column + j] = block.col(j)[i];
                }
            }
        }
        for i in 0..rows {
            let (before, own) = factor.split_at_mut(i * rows);
            for (j, row) in before.chunks(rows).enumerate() {
                own[j] = (own[j] - dot(&own[..j], &row[..j])) * row[j];
            }
            let pivot = own[i] - dot(&own[..i], &own[..i]);
            // The diagonal holds its inverse: zero for a row of pinned particles.
            own[i] = if pivot > PIVOT_TOLERANCE * own[i] { 1.0 / pivot.sqrt() } else { 0.0 };
        }
    }

    /// Writes the solution for the load of a grid.
    pub(super) fn solve(&mut self, grid: &mut Colours) {
        let Self { factor, values } = self;
        let rows = values.len();
        for (number, value) in values.as_chunks_mut().0.iter_mut().enumerate() {
            *value = grid.load(number).to_array();
        }
        for i in 0..rows {
            let row = &factor[i * rows..][..=i];
            values[i] = (values[i] - dot(&row[..i], &values[..i])) * row[i];
        }
        for i in (0..rows).rev() {
            let row = &factor[i * rows..][..=i];
            let (before, own) = values.split_at_mut(i);
            own[0] *= row[i];
            before.iter_mut().zip(row).for_each(|(value, factor)| *value -= factor * own[0]);
        }
        for (number, value) in values.as_chunks().0.iter().enumerate() {
            grid.set_solution(number, DVec3::from_array(*value));
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b)
}
