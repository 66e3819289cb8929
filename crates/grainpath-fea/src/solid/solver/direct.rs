//! Small systems with many loads: the stiffness is stored, factored once, and used for every load.
//!
//! Method: sparse Cholesky factorization, ordered by nested dissection (`george1973`) of the nodes'
//! positions. The nodes are cut in half along the longest side of their box; nodes of the upper half that are
//! coupled to the lower half form the separator and are eliminated last. Sets of up to 48 nodes are left
//! undivided. Each load is solved twice: the second solution corrects the residual that rounding left in the
//! first (one step of iterative refinement). Supported directions are projected out of the matrix, with the
//! identity on their diagonal, so that it stays positive definite. A prescribed displacement enters as the
//! forces that it causes.
//!
//! Forces are in N, displacements in mm. Cost for a compact part of n nodes: memory grows with n^(4/3), the
//! factorization with n^2. A load takes four triangular solves and three products with the operator.
//!
//! Limits: a factor above the memory limit is refused before it is made, and the error names an element size
//! that would fit. A stiffness that is not positive definite is an error, as it is if a piece of the part can
//! move freely.

use grainpath_core::{DMat3, DVec3};

use super::block_matrix::{Blocks, add, assemble, dot, finite_size};
use super::operator::Operator;
use super::solution::Solution;
use super::system::System;
use crate::solid::model::constraints::Supports;
use crate::solid::model::error::SolidError;
use crate::solid::model::material_map::Model;
use crate::solid::model::memory::fitting_edge_mm;
use crate::solid::model::quadratic_tet as element;
use crate::sparse::{Cholesky, SparseError, Symmetric};

/// Number of nodes that are ordered without further division.
/// Source: chosen; it changes speed and the order of additions alone.
const LEAF: usize = 48;

/// A factored stiffness.
pub(crate) struct Direct {
    factor: Cholesky,
}

impl Direct {
    pub(crate) fn new(model: &Model<'_>, supports: &Supports, max_mib: f64) -> Result<Self, SolidError> {
        let (mesh, laws) = (model.mesh, model.laws()?);
        let blocks = assemble(mesh.nodes.len(), &mesh.tets, |t| {
            let mut k =
                element::stiffness(&element::gradient_products(&mesh.places(t)), &laws[model.material(t)]);
            // Supported directions are projected out of rows and columns; the diagonal gets the
            // identity there, so the matrix stays positive definite.
            for (a, &i) in mesh.tets[t].iter().enumerate() {
                for (b, &j) in mesh.tets[t].iter().enumerate().take(a + 1) {
                    if let Some(p) = supports.free(i as usize) {
                        k[a][b] = *p * k[a][b];
                    }
                    if let Some(p) = supports.free(j as usize) {
                        k[a][b] *= *p;
                    }
                }
            }
            k
        });
        let order: Vec<usize> = dissected(&mesh.nodes, &blocks)
            .into_iter()
            .flat_map(|i| (0..3).map(move |axis| 3 * i as usize + axis))
            .collect();
        let matrix = lower_half(&blocks, supports);
        drop(blocks);
        let factor = Cholesky::new(&matrix, Some(&order), max_mib);
        let factor = factor.map_err(|e| match e {
            SparseError::Memory { needed_mib, limit_mib } => {
                let fitting_mm = fitting_edge_mm(mesh.mean_cell_mm(), needed_mib, limit_mib);
                let what = "factoring the stiffness";
                SolidError::Memory { what, need_mib: needed_mib, limit_mib, fitting_mm }
            }
            SparseError::Singular => SolidError::NotPositive,
            SparseError::Interrupted(e) => SolidError::Interrupted(e),
        })?;
        Ok(Self { factor })
    }

    /// Bytes of the factor.
    pub(crate) fn bytes(&self) -> usize {
        self.factor.bytes()
    }

    /// The solution for one load.
    ///
    /// # Errors
    /// [`SolidError::LoadNotFinite`].
    pub(crate) fn solve(&self, operator: &Operator<'_>, load: &[DVec3]) -> Result<Solution, SolidError> {
        let supports = operator.supports();
        let (mut u, _) = supports.prescribed();
        let mut scratch = operator.scratch();
        let mut rest = vec![DVec3::ZERO; load.len()];
        let mut goal = 0.0;
        // The second pass solves for the residual that rounding left in the first.
        for pass in 0..2 {
            operator.forces(&u, &mut rest, &mut scratch);
            for (r, f) in rest.iter_mut().zip(load) {
                *r = *f - *r;
            }
            supports.project(&mut rest);
            if pass == 0 {
                goal = finite_size(load, &rest)?;
            }
            let mut x: Vec<f64> = rest.iter().flat_map(|v| v.to_array()).collect();
            self.factor.solve(&mut x);
            // Rounding may leave small displacements along supported directions.
            let mut step: Vec<DVec3> = x.chunks_exact(3).map(DVec3::from_slice).collect();
            supports.project(&mut step);
            add(&mut u, 1.0, &step);
        }
        operator.forces(&u, &mut rest, &mut scratch);
        add(&mut rest, -1.0, load);
        let mut reaction = vec![DVec3::ZERO; load.len()];
        for (i, held) in supports.held_part(&rest) {
            reaction[i] = held;
        }
        supports.project(&mut rest);
        let residual = if goal > 0.0 { dot(&rest, &rest).sqrt() / goal } else { 0.0 };
        Ok(Solution { displacement: u, reaction, residual, iterations: 0 })
    }
}

/// The lower half by columns, which for a symmetric matrix is the upper half by rows.
fn lower_half(blocks: &Blocks, supports: &Supports) -> Symmetric {
    let mut out = Symmetric { starts: vec![0], ..Symmetric::default() };
    for i in 0..blocks.n() {
        let held = supports.free(i).map_or(DMat3::ZERO, |p| DMat3::IDENTITY - *p);
        for axis in 0..3 {
            for (j, block) in blocks.row(i).filter(|(j, _)| *j >= i) {
                let block = if j == i { *block + held } else { *block };
                for other in (0..3).filter(|&o| j > i || o >= axis) {
                    out.rows.push(3 * j + other);
                    out.values.push(block.col(other)[axis]);
                }
            }
            out.starts.push(out.rows.len());
        }
    }
    out
}

/// Nested dissection by position: both halves along the longest side, then the nodes between them.
fn dissected(places: &[DVec3], blocks: &Blocks) -> Vec<u32> {
    let mut order = Vec::with_capacity(places.len());
    let mut side = vec![0u32; places.len()];
    let mut mark = 0;
    dissect(
        &mut (0..places.len() as u32).collect::<Vec<u32>>(),
        places,
        blocks,
        &mut side,
        &mut mark,
        &mut order,
    );
    order
}

fn dissect(
    nodes: &mut [u32],
    places: &[DVec3],
    blocks: &Blocks,
    side: &mut [u32],
    mark: &mut u32,
    order: &mut Vec<u32>,
) {
    if nodes.len() <= LEAF {
        order.extend_from_slice(nodes);
        return;
    }
    let place = |i: u32| places[i as usize];
    let first = place(nodes[0]);
    let (lo, hi) = nodes.iter().fold((first, first), |(lo, hi), &i| (lo.min(place(i)), hi.max(place(i))));
    let extent = hi - lo;
    let axis = (0..3).fold(0, |best, a| if extent[a] > extent[best] { a } else { best });
    let half = nodes.len() / 2;
    nodes.select_nth_unstable_by(half, |&a, &b| place(a)[axis].total_cmp(&place(b)[axis]).then(a.cmp(&b)));
    let (left, right) = nodes.split_at_mut(half);
    *mark += 1;
    left.iter().for_each(|&i| side[i as usize] = *mark);
    // The separator is the set of nodes of the right half that are coupled to the left one. Ordered
    // last, it keeps both halves independent.
    let touches = |i: &u32| blocks.row(*i as usize).any(|(j, _)| side[j] == *mark);
    let (separator, mut rest): (Vec<u32>, Vec<u32>) = right.iter().copied().partition(touches);
    dissect(left, places, blocks, side, mark, order);
    dissect(&mut rest, places, blocks, side, mark, order);
    order.extend(separator);
}
