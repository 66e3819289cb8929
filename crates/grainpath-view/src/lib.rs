//! Pictures for people: layers, stress, grain, supports and damage, and the report page.
//!
//! All pictures show data that the planner returns; this crate decides nothing about beads.

pub mod bead_reserve;
pub mod density_map;
pub mod faces;
pub mod grain;
pub mod guide;
pub mod histogram;
pub mod layer;
mod mesh_pixels;
pub mod page;
pub mod poses;
pub mod strength;
pub mod support;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
