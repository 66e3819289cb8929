//! Settings and results of a solution.

use grainpath_core::DVec3;
use grainpath_core::diagnostics::CancelFlag;

/// Choice of the solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// A factorization for small parts with many loads, otherwise iteration.
    #[default]
    Auto,
    /// Sparse Cholesky factorization: its memory grows with the 4/3rd power of the part.
    Direct,
    /// Conjugate gradients with multigrid.
    Iterative,
}

/// Settings of a solution.
#[derive(Debug, Clone)]
pub struct SolveSettings {
    /// Residual relative to the load at which the iteration ends.
    pub tolerance: f64,
    /// Largest number of iterations.
    pub max_iterations: usize,
    /// Memory limit, MiB.
    pub max_mib: f64,
    /// The solver.
    pub method: Method,
    /// Ends the solution between two iterations.
    pub cancel: CancelFlag,
}

impl Default for SolveSettings {
    /// Eight digits within 400 iterations, by the solver that suits the size, without a limit on memory.
    fn default() -> Self {
        Self {
            tolerance: 1e-8,
            max_iterations: 400,
            max_mib: f64::INFINITY,
            method: Method::Auto,
            cancel: CancelFlag::default(),
        }
    }
}

/// Displacements and reactions under a load.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// Displacement of each node, mm.
    pub displacement: Vec<DVec3>,
    /// Force of the supports on each node, N; zero where no displacement is prescribed.
    pub reaction: Vec<DVec3>,
    /// Residual of the displacement, relative to the load.
    pub residual: f64,
    /// Iterations made; 0 for a direct solution.
    pub iterations: usize,
}

/// How a system was solved.
#[derive(Debug, Clone, PartialEq)]
pub struct SolveInfo {
    /// Number of unknowns: three for each node less the prescribed ones.
    pub n_free: usize,
    /// Name of the method.
    pub solver: &'static str,
    /// Nodes of each level of the multigrid.
    pub levels: Vec<usize>,
    /// Memory of the operator and its preconditioner, MiB.
    pub mib: f64,
}
