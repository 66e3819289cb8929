//! Errors of volume readers.

use grainpath_core::slices::{SampleType, SliceError};

use super::{MAX_PIXELS, MAX_SLICES};
use crate::image::ImageError;

/// Error for a volume that cannot be read: the file and the reason.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{file}: {problem}")]
pub struct VolumeError {
    /// The file, or the folder if the fault cannot be traced to one file.
    pub file: String,
    /// The fault, and what would be correct.
    #[source]
    pub problem: VolumeProblem,
}

/// Faults of volume files. Messages state what was found and what would be correct.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum VolumeProblem {
    /// The system could not open or read the file.
    #[error("{reason}")]
    Unreadable { reason: String },
    #[error("more than {limit} bytes; no slice is that large")]
    FileTooLarge { limit: u64 },
    #[error("no images in it")]
    NoFiles,
    #[error("no DICOM, PNG, TIFF, BMP or JPEG slices in it")]
    NoSlices,
    #[error(
        "not a volume: neither a folder of images, DICOM, TIFF, NRRD, MetaImage nor NIfTI; for raw data give size_px \
         and sample"
    )]
    UnknownFormat,
    #[error("not {expected}, though its name or its first bytes say so")]
    OtherFormat { expected: &'static str },
    #[error("the volume is {} x {} x {} voxels: empty", size[0], size[1], size[2])]
    Empty { size: [usize; 3] },
    #[error(
        "{} x {} x {} voxels; at most {MAX_PIXELS} a slice and {MAX_SLICES} slices are read", size[0], size[1], size[2]
    )]
    TooLarge { size: [usize; 3] },
    #[error("the {format} header has no {field}")]
    MissingField { format: &'static str, field: String },
    #[error("the {format} header states {n_axes} axes; a volume of grey values has 3")]
    OtherAxes { format: &'static str, n_axes: usize },
    #[error("{format} {field} = {found} cannot be read; {expected} can")]
    Field { format: &'static str, field: &'static str, found: String, expected: String },
    #[error("{what} cannot be read; {instead}")]
    Unsupported { what: String, instead: String },
    #[error("damaged {part}: {reason}")]
    Damaged { part: String, reason: String },
    #[error(
        "{} x {} x {} voxels of {} need {needed} bytes after byte {offset}; the file has {length}",
        size[0], size[1], size[2], sample.name()
    )]
    TooShort { size: [usize; 3], sample: SampleType, needed: u64, offset: u64, length: u64 },
    #[error(
        "{} x {} x {} voxels of {} are {needed} bytes; {length} packed bytes cannot hold as many",
        size[0], size[1], size[2], sample.name()
    )]
    CannotHold { size: [usize; 3], sample: SampleType, needed: u64, length: u64 },
    #[error(
        "{name} lies outside the folder of the header; keep both together, or set shape.ct.outside_folder = true"
    )]
    Outside { name: String },
    #[error("the data ends in slice {slice} of {n_slices}")]
    EndsInSlice { slice: usize, n_slices: usize },
    #[error("page {page}: {reason}")]
    Page { page: usize, reason: String },
    #[error(transparent)]
    Image(#[from] ImageError),
    #[error(
        "{} x {} pixels; {first} has {} x {}; all slices of a volume must have the same size",
        found[0], found[1], expected[0], expected[1]
    )]
    OtherSize { found: [usize; 2], expected: [usize; 2], first: String },
    #[error("{found} grey values; the first slice has {expected}")]
    OtherSample { found: &'static str, expected: &'static str },
    #[error("its name does not go with {like} and {n_like} more like it: is it of another series?")]
    OtherName { like: String, n_like: usize },
    #[error("slices are missing after it: the numbers go from {from} to {to}, elsewhere in steps of {step}")]
    GapInNumbers { from: u64, to: u64, step: u64 },
    #[error("belongs to another series than {first}; keep one series in the folder")]
    OtherSeries { first: String },
    #[error("is turned against {first}; slices must be parallel")]
    NotParallel { first: String },
    #[error("is at the same position as {other}")]
    SamePosition { other: String },
    #[error(
        "lies {off_mm:.3} mm beside the line through the other slices; resample the series to a straight stack"
    )]
    OffLine { off_mm: f64 },
    #[error(
        "the steps from voxel to voxel are {:?}, {:?} and {:?} mm: they span no volume; give the axes of the voxels in \
         three independent directions",
        step_mm[0], step_mm[1], step_mm[2]
    )]
    FlatAxes { step_mm: [[f64; 3]; 3] },
    #[error("voxels are {mm} mm apart; between 1e-7 and 1e4 mm can be read")]
    Spacing { mm: f64 },
    #[error(
        "the stack leans by {lean_deg:.1} degrees; up to {limit_deg} degrees are moved upright, so resample it first"
    )]
    Leans { lean_deg: f64, limit_deg: f64 },
    #[error(
        "slices are missing after it ({n_missing}): the next is {gap_mm:.3} mm higher, elsewhere {usual_mm:.3}"
    )]
    GapInPositions { n_missing: f64, gap_mm: f64, usual_mm: f64 },
    #[error(
        "pixels are packed as {encoding} ({syntax}); save the series uncompressed, or with RLE, JPEG or JPEG-LS"
    )]
    Packed { encoding: &'static str, syntax: String },
    /// This build leaves out the reader to save build time.
    #[error(
        "{what} is left out of this build; the packages read it, and so does a build with --features {feature}"
    )]
    LeftOut { what: &'static str, feature: &'static str },
    #[error("pixels are cut short: {found} of {needed} bytes")]
    PixelsCutShort { found: usize, needed: usize },
}

impl From<VolumeError> for SliceError {
    fn from(error: VolumeError) -> Self {
        Self::new(error)
    }
}

pub(crate) fn error(file: impl Into<String>, problem: impl Into<VolumeProblem>) -> VolumeError {
    VolumeError { file: file.into(), problem: problem.into() }
}

pub(crate) fn io_error(file: &str, e: &std::io::Error) -> VolumeError {
    // The system's message ends in "(os error 2)", which means nothing to a user.
    let text = e.to_string();
    let reason = text.split(" (os error").next().unwrap_or(&text).to_lowercase();
    error(file, VolumeProblem::Unreadable { reason })
}

/// An error for a part of the file that is not what its format requires.
pub(super) fn damaged(file: &str, part: impl Into<String>, reason: impl ToString) -> VolumeError {
    error(file, VolumeProblem::Damaged { part: part.into(), reason: reason.to_string() })
}

/// An error for something that the format allows and these readers do not support.
pub(super) fn unsupported(file: &str, what: impl Into<String>, instead: impl Into<String>) -> VolumeError {
    error(file, VolumeProblem::Unsupported { what: what.into(), instead: instead.into() })
}
