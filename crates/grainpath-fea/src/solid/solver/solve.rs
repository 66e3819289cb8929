//! Displacements and reactions of a mesh of tetrahedra for given loads and supports.
//!
//! Method: systems of up to 60 000 unknowns with six loads or more are factored (`direct`). All others are
//! solved by conjugate gradients (`hestenes1952`) with one multigrid cycle as preconditioner. The search
//! direction follows Polak and Ribière's formula, because the preconditioner is symmetric only up to rounding
//! (`notay2000`). Prescribed displacements are moved to the right-hand side as the forces that they cause.
//! The residual that is reported is recomputed from the result. Reactions are what the supports add for
//! equilibrium.
//!
//! Forces are in N, displacements and prescribed values in mm; a load is one vector for each node. The
//! residual is relative to the load. Cost: linear in the nodes for an iteration, and the number of iterations
//! hardly grows with the nodes. Memory: about 1250 bytes a node, estimated and refused before it is
//! allocated.
//!
//! Degenerate cases: without loads there are no solutions. A load of zero gives the prescribed displacements
//! alone. A piece of the part that can move freely, a material that is not positive definite, too many
//! iterations and a stop by the flag of the settings are errors, and so is a load that is not finite.

use grainpath_core::DVec3;
use rayon::prelude::*;

use super::block_matrix::{add, dot, finite_size};
use super::direct::Direct;
use super::multigrid::Multigrid;
use super::operator::{CHUNK, Operator};
use super::solution::{Method, Solution, SolveInfo, SolveSettings};
use super::system::System;
use crate::solid::model::constraints::Supports;
use crate::solid::model::error::SolidError;
use crate::solid::model::material_map::Model;
use crate::solid::model::memory::{fitting_edge_mm, solving_mib};
use crate::sparse::BYTES_PER_MIB;

/// A factorization pays up to this number of unknowns and from this number of loads on.
const DIRECT_DOFS: usize = 60_000;
const DIRECT_LOADS: usize = 6;

/// Solves for several loads (forces on each node, N) with one preparation.
///
/// # Errors
/// A piece that is not held, a material whose stiffness is not positive, a load that is not finite, memory above the
/// limit, no convergence, or a stop by the flag of the settings.
pub fn solve(
    model: &Model<'_>,
    supports: &Supports,
    loads: &[Vec<DVec3>],
    settings: &SolveSettings,
) -> Result<(Vec<Solution>, SolveInfo), SolidError> {
    supports.check(model.mesh)?;
    let (need_mib, limit_mib) = (solving_mib(model.mesh.nodes.len() as f64), settings.max_mib);
    if need_mib > limit_mib {
        let fitting_mm = fitting_edge_mm(model.mesh.mean_cell_mm(), need_mib, limit_mib);
        return Err(SolidError::Memory { what: "solving", need_mib, limit_mib, fitting_mm });
    }
    settings.cancel.check()?;
    let operator = Operator::new(model, supports)?;
    let n_free = model.mesh.n_dofs() - supports.count();
    let direct = match settings.method {
        Method::Auto => n_free <= DIRECT_DOFS && loads.len() >= DIRECT_LOADS,
        method => method == Method::Direct,
    };
    if direct {
        let factored = Direct::new(model, supports, settings.max_mib)?;
        let solved = |load: &Vec<DVec3>| {
            settings.cancel.check()?;
            factored.solve(&operator, load)
        };
        let solutions = loads.iter().map(solved).collect::<Result<_, SolidError>>()?;
        let mib = factored.bytes() as f64 / BYTES_PER_MIB;
        return Ok((solutions, SolveInfo { n_free, solver: "sparse Cholesky", levels: Vec::new(), mib }));
    }
    settings.cancel.check()?;
    let mut multigrid = Multigrid::new(model, supports, &operator)?;
    let info = SolveInfo {
        n_free,
        solver: "conjugate gradients with p- and grid multigrid",
        levels: multigrid.sizes(),
        mib: (operator.bytes() + multigrid.bytes()) as f64 / BYTES_PER_MIB,
    };
    let solutions = loads
        .iter()
        .map(|load| Ok(iterate(&operator, &mut multigrid, load, None, settings)?.solution))
        .collect::<Result<_, SolidError>>()?;
    Ok((solutions, info))
}

/// A solution, its residual at each node (zero along supports), and the size of the load that the
/// residual is compared with.
pub(crate) struct Solved {
    pub(crate) solution: Solution,
    pub(crate) residual: Vec<DVec3>,
    pub(crate) load_size: f64,
}

/// Conjugate gradients, from a displacement and its residual where they are given.
///
/// `grainpath_core::conjugate_gradients` is not used here: it begins with a product of the matrix that a known residual
/// saves, its preconditioner cannot keep memory between calls, and its sums and updates run on one thread.
pub(crate) fn iterate(
    operator: &dyn System,
    multigrid: &mut Multigrid,
    load: &[DVec3],
    from: Option<(Vec<DVec3>, Vec<DVec3>)>,
    settings: &SolveSettings,
) -> Result<Solved, SolidError> {
    let supports = operator.supports();
    let n = operator.n_nodes();
    let zero = || vec![DVec3::ZERO; n];
    let mut scratch = operator.scratch();
    let (prescribed, moved) = supports.prescribed();
    let mut q = zero();
    let mut first = load.to_vec();
    // A prescribed displacement acts as a load: the forces that it causes at free nodes move to the
    // right-hand side.
    if moved {
        operator.forces(&prescribed, &mut q, &mut scratch);
        add(&mut first, -1.0, &q);
    }
    supports.project(&mut first);
    let load_size = finite_size(load, &first)?;
    let goal = settings.tolerance * load_size;
    let (mut u, mut r) = from.unwrap_or((prescribed, first));
    let (mut z, mut p, mut before) = (zero(), zero(), zero());
    let (mut size, mut rz, mut iterations) = (dot(&r, &r).sqrt(), 1.0, 0);
    // The loop below would take a start whose residual is not finite for a solution.
    if !size.is_finite() {
        return Err(SolidError::NotPositive);
    }
    while size > goal && iterations < settings.max_iterations {
        settings.cancel.check()?;
        multigrid.apply(operator, &r, &mut z);
        // The preconditioner is symmetric but for rounding. Polak and Ribiere's formula, which uses
        // the change of the residual, tolerates that (`notay2000`).
        add(&mut before, -1.0, &r);
        let beta = if iterations == 0 { 0.0 } else { -dot(&before, &z) / rz };
        rz = dot(&r, &z);
        // The next direction: what the preconditioner gives, made conjugate to the last one.
        p.par_chunks_mut(CHUNK).zip(z.par_chunks(CHUNK)).for_each(|(p, z)| {
            p.iter_mut().zip(z).for_each(|(p, z)| *p = *z + *p * beta);
        });
        operator.apply(&p, &mut q, &mut scratch);
        let alpha = rz / dot(&p, &q);
        before.copy_from_slice(&r);
        add(&mut u, alpha, &p);
        add(&mut r, -alpha, &q);
        size = dot(&r, &r).sqrt();
        iterations += 1;
        if !size.is_finite() {
            return Err(SolidError::NotPositive);
        }
    }
    if size > goal {
        let residual = size / load_size;
        return Err(SolidError::NotConverged { residual, iterations });
    }
    // The reported residual is computed from the result, not the one carried along by the
    // iteration.
    operator.forces(&u, &mut q, &mut scratch);
    let mut rest = q;
    add(&mut rest, -1.0, load);
    let mut reaction = zero();
    for (i, held) in supports.held_part(&rest) {
        reaction[i] = held;
    }
    supports.project(&mut rest);
    let residual = if load_size > 0.0 { dot(&rest, &rest).sqrt() / load_size } else { 0.0 };
    rest.iter_mut().for_each(|r| *r = -*r);
    let solution = Solution { displacement: u, reaction, residual, iterations };
    Ok(Solved { solution, residual: rest, load_size })
}
