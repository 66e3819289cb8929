//! Multipage TIFF and BigTIFF, with one page for each slice.
//!
//! Source: TIFF 6.0, and the description that `ImageJ` writes. Pages are linked one after another, so
//! counting them means walking through the file once. The voxel size in the plane comes from the
//! resolution tags, per inch or centimetre, or in the unit of the description. Only the description
//! states the distance between slices. Resolutions of 1, 72 and 96 dots an inch are defaults of programs
//! that do not know the size; they are ignored.
//!
//! Lengths are in mm. The cost is a page at a time in memory, and the decoder's limits follow from the
//! size of the first page. A page of another size, such as a thumbnail, and a change of depth are
//! refused.

use std::io::BufReader;

use grainpath_core::units::LengthUnit;
use tiff::decoder::{Decoder, Limits};
use tiff::tags::Tag;

use super::series::{sample_of, take_grey};
use super::{
    Files, MAX_SLICES, ReadSeek, SliceError, SliceSource, VolumeError, VolumeInfo, VolumeProblem, check_size,
    error, spacing,
};
use crate::image::tiff as page;

type Pages = Decoder<BufReader<Box<dyn ReadSeek>>>;

pub(super) struct TiffSource {
    info: VolumeInfo,
    files: Files,
    name: String,
    decoder: Pages,
    next: usize,
}

pub(super) fn open(files: &Files, name: &str) -> Result<TiffSource, VolumeError> {
    // The size is read with small limits first. Only then are limits of that size set, since the decoder
    // needs them before it decodes.
    let mut decoder = start(files, name, [1, 1])?;
    let (width, height) = decoder.dimensions().map_err(|e| damaged(name, 0, &e))?;
    let (nx, ny) = (width as usize, height as usize);
    check_size(name, [nx, ny, 1])?;
    let mut decoder = start(files, name, [nx, ny])?;
    let first = page::read_page(&mut decoder, super::MAX_PIXELS as u64).map_err(|e| error(name, e))?;
    let mut info = VolumeInfo::new("multipage TIFF", [nx, ny, 1], sample_of(&first.samples));
    spacing_of(&mut decoder, &mut info);
    let mut n = 1;
    // Pages are linked one after another, so counting them means walking through the file.
    while decoder.more_images() {
        decoder.next_image().map_err(|e| damaged(name, n, &e))?;
        n += 1;
        if n > MAX_SLICES {
            return Err(error(name, VolumeProblem::TooLarge { size: [nx, ny, n] }));
        }
    }
    info.size[2] = n;
    let decoder = start(files, name, [nx, ny])?;
    Ok(TiffSource { info, files: files.clone(), name: name.to_owned(), decoder, next: 0 })
}

fn damaged(name: &str, page: usize, e: &tiff::TiffError) -> VolumeError {
    error(name, VolumeProblem::Page { page: page + 1, reason: e.to_string() })
}

fn start(files: &Files, name: &str, size: [usize; 2]) -> Result<Pages, VolumeError> {
    let decoder = Decoder::new(files.open(name)?).map_err(|e| damaged(name, 0, &e))?;
    let mut limits = Limits::default();
    // A pixel has at most four channels of eight bytes.
    limits.decoding_buffer_size = (size[0] * size[1] * 32).max(1 << 20);
    limits.intermediate_buffer_size = limits.decoding_buffer_size;
    Ok(decoder.with_limits(limits))
}

/// Reads the voxel size from the resolution tags (per inch or cm) and from what `ImageJ` writes into the
/// description.
fn spacing_of(decoder: &mut Pages, info: &mut VolumeInfo) {
    let description = decoder.get_tag_ascii_string(Tag::ImageDescription).unwrap_or_default();
    let said = |key: &str| {
        let line = description.lines().find_map(|l| l.strip_prefix(key)?.strip_prefix('='));
        line.map(|v| v.trim().to_owned())
    };
    // ImageJ gives the unit in the description and leaves ResolutionUnit at none.
    let imagej = description.starts_with("ImageJ");
    let unit = match said("unit").as_deref() {
        Some("\\u00B5m" | "µm") => Some(LengthUnit::Micron),
        Some(name) => LengthUnit::from_name(name),
        None => None,
    };
    let unit_mm = match unit {
        Some(unit) => Some(unit.mm()),
        None => match decoder.find_tag_unsigned::<u16>(Tag::ResolutionUnit) {
            // TIFF 6.0: 2 is inch, 3 is centimetre.
            Ok(Some(2)) if !imagej => Some(LengthUnit::Inch.mm()),
            Ok(Some(3)) if !imagej => Some(LengthUnit::Centimetre.mm()),
            _ => None,
        },
    };
    let Some(unit_mm) = unit_mm else { return };
    for (k, tag) in [Tag::XResolution, Tag::YResolution].into_iter().enumerate() {
        if let Ok(Some(tiff::decoder::ifd::Value::Rational(a, b))) = decoder.find_tag(tag) {
            // 1, 72 and 96 dots an inch are defaults of programs that do not know the size.
            let per_unit = f64::from(a) / f64::from(b);
            if ![1.0, 72.0, 96.0].contains(&per_unit) || imagej {
                info.spacing_mm[k] = spacing(unit_mm / per_unit);
            }
        }
    }
    // Only ImageJ states the distance between slices.
    info.spacing_mm[2] =
        said("spacing").and_then(|v| v.parse::<f64>().ok()).and_then(|s| spacing(s * unit_mm));
}

impl TiffSource {
    fn advance(&mut self) -> Result<(), VolumeError> {
        self.next += 1;
        if self.next < self.info.size[2] {
            self.decoder.next_image().map_err(|e| damaged(&self.name, self.next, &e))?;
        }
        Ok(())
    }
}

impl SliceSource for TiffSource {
    fn info(&self) -> &VolumeInfo {
        &self.info
    }

    fn restart(&mut self) -> Result<(), SliceError> {
        self.decoder = start(&self.files, &self.name, [self.info.size[0], self.info.size[1]])?;
        self.next = 0;
        Ok(())
    }

    fn next_slice(&mut self, out: &mut Vec<f32>) -> Result<bool, SliceError> {
        out.clear();
        if self.next == self.info.size[2] {
            return Ok(false);
        }
        let place = format!("{} page {}", self.name, self.next + 1);
        let size = self.decoder.dimensions().map_err(|e| damaged(&self.name, self.next, &e))?;
        let (nx, ny) = (size.0 as usize, size.1 as usize);
        // Thumbnails and previews may stand among the pages.
        if [nx, ny] != self.info.size[..2] {
            let [x, y, _] = self.info.size;
            let first = "the first page".to_owned();
            return Err(
                error(place, VolumeProblem::OtherSize { found: [nx, ny], expected: [x, y], first }).into()
            );
        }
        let image = page::read_page(&mut self.decoder, super::MAX_PIXELS as u64);
        let image = image.map_err(|e| error(&place, e))?;
        take_grey(image, &self.info, &place, out)?;
        self.advance()?;
        Ok(true)
    }

    fn skip_slice(&mut self) -> Result<bool, SliceError> {
        if self.next == self.info.size[2] {
            return Ok(false);
        }
        self.advance()?;
        Ok(true)
    }
}
