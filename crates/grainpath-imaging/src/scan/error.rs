//! Errors of scans.

use std::fmt;

use grainpath_core::diagnostics::Interrupted;
use grainpath_core::slices::SliceError;

/// Why a scan cannot be made into layers.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)]
pub enum ScanError {
    #[error(transparent)]
    Slices(#[from] SliceError),
    #[error(
        "the part is {height_mm:.3} mm high, less than half the first layer ({first_layer_mm} mm); check its unit"
    )]
    TooFlat { height_mm: f64, first_layer_mm: f64 },
    #[error("{n} layers of {height_mm} mm; at most {limit} are possible")]
    TooManyLayers { n: usize, height_mm: f64, limit: usize },
    #[error(
        "{section}.crop_px = {crop:?}: should be first column, first row, last column, last row of {columns} x {rows} pixels"
    )]
    Crop { section: &'static str, crop: [usize; 4], columns: usize, rows: usize },
    #[error(
        "{section}.window = [{first}, {last}]: should be the first and last of {n} slices, counted from 0"
    )]
    Window { section: &'static str, first: usize, last: usize, n: usize },
    #[error("the file states no {what}; set {keys}")]
    NoSpacing { what: String, keys: String },
    #[error(
        "none of {voxels} voxels looked at is a number (all are NaN, infinite or padding); check the sample type and the byte order"
    )]
    NotFinite { voxels: u64 },
    #[error(
        "the bytes of the voxels are in the wrong order: the image is noise as stored and smooth with the bytes exchanged; give the other {section}.byte_order for raw data, or correct the header of the file"
    )]
    ByteOrder { section: &'static str },
    #[error(
        "the grey values are noise: neighbouring voxels are unrelated; check the size, the sample type and the byte order of raw data, or set {section}.smooth for a very noisy scan"
    )]
    Noise { section: &'static str },
    #[error("every voxel has the grey value {grey} as float32, so the part cannot be told from air")]
    Blank { grey: f32 },
    #[error("the scan ends early")]
    EndsEarly,
    #[error("a threshold of {threshold} leaves no material; {greys}")]
    ThresholdTooHigh { threshold: GreyRange, greys: GreyValues },
    #[error("a threshold of {threshold} makes every voxel material; {greys}")]
    ThresholdTooLow { threshold: GreyRange, greys: GreyValues },
    #[error(
        "a threshold of {threshold} leaves only islands below min_island_mm2 = {min_island_mm2}; {greys}"
    )]
    OnlySpecks { threshold: GreyRange, min_island_mm2: f64, greys: GreyValues },
    #[error(
        "Canny finds no edge along the threshold of {threshold}: lower {section}.canny_low and {section}.canny_high"
    )]
    NoEdge { threshold: GreyRange, section: &'static str },
    #[error("a scan with unevenly spaced slices cannot be rotated; resample the scan first")]
    UnevenSlices,
    #[error(
        "rotated slices have {columns} x {rows} pixels; at most {limit} are made: set crop_px or rotate by quarter turns"
    )]
    TooManyPixels { columns: f64, rows: f64, limit: f64 },
    #[error("a rotated scan cannot be read in parts: each rotated slice needs every slice of the file")]
    TurnedInParts,
    #[error("a part of the scan names the slices {first} to {end}, but the scan has {n} slices")]
    PartOutside { first: usize, end: usize, n: usize },
    #[error("two parts of the scan hold the same layer: they were cut from different surveys of the scan")]
    PartsOverlap,
    #[error("slice {slice} is in no part of the scan, or in more than one")]
    MissingPart { slice: usize },
    #[error("no layer of the part has any area")]
    NothingLeft,
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

/// The grey values that are material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GreyRange {
    /// The lowest.
    pub low: f64,
    /// The highest; infinite without an upper threshold.
    pub high: f64,
}

impl fmt::Display for GreyRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.high.is_finite() {
            write!(f, "{} to {}", self.low, self.high)
        } else {
            write!(f, "{}", self.low)
        }
    }
}

/// The lowest and the highest grey value of a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GreyValues(pub f32, pub f32);

impl fmt::Display for GreyValues {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the grey values are {} to {}", self.0, self.1)
    }
}
