//! CT volumes, read one slice after another: memory holds one slice, whatever the size of the stack.
//!
//! NRRD, MetaImage, NIfTI, raw with its header given, DICOM series, multipage TIFF, folders of single images, Zarr. The
//! caller says how files are opened ([`Files`]). No content of a file makes these readers panic.

mod dicom;
mod error;
mod files;
mod finite;
mod in_order;
mod metaimage;
mod nifti;
mod nrrd;
mod placement;
mod raw;
mod resliced;
mod sample;
mod series;
mod tiff_pages;
mod write;
#[cfg(feature = "zarr")]
mod zarr;

pub use error::{VolumeError, VolumeProblem};
pub use files::{Files, ReadSeek, natural_order};
pub use finite::Finite;
pub use in_order::{AnySlice, InOrder};
pub use raw::RawHeader;
pub use write::write_tiff_stack;

use grainpath_core::slices::{SampleType, SliceError, SliceSource, VolumeInfo};

use error::{damaged, unsupported};
pub(crate) use error::{error, io_error};

/// Limit on the pixels of a slice: 8192 x 8192. Source: derived. A slice is held as f32, 256 MiB at this size.
const MAX_PIXELS: usize = 1 << 26;
/// Limit on the slices of a volume. Source: derived. A stack of as many micrometre slices is one metre high.
const MAX_SLICES: usize = 1 << 20;

fn check_size(file: &str, size: [usize; 3]) -> Result<(), VolumeError> {
    let pixels = size[0].saturating_mul(size[1]);
    if size.contains(&0) {
        return Err(error(file, VolumeProblem::Empty { size }));
    }
    if pixels > MAX_PIXELS || size[2] > MAX_SLICES {
        return Err(error(file, VolumeProblem::TooLarge { size }));
    }
    Ok(())
}

/// A spacing from a file. `None` unless it is finite, positive and of a size that voxels can have.
fn spacing(mm: f64) -> Option<f64> {
    let mm = mm.abs();
    // The limits are 0.1 nm and 10 m. Axes may run backwards: the sign, dropped above, belongs to the placement.
    (1e-7..1e4).contains(&mm).then_some(mm)
}

/// Whether these are the files of a Zarr array or group.
fn is_zarr(files: &Files) -> bool {
    let description = |name: &String| {
        let name = name.rsplit(['/', '\\']).next().unwrap_or(name);
        ["zarr.json", ".zarray", ".zgroup", ".zattrs"].contains(&name)
    };
    files.names().iter().any(description)
}

/// Opens a volume. Several files are a series of slices; the format of a single file is found from its content. A ZIP
/// archive is read as the folder it holds. A folder with the description of a Zarr array or group is read as Zarr. `raw`
/// describes a single file without a header.
///
/// # Errors
/// [`VolumeError`]: unknown or damaged formats, slices that do not belong together, missing slices.
pub fn open_volume(files: Files, raw: Option<&RawHeader>) -> Result<Box<dyn SliceSource>, VolumeError> {
    let Some(first) = files.names().first().cloned() else {
        return Err(error(files.place(), VolumeProblem::NoFiles));
    };
    // A header given by the user wins over the content, which may look like any format by chance.
    if let Some(header) = raw {
        return Ok(Box::new(Finite::new(raw::open(&files, &first, header)?)));
    }
    if files.is_folder() {
        if is_zarr(&files) {
            #[cfg(feature = "zarr")]
            return zarr::open(&files);
            #[cfg(not(feature = "zarr"))]
            return Err(error(files.place(), VolumeProblem::LeftOut { what: "Zarr", feature: "zarr" }));
        }
        return series::open(files);
    }
    // 512 bytes hold every signature below, up to NIfTI's at byte 344.
    let head = files.head(&first, 512)?;
    let starts = |magic: &[u8]| head.starts_with(magic);
    if starts(b"PK\x03\x04") {
        let inside = files::zip_files(&files, &first)?;
        if is_zarr(&inside) {
            return Err(unsupported(
                &first,
                "Zarr in a ZIP archive",
                "unpack the archive and name its folder",
            ));
        }
        return series::open(inside);
    }
    if starts(b"NRRD") {
        return nrrd::open(&files, &first);
    }
    if starts(b"II*\0") || starts(b"MM\0*") || starts(b"II+\0") || starts(b"MM\0+") {
        return Ok(Box::new(Finite::new(tiff_pages::open(&files, &first)?)));
    }
    // Gzip is read as NIfTI (.nii.gz): NRRD and MetaImage compress only their voxels.
    if starts(b"\x1f\x8b") || nifti::is(&head) {
        return nifti::open(&files, &first);
    }
    if head.get(128..132) == Some(b"DICM") {
        return series::open(files);
    }
    // MetaImage has no signature, only keys, and is asked after the formats that have one.
    if metaimage::is(&head) {
        return metaimage::open(&files, &first);
    }
    if starts(b"\x89PNG") || starts(b"BM") || starts(b"\xff\xd8\xff") {
        return series::open(files);
    }
    if let Some(header) = nifti::header_of(&files, &first)? {
        return nifti::open(&files, &header);
    }
    Err(error(first, VolumeProblem::UnknownFormat))
}

#[cfg(test)]
mod tests;
