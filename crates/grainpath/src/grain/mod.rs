//! The grain of a photograph: rectified, read as directions and as curves.

pub mod board;
pub mod canny;
pub mod curves;
pub mod lay;
pub mod raster;
pub mod tensor;
pub mod warp;
