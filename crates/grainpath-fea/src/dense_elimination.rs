//! Elimination of the first unknowns of a dense symmetric matrix, as needed for a front of a multifrontal factorization.
//!
//! Method: Cholesky's factorization by blocks of columns (`golub2013` in docs/references.bib, section 4.2). A block is
//! factored column by column. Then the product of two thin matrices is subtracted from the columns after it. The product
//! is computed in tiles that stay in the processor's registers, from a copy of the block in the order in which it is
//! read (`goto2008`).
//!
//! Each entry is a sum over the columns of a block, from the first to the last, with one rounding for each product and
//! each sum. A processor with wider vectors computes more entries at once, but rounds each in the same way, so the
//! result has the same bits on every processor.
//!
//! Cost: for `n` unknowns of which `m` are eliminated, `m n^2` products and sums at most, and a copy of one block. With
//! vectors of 256 bits, fronts of 60 to 1000 unknowns take 1.0 to 1.4 times as long as with a library (faer 0.24) that uses
//! fused multiply-add where the processor has it. The whole strength test of a plate takes equally long with both (10.5 and
//! 10.7 s of processor time). Vectors of 512 bits, where the processor has them, lower the part of elimination in a test that
//! takes 13 to 14 s of processor time from 2.5 to 2.1 s.

use multiversion::multiversion;

use crate::sparse::SparseError;

/// Columns of a block. Measured: elimination of 200 of 600 unknowns takes 1.70, 1.56 and 1.64 ms with 16, 32 and 64.
const BLOCK: usize = 32;
/// Rows and columns of a tile. Source: derived. Its entries fill eight of the sixteen registers, which hold four
/// numbers each; the other eight are left for the operands.
const TILE: [usize; 2] = [8, 4];

/// Eliminates the first unknowns of a dense symmetric matrix, `(size, size)` by columns, lower half. Their columns become
/// those of the factor; the rest becomes the Schur complement for the other unknowns. Entries above the diagonal are
/// overwritten.
///
/// # Errors
/// [`SparseError::Singular`] when the eliminated part is not positive definite.
#[multiversion(targets("x86_64+avx512f", "x86_64+avx2"))]
pub(crate) fn eliminate(whole: &mut [f64], size: usize, first: usize) -> Result<(), SparseError> {
    let mut copy = Vec::new();
    for start in (0..first).step_by(BLOCK) {
        let end = first.min(start + BLOCK);
        factor_block(whole, size, start, end)?;
        copy_rows(whole, size, start, end, &mut copy);
        subtract_products(whole, size, end, &copy, end - start);
    }
    Ok(())
}

/// Factors the columns of a block, down to the last row.
#[inline(always)]
fn factor_block(whole: &mut [f64], size: usize, start: usize, end: usize) -> Result<(), SparseError> {
    for j in start..end {
        // Only columns of this block are still to be subtracted: earlier blocks were subtracted when they were finished.
        let (before, own) = whole.split_at_mut(j * size);
        let own = &mut own[j..size];
        for column in before[start * size..].chunks_exact(size) {
            let factor = column[j];
            own.iter_mut().zip(&column[j..]).for_each(|(x, l)| *x -= factor * l);
        }
        // A pivot that is NaN is refused as well.
        if own[0].is_nan() || own[0] <= 0.0 {
            return Err(SparseError::Singular);
        }
        let pivot = own[0].sqrt();
        own[0] = pivot;
        let inverse = pivot.recip();
        own[1..].iter_mut().for_each(|x| *x *= inverse);
    }
    Ok(())
}

/// Copies the rows below a block into strips of `TILE[0]` rows, each stored column by column. The last strip is filled
/// up with rows of zeros.
#[inline(always)]
fn copy_rows(whole: &[f64], size: usize, start: usize, end: usize, copy: &mut Vec<f64>) {
    let (n_rows, n_columns) = (size - end, end - start);
    copy.clear();
    // With rows of zeros, tiles at the border need no separate case.
    copy.resize(n_rows.div_ceil(TILE[0]) * TILE[0] * n_columns, 0.0);
    for (p, column) in whole[start * size..end * size].chunks_exact(size).enumerate() {
        for (strip, rows) in column[end..].chunks(TILE[0]).enumerate() {
            let to = (strip * n_columns + p) * TILE[0];
            copy[to..to + rows.len()].copy_from_slice(rows);
        }
    }
}

/// Subtracts from the lower half of the columns after a block the products of the block's rows.
#[inline(always)]
fn subtract_products(whole: &mut [f64], size: usize, end: usize, copy: &[f64], n_columns: usize) {
    let strip = |k: usize| &copy[k * n_columns * TILE[0]..(k + 1) * n_columns * TILE[0]];
    for first_column in (end..size).step_by(TILE[1]) {
        let columns = &mut whole[first_column * size..size.min(first_column + TILE[1]) * size];
        let (own, offset) = ((first_column - end) / TILE[0], (first_column - end) % TILE[0]);
        // Only the lower half is computed: strips above the diagonal are left out.
        for k in own..(size - end).div_ceil(TILE[0]) {
            // A tile on the diagonal also writes above the diagonal, where nothing is read.
            let tile = products(strip(k), strip(own), offset);
            let first_row = end + k * TILE[0];
            for (column, products) in columns.chunks_exact_mut(size).zip(&tile) {
                column[first_row..].iter_mut().zip(products).for_each(|(x, product)| *x -= product);
            }
        }
    }
}

/// Products of the rows of a strip with `TILE[1]` rows of another one, summed over the columns.
#[inline(always)]
fn products(rows: &[f64], others: &[f64], offset: usize) -> [[f64; TILE[0]]; TILE[1]] {
    // The sums stay in registers over the whole block; each runs from the first column to the last.
    let mut sums = [[0.0; TILE[0]]; TILE[1]];
    let (rows, _) = rows.as_chunks::<{ TILE[0] }>();
    let (others, _) = others.as_chunks::<{ TILE[0] }>();
    for (row, other) in rows.iter().zip(others) {
        for c in 0..TILE[1] {
            for r in 0..TILE[0] {
                sums[c][r] += row[r] * other[offset + c];
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A positive definite matrix by columns.
    fn matrix(size: usize) -> Vec<f64> {
        let entry = |i: usize, j: usize| {
            let waves = ((i * 7 + j * 7) % 13) as f64 / 13.0 + ((i * j) % 5) as f64 / 5.0;
            waves + if i == j { 3.0 * size as f64 } else { 0.0 }
        };
        (0..size * size).map(|k| entry(k % size, k / size)).collect()
    }

    #[test]
    fn the_factor_and_the_complement_give_the_matrix_back() {
        for (size, first) in [(1, 1), (5, 2), (8, 8), (31, 9), (64, 33), (75, 70), (130, 64), (131, 97)] {
            let want = matrix(size);
            let mut found = want.clone();
            eliminate(&mut found, size, first).expect("positive definite");
            for j in 0..size {
                for i in j..size {
                    let products = (0..first.min(j + 1)).map(|p| found[p * size + i] * found[p * size + j]);
                    let complement = if j >= first { found[j * size + i] } else { 0.0 };
                    let sum = products.sum::<f64>() + complement;
                    let off = (sum - want[j * size + i]).abs();
                    assert!(off < 1e-12 * 3.0 * size as f64, "{size} {first}: {i}, {j}: {off:.1e}");
                }
            }
        }
    }

    #[test]
    fn every_processor_rounds_the_same_way() {
        let (size, first) = (200, 90);
        let mut found = matrix(size);
        eliminate(&mut found, size, first).expect("positive definite");
        // The same sums one after the other.
        let mut want = matrix(size);
        for start in (0..first).step_by(BLOCK) {
            let end = first.min(start + BLOCK);
            factor_block(&mut want, size, start, end).expect("positive definite");
            for j in end..size {
                for i in j..size {
                    let sum = (start..end).fold(0.0, |sum, p| sum + want[p * size + i] * want[p * size + j]);
                    want[j * size + i] -= sum;
                }
            }
        }
        for j in 0..size {
            assert_eq!(found[j * size + j..(j + 1) * size], want[j * size + j..(j + 1) * size], "column {j}");
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_is_refused() {
        for wrong in [-1.0, 0.0, f64::NAN] {
            let mut a = matrix(40);
            a[35 * 40 + 35] = wrong;
            assert_eq!(eliminate(&mut a, 40, 36), Err(SparseError::Singular), "{wrong}");
        }
    }
}
