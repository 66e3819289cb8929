//! Displacements from forces: conjugate gradients with multigrid, or a sparse factorization.

pub(crate) mod block_matrix;
mod direct;
pub(crate) mod easing;
pub(crate) mod half_matrix;
pub(crate) mod multigrid;
pub(crate) mod operator;
pub(crate) mod solution;
pub(crate) mod solve;
pub(crate) mod system;
