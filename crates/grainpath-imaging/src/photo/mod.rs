//! Photographs of boards: where the board is, the rectified picture, and curves along its edges.

pub mod corners;
pub mod edge_curves;
pub mod markers;
pub mod width_side;
mod photograph;
pub mod warp;

pub use photograph::Photo;
