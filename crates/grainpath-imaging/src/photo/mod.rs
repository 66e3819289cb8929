//! Photographs of boards: where the board is, the rectified picture, and curves along its edges.

pub mod corners;
pub mod curves;
pub mod markers;
pub mod orientation;
mod photograph;
pub mod warp;

pub use photograph::Photo;
