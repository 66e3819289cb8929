//! Solves small dense systems with a symmetric positive definite matrix by Cholesky factors, with one rule
//! for rank-deficient matrices.
//!
//! Least-squares fits and coarse levels of solvers lead to such systems. Some are rank deficient: samples
//! on one line, for example, do not determine a plane. The factor leaves out each unknown whose column
//! depends on the columns before it, and the solution is zero there. An unknown is left out if
//! elimination reduces its diagonal entry to `RANK_TOLERANCE` times its original value or less.
//!
//! Storage: row-major, `n * n`, of which the lower triangle is read. Cost: n³ / 6 multiplications
//! for the factor and n² for a solution. Degenerate: an all-zero matrix gives the zero solution. In a
//! matrix that is not positive definite, elimination may make a diagonal entry negative; that unknown is left
//! out too. Entries that are not finite raise no error. An unknown with such an entry on its diagonal is left
//! out, so the caller has to check for them.

/// An unknown is kept if elimination leaves more than this share of its diagonal entry.
///
/// Source: error bound. For normal equations this share, the remainder, is the squared sine of the angle
/// between a column and those before it. Rounding changes it by about n times 2.2e-16 (Higham 2002, theorem
/// 10.3, `higham2002` in docs/references.bib), which is 2e-15 for ten unknowns. A remainder of 1e-9 therefore
/// still has a relative error of only 2e-6.
pub(crate) const RANK_TOLERANCE: f64 = 1e-9;

/// The dot product in four partial sums: in a single sum each addition would wait for the previous
/// one.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    for (a, b) in a.iter().zip(b) {
        (0..4).for_each(|k| sums[k] += a[k] * b[k]);
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// Replaces the lower triangle of `a` (`n * n`, row-major) by its Cholesky factor. The upper triangle is
/// neither read nor changed.
///
/// An unknown that is left out gets a zero on the diagonal of its row.
///
/// # Panics
/// When `a` is shorter than `n * n`.
pub fn cholesky_in_place(a: &mut [f64], n: usize) {
    for i in 0..n {
        let (above, own) = a.split_at_mut(i * n);
        let own = &mut own[..n];
        let whole = own[i];
        // The factor is computed row by row. Each entry needs only finished rows above and its own row, so
        // the factor can replace the matrix in place.
        for j in 0..i {
            let other = &above[j * n..j * n + n];
            let pivot = other[j];
            let sum = own[j] - dot(&own[..j], &other[..j]);
            // A zero pivot marks an unknown that was left out; it must not contribute to
            // this row.
            own[j] = if pivot > 0.0 { sum / pivot } else { 0.0 };
        }
        let rest = whole - dot(&own[..i], &own[..i]);
        own[i] = if rest > RANK_TOLERANCE * whole { rest.sqrt() } else { 0.0 };
    }
}

/// Solves for one right side with the factor of [`cholesky_in_place`]. On entry `x` holds the right side,
/// on return the solution.
///
/// # Panics
/// When `factor` is shorter than `n * n` with `n = x.len()`.
pub fn cholesky_solve(factor: &[f64], x: &mut [f64]) {
    let n = x.len();
    // Forward substitution with the lower triangle, then back substitution with its transpose.
    for i in 0..n {
        let row = &factor[i * n..i * n + i + 1];
        let sum = x[i] - dot(&row[..i], &x[..i]);
        x[i] = if row[i] > 0.0 { sum / row[i] } else { 0.0 };
    }
    for i in (0..n).rev() {
        let row = &factor[i * n..i * n + i + 1];
        x[i] = if row[i] > 0.0 { x[i] / row[i] } else { 0.0 };
        let value = x[i];
        x[..i].iter_mut().zip(row).for_each(|(x, l)| *x -= l * value);
    }
}

/// Solves a small system on the stack for several right sides at once: `matrix` times the result is `right`.
///
/// ```
/// use grainpath_core::dense::solve_spd;
///
/// // Two unknowns, two right sides.
/// let x = solve_spd([[4.0, 2.0], [2.0, 3.0]], [[2.0, 8.0], [-1.0, 8.0]]);
/// assert!((x[0][0] - 1.0).abs() < 1e-12 && (x[1][0] + 1.0).abs() < 1e-12);
/// assert!((x[0][1] - 1.0).abs() < 1e-12 && (x[1][1] - 2.0).abs() < 1e-12);
/// // The second unknown repeats the first: it is left out and stays zero.
/// assert_eq!(solve_spd([[1.0, 1.0], [1.0, 1.0]], [[3.0], [3.0]]), [[3.0], [0.0]]);
/// ```
pub fn solve_spd<const N: usize, const M: usize>(
    mut matrix: [[f64; N]; N],
    mut right: [[f64; M]; N],
) -> [[f64; M]; N] {
    cholesky_in_place(matrix.as_flattened_mut(), N);
    for c in 0..M {
        let mut x: [f64; N] = std::array::from_fn(|i| right[i][c]);
        cholesky_solve(matrix.as_flattened(), &mut x);
        (0..N).for_each(|i| right[i][c] = x[i]);
    }
    right
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Normal equations of rows with a known rank: the fitted values are those of the full
        /// least-squares problem.
        #[test]
        fn fits_of_any_rank_reproduce_what_can_be_fitted(
            rows in prop::collection::vec(prop::array::uniform4(-1.0f64..1.0), 1..9),
            truth in prop::array::uniform4(-1.0f64..1.0),
        ) {
            let (mut m, mut b) = ([[0.0; 4]; 4], [[0.0]; 4]);
            for r in &rows {
                let value: f64 = r.iter().zip(&truth).map(|(a, t)| a * t).sum();
                for i in 0..4 {
                    (0..4).for_each(|j| m[i][j] += r[i] * r[j]);
                    b[i][0] += r[i] * value;
                }
            }
            let x = solve_spd(m, b);
            for r in &rows {
                let wanted: f64 = r.iter().zip(&truth).map(|(a, t)| a * t).sum();
                let found: f64 = (0..4).map(|k| r[k] * x[k][0]).sum();
                // A column that is left out lies within an angle of sqrt(RANK_TOLERANCE) = 3e-5 of those before it.
                prop_assert!((found - wanted).abs() < 1e-3, "{} {}", found, wanted);
            }
        }
    }

    #[test]
    fn zero_rows_and_long_systems() {
        assert_eq!(solve_spd([[0.0; 3]; 3], [[1.0]; 3]), [[0.0]; 3]);
        // A second difference of 30 unknowns: the solution of a constant load is a parabola.
        let n = 30;
        let mut a = vec![0.0; n * n];
        for i in 0..n {
            a[i * n + i] = 2.0;
            if i > 0 {
                a[i * n + i - 1] = -1.0;
            }
        }
        cholesky_in_place(&mut a, n);
        let mut x = vec![1.0; n];
        cholesky_solve(&a, &mut x);
        let wanted = |i: usize| 0.5 * (i + 1) as f64 * (n - i) as f64;
        assert!((0..n).all(|i| (x[i] - wanted(i)).abs() < 1e-9), "{x:?}");
    }
}
