//! CT volumes, one slice after another: memory for a slice, whatever the size of the stack.
//!
//! NRRD, MetaImage, NIfTI, raw with its header given, DICOM series, multipage TIFF and folders of single images.
//! Front ends say how files are opened ([`Files`]); everything here survives any bytes.

mod dicom;
mod files;
mod metaimage;
mod nifti;
mod nrrd;
mod raw;
mod sample;
mod series;
mod tiff_pages;
mod write;

pub use files::{Files, ReadSeek, natural_order};
pub use raw::RawHeader;
pub use sample::SampleType;
pub use write::write_tiff_stack;

use grainpath_core::units::LengthUnit;

/// Why a volume cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {problem}")]
pub struct VolumeError {
    /// The file, or the folder where no single file is to blame.
    pub file: String,
    /// What is wrong and what would be right.
    pub problem: String,
}

pub(crate) fn error(file: impl Into<String>, problem: impl Into<String>) -> VolumeError {
    VolumeError { file: file.into(), problem: problem.into() }
}

pub(crate) fn io_error(file: &str, e: &std::io::Error) -> VolumeError {
    let text = e.to_string();
    error(file, text.split(" (os error").next().unwrap_or(&text).to_lowercase())
}

/// What is known of a volume before its slices are read.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumeInfo {
    /// The format's name for people.
    pub format: &'static str,
    /// Columns, rows, slices.
    pub size: [usize; 3],
    /// How a voxel is stored.
    pub sample: SampleType,
    /// Distance of voxels in x, y and z in mm where the file states it.
    pub spacing_mm: [Option<f64>; 3],
    /// Heights of the slices where they are not even, mm, rising from 0; else empty.
    pub z_mm: Vec<f64>,
    /// What was odd but could be read.
    pub warnings: Vec<String>,
}

impl VolumeInfo {
    fn new(format: &'static str, size: [usize; 3], sample: SampleType) -> Self {
        Self { format, size, sample, spacing_mm: [None; 3], z_mm: Vec::new(), warnings: Vec::new() }
    }
}

/// A volume that gives one slice after another, from the first.
pub trait SliceSource: Send {
    /// What is known beforehand.
    fn info(&self) -> &VolumeInfo;

    /// Goes back to the first slice.
    ///
    /// # Errors
    /// [`VolumeError`] where a file can no longer be read.
    fn restart(&mut self) -> Result<(), VolumeError>;

    /// Puts the next slice into `out`, row by row, and goes on; `false` after the last.
    ///
    /// # Errors
    /// [`VolumeError`] that names the file and what is wrong in it.
    fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, VolumeError>;

    /// Passes over the next slice; `false` after the last.
    ///
    /// # Errors
    /// As [`SliceSource::next_slice`].
    fn skip_slice(&mut self) -> Result<bool, VolumeError>;
}

/// Slices with more pixels are not read.
const MAX_PIXELS: usize = 1 << 26;
/// Nor volumes with more slices.
const MAX_SLICES: usize = 1 << 20;

fn check_size(file: &str, size: [usize; 3]) -> Result<(), VolumeError> {
    let pixels = size[0].saturating_mul(size[1]);
    if size.contains(&0) {
        return Err(error(
            file,
            format!("the volume is {} x {} x {} voxels: empty", size[0], size[1], size[2]),
        ));
    }
    if pixels > MAX_PIXELS || size[2] > MAX_SLICES {
        let what = format!("{} x {} x {} voxels", size[0], size[1], size[2]);
        return Err(error(
            file,
            format!("{what}; at most {MAX_PIXELS} a slice and {MAX_SLICES} slices are read"),
        ));
    }
    Ok(())
}

fn unit_mm(unit: LengthUnit) -> f64 {
    unit.mm()
}

/// A spacing out of a file: finite, positive, of a size voxels can have.
fn spacing(mm: f64) -> Option<f64> {
    let mm = mm.abs();
    (1e-7..1e4).contains(&mm).then_some(mm)
}

/// Opens a volume. Several files are a series of slices, a single one is told by its content; a ZIP archive stands for
/// the folder it holds. `raw` describes a single file without a header.
///
/// # Errors
/// [`VolumeError`]: unknown or damaged formats, slices that do not belong together, missing slices.
pub fn open_volume(files: Files, raw: Option<&RawHeader>) -> Result<Box<dyn SliceSource>, VolumeError> {
    let Some(first) = files.names().first().cloned() else {
        return Err(error(files.place(), "no images in it"));
    };
    if let Some(header) = raw {
        return Ok(Box::new(raw::open(&files, &first, header)?));
    }
    if files.is_folder() {
        return series::open(files);
    }
    let head = files.head(&first, 512)?;
    let starts = |magic: &[u8]| head.starts_with(magic);
    if starts(b"PK\x03\x04") {
        return series::open(files::zip_files(&files, &first)?);
    }
    if starts(b"NRRD") {
        return Ok(Box::new(nrrd::open(&files, &first)?));
    }
    if starts(b"II*\0") || starts(b"MM\0*") || starts(b"II+\0") || starts(b"MM\0+") {
        return Ok(Box::new(tiff_pages::open(&files, &first)?));
    }
    if starts(b"\x1f\x8b") || nifti::is(&head) {
        return Ok(Box::new(nifti::open(&files, &first)?));
    }
    if head.get(128..132) == Some(b"DICM") {
        return series::open(files);
    }
    if metaimage::is(&head) {
        return Ok(Box::new(metaimage::open(&files, &first)?));
    }
    if starts(b"\x89PNG") || starts(b"BM") || starts(b"\xff\xd8\xff") {
        return series::open(files);
    }
    Err(error(
        first,
        "not a volume: neither a folder of images, DICOM, TIFF, NRRD, MetaImage nor NIfTI; for raw data give size_px and sample",
    ))
}

#[cfg(test)]
mod tests;
