//! Results of a run: the planned job, and measurements on the written program.

pub mod alignment;
pub mod laid_density;
pub mod laid_fibre;
pub mod on_air;
pub mod plan_json;
mod planned;
pub mod report;
pub mod separate_lines;
pub mod strength;

pub use grainpath_gcode::dimensions;
pub use planned::Planned;

use grainpath_core::DVec2;

/// Compares a straight piece of a bead with the guide. The arguments are the mid-height of the layer, mm,
/// and the ends of the piece in part coordinates. The result is the angle between the piece and the guide's
/// direction, degrees from 0 to 90, and its weight: MPa for a guide by stress, 0 to 1 for grain and the user's own
/// directions. `None` outside the part and for pieces without length.
pub type DirectionError<'a> = dyn Fn(f64, [DVec2; 2]) -> Option<(f64, f64)> + 'a;
