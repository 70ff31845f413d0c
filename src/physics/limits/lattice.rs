//! The largest eigenvalue of a lattice of equal cells as a share of that of one cell.
//!
//! Cells that meet hold each other back: the largest eigenvalue of a body is below that of its stiffest cell (`cells`), in a
//! block by a third. If all cells are alike, both are that of one cell times a number that depends on the lattice alone. So
//! their ratio is the same for every solid: it is computed once for a lattice, by Lanczos' method (Golub and Van Loan,
//! *Matrix Computations*, §10.1) on cells of unit mass and diagonal.
//!
//! The method's largest value θ is below the eigenvalue λ. From a start that is drawn evenly from all directions, after k
//! steps on n numbers, `λ (1 − ε) ≤ θ` fails with a probability of at most
//!
//! ```text
//! 1.648 √n exp(−√ε (2k − 1))
//! ```
//!
//! (Kuczyński and Woźniakowski, *Estimating the largest eigenvalue by the power and Lanczos algorithms with a random start*,
//! SIAM J. Matrix Anal. Appl. 13(4), 1992). `θ/(1 − ε)` is the bound, with the ε that belongs to [`FAILURE_PROBABILITY`].
//! The vectors are not orthogonalised again, as they stay orthogonal until θ is exact (Paige 1971). The start and the order
//! of all sums are fixed: the same lattice gives the same bits.

use super::cells::{SIZE, largest_eigenvalue, unit_cell};
use crate::geometry::Lattice;
use crate::math::rng::Rng;
use crate::physics::model::levels::StiffnessLevels;

/// Lanczos steps: ε is then 2 % for some thousand particles, which costs 1 % of a step's length.
const LANCZOS_STEPS: usize = 60;

/// The largest probability of a bound that is too low, over all starts.
const FAILURE_PROBABILITY: f64 = 1e-6;

/// Lattices of more cells keep the bound of one cell: at some ten microseconds a cell, as long as a few hundred substeps of
/// the body, the method would keep the user waiting.
const MAX_CELLS: usize = 20_000;

/// Returns the largest eigenvalue of a lattice of equal cells over that of one of them, at most 1. `constants` are those of
/// the cells' edges and diagonals; only their ratio matters.
pub(in crate::physics) fn load_share(lattice: &Lattice, constants: [f64; 2]) -> f64 {
    if lattice.cells.len() > MAX_CELLS { 1.0 } else { share(lattice, constants, LANCZOS_STEPS) }
}

fn share(lattice: &Lattice, constants: [f64; 2], steps: usize) -> f64 {
    let cell = unit_cell(constants);
    let numbers = 3.0 * lattice.corners.len() as f64;
    let root = libm::log(1.648 * numbers.sqrt() / FAILURE_PROBABILITY) / (2 * steps - 1) as f64;
    // An eighth of a cell's mass is at each of its corners.
    let alone = 8.0 * largest_eigenvalue(cell);
    let least = largest_ritz_value(&Weighted::of(lattice, &cell), steps) / alone;
    if root < 1.0 { (least / (1.0 - root * root)).min(1.0) } else { 1.0 }
}

/// `M^-½ K M^-½` of equal cells of unit mass.
struct Weighted<'a> {
    lattice: &'a Lattice,
    /// The matrix of one cell by columns; it is symmetric.
    cell: &'a [[f64; SIZE]; SIZE],
    /// The stiffness of the cells relative to a full one.
    levels: Option<StiffnessLevels>,
    /// One over the root of every particle's mass.
    inverse_roots: Vec<f64>,
}

impl<'a> Weighted<'a> {
    fn of(lattice: &'a Lattice, cell: &'a [[f64; SIZE]; SIZE]) -> Self {
        let mut cells = vec![0.0; lattice.corners.len()];
        for (number, corners) in lattice.cells.iter().enumerate() {
            let share = lattice.share(number);
            for &corner in corners {
                cells[corner as usize] += share;
            }
        }
        let inverse_roots = cells.iter().map(|&cells: &f64| (8.0 / cells).sqrt()).collect();
        Self { lattice, cell, levels: StiffnessLevels::of(lattice), inverse_roots }
    }

    fn apply(&self, v: &[[f64; 3]], out: &mut [[f64; 3]]) {
        out.fill([0.0; 3]);
        for (number, corners) in self.lattice.cells.iter().enumerate() {
            let mut sum = [0.0; SIZE];
            let stiffness = self.levels.as_ref().map_or(1.0, |levels| levels.stiffness(number));
            for (corner, columns) in corners.iter().zip(self.cell.chunks_exact(3)) {
                let at = *corner as usize;
                for (x, column) in v[at].iter().zip(columns) {
                    let x = x * self.inverse_roots[at] * stiffness;
                    for (sum, entry) in sum.iter_mut().zip(column) {
                        *sum += entry * x;
                    }
                }
            }
            for (corner, sums) in corners.iter().zip(sum.chunks_exact(3)) {
                let at = *corner as usize;
                for (out, sum) in out[at].iter_mut().zip(sums) {
                    *out += sum * self.inverse_roots[at];
                }
            }
        }
    }
}

fn largest_ritz_value(matrix: &Weighted<'_>, steps: usize) -> f64 {
    let mut v = random_direction(matrix.inverse_roots.len());
    let (mut before, mut next) = (vec![[0.0; 3]; v.len()], vec![[0.0; 3]; v.len()]);
    let (mut diagonal, mut off_diagonal) = (Vec::new(), Vec::new());
    let mut beta = 0.0;
    for _ in 0..steps {
        matrix.apply(&v, &mut next);
        let alpha = dot(&next, &v);
        for ((next, v), before) in next.iter_mut().zip(&v).zip(&before) {
            for axis in 0..3 {
                next[axis] -= alpha * v[axis] + beta * before[axis];
            }
        }
        diagonal.push(alpha);
        beta = dot(&next, &next).sqrt();
        if beta <= 1e-10 * alpha {
            // All eigenvectors with a part in the start have been found.
            break;
        }
        off_diagonal.push(beta);
        scale(&mut next, 1.0 / beta);
        // The oldest vector is overwritten next.
        std::mem::swap(&mut before, &mut v);
        std::mem::swap(&mut v, &mut next);
    }
    largest_of_tridiagonal(&diagonal, &off_diagonal)
}

/// Returns a vector of unit length, drawn evenly from all directions: normal deviates (Box and Muller 1958) for every
/// component.
fn random_direction(particles: usize) -> Vec<[f64; 3]> {
    let mut rng = Rng::new(1);
    let mut deviate = || {
        let (radius, turn) = ((-2.0 * libm::log(1.0 - rng.unit())).sqrt(), rng.unit());
        radius * libm::cos(std::f64::consts::TAU * turn)
    };
    let mut v: Vec<[f64; 3]> = (0..particles).map(|_| [0; 3].map(|_| deviate())).collect();
    let length = dot(&v, &v).sqrt();
    scale(&mut v, 1.0 / length);
    v
}

fn dot(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    a.iter().zip(b).map(|([ax, ay, az], [bx, by, bz])| ax * bx + ay * by + az * bz).sum()
}

fn scale(v: &mut [[f64; 3]], factor: f64) {
    for x in v.iter_mut().flatten() {
        *x *= factor;
    }
}

/// Returns the largest eigenvalue of a tridiagonal matrix by bisection: above all eigenvalues every pivot of the matrix less
/// the value is negative.
fn largest_of_tridiagonal(diagonal: &[f64], off_diagonal: &[f64]) -> f64 {
    let is_above_all = |x: f64| {
        let mut pivot = 1.0;
        diagonal.iter().enumerate().all(|(row, alpha)| {
            let beta = row.checked_sub(1).map_or(0.0, |above| off_diagonal[above]);
            pivot = alpha - x - beta * beta / pivot;
            pivot < 0.0
        })
    };
    let mut low = diagonal.iter().copied().fold(0.0, f64::max);
    let mut high = low + 2.0 * off_diagonal.iter().copied().fold(0.0, f64::max);
    while high - low > 1e-9 * high {
        let middle = 0.5 * (low + high);
        if is_above_all(middle) { high = middle } else { low = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::voxel::Cells;

    /// The constants of an isotropic solid.
    const SOLID: [f64; 2] = [2.246_71, 1.0];

    fn block(n: [i32; 3], keep: impl Fn([i32; 3]) -> bool) -> Lattice {
        let [x, y, z] = n;
        let all = (0..x).flat_map(|x| (0..y).flat_map(move |y| (0..z).map(move |z| [x, y, z])));
        let list: Vec<[i32; 3]> = all.filter(|&cell| keep(cell)).collect();
        Lattice::new(&Cells::from_list(&list, 0.3).expect("cells"))
    }

    /// Returns what many more steps find, with no ε added.
    fn exact(lattice: &Lattice) -> f64 {
        let cell = unit_cell(SOLID);
        largest_ritz_value(&Weighted::of(lattice, &cell), 400) / (8.0 * largest_eigenvalue(cell))
    }

    #[test]
    fn one_cell_bears_all_of_it() {
        let one = block([1; 3], |_| true);
        assert!((exact(&one) - 1.0).abs() < 1e-8, "{}", exact(&one));
        assert!(load_share(&one, SOLID) >= 1.0 - 1e-8, "{}", load_share(&one, SOLID));
    }

    #[test]
    fn the_share_is_never_below_that_of_the_lattice_and_near_it() {
        let mut rng = Rng::new(8);
        let mut excess = Vec::new();
        for _ in 0..40 {
            let n = [0; 3].map(|_| 1 + i32::try_from(rng.next_u64() % 7).expect("small"));
            let holes = if rng.unit() < 0.5 { 0.0 } else { rng.between(0.0, 0.8) };
            let kept: Vec<bool> = (0..512).map(|_| rng.unit() >= holes).collect();
            let lattice =
                block(n, |[x, y, z]| kept[usize::try_from(64 * x + 8 * y + z).expect("small")] || x + y + z == 0);
            let (share, exact) = (load_share(&lattice, SOLID), exact(&lattice));
            assert!(share >= exact * (1.0 - 1e-9) && share <= 1.0, "{share} of {exact}: {n:?}, holes {holes}");
            excess.push(share / exact);
        }
        excess.sort_by(f64::total_cmp);
        assert!(excess[20] < 1.03, "the median is near: {}", excess[20]);
    }

    #[test]
    fn few_steps_find_too_little_and_are_given_what_they_may_have_missed() {
        let lattice = block([6; 3], |_| true);
        let cell = unit_cell(SOLID);
        let found = largest_ritz_value(&Weighted::of(&lattice, &cell), 8) / (8.0 * largest_eigenvalue(cell));
        assert!(found < 0.995 * exact(&lattice), "as it stands it would be too low: {found}");
        assert!(share(&lattice, SOLID, 8) > exact(&lattice), "{}", share(&lattice, SOLID, 8));
    }

    #[test]
    fn a_large_lattice_keeps_the_bound_of_its_cells() {
        let large = block([28; 3], |_| true);
        assert!(large.cells.len() > MAX_CELLS, "{}", large.cells.len());
        assert!(load_share(&large, SOLID) >= 1.0, "not looked at");
    }
}
