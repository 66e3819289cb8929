//! Results: the planned job, and measurements on the written program.

pub mod alignment;
pub mod density;
pub mod dimensions;
pub mod fibre;
pub mod plan_json;
mod planned;
pub mod report;
pub mod separate_lines;
pub mod strength;

pub use planned::Planned;

use grainpath_core::DVec2;

/// Of the height of a layer's middle, mm, and the ends of a straight piece of bead, in part
/// coordinates: the angle between it and the axis the guide asks for there, degrees from 0 to 90,
/// and how much that matters, 0 to 1. `None` outside the part and for points.
pub type DirectionError<'a> = dyn Fn(f64, [DVec2; 2]) -> Option<(f64, f64)> + 'a;
