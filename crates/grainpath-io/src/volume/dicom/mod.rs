//! DICOM series: sorted by position, rescaled, checked. Pixels uncompressed, RLE, JPEG, JPEG-LS and JPEG 2000.
//!
//! Source: DICOM PS3.3 (attributes), PS3.5 (data elements, transfer syntaxes, RLE) and PS3.10 (files).
//! All headers are read before any pixel, so that a mixed folder is refused before work begins. The cross
//! product of the row and column directions is the direction in which slices follow; the position along
//! it orders them, and its median step is the spacing. A sideways drift along the stack comes from a
//! tilted gantry and is kept as a shear. Values are rescaled by slope and intercept, to Hounsfield units
//! for CT; MONOCHROME1 is inverted, so that dense material is bright.
//!
//! Frames of one file that have positions of their own are sorted and checked like the slices of a series. Padding
//! (PixelPaddingValue, up to its range limit) becomes NaN, so that it is counted and taken for air.
//!
//! Positions are in mm in the patient's frame (LPS). The cost is a pass over the headers, then a slice at
//! a time in memory. Uneven positions are kept with a warning. Missing slices, two slices at one
//! position, slices of other series, sizes, depths or spacings, several files of frames without their own positions, and
//! pixels packed in other ways are refused, each with its reason.
//!
//! Measured against dicom-object and dicom-pixeldata 0.10.1 (with their openjp2; JPEG-LS needs a C++ compiler there), on two
//! cores: they are 53 crates and 65 s of processor time to build; hayro-jpeg2000, all that this module adds, takes 7 s. Of 2000 mutants of the
//! files in `tests/dicom` they panic in 23, abort in 1 and take up to 1.1 s and 1364 MiB; this module refuses 1569 in
//! one line, reads 431, and takes at most 0.02 s and 4 MiB. Frames of 512 x 512 pixels of 12 bits: lossless JPEG 5 ms (theirs 6),
//! JPEG 2000 38 ms (theirs 53), JPEG-LS 12 ms and 12-bit JPEG 7 ms, both refused by them; JPEG of 8 bits 3 ms (theirs 1).

mod codec;
mod data_elements;
mod fragments;
mod unpacked;
mod grey_jpeg;
mod header;
#[cfg(feature = "jpeg2000")]
mod jpeg_2000;
mod jpeg_ls;
mod jpeg_stream;
mod run_length;

use grainpath_core::{Warning, WarningId};
use std::io::{Read, Seek, SeekFrom};

use grainpath_core::DVec3;

use self::codec::Codec;
use self::header::{Padding, Pixels, Slice};
use super::finite::Finite;
use super::placement::{Placement, oriented};
use super::{
    AnySlice, Files, InOrder, SampleType, SliceError, SliceSource, VolumeError, VolumeInfo, VolumeProblem,
    check_size, error, io_error, spacing, unsupported,
};

const FORMAT: &str = "DICOM";

struct Series {
    info: VolumeInfo,
    files: Files,
    slices: Vec<Slice>,
}

pub(super) fn open(
    files: &Files,
    names: &[String],
    others: usize,
) -> Result<Box<dyn SliceSource>, VolumeError> {
    // Every header is read before any pixel, so that a mixed folder is refused before work begins.
    let mut slices = Vec::new();
    for name in names {
        slices.append(&mut header::read(files, name)?);
    }
    let first = slices[0].clone();
    for s in if slices.len() == 1 { &[] } else { &slices[..] } {
        let wrong = |problem: VolumeProblem| Err(error(s.place(), problem));
        let name = first.place();
        if s.series != first.series {
            return wrong(VolumeProblem::OtherSeries { first: name });
        }
        if s.size != first.size {
            return wrong(VolumeProblem::OtherSize { found: s.size, expected: first.size, first: name });
        }
        if (s.bits, s.signed) != (first.bits, first.signed) {
            let expected = format!("{} as in {name}", bits_of(&first));
            let problem =
                VolumeProblem::Field { format: FORMAT, field: "BitsAllocated", found: bits_of(s), expected };
            return wrong(problem);
        }
        if s.frames > 1 {
            return Err(unsupported(
                &s.name,
                "several frames without functional groups in one file of a series",
                "keep a slice a file",
            ));
        }
        if let (Some(found), Some(expected)) = (s.geometry.pixel_mm, first.geometry.pixel_mm) {
            // A thousandth moves the border of a slice of 500 pixels by half a pixel.
            if (0..2).any(|k| (found[k] - expected[k]).abs() > 1e-3 * expected[k].abs()) {
                let problem = VolumeProblem::Field {
                    format: FORMAT,
                    field: "PixelSpacing",
                    found: format!("{found:?}"),
                    expected: format!("{expected:?} as in {name}"),
                };
                return wrong(problem);
            }
        }
    }
    let n = if slices.len() == 1 { first.frames } else { slices.len() };
    let sample = match (first.bits, first.signed) {
        (8, false) => SampleType::U8,
        (8, true) => SampleType::I8,
        (16, false) => SampleType::U16,
        (16, true) => SampleType::I16,
        (32, false) => SampleType::U32,
        (32, true) => SampleType::I32,
        _ => {
            let expected = "8, 16 and 32".to_owned();
            let problem = VolumeProblem::Field {
                format: FORMAT,
                field: "BitsAllocated",
                found: bits_of(&first),
                expected,
            };
            return Err(error(&first.name, problem));
        }
    };
    let mut info = VolumeInfo::new("DICOM", [first.size[0], first.size[1], n], sample);
    check_size(&first.name, info.size)?;
    info.padded = slices.iter().any(|s| s.padding.is_some());
    if others > 0 {
        let text = format!("{others} files are not DICOM and were skipped");
        info.warnings.push(Warning::new(WarningId::ScanFilesSkipped, text).in_file(files.place()));
    }
    // PixelSpacing lists the distance of rows first, then that of columns (PS3.3, 10.7.1.3).
    if let Some([dy, dx]) = first.geometry.pixel_mm {
        info.spacing_mm = [spacing(dx), spacing(dy), None];
    }
    let placement = arrange(&mut slices, &mut info)?;
    let series = InOrder::new(Series { info, files: files.clone(), slices });
    match placement {
        Some(placement) => oriented(series, &placement, files.place()),
        None => Ok(Box::new(Finite::new(series))),
    }
}

/// Gives slices that state positions and no orientation that of the usual axial, coronal or sagittal slices, whichever
/// lie across the line of the positions.
fn assume_orientation(slices: &mut [Slice], info: &mut VolumeInfo) {
    let positions: Option<Vec<[f64; 3]>> = slices.iter().map(|s| s.geometry.position).collect();
    let Some(positions) = positions.filter(|p| p.len() > 1) else { return };
    if slices.iter().any(|s| s.geometry.orientation.is_some()) {
        return;
    }
    // Slices are stacked along the axis in which their positions differ most.
    let extent = [0, 1, 2].map(|axis| {
        let along = positions.iter().map(|p| p[axis]);
        along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
    });
    // Positions that do not differ are no positions.
    if extent.iter().all(|mm| *mm < SAME_PLACE_MM) {
        return;
    }
    let (plane, orientation) = if extent[2] >= extent[0].max(extent[1]) {
        ("axial", [1.0, 0.0, 0.0, 0.0, 1.0, 0.0])
    } else if extent[1] >= extent[0] {
        ("coronal", [1.0, 0.0, 0.0, 0.0, 0.0, -1.0])
    } else {
        ("sagittal", [0.0, 1.0, 0.0, 0.0, 0.0, -1.0])
    };
    let text = format!(
        "the slices state ImagePositionPatient and no ImageOrientationPatient; they are taken for {plane} ones"
    );
    let warning = Warning::new(WarningId::ScanDirectionsAssumed, text).in_file(slices[0].name.clone());
    info.warnings.push(warning);
    slices.iter_mut().for_each(|s| s.geometry.orientation = Some(orientation));
}

/// Sorts slices without positions: by their places on a line where all state one, otherwise by instance number.
fn arrange_unplaced(slices: &mut [Slice], info: &mut VolumeInfo) -> Result<(), VolumeError> {
    info.spacing_mm[2] = slices[0].geometry.rise_mm().and_then(spacing);
    if slices.len() == 1 {
        return Ok(());
    }
    let known = |has: fn(&header::Geometry) -> bool| slices.iter().filter(|s| has(&s.geometry)).count();
    let what = match (known(|g| g.position.is_some()), known(|g| g.orientation.is_some())) {
        (0, _) => "state no positions (ImagePositionPatient)",
        (n, _) if n < slices.len() => "do not all state positions (ImagePositionPatient)",
        _ => "do not all state directions (ImageOrientationPatient)",
    };
    // SliceLocation is no place in space, but it orders the slices and gives their distance.
    let locations: Option<Vec<f64>> = slices.iter().map(|s| s.location_mm).collect();
    let distinct = |mm: &Vec<f64>| {
        let mut sorted = mm.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.windows(2).all(|w| w[1] - w[0] > SAME_PLACE_MM)
    };
    let by = if let Some(mut mm) = locations.filter(distinct) {
        slices.sort_by(|a, b| a.location_mm.unwrap_or(0.0).total_cmp(&b.location_mm.unwrap_or(0.0)));
        mm.sort_by(f64::total_cmp);
        let heights: Vec<f64> = mm.iter().map(|z| z - mm[0]).collect();
        info.spacing_mm[2] = spacing(rise(slices, heights, info)?);
        "sorted by SliceLocation"
    } else if slices.iter().all(|s| s.frame.is_some()) {
        "taken in the order of the frames"
    } else {
        // The instance number usually follows the acquisition, and file names often do not.
        slices.sort_by_key(|s| s.instance);
        "sorted by instance number"
    };
    let text = format!("the slices {what} and were {by}");
    info.warnings.push(Warning::new(WarningId::ScanOrderAssumed, text).in_file(slices[0].name.clone()));
    Ok(())
}

/// Slices nearer than this lie at one place, mm. Source: derived. Positions have up to six decimals, and no scanner's
/// slices lie 0.1 um apart.
const SAME_PLACE_MM: f64 = 1e-4;

/// The distance of sorted slices, mm, from their heights above the first. Keeps uneven heights.
///
/// # Errors
/// [`VolumeError`] for two slices at one height and for missing slices.
fn rise(slices: &[Slice], heights: Vec<f64>, info: &mut VolumeInfo) -> Result<f64, VolumeError> {
    let gaps: Vec<f64> = heights.windows(2).map(|w| w[1] - w[0]).collect();
    // Two files at one position are two reconstructions of the same scan, or a copy.
    if let Some(i) = gaps.iter().position(|g| *g < SAME_PLACE_MM) {
        return Err(error(slices[i + 1].place(), VolumeProblem::SamePosition { other: slices[i].place() }));
    }
    // The median: a few gaps must not hide themselves in the mean.
    let mut sorted = gaps.clone();
    sorted.sort_by(f64::total_cmp);
    let usual = sorted[sorted.len() / 2];
    for (i, gap) in gaps.iter().enumerate() {
        let times = gap / usual;
        // A distance that is a whole multiple of the usual one means missing slices. Any other unevenness
        // may be intended.
        if times > 1.5 && (times - times.round()).abs() < 0.02 {
            let n_missing = times.round() - 1.0;
            let problem = VolumeProblem::GapInPositions { n_missing, gap_mm: *gap, usual_mm: usual };
            return Err(error(slices[i].place(), problem));
        }
    }
    let even = heights[heights.len() - 1] / gaps.len() as f64;
    // Below 1 % the positions are rounded, and an even spacing describes them better.
    if gaps.iter().all(|g| (g / usual - 1.0).abs() <= 0.01) {
        return Ok(even);
    }
    let (low, high) = (sorted[0], sorted[sorted.len() - 1]);
    let text = format!("slices are unevenly spaced, {low:.3} to {high:.3} mm; their positions are kept");
    info.warnings.push(Warning::new(WarningId::ScanUnevenSlices, text));
    info.z_mm = heights;
    Ok(usual)
}

/// Sorts the slices by position along their normal. Finds the spacing and where the voxels lie in the
/// patient's coordinates.
fn arrange(slices: &mut [Slice], info: &mut VolumeInfo) -> Result<Option<Placement>, VolumeError> {
    assume_orientation(slices, info);
    let placed = slices.iter().all(|s| s.geometry.position.is_some() && s.geometry.orientation.is_some());
    if !placed {
        arrange_unplaced(slices, info)?;
        return Ok(None);
    }
    let o = slices[0].geometry.orientation.unwrap_or_default();
    let (row, column) = (vector(&o[..3]), vector(&o[3..]));
    // Row and column directions span the slice; their cross product is the direction in which slices
    // follow.
    let normal = row.cross(column).normalize_or_zero();
    // Six decimals leave the two directions at right angles within 1e-5. The limit of 1e-2 accepts
    // rounding and refuses directions that belong to no plane.
    let sound = |v: DVec3| (v.length() - 1.0).abs() < 1e-2;
    if !sound(row) || !sound(column) || row.dot(column).abs() > 1e-2 {
        let problem = VolumeProblem::Field {
            format: FORMAT,
            field: "ImageOrientationPatient",
            found: format!("{o:?}"),
            expected: "two directions at right angles".to_owned(),
        };
        return Err(error(slices[0].place(), problem));
    }
    let stated = slices[0].geometry.pixel_mm.is_some();
    // Without a spacing the steps get 1 mm, and `stated` tells that they are not known.
    let [dy, dx] = slices[0].geometry.pixel_mm.unwrap_or([1.0; 2]);
    let (row_mm, column_mm) = (row * dx, column * dy);
    if slices.len() == 1 {
        let thickness = slices[0].geometry.rise_mm().and_then(spacing);
        info.spacing_mm[2] = thickness;
        let origin_mm = vector(&slices[0].geometry.position.unwrap_or_default());
        let step_mm = [row_mm, column_mm, normal * thickness.unwrap_or(1.0)];
        return Ok(Some(Placement { origin_mm, step_mm, stated: [stated, stated, thickness.is_some()] }));
    }
    for s in slices.iter() {
        let p = s.geometry.orientation.unwrap_or_default();
        // 1e-3 is 0.06 degrees, which moves the border of a slice 300 mm wide by 0.3 mm.
        if (0..6).any(|k| (p[k] - o[k]).abs() > 1e-3) {
            return Err(error(s.place(), VolumeProblem::NotParallel { first: slices[0].place() }));
        }
    }
    let place = |s: &Slice| vector(&s.geometry.position.unwrap_or_default());
    slices.sort_by(|a, b| normal.dot(place(a)).total_cmp(&normal.dot(place(b))));
    let origin = place(&slices[0]);
    let heights: Vec<f64> = slices.iter().map(|s| normal.dot(place(s) - origin)).collect();
    let height_mm = heights[heights.len() - 1];
    // Slices that drift sideways as they rise come from a tilted gantry; the drift is a shear of the
    // stack.
    let drift = (place(&slices[slices.len() - 1]) - origin) - normal * height_mm;
    for (s, z) in slices.iter().zip(&heights) {
        let off_mm = (place(s) - origin - normal * *z - drift * (z / height_mm)).length();
        // Half a pixel is the most that the nearest pixel hides.
        if off_mm > 0.5 * dx.min(dy) {
            return Err(error(s.place(), VolumeProblem::OffLine { off_mm }));
        }
    }
    let rise_mm = rise(slices, heights, info)?;
    info.spacing_mm[2] = spacing(rise_mm);
    let step_mm = [row_mm, column_mm, (normal + drift / height_mm) * rise_mm];
    Ok(Some(Placement { origin_mm: origin, step_mm, stated: [stated, stated, true] }))
}

fn bits_of(slice: &Slice) -> String {
    format!("{}{}", slice.bits, if slice.signed { " (signed)" } else { "" })
}

fn vector(v: &[f64]) -> DVec3 {
    DVec3::new(v[0], v[1], v[2])
}

/// The bits of a stored pixel that hold its value.
#[derive(Debug, Clone, Copy)]
struct Field {
    /// Bits below the value.
    shift: u32,
    bits: u32,
    signed: bool,
    /// All bits of the pixel.
    n_allocated: u32,
    padding: Option<Padding>,
}

impl Field {
    fn value(self, pattern: u32) -> i64 {
        let unused = 32 - self.bits;
        let upper = pattern >> self.shift << unused;
        if self.signed { i64::from(upper.cast_signed() >> unused) } else { i64::from(upper >> unused) }
    }

    /// Appends the values of these pixels. Padding is NaN.
    fn values(self, patterns: impl Iterator<Item = u32>, out: &mut Vec<f32>) {
        // Integers above 2^24 lose digits as f32; grey values need far fewer.
        let Some(padding) = self.padding else {
            out.extend(patterns.map(|p| self.value(p) as f32));
            return;
        };
        let word =
            if padding.of_whole_word { Self { shift: 0, bits: self.n_allocated, ..self } } else { self };
        out.extend(patterns.map(|p| {
            let is_padding = (padding.lowest..=padding.highest).contains(&word.value(p));
            if is_padding { f32::NAN } else { self.value(p) as f32 }
        }));
    }
}

/// The bits of a pixel of one to four bytes.
fn pattern(bytes: &[u8], big_endian: bool) -> u32 {
    let join = |sum: u32, b: &u8| sum << 8 | u32::from(*b);
    if big_endian { bytes.iter().fold(0, join) } else { bytes.iter().rev().fold(0, join) }
}

impl Series {
    /// Slice `k`, and its frame within the file.
    fn slice(&self, k: usize) -> (&Slice, usize) {
        // One file whose frames state nothing of their own; otherwise each slice knows its frame.
        if self.slices.len() == 1 {
            (&self.slices[0], k)
        } else {
            (&self.slices[k], self.slices[k].frame.unwrap_or(0))
        }
    }
}

impl AnySlice for Series {
    fn info(&self) -> &VolumeInfo {
        &self.info
    }

    fn read_slice(&mut self, k: usize, out: &mut Vec<f32>) -> Result<(), SliceError> {
        let (s, frame) = self.slice(k);
        let n_bytes = self.info.sample.n_bytes();
        let n_allocated = 8 * n_bytes as u32;
        let field =
            Field { shift: s.shift, bits: s.stored, signed: s.signed, n_allocated, padding: s.padding };
        match &s.pixels {
            Pixels::Plain(begin) => {
                let needed = s.size[0] * s.size[1] * n_bytes;
                let mut reader = self.files.open(&s.name)?;
                let at = begin + frame as u64 * needed as u64;
                reader.seek(SeekFrom::Start(at)).map_err(|e| io_error(&s.name, &e))?;
                let mut bytes = Vec::new();
                reader.take(needed as u64).read_to_end(&mut bytes).map_err(|e| io_error(&s.name, &e))?;
                if bytes.len() < needed {
                    let problem = VolumeProblem::PixelsCutShort { found: bytes.len(), needed };
                    return Err(error(&s.name, problem).into());
                }
                field.values(bytes.chunks_exact(n_bytes).map(|b| pattern(b, s.big_endian)), out);
            }
            Pixels::Packed(packed) => {
                let bytes = packed.frame(&self.files, &s.name, frame)?;
                let frame = packed.codec.unpack(&s.name, &packed.name_of(frame), &bytes, s.size, n_bytes)?;
                // Padding beyond the bits stored cannot be in values without the bits above them.
                let padding = s.padding.filter(|p| !p.of_whole_word);
                // Runs of bytes keep the bits where they were; the other codecs hold values alone.
                let field = match packed.codec {
                    Codec::Rle => field,
                    _ if frame.signed => Field { shift: 0, bits: frame.bits, signed: true, padding, ..field },
                    _ => Field { shift: 0, bits: frame.bits.min(s.stored), padding, ..field },
                };
                field.values(frame.patterns.into_iter(), out);
            }
        }
        // MONOCHROME1 means that the lowest value is white. The sign makes dense material bright in every
        // scan.
        let sign = if s.inverted { -1.0 } else { 1.0 };
        let (slope, intercept) = s.geometry.rescale();
        let (slope, intercept) = ((slope * sign) as f32, (intercept * sign) as f32);
        // Rescale slope and intercept give Hounsfield units for CT (PS3.3, C.11.1). A slope of 1e38 overflows f32.
        out.iter_mut().for_each(|v| *v = *v * slope + intercept);
        Ok(())
    }
}
