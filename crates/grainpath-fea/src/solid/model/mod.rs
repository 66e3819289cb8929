//! The model of a solid: tetrahedra with their materials, supports and nodal forces.

pub(crate) mod adjacency;
pub(crate) mod constraints;
pub(crate) mod error;
pub(crate) mod material_map;
pub(crate) mod memory;
pub mod nodal_forces;
pub(crate) mod point_location;
pub(crate) mod quadratic_tet;
pub(crate) mod tet_mesh;
pub(crate) mod tet_shape;
