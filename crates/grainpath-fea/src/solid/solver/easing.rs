//! Corrects a solution locally after a few cells have changed: nodes around them move, and all others keep
//! their displacement.
//!
//! Method: conjugate gradients with the block diagonal as preconditioner (`hestenes1952`), on the nodes
//! within a number of coupling steps from the change. This works because the forces that a changed cell sets
//! free are in equilibrium among themselves, so their effect decays with distance (Saint-Venant's principle).
//! The residual is computed exactly on all nodes that the motion affects, the corrected nodes and a rim of
//! one step around them. The caller compares it with the goal and solves the whole part where it is still too
//! large.
//!
//! Displacements are in mm, forces in N; node lists are ascending. Cost of a step: one row of the matrix for
//! each corrected node, in single precision where the caller stores it. The preparation passes over all nodes
//! of the part once.
//!
//! Degenerate cases: without changed nodes nothing moves. The steps end early at zero or negative stiffness
//! along a search direction, which means that only rounding is left. Supported directions never move.

use grainpath_core::{DMat3, DVec3};
use rayon::prelude::*;

use super::block_matrix::{add, dot};

/// Computes the forces on a list of nodes from their displacements, as if no node were supported and no other node moved.
pub(crate) type RoughPart<'a> = Box<dyn FnMut(&[DVec3], &mut [DVec3]) + 'a>;

/// A stiffness matrix that is applied row by row.
pub(crate) trait Rows: Sync {
    /// The nodes that are coupled to a node, itself included.
    fn around(&self, node: usize) -> &[u32];
    /// The force on a node as if no node were supported.
    fn row(&self, node: usize, u: &[DVec3]) -> DVec3;
    /// The forces of some nodes, in ascending order, on one another, with a few correct digits where that is cheaper. It is
    /// made once for many displacements.
    fn rough_part<'a>(&'a self, nodes: &'a [u32]) -> RoughPart<'a>;
    /// Inverse of the diagonal block; for supported directions the identity.
    fn inverse_block(&self, node: usize) -> DMat3;
    /// Projection onto the free directions of a node; `None` for a node without supports.
    fn free(&self, node: usize) -> Option<&DMat3>;
}

fn freed(rows: &dyn Rows, node: u32, force: DVec3) -> DVec3 {
    rows.free(node as usize).map_or(force, |free| *free * force)
}

/// The nodes within a number of coupling steps from the nodes `from`, in ascending order, and those one step
/// farther. `n` is the number of all nodes. Fewer steps are made if more than `most` nodes would be reached.
pub(crate) fn within(
    rows: &dyn Rows,
    from: &[u32],
    (steps, most): (usize, usize),
    n: usize,
) -> [Vec<u32>; 2] {
    let mut seen = vec![false; n];
    from.iter().for_each(|&i| seen[i as usize] = true);
    let (mut inside, mut rim) = (Vec::new(), from.to_vec());
    for step in 0..=steps {
        if step > 0 && inside.len() + rim.len() > most {
            break;
        }
        let mut next = Vec::new();
        for &j in rim.iter().flat_map(|&i| rows.around(i as usize)) {
            if !std::mem::replace(&mut seen[j as usize], true) {
                next.push(j);
            }
        }
        inside.append(&mut rim);
        rim = next;
    }
    inside.sort_unstable();
    rim.sort_unstable();
    [inside, rim]
}

/// Updates the residual of a displacement at some nodes.
pub(crate) fn residual(rows: &dyn Rows, nodes: &[u32], u: &[DVec3], load: &[DVec3], residual: &mut [DVec3]) {
    let residual_of = |&i: &u32| freed(rows, i, load[i as usize] - rows.row(i as usize, u));
    let new: Vec<DVec3> = nodes.par_iter().map(residual_of).collect();
    nodes.iter().zip(new).for_each(|(&i, r)| residual[i as usize] = r);
}

/// The loop is not that of `grainpath_core::conjugate_gradients`, which ends with an error where the curvature of a
/// direction is lost. Here rows carry a few digits only, so that is the normal end.
///
/// Moves the nodes inside, with all others fixed, until the residual on them is below the goal or
/// the number of steps is reached. `left` is the residual of `u` on all nodes, before and after.
pub(crate) fn ease(
    rows: &dyn Rows,
    [inside, rim]: &[Vec<u32>; 2],
    load: &[DVec3],
    u: &mut [DVec3],
    left: &mut [DVec3],
    (goal, most): (f64, usize),
) {
    let mut r: Vec<DVec3> = inside.iter().map(|&i| left[i as usize]).collect();
    let inverse: Vec<DMat3> = inside.par_iter().map(|&i| rows.inverse_block(i as usize)).collect();
    let mut forces = rows.rough_part(inside);
    let mut p = vec![DVec3::ZERO; inside.len()];
    let mut q = vec![DVec3::ZERO; inside.len()];
    let mut rz = 1.0;
    for step in 0..most {
        if dot(&r, &r).sqrt() <= goal {
            break;
        }
        let z: Vec<DVec3> = r.iter().zip(&inverse).map(|(r, m)| *m * *r).collect();
        let now = dot(&r, &z);
        let beta = if step == 0 { 0.0 } else { now / rz };
        rz = now;
        p.iter_mut().zip(&z).for_each(|(p, z)| *p = *z + *p * beta);
        forces(&p, &mut q);
        inside.iter().zip(&mut q).for_each(|(&i, q)| *q = freed(rows, i, *q));
        let along = dot(&p, &q);
        // Zero or negative curvature is a sign that only rounding is left, so further steps would not help.
        if along.is_nan() || along <= 0.0 {
            break;
        }
        let alpha = rz / along;
        inside.iter().zip(&p).for_each(|(&i, p)| u[i as usize] += *p * alpha);
        add(&mut r, -alpha, &q);
    }
    // The residual is recomputed instead of carried along, because rows were applied with a few
    // digits only. It changes on the rim as well.
    for nodes in [inside, rim] {
        residual(rows, nodes, u, load, left);
    }
}
