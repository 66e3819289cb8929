//! Symmetric systems, sparse and dense: the one place that names the solver library.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::perm::Perm;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Accum, Conj, MatMut, Par, Side};

/// Bytes in a MiB, the unit of every memory limit in this crate. Source: definition, 2^20.
pub(crate) const BYTES_PER_MIB: f64 = 1_048_576.0;

/// Why a system cannot be solved.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SparseError {
    /// The factor would exceed the memory limit.
    #[error("the solver would need {needed_mib:.0} MiB, more than the {limit_mib:.0} MiB allowed")]
    Memory {
        /// Memory of the factor, MiB.
        needed_mib: f64,
        /// The limit, MiB.
        limit_mib: f64,
    },
    /// The matrix is not positive definite.
    #[error("the stiffness is singular: some part can move freely or has no stiffness")]
    Singular,
    /// A stop was asked for.
    #[error(transparent)]
    Interrupted(#[from] grainpath_core::diagnostics::Interrupted),
}

/// A symmetric matrix, its lower half by columns: `rows[starts[j]..starts[j + 1]]` rise from the
/// diagonal `j`.
#[derive(Debug, Clone, Default)]
pub struct Symmetric {
    /// `(n + 1)`
    pub starts: Vec<usize>,
    /// Row of each entry, at or below the diagonal.
    pub rows: Vec<usize>,
    /// Entries.
    pub values: Vec<f64>,
}

impl Symmetric {
    /// Number of rows.
    pub fn n(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// `y = A x`.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.n()];
        for j in 0..self.n() {
            for k in self.starts[j]..self.starts[j + 1] {
                let (i, a) = (self.rows[k], self.values[k]);
                y[i] += a * x[j];
                // Only the lower half is stored; an entry off the diagonal stands for two.
                if i != j {
                    y[j] += a * x[i];
                }
            }
        }
        y
    }
}

/// A factored matrix.
pub struct Cholesky {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
}

impl Cholesky {
    /// Factors a positive definite matrix. `order`, where given, is the order of elimination. The
    /// factor's size is known before memory is taken, and a size above `max_mib` is refused.
    ///
    /// # Errors
    /// [`SparseError`] when the factor would be too large or the matrix is not positive definite.
    pub fn new(a: &Symmetric, order: Option<&[usize]>, max_mib: f64) -> Result<Self, SparseError> {
        let n = a.n();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &a.starts, None, &a.rows);
        // An order of our own comes from the geometry (nested dissection); minimum degree is the
        // fallback.
        let custom = order.map(|forward| {
            let mut inverse = vec![0; n];
            forward.iter().enumerate().for_each(|(k, &i)| inverse[i] = k);
            Perm::new_checked(forward.into(), inverse.into(), n)
        });
        let ordering =
            custom.as_ref().map_or(SymmetricOrdering::Amd, |p| SymmetricOrdering::Custom(p.as_ref()));
        // Column by column: products of dense blocks take the widest vectors that the processor has, and round otherwise
        // on another one. Measured on the tensile bar with a hole, whole run, processor time with blocks and without:
        // 2.3 and 2.1 s on elements of 1 mm, 2.6 and 3.4 s on 0.5 mm, 4.5 and 7.0 s on 0.3 mm.
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SIMPLICIAL,
            ..Default::default()
        };
        // The symbolic step finds the factor's pattern, and with it the memory, without computing a
        // number.
        let symbolic = factorize_symbolic_cholesky(pattern, Side::Lower, ordering, params)
            .map_err(|_| SparseError::Memory { needed_mib: f64::INFINITY, limit_mib: max_mib })?;
        let needed_mib = symbolic.len_val() as f64 * 8.0 / BYTES_PER_MIB;
        if needed_mib > max_mib {
            return Err(SparseError::Memory { needed_mib, limit_mib: max_mib });
        }
        let values = vec![0.0; symbolic.len_val()];
        let mut factor = Self { symbolic, values };
        factor.refactor(a)?;
        Ok(factor)
    }

    /// Factors a matrix with the same pattern and other values.
    ///
    /// # Errors
    /// [`SparseError::Singular`] when the matrix is not positive definite.
    pub fn refactor(&mut self, a: &Symmetric) -> Result<(), SparseError> {
        let pattern = SymbolicSparseColMatRef::new_checked(a.n(), a.n(), &a.starts, None, &a.rows);
        // One thread: the sums of a parallel factorization would depend on the number of threads.
        let scratch = self.symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        self.symbolic
            .factorize_numeric_llt(
                &mut self.values,
                SparseColMatRef::new(pattern, &a.values),
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut MemBuffer::new(scratch)),
                Default::default(),
            )
            .map(|_| ())
            .map_err(|_| SparseError::Singular)
    }

    /// Memory of the factor.
    pub fn bytes(&self) -> usize {
        self.values.len() * size_of::<f64>()
    }

    /// Solves for one right side in place.
    pub fn solve(&self, x: &mut [f64]) {
        let n = x.len();
        let mut x = MatMut::from_column_major_slice_mut(x, n, 1);
        let scratch = self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let factor = LltRef::new(&self.symbolic, &self.values);
        factor.solve_in_place_with_conj(
            Conj::No,
            x.rb_mut(),
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
        );
    }
}

/// Eliminates the first unknowns of a dense symmetric matrix, `(size, size)` by columns, lower
/// half. Their columns become those of the factor; the rest becomes the Schur complement for the
/// other unknowns.
///
/// # Errors
/// [`SparseError::Singular`] when the eliminated part is not positive definite.
pub fn eliminate(whole: &mut [f64], size: usize, first: usize) -> Result<(), SparseError> {
    let matrix = MatMut::from_column_major_slice_mut(whole, size, size);
    let (mut own, _, mut below, rest) = matrix.split_at_mut(first, first);
    let scratch = cholesky_in_place_scratch::<f64>(first, Par::Seq, Default::default());
    let mut scratch = MemBuffer::new(scratch);
    let stack = MemStack::new(&mut scratch);
    cholesky_in_place(own.rb_mut(), Default::default(), Par::Seq, stack, Default::default())
        .map_err(|_| SparseError::Singular)?;
    // L21 = A21 / L11', written as a solve with the transposes.
    solve_lower_triangular_in_place(own.rb(), below.rb_mut().transpose_mut(), Par::Seq);
    // The Schur complement: A22 - L21 L21', lower half.
    matmul(
        rest,
        BlockStructure::TriangularLower,
        Accum::Add,
        below.rb(),
        BlockStructure::Rectangular,
        below.rb().transpose(),
        BlockStructure::Rectangular,
        -1.0,
        Par::Seq,
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_of_springs_is_solved_and_a_loose_one_refused() {
        let n = 50;
        let mut a = Symmetric { starts: vec![0], ..Symmetric::default() };
        for j in 0..n {
            a.rows.push(j);
            a.values.push(2.0);
            if j + 1 < n {
                a.rows.push(j + 1);
                a.values.push(-1.0);
            }
            a.starts.push(a.rows.len());
        }
        let want: Vec<f64> = (0..n).map(|i| ((i * 7) % 11) as f64 - 5.0).collect();
        let mut x = a.times(&want);
        Cholesky::new(&a, None, 1024.0).expect("positive definite").solve(&mut x);
        assert!(x.iter().zip(&want).all(|(x, w)| (x - w).abs() < 1e-10));
        assert!(matches!(Cholesky::new(&a, None, 1e-5), Err(SparseError::Memory { .. })));
        a.values[0] = -1.0;
        assert_eq!(Cholesky::new(&a, None, 1024.0).err(), Some(SparseError::Singular));
    }
}
