//! Plates loaded in their plane: quadratic triangles, one direct solve, stress recovered at the nodes.

mod edge_loads;
mod patch_fit;
mod plane_loads;
mod plane_mesh;
mod plane_problem;
mod plane_stress;
mod plane_system;
mod quadratic_triangle;

pub use edge_loads::{LoadedSide, body_force_n, traction_n};
pub use plane_loads::Plate;
pub use plane_mesh::{PlaneMesh, mesh_region};
pub(crate) use plane_problem::loose;
pub use plane_problem::{Hold, PlaneError, PlaneProblem, PlaneStiffness};
pub use plane_stress::PlaneStress;
pub use plane_system::{PlaneSolution, PlaneSystem};

#[cfg(test)]
mod tests;
