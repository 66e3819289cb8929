//! Fills that follow a direction field.
//!
//! A room is covered with a fine grid of right triangles ([`mesh`]). On it a phase is sought that grows by a turn
//! for every bead across the field ([`phase`]); its whole turns are the beads ([`levels`]). How wide each may be is
//! then measured between its neighbours ([`widths`]).

mod levels;
mod mesh;
mod phase;
mod stripes;
mod widths;

pub use stripes::Stripes;
