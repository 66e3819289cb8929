//! Image processing: photographs of boards become rectified images, directions and curves; scans become contours.
//!
//! This crate does not depend on job files, printers or toolpaths. Lengths are in mm unless a name
//! ends in `_px`, angles in radians. Grey values are `f32`, row by row; photographs have their first
//! row at the top, rectified images and scan slices at the bottom.

pub mod canny;
pub mod distance;
pub mod loft;
pub mod metric;
pub mod photo;
pub mod raster;
pub mod scan;
pub mod smooth;
pub mod structure_tensor;
pub mod threshold;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
