//! Sparse matrices of 3 x 3 blocks, one block for each pair of coupled nodes, and sums that are the same for
//! any number of threads.
//!
//! Storage: compressed rows. `start` is `(n + 1)`; the blocks of row i are `values[start[i]..start[i + 1]]`,
//! and `columns` holds their columns in ascending order. Both halves of a symmetric matrix are stored, so a
//! product needs no exchange between threads. Stiffness is in N/mm, displacements in mm.
//!
//! Assembly works on 4096 rows at a time. Each task lists the columns of its rows, computes the elements that
//! touch them, and adds their blocks in the order of the elements. An element whose nodes belong to several
//! tasks is computed once in each. Dot products are summed in chunks of 4096 vectors, and the chunks in
//! order.
//!
//! Cost: a product is linear in the blocks; 76 bytes a block. Degenerate cases: a node without an element has
//! an empty row, and the identity as its inverse diagonal block.

use std::collections::BTreeMap;

use grainpath_core::{DMat3, DVec3};
use rayon::prelude::*;

use super::operator::CHUNK;
use crate::solid::model::adjacency::incidence;
use crate::solid::model::error::SolidError;

/// A matrix by rows of blocks; the columns of a row are ascending.
#[derive(Debug, Clone, Default)]
pub(crate) struct Blocks {
    pub(crate) start: Vec<u32>,
    pub(crate) columns: Vec<u32>,
    pub(crate) values: Vec<DMat3>,
}

impl Blocks {
    pub(crate) fn n(&self) -> usize {
        self.start.len() - 1
    }

    pub(crate) fn row(&self, i: usize) -> impl Iterator<Item = (usize, &DMat3)> {
        let range = self.start[i] as usize..self.start[i + 1] as usize;
        self.columns[range.clone()].iter().map(|&c| c as usize).zip(&self.values[range])
    }

    pub(crate) fn from_rows(rows: Vec<Vec<(u32, DMat3)>>) -> Self {
        let mut blocks = Self { start: vec![0], ..Self::default() };
        for row in rows {
            blocks.columns.extend(row.iter().map(|e| e.0));
            blocks.values.extend(row.iter().map(|e| e.1));
            blocks.start.push(blocks.columns.len() as u32);
        }
        blocks
    }

    pub(crate) fn apply(&self, x: &[DVec3], y: &mut [DVec3]) {
        y.par_chunks_mut(CHUNK / 4).enumerate().for_each(|(c, chunk)| {
            for (i, y) in (c * CHUNK / 4..).zip(chunk) {
                *y = self.row(i).fold(DVec3::ZERO, |sum, (j, a)| sum + *a * x[j]);
            }
        });
    }

    pub(crate) fn inverse_diagonal(&self) -> Vec<DMat3> {
        let diagonal = |i: usize| self.row(i).find(|(j, _)| *j == i).map_or(DMat3::ZERO, |(_, a)| *a);
        (0..self.n()).into_par_iter().map(|i| super::operator::inverse(diagonal(i))).collect()
    }

    pub(crate) fn bytes(&self) -> usize {
        self.values.len() * (size_of::<DMat3>() + 4)
    }
}

/// Sums of the blocks of a row, one for each of `N` places around its node. Copies of a node have one place; all but the first of
/// them are summed apart.
pub(crate) struct RowSums<const N: usize> {
    columns: [u32; N],
    sums: [DMat3; N],
    copies: BTreeMap<u32, DMat3>,
}

impl<const N: usize> RowSums<N> {
    /// Marks a place without a block.
    const NONE: u32 = u32::MAX;

    pub(crate) fn new() -> Self {
        Self { columns: [Self::NONE; N], sums: [DMat3::ZERO; N], copies: BTreeMap::new() }
    }

    pub(crate) fn add(&mut self, place: usize, column: u32, block: DMat3) {
        if self.columns[place] == Self::NONE || self.columns[place] == column {
            self.columns[place] = column;
            self.sums[place] += block;
        } else {
            *self.copies.entry(column).or_insert(DMat3::ZERO) += block;
        }
    }

    /// The blocks in the order of their columns.
    pub(crate) fn into_row(self) -> Vec<(u32, DMat3)> {
        let used = self.columns.into_iter().zip(self.sums).filter(|(column, _)| *column != Self::NONE);
        let mut row: Vec<(u32, DMat3)> = used.chain(self.copies).collect();
        row.sort_unstable_by_key(|(column, _)| *column);
        row
    }
}

/// Assembles elements of `N` nodes. `element(t)` gives the blocks of nodes a and b for b <= a.
pub(crate) fn assemble<const N: usize>(
    n_nodes: usize,
    tets: &[[u32; N]],
    element: impl Fn(usize) -> [[DMat3; N]; N] + Sync,
) -> Blocks {
    let (start, around) = incidence(n_nodes, tets);
    let at = |i: usize| &around[start[i] as usize..start[i + 1] as usize];
    // Rows assembled by one task: enough to share the elements between them, few enough to spread
    // over the threads. Source: chosen; it changes speed alone, never the result.
    const ROWS: usize = 4096;
    let parts: Vec<(Vec<u32>, Vec<u32>, Vec<DMat3>)> = (0..n_nodes.div_ceil(ROWS))
        .into_par_iter()
        .map(|part| {
            let rows = part * ROWS..n_nodes.min((part + 1) * ROWS);
            let mut counts = Vec::with_capacity(rows.len());
            let mut columns: Vec<u32> = Vec::new();
            let mut starts = vec![0];
            let mut row = Vec::new();
            for i in rows.clone() {
                row.clear();
                row.extend(at(i).iter().flat_map(|&t| tets[t as usize]));
                row.sort_unstable();
                row.dedup();
                columns.extend_from_slice(&row);
                counts.push(row.len() as u32);
                starts.push(columns.len());
            }
            // Each element of these rows is computed once here, and once more by every other task
            // whose rows it touches.
            let mut used: Vec<u32> = rows.clone().flat_map(at).copied().collect();
            used.sort_unstable();
            used.dedup();
            let mut values = vec![DMat3::ZERO; columns.len()];
            for t in used {
                let nodes = &tets[t as usize];
                let k = element(t as usize);
                for (a, &i) in nodes.iter().enumerate().filter(|(_, i)| rows.contains(&(**i as usize))) {
                    let own = starts[i as usize - rows.start]..starts[i as usize - rows.start + 1];
                    for (b, j) in nodes.iter().enumerate() {
                        let slot = columns[own.clone()].binary_search(j).expect("in the pattern");
                        values[own.start + slot] += if b <= a { k[a][b] } else { k[b][a].transpose() };
                    }
                }
            }
            (counts, columns, values)
        })
        .collect();
    let mut blocks = Blocks { start: vec![0], ..Blocks::default() };
    for (counts, columns, values) in parts {
        for count in counts {
            blocks.start.push(blocks.start[blocks.start.len() - 1] + count);
        }
        blocks.columns.extend(columns);
        blocks.values.extend(values);
    }
    blocks
}

/// Sum of products, by chunks of fixed size: the order of additions does not depend on the number
/// of threads.
pub(crate) fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    let chunk = |(a, b): (&[DVec3], &[DVec3])| a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum::<f64>();
    let sums: Vec<f64> = a.par_chunks(CHUNK).zip(b.par_chunks(CHUNK)).map(chunk).collect();
    sums.iter().sum()
}

/// Size of the forces at nodes that can move: those of a load and of prescribed displacements.
///
/// # Errors
/// [`SolidError::LoadNotFinite`], also for forces whose squares overflow.
pub(super) fn finite_size(load: &[DVec3], forces: &[DVec3]) -> Result<f64, SolidError> {
    let size = dot(forces, forces).sqrt();
    // Forces on supports are not in the size, but they go into the reactions.
    let is_finite = size.is_finite() && load.iter().all(|f| f.is_finite());
    if is_finite { Ok(size) } else { Err(SolidError::LoadNotFinite) }
}

/// `y += factor * x`.
pub(crate) fn add(y: &mut [DVec3], factor: f64, x: &[DVec3]) {
    y.par_chunks_mut(CHUNK).zip(x.par_chunks(CHUNK)).for_each(|(y, x)| {
        for (y, x) in y.iter_mut().zip(x) {
            *y += *x * factor;
        }
    });
}
