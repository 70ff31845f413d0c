//! The lowest modes by block Lanczos on the inverse (G. Golub, R. Underwood, "The block Lanczos method for computing
//! eigenvalues", 1977; T. Ericsson, A. Ruhe, "The spectral transformation Lanczos method", Math. Comp. 35, 1980), with all
//! vectors kept orthogonal to each other.
//!
//! The eigenvalues of `B = A + σ` are `ω² + σ`, those of `B⁻¹` are `θ = 1/(ω² + σ)`: the lowest frequencies give the largest
//! ones, which are far apart and are found first. A block of vectors finds as many modes of the same frequency as it has
//! vectors; a cube has such modes.
//!
//! ```text
//!   W = B⁻¹ Qⱼ,  less its part in the rigid motions and in all Q;   W = Qⱼ₊₁ R
//!   T = Qᵀ B⁻¹ Q = S Θ Sᵀ     a Ritz vector Q s is wrong by |R s_last|
//! ```

use faer::linalg::matmul::matmul;
use faer::reborrow::Reborrow;
use faer::{Accum, Mat, MatMut, MatRef, Par, Side};
use glam::DVec3;

use super::factor::SymbolicFactor;
use super::stiffness::{LowerColumns, System};
use super::{ModalError, Mode, Modes, Wanted, rigid};
use crate::geometry::Watch;
use crate::math::Real;
use crate::math::rng::Rng;
use crate::physics::BodyModel;

/// Vectors in a block: this many modes of the same frequency are certainly found.
const BLOCK_SIZE: usize = 8;
/// Modes that are found besides those wanted, so that none of the wanted ones is missed.
const EXTRA_MODES: usize = 4;
/// The shift, as a share of the mean of the matrix's diagonal: far below all frequencies, far above rounding.
const SHIFT: f64 = 1e-10;
/// A Ritz vector counts as found when its error is at most this share of its value.
const RITZ_TOLERANCE: f64 = 1e-9;
/// The tolerances of a mode's residual, as shares of its own eigenvalue and of the mean of the diagonal.
const RESIDUAL_TOLERANCES: [f64; 2] = [1e-6, 1e-12];
/// An eigenvalue below this share of the mean of the diagonal is rounding error: the mode has no frequency.
const ZERO_EIGENVALUE: f64 = 1e-13;
/// If no more than this share of a vector is left, it depends on the others.
const DEPENDENCE_TOLERANCE: f64 = 1e-10;
/// The progress when the matrix is assembled, and when it is factorised.
const PROGRESS_ASSEMBLED: f64 = 0.05;
const PROGRESS_FACTORISED: f64 = 0.5;

/// Finds the lowest modes of a compiled body about rest, in the body's own coordinates. `watch` hears of the progress; the
/// factorisation is a single call, so that a cancel during it takes effect at its end.
///
/// # Errors
/// If nothing is free to move, the body falls into many pieces, memory is lacking, or stiffnesses are too far apart.
pub fn modes<R: Real>(body: &BodyModel<R>, wanted: Wanted, watch: &dyn Watch) -> Result<Modes, ModalError> {
    let system = System::of(body);
    if system.size() == 0 {
        return Err(ModalError::NothingFree);
    }
    let rigid = rigid::rigid_motions(&system)?;
    let count = wanted.count.min(system.size() - rigid.ncols());
    report_progress(watch, PROGRESS_ASSEMBLED)?;
    let is_small = system.size() <= max_vectors(count) + rigid.ncols() + 2 * BLOCK_SIZE;
    let (found, bytes) = if is_small {
        solve_dense(&system, rigid.as_ref(), count)?
    } else {
        solve_sparse(&system, rigid.as_ref(), Wanted { count, ..wanted }, watch)?
    };
    let modes = found.into_modes(&system, rigid.ncols(), count, bytes)?;
    watch.progress(1.0);
    Ok(modes)
}

/// Eigenvectors of the system, or approximations, and their eigenvalues.
pub(super) struct EigenPairs {
    /// Orthonormal, ascending by eigenvalue.
    vectors: Mat<f64>,
    /// 1/s².
    pub(super) eigenvalues: Vec<f64>,
}

impl EigenPairs {
    /// Converts to modes, after a check of how well they solve the equations.
    fn into_modes(self, system: &System, rigid: usize, count: usize, bytes: u64) -> Result<Modes, ModalError> {
        let mut image = Mat::zeros(system.size(), self.vectors.ncols());
        let mut vectors = self.vectors;
        system.apply(&vectors.as_mut(), image.as_mut());
        let mut residual: f64 = 0.0;
        let mut modes = Vec::with_capacity(count);
        for (column, &eigenvalue) in self.eigenvalues.iter().enumerate().take(count) {
            let (y, ay) = (vectors.col(column), image.col(column));
            let residual_norm =
                (0..system.size()).map(|row| (ay[row] - eigenvalue * y[row]).powi(2)).sum::<f64>().sqrt();
            let [of_itself, of_all] = RESIDUAL_TOLERANCES;
            if residual_norm > of_itself * eigenvalue + of_all * system.mean_diagonal {
                return Err(ModalError::NotConverged { found: column, asked: count });
            }
            let has_frequency = eigenvalue > ZERO_EIGENVALUE * system.mean_diagonal;
            if has_frequency {
                residual = residual.max(residual_norm / eigenvalue);
            }
            let mut shape = vec![DVec3::ZERO; system.rest.len()];
            for (place, &particle) in system.free.iter().enumerate() {
                let way = DVec3::from([0, 1, 2].map(|axis| y[3 * place + axis]));
                shape[particle as usize] = way * system.inverse_root_mass[place];
            }
            normalise_sign(&mut shape);
            let frequency_hz = if has_frequency { eigenvalue.sqrt() / std::f64::consts::TAU } else { 0.0 };
            modes.push(Mode { frequency_hz, damping: system.damping_power(&shape), shape });
        }
        Ok(Modes { modes, rigid, residual, bytes })
    }
}

/// Chooses the sign of a shape for which its largest component is positive.
fn normalise_sign(shape: &mut [DVec3]) {
    let largest = shape.iter().flat_map(DVec3::to_array).fold(0.0_f64, |most, x| most.max(x.abs()));
    let first = shape.iter().flat_map(DVec3::to_array).find(|x| x.abs() > 0.999 * largest);
    if first.is_some_and(|x| x < 0.0) {
        for way in shape {
            *way = -*way;
        }
    }
}

/// The most vectors that are kept.
fn max_vectors(count: usize) -> usize {
    6 * count + 120
}

fn report_progress(watch: &dyn Watch, done: f64) -> Result<(), ModalError> {
    watch.progress(done);
    if watch.cancelled() { Err(ModalError::Cancelled) } else { Ok(()) }
}

/// Finds all eigenvectors of a small system and keeps the lowest; rigid motions are made the stiffest, so they come last.
pub(super) fn solve_dense(
    system: &System,
    rigid: MatRef<'_, f64>,
    count: usize,
) -> Result<(EigenPairs, u64), ModalError> {
    let LowerColumns { begins, rows, values } = system.matrix(0.0);
    let mut matrix = Mat::zeros(system.size(), system.size());
    for column in 0..system.size() {
        for at in begins[column]..begins[column + 1] {
            matrix[(rows[at], column)] = values[at];
        }
    }
    // No eigenvalue is above the largest sum of a row.
    let mut sums = vec![0.0; system.size()];
    for column in 0..system.size() {
        for at in begins[column]..begins[column + 1] {
            sums[column] += values[at].abs();
            if rows[at] != column {
                sums[rows[at]] += values[at].abs();
            }
        }
    }
    let rigid_shift = 2.0 * sums.into_iter().fold(0.0, f64::max);
    matmul(matrix.as_mut(), Accum::Add, rigid, rigid.transpose(), rigid_shift, Par::Seq);
    let all = matrix.self_adjoint_eigen(Side::Lower).map_err(|_error| ModalError::Singular)?;
    let eigenvalues = (0..count).map(|column| all.S()[column]).collect();
    let bytes = 3 * system.size() * system.size() * size_of::<f64>();
    Ok((EigenPairs { vectors: all.U().subcols(0, count).to_owned(), eigenvalues }, bytes as u64))
}

/// The lowest eigenvectors of a large system.
pub(super) fn solve_sparse(
    system: &System,
    rigid: MatRef<'_, f64>,
    wanted: Wanted,
    watch: &dyn Watch,
) -> Result<(EigenPairs, u64), ModalError> {
    let matrix = system.matrix(SHIFT * system.mean_diagonal);
    let predicted = SymbolicFactor::of(&matrix)?;
    let vector_limit = max_vectors(wanted.count);
    // The matrix, the vectors and what is made of them at the end.
    let of_matrix = matrix.rows.len() * (size_of::<usize>() + size_of::<f64>());
    let of_vectors = (vector_limit + 4 * (wanted.count + EXTRA_MODES)) * system.size() * size_of::<f64>();
    let needed = predicted.bytes() + (of_matrix + of_vectors) as u64;
    if needed > wanted.max_bytes {
        return Err(ModalError::Memory { needed, free: wanted.max_bytes });
    }
    report_progress(watch, 2.0 * PROGRESS_ASSEMBLED)?;
    let kept = wanted.count + EXTRA_MODES;
    let mut factor = predicted.factorise(&matrix, kept.max(BLOCK_SIZE))?;
    drop(matrix);
    let mut space = KrylovSpace::begin(system.size(), rigid);
    loop {
        let done = space.converged as f64 / wanted.count as f64;
        report_progress(watch, PROGRESS_FACTORISED + (0.95 - PROGRESS_FACTORISED) * done.min(1.0))?;
        let mut next = space.newest_block().to_owned();
        factor.solve(next.as_mut());
        if space.extend(next, wanted.count)? {
            break;
        }
        if space.blocks.len() * BLOCK_SIZE > vector_limit {
            return Err(ModalError::NotConverged { found: space.converged, asked: wanted.count });
        }
    }
    // One more product with the inverse takes away what is left of high frequencies.
    let mut vectors = space.ritz_vectors(kept);
    factor.solve(vectors.as_mut());
    drop(factor);
    space.remove_rigid(vectors.as_mut());
    for column in 0..vectors.ncols() {
        let (before, mut rest) = vectors.as_mut().split_at_col_mut(column);
        let mut own = rest.as_mut().subcols_mut(0, 1);
        project_out(before.rb(), own.as_mut());
        normalise(own.as_mut());
    }
    let mut image = Mat::zeros(system.size(), vectors.ncols());
    system.apply(&vectors.as_mut(), image.as_mut());
    let small = vectors.transpose() * &image;
    let turned = small.self_adjoint_eigen(Side::Lower).map_err(|_error| ModalError::Singular)?;
    let eigenvalues = (0..vectors.ncols()).map(|column| turned.S()[column]).collect();
    Ok((EigenPairs { vectors: &vectors * turned.U(), eigenvalues }, needed))
}

/// The Krylov space that is searched.
struct KrylovSpace<'a> {
    rigid: MatRef<'a, f64>,
    /// Orthonormal vectors, a block after another; the last block is yet to be multiplied by the inverse.
    blocks: Vec<Mat<f64>>,
    /// The upper half of the inverse in that space.
    small: Mat<f64>,
    /// The Ritz vectors in that space, by ascending value.
    ritz_coordinates: Mat<f64>,
    /// Modes that are certain.
    converged: usize,
    rng: Rng,
}

impl<'a> KrylovSpace<'a> {
    fn begin(size: usize, rigid: MatRef<'a, f64>) -> Self {
        let (rng, none) = (Rng::new(1), Mat::zeros(0, 0));
        let mut space =
            Self { rigid, blocks: Vec::new(), small: none.clone(), ritz_coordinates: none, converged: 0, rng };
        let rng = &mut space.rng;
        let mut first = Mat::from_fn(size, BLOCK_SIZE, |_, _| rng.between(-1.0, 1.0));
        space.remove_rigid(first.as_mut());
        space.orthonormalise(&mut first);
        space.blocks.push(first);
        space
    }

    fn newest_block(&self) -> MatRef<'_, f64> {
        self.blocks.last().map_or(self.rigid, Mat::as_ref)
    }

    fn remove_rigid(&self, mut of: MatMut<'_, f64>) {
        for _ in 0..2 {
            project_out(self.rigid, of.as_mut());
        }
    }

    /// Adds `next`, the inverse times the newest block, to the space. Returns whether enough modes are certain.
    fn extend(&mut self, mut next: Mat<f64>, wanted: usize) -> Result<bool, ModalError> {
        let order = self.blocks.len() * BLOCK_SIZE;
        let mut small = Mat::zeros(order, order);
        let before = order - BLOCK_SIZE;
        small.as_mut().submatrix_mut(0, 0, before, before).copy_from(&self.small);
        for _ in 0..2 {
            project_out(self.rigid, next.as_mut());
            for (number, block) in self.blocks.iter().enumerate() {
                let along = block.transpose() * &next;
                matmul(next.as_mut(), Accum::Add, block, &along, -1.0, Par::Seq);
                let mut entry = small.as_mut().submatrix_mut(number * BLOCK_SIZE, before, BLOCK_SIZE, BLOCK_SIZE);
                entry += &along;
            }
        }
        self.small = small;
        let remainder = self.orthonormalise(&mut next);
        let ritz = self.small.self_adjoint_eigen(Side::Upper).map_err(|_error| ModalError::Singular)?;
        let last = ritz.U().submatrix(before, 0, BLOCK_SIZE, order);
        let errors = &remainder * last;
        let is_found = |from_top: &usize| {
            let column = order - 1 - from_top;
            errors.col(column).norm_l2() <= RITZ_TOLERANCE * ritz.S()[column]
        };
        let checked = (wanted + EXTRA_MODES).min(order);
        self.converged = (0..checked).take_while(is_found).count();
        self.ritz_coordinates = ritz.U().to_owned();
        if self.converged >= wanted + EXTRA_MODES {
            return Ok(true);
        }
        self.blocks.push(next);
        Ok(false)
    }

    /// The Ritz vectors of the largest values.
    fn ritz_vectors(&self, count: usize) -> Mat<f64> {
        let order = self.ritz_coordinates.nrows();
        let chosen = self.ritz_coordinates.as_ref().subcols(order - count, count);
        let size = self.newest_block().nrows();
        let mut vectors = Mat::zeros(size, count);
        for (number, block) in self.blocks.iter().take(order / BLOCK_SIZE).enumerate() {
            let weights = chosen.submatrix(number * BLOCK_SIZE, 0, BLOCK_SIZE, count);
            matmul(vectors.as_mut(), Accum::Add, block, weights, 1.0, Par::Seq);
        }
        vectors
    }

    /// Makes the columns of a block orthonormal. The block as it was is the new one times the returned upper triangle. A
    /// column that depends on the others is replaced by a random one.
    fn orthonormalise(&mut self, block: &mut Mat<f64>) -> Mat<f64> {
        let mut triangle = Mat::zeros(BLOCK_SIZE, BLOCK_SIZE);
        for column in 0..BLOCK_SIZE {
            let (before, mut rest) = block.as_mut().split_at_col_mut(column);
            let mut own = rest.as_mut().subcols_mut(0, 1);
            let whole = own.norm_l2();
            for _ in 0..2 {
                let along = before.rb().transpose() * own.rb();
                matmul(own.as_mut(), Accum::Add, before.rb(), &along, -1.0, Par::Seq);
                for row in 0..column {
                    triangle[(row, column)] += along[(row, 0)];
                }
            }
            let left = own.norm_l2();
            if left > DEPENDENCE_TOLERANCE * whole {
                triangle[(column, column)] = left;
            } else {
                for row in 0..own.nrows() {
                    own[(row, 0)] = self.rng.between(-1.0, 1.0);
                }
                for _ in 0..2 {
                    project_out(self.rigid, own.as_mut());
                    self.blocks.iter().for_each(|other| project_out(other.as_ref(), own.as_mut()));
                    project_out(before.rb(), own.as_mut());
                }
            }
            normalise(own);
        }
        triangle
    }
}

/// Removes the part of vectors that lies in an orthonormal basis.
fn project_out(basis: MatRef<'_, f64>, mut of: MatMut<'_, f64>) {
    if basis.ncols() > 0 {
        let along = basis.transpose() * of.rb();
        matmul(of.as_mut(), Accum::Add, basis, &along, -1.0, Par::Seq);
    }
}

/// Scales a vector to length 1.
fn normalise(mut vector: MatMut<'_, f64>) {
    let length = vector.norm_l2();
    for row in 0..vector.nrows() {
        vector[(row, 0)] /= length;
    }
}
