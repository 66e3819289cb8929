//! Solves symmetric positive definite systems with few entries a row, by Cholesky factors stored by columns.
//!
//! Method: the unknowns are ordered so that the factor stays sparse, by the caller (nested dissection of a mesh) or by
//! approximate minimum degree (`amestoy1996` in docs/references.bib). The elimination tree gives the pattern of the factor
//! `L L'` before a number is computed (`liu1990`), and with it the memory. Row `k` of the factor is the solution of a
//! triangular system with the rows above it, whose entries are found by walking up the tree (`davis2006`, chapter 4).
//!
//! Every sum is made in one order, with one rounding for each product and each sum, so that the result has the same bits
//! on every processor and for any number of threads. Cost for a plane mesh of n nodes: n log n entries and n^1.5
//! products. A matrix that is not positive definite is an error: the part can move freely.

/// Bytes in a MiB, the unit of every memory limit in this crate. Source: definition, 2^20.
pub(crate) const BYTES_PER_MIB: f64 = 1_048_576.0;
/// Bytes of an entry of the factor: its value and its row.
const BYTES_PER_ENTRY: usize = size_of::<f64>() + size_of::<u32>();

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

/// A symmetric matrix; its lower triangle is stored by columns. The rows of column `j`,
/// `rows[starts[j]..starts[j + 1]]`, are ascending from the diagonal.
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
    /// The unknown that is eliminated at each place, `(n)`.
    order: Vec<u32>,
    /// The elimination tree: for each column the row of its first entry below the diagonal, `(n)`; [`NO_PARENT`] for
    /// roots.
    parents: Vec<u32>,
    /// Columns of the factor, `(n + 1)`.
    starts: Vec<usize>,
    /// Row of each entry of the factor, rising from the diagonal.
    rows: Vec<u32>,
    values: Vec<f64>,
}

const NO_PARENT: u32 = u32::MAX;

impl Cholesky {
    /// Factors a positive definite matrix. `order`, where given, is the order of elimination. The
    /// size of the factor is known before memory is allocated; a size above `max_mib` is an error.
    ///
    /// # Errors
    /// [`SparseError`] when the factor would be too large or the matrix is not positive definite.
    pub fn new(a: &Symmetric, order: Option<&[usize]>, max_mib: f64) -> Result<Self, SparseError> {
        let n = a.n();
        // Row numbers have 32 bits; a matrix with more rows does not fit into any memory limit.
        if n >= NO_PARENT as usize {
            return Err(SparseError::Memory { needed_mib: f64::INFINITY, limit_mib: max_mib });
        }
        let order: Vec<u32> = match order {
            Some(order) => order.iter().map(|&i| i as u32).collect(),
            None => minimum_degree(a),
        };
        let mut place = vec![0; n];
        order.iter().enumerate().for_each(|(k, &i)| place[i as usize] = k as u32);
        let above = Above::new(a, &place);
        let (parents, counts) = above.tree_and_counts();
        let n_values: usize = counts.iter().sum();
        let needed_mib = (n_values * BYTES_PER_ENTRY) as f64 / BYTES_PER_MIB;
        if needed_mib > max_mib {
            return Err(SparseError::Memory { needed_mib, limit_mib: max_mib });
        }
        let starts = running_sums(&counts);
        let rows = above.rows_of_factor(&parents, &starts);
        let mut factor = Self { order, parents, starts, rows, values: vec![0.0; n_values] };
        factor.compute(&above)?;
        Ok(factor)
    }

    /// Computes the entries of the factor, row by row.
    fn compute(&mut self, above: &Above) -> Result<(), SparseError> {
        let n = self.order.len();
        let mut next: Vec<usize> = self.starts[..n].iter().map(|start| start + 1).collect();
        let mut walk = TreeWalk::new(n);
        let mut x = vec![0.0; n];
        for k in 0..n {
            for entry in above.column(k) {
                x[above.rows[entry] as usize] = above.values[entry];
            }
            let mut pivot = std::mem::take(&mut x[k]);
            // A column comes before its ancestors in the tree, so `x[j]` is final when column `j` is processed.
            for &j in walk.reach(above, &self.parents, k) {
                let (start, end) = (self.starts[j as usize], next[j as usize]);
                let value = std::mem::take(&mut x[j as usize]) * self.values[start].recip();
                // Entries below row `k` are not computed yet. `end` is the position of the entry in row `k`.
                for (&i, &entry) in self.rows[start + 1..end].iter().zip(&self.values[start + 1..end]) {
                    x[i as usize] -= entry * value;
                }
                pivot -= value * value;
                self.values[end] = value;
                next[j as usize] += 1;
            }
            // A pivot that is NaN is an error as well.
            if pivot.is_nan() || pivot <= 0.0 {
                return Err(SparseError::Singular);
            }
            self.values[self.starts[k]] = pivot.sqrt();
        }
        Ok(())
    }

    /// Memory of the factor: of its values and their rows, bytes.
    pub fn bytes(&self) -> usize {
        self.values.len() * BYTES_PER_ENTRY
    }

    /// Solves for one right-hand side in place.
    pub fn solve(&self, x: &mut [f64]) {
        let column = |j: usize| {
            let range = self.starts[j] + 1..self.starts[j + 1];
            (self.values[self.starts[j]].recip(), &self.rows[range.clone()], &self.values[range])
        };
        let mut y: Vec<f64> = self.order.iter().map(|&i| x[i as usize]).collect();
        // Forward substitution uses the columns of `L`, back substitution the same columns as rows of its transpose.
        for j in 0..y.len() {
            let (inverse, rows, values) = column(j);
            let value = y[j] * inverse;
            y[j] = value;
            for (&i, entry) in rows.iter().zip(values) {
                y[i as usize] -= entry * value;
            }
        }
        for j in (0..y.len()).rev() {
            let (inverse, rows, values) = column(j);
            let mut sum = 0.0;
            for (&i, entry) in rows.iter().zip(values).rev() {
                sum += entry * y[i as usize];
            }
            y[j] = (y[j] - sum) * inverse;
        }
        self.order.iter().zip(y).for_each(|(&i, y)| x[i as usize] = y);
    }
}

/// An order of elimination by approximate minimum degree.
fn minimum_degree(a: &Symmetric) -> Vec<u32> {
    // The library takes signed numbers.
    let starts: Vec<i64> = a.starts.iter().map(|&start| start as i64).collect();
    let rows: Vec<i64> = a.rows.iter().map(|&row| row as i64).collect();
    // Any order gives a correct factor. If the library rejects the pattern, the unknowns keep their own order.
    amd::order(a.n() as i64, &starts, &rows, &amd::Control::default()).map_or_else(
        |_| (0..a.n() as u32).collect(),
        |(order, _, _)| order.into_iter().map(|i| i as u32).collect(),
    )
}

/// The entries at and above the diagonal of a matrix whose rows and columns are in the order of elimination, by columns.
struct Above {
    starts: Vec<usize>,
    rows: Vec<u32>,
    values: Vec<f64>,
}

impl Above {
    fn new(a: &Symmetric, place: &[u32]) -> Self {
        let n = a.n();
        let entries = |j: usize| {
            (a.starts[j]..a.starts[j + 1]).map(move |k| {
                let (i, j) = (place[a.rows[k]], place[j]);
                (i.min(j), i.max(j), a.values[k])
            })
        };
        let mut counts = vec![0; n];
        (0..n).flat_map(&entries).for_each(|(_, column, _)| counts[column as usize] += 1);
        let starts = running_sums(&counts);
        // Each entry is put at the next free position of its column, in the order of the matrix.
        let mut next = starts.clone();
        let (mut rows, mut values) = (vec![0; a.rows.len()], vec![0.0; a.rows.len()]);
        for (row, column, value) in (0..n).flat_map(&entries) {
            let at = &mut next[column as usize];
            (rows[*at], values[*at]) = (row, value);
            *at += 1;
        }
        Self { starts, rows, values }
    }

    fn n(&self) -> usize {
        self.starts.len() - 1
    }

    /// Numbers of the entries of a column.
    fn column(&self, k: usize) -> std::ops::Range<usize> {
        self.starts[k]..self.starts[k + 1]
    }

    /// The elimination tree, and the number of entries in each column of the factor.
    fn tree_and_counts(&self) -> (Vec<u32>, Vec<usize>) {
        let n = self.n();
        let (mut parents, mut counts) = (vec![NO_PARENT; n], vec![1; n]);
        let mut seen = vec![NO_PARENT; n];
        for k in 0..n {
            seen[k] = k as u32;
            for entry in self.column(k) {
                // An entry fills its row in all ancestors of its column, up to the first that is filled already.
                let mut i = self.rows[entry] as usize;
                while seen[i] != k as u32 {
                    seen[i] = k as u32;
                    counts[i] += 1;
                    if parents[i] == NO_PARENT {
                        parents[i] = k as u32;
                    }
                    i = parents[i] as usize;
                }
            }
        }
        (parents, counts)
    }

    /// Rows of the entries of the factor, rising in each column.
    fn rows_of_factor(&self, parents: &[u32], starts: &[usize]) -> Vec<u32> {
        let n = self.n();
        let mut rows = vec![0; starts[n]];
        let mut next = starts[..n].to_vec();
        let mut walk = TreeWalk::new(n);
        for k in 0..n {
            let reach = walk.reach(self, parents, k).iter().copied();
            for j in reach.chain(std::iter::once(k as u32)) {
                rows[next[j as usize]] = k as u32;
                next[j as usize] += 1;
            }
        }
        rows
    }
}

/// Finds the entries of a row of the factor.
struct TreeWalk {
    /// For each column, the last row in which it was found.
    seen: Vec<u32>,
    stack: Vec<u32>,
}

impl TreeWalk {
    fn new(n: usize) -> Self {
        Self { seen: vec![NO_PARENT; n], stack: vec![0; n] }
    }

    /// The columns left of the diagonal in which row `k` of the factor has an entry, each before its ancestors.
    fn reach(&mut self, above: &Above, parents: &[u32], k: usize) -> &[u32] {
        let row = k as u32;
        let mut top = self.stack.len();
        self.seen[k] = row;
        for entry in above.column(k) {
            let mut i = above.rows[entry];
            let mut length = 0;
            while self.seen[i as usize] != row {
                self.seen[i as usize] = row;
                self.stack[length] = i;
                length += 1;
                i = parents[i as usize];
            }
            // The path was found from the leaf up. It goes before earlier paths, which may contain its ancestors.
            self.stack.copy_within(..length, top - length);
            top -= length;
        }
        &self.stack[top..]
    }
}

/// Start of each of several consecutive runs of these lengths, and the end of the last one.
fn running_sums(counts: &[usize]) -> Vec<usize> {
    let sums = counts.iter().scan(0, |sum, count| {
        *sum += count;
        Some(*sum)
    });
    std::iter::once(0).chain(sums).collect()
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
        // The memory that a refusal names is that of the factor, values and rows.
        let mib = Cholesky::new(&a, None, 1024.0).expect("positive definite").bytes() as f64 / BYTES_PER_MIB;
        assert!(mib >= 12.0 * (2 * n - 1) as f64 / BYTES_PER_MIB);
        let refused = Cholesky::new(&a, None, 0.99 * mib).err();
        assert_eq!(refused, Some(SparseError::Memory { needed_mib: mib, limit_mib: 0.99 * mib }));
        a.values[0] = -1.0;
        assert_eq!(Cholesky::new(&a, None, 1024.0).err(), Some(SparseError::Singular));
    }
}
