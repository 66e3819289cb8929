//! Three-dimensional elasticity: from a closed surface to quadratic tetrahedra, displacements and stresses.

#![allow(clippy::needless_range_loop, reason = "rows and columns of small matrices are told by index")]

mod loading;
mod meshing;
mod model;
mod recovery;
mod solver;
pub mod voxel;

pub use loading::LoadedSolid;
pub use meshing::mesher::{MeshSettings, Meshed, expected_dofs, mesh};
pub use model::constraints::Supports;
pub use model::error::SolidError;
pub use model::material_map::Model;
pub use model::nodal_forces;
pub use model::point_location::{Sampler, Spot};
pub use model::tet_mesh::{Face, Piece, TetMesh};
pub use model::tet_shape::{MeshQuality, TetQuality};
pub use recovery::{Recovered, Stress, recover};
pub use solver::solution::{Method, Solution, SolveInfo, SolveSettings};
pub use solver::solve::solve;
