//! The stiffness of the nodes of a grid in single precision, stored as the upper half of a symmetric matrix.
//!
//! A row couples its node with itself and with those of its 26 neighbours that have a higher number. Applying the matrix
//! takes as long as reading it, so half of it takes half the time: a row gives the force that the neighbours of higher number
//! cause at the node, and, transposed, the forces that the node causes at them. Nodes are divided into slabs that threads
//! take. Each slab adds up forces of its own, and these are added in the order of the slabs, so the sums do not depend on the
//! number of threads. Forces are in N, displacements in mm; about seven digits of a force are correct, less what cancels.
//! Cost: 528 bytes a node.
//!
//! Two products are offered. [`forces`] multiplies displacements that were rounded to single precision. That is enough for a
//! preconditioner, but where a part moves far as a whole the forces of its strain drown in the rounding.
//! [`forces_of_differences`] multiplies differences between neighbours and keeps their digits; it suits conjugate gradients that
//! end at a few digits.
//!
//! Besides the finest matrix, coarser ones of grids can be kept in this form ([`HalfMatrix`]). A node with 26 neighbours
//! takes 580 bytes there, with the numbers of its neighbours; whole rows in double precision take 2052.

use std::ops::Range;

use grainpath_core::{DMat3, DVec3};
use rayon::prelude::*;

use super::block_matrix::Blocks;

/// Neighbours of higher number. Source: derived: half of the 26 around a node.
pub(crate) const AFTER: usize = 13;
/// Numbers of a line: components of the node's own displacement and of its neighbours'. Source: derived: 42, filled up with
/// zeros to a multiple of four, which one vector instruction takes.
const LINE: usize = 44;
/// Numbers for the nodes of a row.
type Line = [f32; LINE];
/// The row of a node in three lines, one for each component of the force.
pub(crate) type Row = [Line; 3];
/// The row of a node without stiffness.
pub(crate) const EMPTY: Row = [[0.0; LINE]; 3];
/// The largest number of slabs. Source: chosen: more slabs can be shared by more threads, but each reaches as far into the
/// next ones as a layer of the grid has nodes.
const SLABS: usize = 32;
/// The least number of nodes in a slab. Source: chosen; it changes speed and the order of additions alone.
const SLAB_NODES: usize = 1024;
/// Bytes a node of displacements and sums while forces are computed, at most. Source: derived: in a plate a few nodes thick
/// every slab reaches almost to the last node, so a node lies in half of all slabs.
pub(crate) const SUM_BYTES: usize = size_of::<[f32; 3]>() + (SLABS / 2 + 1) * size_of::<[f32; 4]>();

/// Consecutive nodes whose forces are added up together.
pub(crate) struct Slab {
    nodes: Range<usize>,
    /// One more than the highest number that these nodes reach.
    end: usize,
}

/// The upper half of a stored matrix in which nearly every node is coupled to 26 others at most.
pub(crate) struct HalfMatrix {
    rows: Vec<Row>,
    /// Neighbours of higher number of each node; where one is missing, the node itself.
    after: Vec<[u32; AFTER]>,
    /// Blocks that did not fit into their rows: where copies of a grid node are coupled with a node.
    beyond: Vec<Beyond>,
    /// What threads take.
    slabs: Vec<Slab>,
}

/// A block with its row and its column.
type Beyond = (u32, u32, DMat3);

/// The largest share of rows with more blocks. Source: chosen. Their blocks are multiplied by one thread, in a time that is
/// small beside that of all rows.
const MOST_BEYOND: f64 = 0.25;

impl HalfMatrix {
    /// `None` for a matrix in which many rows have more blocks.
    pub(crate) fn new(matrix: &Blocks) -> Option<Self> {
        let row = |i: usize| {
            // The blocks of a row are in the order of their nodes, so the node itself comes first.
            let (mut row, mut after, mut n, mut beyond) = (EMPTY, [i as u32; AFTER], 0, Vec::new());
            for (j, block) in matrix.row(i).filter(|(j, _)| *j >= i) {
                if j == i {
                    put(&mut row, 0, block);
                } else if n < AFTER {
                    after[n] = j as u32;
                    n += 1;
                    put(&mut row, n, block);
                } else {
                    beyond.push((i as u32, j as u32, *block));
                }
            }
            (row, (after, beyond))
        };
        let (rows, (after, beyond)): (Vec<_>, (Vec<_>, Vec<Vec<Beyond>>)) =
            (0..matrix.n()).into_par_iter().map(row).unzip();
        let n_beyond = beyond.iter().filter(|blocks| !blocks.is_empty()).count();
        if n_beyond as f64 > MOST_BEYOND * rows.len() as f64 {
            return None;
        }
        let slabs = slabs(rows.len(), |i| &after[i]);
        Some(Self { rows, after, beyond: beyond.into_iter().flatten().collect(), slabs })
    }

    /// The product with displacements, in the digits of single precision.
    pub(crate) fn apply(&self, x: &[DVec3], y: &mut [DVec3]) {
        forces(&self.rows, |i| &self.after[i], &self.slabs, &rounded(x), y);
        for (i, j, block) in &self.beyond {
            let (i, j) = (*i as usize, *j as usize);
            y[i] += *block * x[j];
            y[j] += block.transpose() * x[i];
        }
    }

    /// Memory of its rows and of the numbers of their nodes.
    pub(crate) fn bytes(&self) -> usize {
        self.rows.len() * (size_of::<Row>() + size_of::<[u32; AFTER]>())
            + self.beyond.len() * size_of::<Beyond>()
    }
}

/// Writes the block with a node's neighbour into its row: number 0 is the node itself.
pub(crate) fn put(row: &mut Row, neighbour: usize, block: &DMat3) {
    for (line, numbers) in row.iter_mut().enumerate() {
        (0..3).for_each(|j| numbers[3 * neighbour + j] = block.col(j)[line] as f32);
    }
}

/// Displacements in single precision. Each is read many times, so it is rounded before.
pub(crate) fn rounded(u: &[DVec3]) -> Vec<[f32; 3]> {
    u.par_iter().with_min_len(SLAB_NODES).map(|u| u.as_vec3().to_array()).collect()
}

/// Divides `n` nodes into slabs. `after` gives the neighbours of higher number; where one is missing, the node itself
/// stands in its place.
pub(crate) fn slabs<'a>(n: usize, after: impl Fn(usize) -> &'a [u32] + Sync) -> Vec<Slab> {
    let size = n.div_ceil(SLABS).max(SLAB_NODES);
    let starts: Vec<usize> = (0..n).step_by(size).collect();
    let slab = |&start: &usize| {
        let nodes = start..n.min(start + size);
        let highest = nodes.clone().flat_map(&after).max();
        Slab { nodes, end: highest.map_or(start, |&j| j as usize + 1) }
    };
    starts.par_iter().map(slab).collect()
}

/// The forces of a displacement. Blocks of missing neighbours are zero in the rows.
pub(crate) fn forces<'a>(
    rows: &[Row],
    after: impl Fn(usize) -> &'a [u32] + Sync,
    slabs: &[Slab],
    u: &[[f32; 3]],
    forces: &mut [DVec3],
) {
    // A slab writes to nodes of the next ones, so each has sums of its own.
    let sums: Vec<_> = slabs.par_iter().map(|slab| slab_forces(rows, &after, slab, u)).collect();
    add_up(slabs, &sums, forces);
}

/// The forces of a displacement of a matrix whose rows of blocks add up to zero, as those of a stiffness do: from how far the
/// neighbours of each node move away from it. Differences are taken before they are rounded, so a force keeps its digits
/// however far the part moves as a whole. Measured on a bar of 133 cells: the residual over the load is right to better than
/// 1e-2, while with [`forces`] it is not.
pub(crate) fn forces_of_differences<'a>(
    rows: &[Row],
    after: impl Fn(usize) -> &'a [u32] + Sync,
    slabs: &[Slab],
    u: &[DVec3],
    forces: &mut [DVec3],
) {
    let sums: Vec<_> =
        slabs.par_iter().map(|slab| slab_forces_of_differences(rows, &after, slab, u)).collect();
    add_up(slabs, &sums, forces);
}

/// Adds up what slabs cause, in their order: that keeps the bits the same for any number of threads. Sums of slabs are in
/// single precision, their total in double.
fn add_up(slabs: &[Slab], sums: &[Vec<[f32; 4]>], forces: &mut [DVec3]) {
    forces.par_chunks_mut(SLAB_NODES).enumerate().for_each(|(c, forces)| {
        forces.fill(DVec3::ZERO);
        let first = c * SLAB_NODES;
        // Each force is the sum over the slabs that reach its node, in the order of the slabs.
        for (slab, sums) in slabs.iter().zip(sums) {
            let start = slab.nodes.start;
            for i in first.max(start)..slab.end.min(first + forces.len()) {
                let [x, y, z, _] = sums[i - start];
                forces[i - first] += DVec3::new(x.into(), y.into(), z.into());
            }
        }
    });
}

/// What the nodes of a slab and their neighbours cause, from the first node of the slab to its end. The fourth number of a
/// force has no meaning: four numbers are one vector instruction, and three are not. `of_node` gets a node with its row and its
/// neighbours. It writes the displacements that the row multiplies, and then what the node causes at its neighbours; the
/// numbers for the node itself are left out of the latter. Both lines begin as zeros and are the same for all nodes of the slab.
fn slab_sums<'a>(
    rows: &[Row],
    after: &impl Fn(usize) -> &'a [u32],
    slab: &Slab,
    of_node: impl Fn(usize, &Row, &[u32], &mut Line, &mut Line),
) -> Vec<[f32; 4]> {
    let start = slab.nodes.start;
    let mut forces = vec![[0.0; 4]; slab.end - start];
    let (mut near, mut caused) = ([0.0; LINE], [0.0; LINE]);
    for i in slab.nodes.clone() {
        let (row, after) = (&rows[i], after(i));
        of_node(i, row, after, &mut near, &mut caused);
        let force = product(row, &near);
        (0..3).for_each(|k| forces[i - start][k] += force[k]);
        for (k, &j) in after.iter().enumerate() {
            let force = &mut forces[j as usize - start];
            (0..4).for_each(|c| force[c] += caused[3 + 3 * k + c]);
        }
    }
    forces
}

/// The forces of displacements on the nodes of a slab.
fn slab_forces<'a>(
    rows: &[Row],
    after: &impl Fn(usize) -> &'a [u32],
    slab: &Slab,
    u: &[[f32; 3]],
) -> Vec<[f32; 4]> {
    slab_sums(rows, after, slab, |i, row, after, near, caused| {
        let own = u[i];
        // The row itself: what the node's own displacement and those of its neighbours cause at the node.
        let (places, _) = near.as_chunks_mut::<3>();
        places[0] = own;
        for (place, &j) in places[1..].iter_mut().zip(after) {
            *place = u[j as usize];
        }
        // The row transposed: what the displacement of the node causes at its neighbours.
        for (k, caused) in caused.iter_mut().enumerate() {
            *caused = row[0][k] * own[0] + row[1][k] * own[1] + row[2][k] * own[2];
        }
    })
}

/// As [`slab_forces`], for [`forces_of_differences`].
fn slab_forces_of_differences<'a>(
    rows: &[Row],
    after: &impl Fn(usize) -> &'a [u32],
    slab: &Slab,
    u: &[DVec3],
) -> Vec<[f32; 4]> {
    slab_sums(rows, after, slab, |i, row, after, near, caused| {
        // The node does not move away from itself, so the numbers of its own block stay zero.
        // Each component of a difference once for every column of its block.
        let mut spread = [[0.0; LINE]; 3];
        for (k, &j) in after.iter().enumerate() {
            let d = (u[j as usize] - u[i]).as_vec3().to_array();
            near[3 + 3 * k..6 + 3 * k].copy_from_slice(&d);
            spread.iter_mut().zip(d).for_each(|(s, d)| s[3 + 3 * k..6 + 3 * k].fill(d));
        }
        // Seen from a neighbour, the node moves the other way, hence the minus.
        for (k, caused) in caused.iter_mut().enumerate() {
            *caused = -(row[0][k] * spread[0][k] + row[1][k] * spread[1][k] + row[2][k] * spread[2][k]);
        }
    })
}

/// A row times the displacements of its nodes.
fn product(row: &Row, near: &Line) -> [f32; 3] {
    // Four sums a line match the width of a vector instruction, and the three lines advance together, because a sum
    // waits for its last addition.
    let mut sums = [[0.0f32; 4]; 3];
    let [a, b, c] = row.each_ref().map(|line| line.as_chunks::<4>().0);
    for (near, ((a, b), c)) in near.as_chunks::<4>().0.iter().zip(a.iter().zip(b).zip(c)) {
        for (sums, row) in sums.iter_mut().zip([a, b, c]) {
            (0..4).for_each(|j| sums[j] += row[j] * near[j]);
        }
    }
    sums.map(|s| (s[0] + s[1]) + (s[2] + s[3]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_are_those_of_the_whole_matrix_for_any_number_of_threads() {
        // A matrix of 3000 nodes, of which each is coupled with every seventh after it, in three slabs.
        let n = 3000;
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1u32 << 23) as f32 - 1.0
        };
        let mut rows = vec![EMPTY; n];
        let mut after = vec![[0; AFTER]; n];
        let u: Vec<[f32; 3]> = (0..n).map(|_| [next(), next(), next()]).collect();
        let mut expected = vec![[0.0f64; 3]; n];
        for i in 0..n {
            let neighbour = |k: usize| if i + 7 * k < n { i + 7 * k } else { i };
            after[i] = std::array::from_fn(|k| neighbour(k + 1) as u32);
            for k in (0..=AFTER).filter(|&k| k == 0 || neighbour(k) != i) {
                let mut block: [[f32; 3]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| next()));
                // The block acts on both nodes; a node's block with itself acts once and is symmetric.
                let j = neighbour(k);
                for (a, b) in (0..3).flat_map(|a| (0..3).map(move |b| (a, b))) {
                    if k == 0 && b > a {
                        block[b][a] = block[a][b];
                    }
                    rows[i][a][3 * k + b] = block[a][b];
                    expected[i][a] += f64::from(block[a][b]) * f64::from(u[j][b]);
                    if k > 0 {
                        expected[j][b] += f64::from(block[a][b]) * f64::from(u[i][a]);
                    }
                }
            }
        }
        let slabs = slabs(n, |i| &after[i]);
        // Fewer slabs would leave their overlap untested.
        assert_eq!(slabs.len(), 3);
        let solved = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let mut found = vec![DVec3::ONE; n];
            pool.install(|| forces(&rows, |i| &after[i], &slabs, &u, &mut found));
            found
        };
        let found = solved(1);
        for (found, expected) in found.iter().zip(expected) {
            assert!((*found - DVec3::from_array(expected)).length() < 1e-5, "{found} for {expected:?}");
        }
        assert_eq!(found, solved(3));
        // Where blocks of a row add up to zero, as those of a stiffness do, differences give the same forces, and a motion of
        // the whole part adds none.
        let mut diagonal = vec![[[0.0f64; 3]; 3]; n];
        for i in 0..n {
            for (k, &j) in after[i].iter().enumerate().filter(|(_, j)| **j as usize != i) {
                for (a, b) in (0..3).flat_map(|a| (0..3).map(move |b| (a, b))) {
                    let value = f64::from(rows[i][a][3 + 3 * k + b]);
                    diagonal[i][a][b] -= value;
                    diagonal[j as usize][b][a] -= value;
                }
            }
        }
        let mut expected = vec![DVec3::ZERO; n];
        let place = |i: usize| DVec3::from_array(u[i].map(f64::from));
        for i in 0..n {
            let own = DMat3::from_cols_array_2d(&diagonal[i]).transpose();
            expected[i] += own * place(i);
            for (k, &j) in after[i].iter().enumerate().filter(|(_, j)| **j as usize != i) {
                let line = |a: usize| std::array::from_fn(|b| f64::from(rows[i][a][3 + 3 * k + b]));
                let block = DMat3::from_cols_array_2d(&[line(0), line(1), line(2)]).transpose();
                expected[i] += block * place(j as usize);
                expected[j as usize] += block.transpose() * place(i);
            }
        }
        // Some ten thousand times the differences: single precision would keep three of their digits.
        let moved: Vec<DVec3> = (0..n).map(|i| place(i) + DVec3::new(3e4, -2e4, 1e4)).collect();
        let mut found = vec![DVec3::ONE; n];
        forces_of_differences(&rows, |i| &after[i], &slabs, &moved, &mut found);
        for (found, expected) in found.iter().zip(&expected) {
            assert!((*found - *expected).length() < 1e-4, "{found} for {expected}");
        }
    }
}
