//! From a closed surface to tetrahedra, by isosurface stuffing (`labelle2007`). `mesher` runs the steps:
//! `clean_surface` and `wall_thickness` prepare the surface, `lattice` and `thin_gaps` the background
//! lattice, `stuffing` cuts it along the surface, `features` and `snap` restore sharp edges.

mod clean_surface;
mod features;
mod lattice;
pub(crate) mod mesher;
mod snap;
mod stuffing;
mod thin_gaps;
mod wall_thickness;
