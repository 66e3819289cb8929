//! From a closed surface to tetrahedra, by isosurface stuffing.

mod clean_surface;
mod features;
mod lattice;
pub(crate) mod mesher;
mod snap;
mod stuffing;
mod thin_gaps;
mod wall_thickness;
