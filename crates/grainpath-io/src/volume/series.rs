//! Folders with one file for each slice.
//!
//! A folder is a DICOM series if any of its files is DICOM; the content decides, because such files often have no extension.
//! Otherwise its images are the slices, in natural order: numbers within names are compared as numbers, so slice 10 follows
//! slice 9. The first image sets the size and depth that all others must have.
//!
//! Two checks come before any pixel is decoded. A name that differs from the others in more than its
//! numbers belongs to another series. A number that is missing in a regular sequence is a missing slice,
//! which would shift all slices above it. The voxel size is not known from images. The cost is one image
//! at a time in memory; hidden files and index files of DICOM media are skipped.

use super::files::MAX_FILE;
use super::finite::Finite;
use super::{
    Files, SampleType, SliceError, SliceSource, VolumeError, VolumeInfo, VolumeProblem, check_size, error,
};
use crate::image::{Image, Samples, decode_within};
use grainpath_core::slices::SliceCursor;
use grainpath_core::{Warning, WarningId};

/// Opens a folder: as a DICOM series where any file is DICOM, otherwise as images in natural order.
pub(super) fn open(files: Files) -> Result<Box<dyn SliceSource>, VolumeError> {
    let name_of = |path: &str| path.rsplit(['/', '\\']).next().unwrap_or(path).to_owned();
    // Index files of DICOM media and hidden files of macOS are no slices.
    let visible =
        |n: &&String| !name_of(n).starts_with('.') && name_of(n) != "DICOMDIR" && !n.contains("__MACOSX");
    let names: Vec<String> = files.names().iter().filter(visible).cloned().collect();
    let kind =
        |n: &String| name_of(n).rsplit_once('.').map(|(_, e)| e.to_ascii_lowercase()).unwrap_or_default();
    let image = |n: &&String| ["png", "bmp", "jpg", "jpeg", "tif", "tiff"].contains(&kind(n).as_str());
    let images: Vec<String> = names.iter().filter(image).cloned().collect();
    let mut others = Vec::new();
    let mut dicoms = Vec::new();
    for name in names.iter().filter(|n| !image(n)) {
        // DICOM files often have no extension, so their content decides.
        let head = files.head(name, 132)?;
        if head.get(128..132) == Some(b"DICM") {
            dicoms.push(name.clone())
        } else {
            others.push(name.clone())
        }
    }
    if !dicoms.is_empty() {
        return super::dicom::open(&files, &dicoms, images.len() + others.len());
    }
    if images.is_empty() {
        return Err(error(files.place(), VolumeProblem::NoSlices));
    }
    // Both checks come before any pixel is decoded, because a gap would shift all slices above it.
    check_names(&images)?;
    check_numbers(&images)?;
    // The first slice fixes size and depth of all; each later slice is compared when it is read.
    let first = read(&files, &images[0])?;
    let format = match first.format {
        crate::image::ImageFormat::Png => "PNG series",
        crate::image::ImageFormat::Jpeg => "JPEG series",
        crate::image::ImageFormat::Tiff => "TIFF series",
        crate::image::ImageFormat::Bmp => "BMP series",
    };
    let size = [first.width, first.height, images.len()];
    check_size(files.place(), size)?;
    let mut info = VolumeInfo::new(format, size, sample_of(&first.samples));
    if !others.is_empty() {
        let text = format!("{} files are not images and were skipped", others.len());
        info.warnings.push(Warning::new(WarningId::ScanFilesSkipped, text).in_file(files.place()));
    }
    let cursor = SliceCursor::new(images.len());
    Ok(Box::new(Finite::new(Series { info, files, names: images, cursor })))
}

struct Series {
    info: VolumeInfo,
    files: Files,
    names: Vec<String>,
    cursor: SliceCursor,
}

impl SliceSource for Series {
    fn info(&self) -> &VolumeInfo {
        &self.info
    }

    fn restart(&mut self) -> Result<(), SliceError> {
        self.cursor.restart();
        Ok(())
    }

    fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        out.clear();
        let Some(k) = self.cursor.slice() else { return Ok(false) };
        let name = &self.names[k];
        let image = read(&self.files, name)?;
        if [image.width, image.height] != self.info.size[..2] {
            let [x, y, _] = self.info.size;
            let (found, first) = ([image.width, image.height], self.names[0].clone());
            return Err(error(name, VolumeProblem::OtherSize { found, expected: [x, y], first }).into());
        }
        take_grey(image, &self.info, name, out)?;
        Ok(self.cursor.pass())
    }

    fn skip_slice(&mut self) -> Result<bool, SliceError> {
        Ok(self.cursor.pass())
    }
}

fn read(files: &Files, name: &str) -> Result<Image, VolumeError> {
    let bytes = files.whole(name, MAX_FILE)?;
    decode_within(&bytes, super::MAX_PIXELS as u64).map_err(|e| error(name, e))
}

pub(super) fn sample_of(samples: &Samples) -> SampleType {
    match samples {
        Samples::U8(_) => SampleType::U8,
        Samples::U16(_) => SampleType::U16,
        Samples::F32(_) => SampleType::F32,
    }
}

/// Converts a slice to grey values. Its depth must be that of the first slice.
pub(super) fn take_grey(
    image: Image,
    info: &VolumeInfo,
    place: &str,
    out: &mut Vec<f32>,
) -> Result<(), VolumeError> {
    // A change of depth would change the scale of grey values between two slices.
    let found = sample_of(&image.samples);
    if found != info.sample {
        let (found, expected) = (found.name(), info.sample.name());
        return Err(error(place, VolumeProblem::OtherSample { found, expected }));
    }
    *out = image.to_grey_f32();
    Ok(())
}

/// Finds a name that differs from the others in more than its numbers, such as a slice of another series
/// or a thumbnail.
fn check_names(names: &[String]) -> Result<(), VolumeError> {
    // The text parts of a name without its numbers; equal for all slices of a series.
    let shape = |name: &String| {
        let runs = name.split(|c: char| c.is_ascii_digit()).filter(|part| !part.is_empty());
        runs.map(str::to_ascii_lowercase).collect::<Vec<_>>()
    };
    let shapes: Vec<Vec<String>> = names.iter().map(shape).collect();
    let mut counts = std::collections::BTreeMap::new();
    shapes.iter().for_each(|s| *counts.entry(s).or_insert(0usize) += 1);
    // If several patterns of names are equally common, the first one in the folder counts as the series.
    let n = counts.values().copied().max().unwrap_or(0);
    let usual = shapes.iter().position(|s| counts[s] == n).unwrap_or(0);
    match shapes.iter().position(|s| *s != shapes[usual]) {
        // If all names differ, there is no common pattern to compare a name with.
        Some(stranger) if n > 1 => {
            let problem = VolumeProblem::OtherName { like: names[usual].clone(), n_like: n - 1 };
            Err(error(&names[stranger], problem))
        }
        _ => Ok(()),
    }
}

/// The last number in a name, with the text before and after it.
fn number(name: &str) -> Option<(&str, u64, &str)> {
    let stem_end = name.rfind('.').unwrap_or(name.len());
    let end = name[..stem_end].rfind(|c: char| c.is_ascii_digit())? + 1;
    let begin = name[..end]
        .rfind(|c: char| !c.is_ascii_digit())
        .map_or(0, |i| i + name[i..].chars().next().map_or(1, char::len_utf8));
    Some((&name[..begin], name[begin..end].parse().ok()?, &name[end..]))
}

/// Finds a gap in the numbers of the names, if the names are numbered.
fn check_numbers(names: &[String]) -> Result<(), VolumeError> {
    let numbers: Option<Vec<_>> = names.iter().map(|n| number(n)).collect();
    // Two names have only one distance, so a gap cannot be recognised.
    let Some(numbers) = numbers.filter(|n| n.len() > 2) else { return Ok(()) };
    if numbers.iter().any(|n| n.0 != numbers[0].0) {
        return Ok(());
    }
    let steps: Vec<u64> = numbers.windows(2).map(|w| w[1].1.wrapping_sub(w[0].1)).collect();
    // Series may count in steps of 2 or 10, so the smallest step is the regular one.
    let step = steps.iter().copied().min().unwrap_or(1).max(1);
    match steps.iter().position(|&s| s != step) {
        // If a distance is not a multiple of the smallest step, the numbers do not count slices but are, for example, times
        // or sizes.
        Some(i) if steps[i].is_multiple_of(step) => {
            let problem = VolumeProblem::GapInNumbers { from: numbers[i].1, to: numbers[i + 1].1, step };
            Err(error(&names[i], problem))
        }
        _ => Ok(()),
    }
}
