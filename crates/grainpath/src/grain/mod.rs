//! The grain of photographs and of scans: read as directions and as curves, laid as beads.

pub mod board;
pub mod canny;
pub mod corners;
pub mod curves;
pub mod guide;
pub mod lay;
pub mod markers;
pub mod photo;
mod pictures;
pub mod raster;
pub mod tensor;
pub mod texture;
pub mod warp;

pub use guide::{GrainError, GrainGuide, GrainSettings, PhotoReport, read_grain, read_scan};
pub use photo::Photo;
pub use texture::{TextureReport, TextureSettings};
