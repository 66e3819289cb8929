//! Three-dimensional elasticity: from a closed surface to quadratic tetrahedra, displacements and stresses.

#![allow(clippy::needless_range_loop, reason = "rows and columns of small matrices are told by index")]

mod between;
mod blocks;
mod direct;
mod easing;
mod element;
mod error;
mod features;
mod lattice;
pub mod loads;
mod mesh;
mod mesher;
mod model;
mod multigrid;
mod operator;
mod recover;
mod sample;
mod shape;
mod snap;
mod solve;
mod stuffing;
mod supports;
mod system;
mod thickness;
pub mod voxel;

pub use error::SolidError;
pub use mesh::{Face, Piece, TetMesh};
pub use mesher::{MeshSettings, Meshed, expected_dofs, mesh};
pub use model::Model;
pub use recover::{Recovered, Stress, recover};
pub use sample::{Sampler, Spot};
pub use shape::{MeshQuality, TetQuality};
pub use solve::{Method, Solution, SolveInfo, SolveSettings, solve};
pub use supports::Supports;
