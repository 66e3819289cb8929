//! What a person looks at: pictures of layers, stress, grain, supports and damage, and the report page.
//!
//! Everything is drawn from data that the planner returns; nothing here decides where a bead lies.

pub mod grain;
pub mod guide;
pub mod layer;
pub mod page;
pub mod strength;
pub mod support;
