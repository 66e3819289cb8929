//! What solving takes and gives.

use grainpath_core::DVec3;

/// Which solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// A factorization for small parts with many loads, iteration otherwise.
    #[default]
    Auto,
    /// Sparse Cholesky factorization: its memory grows with the 4/3rd power of the part.
    Direct,
    /// Conjugate gradients with multigrid.
    Iterative,
}

/// How to solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolveSettings {
    /// Residual over the load at which the iteration ends.
    pub tolerance: f64,
    /// Iterations at most.
    pub max_iterations: usize,
    /// Memory that may be taken, MiB.
    pub max_mib: f64,
    /// Which solver.
    pub method: Method,
}

impl Default for SolveSettings {
    fn default() -> Self {
        Self { tolerance: 1e-8, max_iterations: 400, max_mib: 4096.0, method: Method::Auto }
    }
}

/// What a load does.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// Displacement of each node, mm.
    pub displacement: Vec<DVec3>,
    /// What holds each node against the load, N; zero where nothing is prescribed.
    pub reaction: Vec<DVec3>,
    /// Residual over the load, of the displacement given.
    pub residual: f64,
    /// Iterations made; 0 for a direct solution.
    pub iterations: usize,
}

/// How it was solved.
#[derive(Debug, Clone, PartialEq)]
pub struct SolveInfo {
    /// Unknowns: three for each node less what is prescribed.
    pub n_free: usize,
    /// Name of the method.
    pub solver: &'static str,
    /// Nodes of each level of the multigrid.
    pub levels: Vec<usize>,
    /// Memory of the operator and its preconditioner, MiB.
    pub mib: f64,
}
