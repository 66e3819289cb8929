#![doc = include_str!("../README.md")]

mod kinematics;
mod machine;
mod quality;
mod read;
mod simulate;
mod write;

pub use kinematics::{Corner, Limits, Move, TimeEstimator};
pub use machine::{Cooling, FibreTool, Flavour, Machine, Material, Retraction, Speeds};
pub use quality::{Quality, quality};
pub use read::{Line, Lines};
pub use simulate::{Bead, BeadLayer, Program, SimulateError, simulate};
pub use write::{GcodeError, Thumbnail, WriteConfig, Written, check_fits, write_gcode};
