#![doc = include_str!("../README.md")]

pub mod dimensions;
mod kinematics;
mod layer_groups;
mod machine;
mod quality;
mod read;
mod simulate;
mod write;

pub use kinematics::{Corner, KLIPPER_ARC_SEGMENT_MM, KLIPPER_MIN_CRUISE_RATIO, Limits, Move, TimeEstimator};
pub use layer_groups::{Bead, BeadLayer, Pull};
pub use machine::{Cooling, FibreTool, Flavour, Machine, Material, Retraction, Speeds};
pub use quality::{Quality, quality};
pub use read::{Line, Lines};
pub use simulate::{Program, Replay, SimulateError, simulate};
pub use write::{GcodeError, Thumbnail, WriteConfig, Written, check_fits, write_gcode};
