//! Plates loaded in their plane: quadratic triangles under plane stress, one direct solution, stress
//! recovered at the nodes. `plane_mesh` makes the mesh, `plane_loads` turns fixtures and loads into holds and
//! forces, `plane_system` solves, `plane_stress` gives the stress at any point. Lengths are in mm, forces in
//! N, stresses in MPa.

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
