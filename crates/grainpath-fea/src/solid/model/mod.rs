//! What a solid is computed as: tetrahedra with their materials, what holds them and what pushes on them.

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
