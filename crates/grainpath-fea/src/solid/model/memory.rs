//! The memory of a solution, estimated before it is allocated.

use crate::sparse::BYTES_PER_MIB;

/// Memory of the operator, the multigrid and the vectors of conjugate gradients for each node.
/// Measured: 1250 bytes a node at the peak of a solution with the iterative solver.
const BYTES_PER_NODE: f64 = 1250.0;

/// Memory of an iterative solution, MiB.
pub(crate) fn solving_mib(n_nodes: f64) -> f64 {
    BYTES_PER_NODE * n_nodes / BYTES_PER_MIB
}

/// The element edge, mm, at which a step fits into memory. The memory of a thin shell grows with
/// the square of the number of elements along an edge. That of a solid grows with the cube, so for
/// solids the estimate is on the safe side.
pub(crate) fn fitting_edge_mm(edge_mm: f64, need_mib: f64, limit_mib: f64) -> f64 {
    edge_mm * (need_mib / limit_mib).sqrt()
}
