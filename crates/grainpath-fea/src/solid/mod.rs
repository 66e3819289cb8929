//! Three-dimensional elasticity: from a closed surface to quadratic tetrahedra, displacements and stresses.

mod element;
mod error;
mod features;
mod lattice;
mod mesh;
mod mesher;
mod shape;
mod snap;
mod stuffing;
mod thickness;

pub use element::Stiffness;
pub use error::SolidError;
pub use mesh::{Face, Piece, TetMesh};
pub use mesher::{MeshSettings, Meshed, expected_dofs, mesh};
pub use shape::{MeshQuality, TetQuality};
pub use thickness::wall_thickness_mm;
