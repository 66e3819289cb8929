//! Elasticity for printed parts: meshes, solvers, recovered stress.
//!
//! Nothing here knows a job file, a printer or a toolpath. Lengths in mm, forces in N, stresses in
//! MPa; tensors in the component order xx, yy, zz, xy, yz, zx (plane: xx, yy, xy), shear strains
//! doubled (engineering).

pub mod degenerate;
mod dense_elimination;
pub mod load_case;
pub mod material;
pub mod plane;
pub mod principal;
pub mod resultant;
pub mod solid;
pub mod sparse;
pub mod strength;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
