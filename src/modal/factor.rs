//! Sparse Cholesky factorisation of the matrix, by faer.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use super::ModalError;
use super::stiffness::LowerColumns;

/// The symbolic factorisation: where the entries of the factor will be.
#[derive(Debug)]
pub(super) struct SymbolicFactor {
    symbolic: SymbolicCholesky<usize>,
}

/// The numeric factor.
pub(super) struct Factor {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    /// The workspace of a solve.
    workspace: MemBuffer,
}

impl SymbolicFactor {
    /// Counts the entries of a matrix's factor; unknowns are eliminated in the order of the matrix.
    pub(super) fn of(matrix: &LowerColumns) -> Result<Self, ModalError> {
        // The symbolic factorisation wants the upper half, which has the same entries by rows.
        let upper = upper_pattern(matrix);
        let size = matrix.begins.len() - 1;
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &upper.0, None, &upper.1);
        let (order, settings) = (SymmetricOrdering::Identity, CholeskySymbolicParams::default());
        let symbolic = factorize_symbolic_cholesky(pattern, Side::Upper, order, settings)
            .map_err(|_error| ModalError::Singular)?;
        Ok(Self { symbolic })
    }

    /// The memory of the factor and of the workspace to compute it, bytes.
    pub(super) fn bytes(&self) -> u64 {
        let workspace = self.symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, faer::Spec::default());
        let workspace = workspace.unaligned_bytes_required();
        (self.symbolic.len_val() * size_of::<f64>() + workspace) as u64
    }

    /// Computes the factor; `columns` is the most right-hand sides that are solved for at once.
    pub(super) fn factorise(self, matrix: &LowerColumns, columns: usize) -> Result<Factor, ModalError> {
        let Self { symbolic } = self;
        let size = matrix.begins.len() - 1;
        let mut values = vec![0.0; symbolic.len_val()];
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &matrix.begins, None, &matrix.rows);
        let of = SparseColMatRef::new(pattern, &matrix.values);
        let needed = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, faer::Spec::default());
        let mut workspace = MemBuffer::new(needed);
        symbolic
            .factorize_numeric_llt(
                &mut values,
                of,
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut workspace),
                faer::Spec::default(),
            )
            .map_err(|_error| ModalError::Singular)?;
        let workspace = MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(columns, Par::Seq));
        Ok(Factor { symbolic, values, workspace })
    }
}

impl Factor {
    /// Replaces right-hand sides by solutions.
    pub(super) fn solve(&mut self, right_hand_sides: MatMut<'_, f64>) {
        let factor = LltRef::new(&self.symbolic, &self.values);
        let workspace = MemStack::new(&mut self.workspace);
        factor.solve_in_place_with_conj(Conj::No, right_hand_sides, Par::Seq, workspace);
    }
}

/// The rows of the upper half by columns: the transpose of the lower half.
fn upper_pattern(matrix: &LowerColumns) -> (Vec<usize>, Vec<usize>) {
    let size = matrix.begins.len() - 1;
    let mut begins = vec![0; size + 1];
    for &row in &matrix.rows {
        begins[row + 1] += 1;
    }
    for column in 0..size {
        begins[column + 1] += begins[column];
    }
    let mut next = begins.clone();
    let mut rows = vec![0; matrix.rows.len()];
    for column in 0..size {
        for &row in &matrix.rows[matrix.begins[column]..matrix.begins[column + 1]] {
            rows[next[row]] = column;
            next[row] += 1;
        }
    }
    (begins, rows)
}
