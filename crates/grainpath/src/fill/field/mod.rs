//! Fills that follow a direction field.
//!
//! A room is covered with a fine grid of right triangles ([`FieldMesh`](grainpath_core::field_mesh::FieldMesh)). On it a phase is sought that grows by a turn
//! for every bead across the field ([`phase`]); its whole turns are the beads ([`levels`]). How wide each may be is
//! then measured between its neighbours ([`widths`]).

mod levels;
pub(super) mod phase;
mod seed_lines;
mod streamlines;
pub(super) mod stripes;
pub(super) mod widths;

pub use seed_lines::SeedLines;
pub use streamlines::Streamlines;
pub use stripes::Stripes;

#[cfg(test)]
mod tests;
