//! DICOM series: sorted by position, rescaled, checked. Uncompressed and RLE pixel data.
//!
//! Source: DICOM PS3.3 (attributes), PS3.5 (data elements, transfer syntaxes, RLE) and PS3.10 (files).
//! All headers are read before any pixel, so that a mixed folder is refused before work begins. The cross
//! product of the row and column directions is the direction in which slices follow; the position along
//! it orders them, and its median step is the spacing. A sideways drift along the stack comes from a
//! tilted gantry and is kept as a shear. Values are rescaled by slope and intercept, to Hounsfield units
//! for CT; MONOCHROME1 is inverted, so that dense material is bright.
//!
//! Positions are in mm in the patient's frame (LPS). The cost is a pass over the headers, then a slice at
//! a time in memory. Uneven positions are kept with a warning. Missing slices, two slices at one
//! position, slices of other series, sizes or depths, frames without their own positions and compressed
//! pixels other than RLE are refused, each with its reason.

use grainpath_core::{Warning, WarningId};
use std::io::{BufRead, Read, Seek, SeekFrom};

use grainpath_core::DVec3;

use super::files::MAX_FILE;
use super::placement::{Placement, oriented};
use super::{
    AnySlice, Files, InOrder, SampleType, SliceError, SliceSource, VolumeError, VolumeInfo, VolumeProblem,
    check_size, damaged, error, io_error, sample, spacing, unsupported,
};

const FORMAT: &str = "DICOM";

/// The header of a slice file.
#[derive(Debug, Clone, Default)]
struct Slice {
    name: String,
    series: String,
    size: [usize; 2],
    bits: usize,
    signed: bool,
    big_endian: bool,
    rle: bool,
    slope: f64,
    intercept: f64,
    pixel_mm: Option<[f64; 2]>,
    thickness_mm: Option<f64>,
    position: Option<[f64; 3]>,
    orientation: Option<[f64; 6]>,
    instance: i64,
    /// Offset of the pixels in the file and their length. Frames follow one another.
    data: (u64, u64),
    frames: usize,
    inverted: bool,
}

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
    let mut slices: Vec<Slice> = names.iter().map(|n| read_header(files, n)).collect::<Result<_, _>>()?;
    let first = slices[0].clone();
    for s in &slices[1..] {
        let wrong = |problem: VolumeProblem| Err(error(&s.name, problem));
        let name = first.name.clone();
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
            // Positions of single frames stand in functional groups, which are not read.
            return Err(unsupported(
                &s.name,
                "several frames in one file of a series",
                "keep a slice a file",
            ));
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
    if others > 0 {
        let text = format!("{others} files are not DICOM and were skipped");
        info.warnings.push(Warning::new(WarningId::ScanFilesSkipped, text).in_file(files.place()));
    }
    // PixelSpacing lists the distance of rows first, then that of columns (PS3.3, 10.7.1.3).
    if let Some([dy, dx]) = first.pixel_mm {
        info.spacing_mm = [spacing(dx), spacing(dy), None];
    }
    let placement = arrange(&mut slices, &mut info)?;
    let series = InOrder::new(Series { info, files: files.clone(), slices });
    match placement {
        Some(placement) => oriented(series, &placement, files.place()),
        None => Ok(Box::new(series)),
    }
}

/// Sorts the slices by position along their normal. Finds the spacing and where the voxels lie in the
/// patient's coordinates.
fn arrange(slices: &mut [Slice], info: &mut VolumeInfo) -> Result<Option<Placement>, VolumeError> {
    let placed = slices.iter().all(|s| s.position.is_some() && s.orientation.is_some());
    if !placed {
        if slices.len() > 1 {
            let text = "the slices state no positions and were sorted by instance number";
            let warning = Warning::new(WarningId::ScanOrderAssumed, text).in_file(slices[0].name.clone());
            info.warnings.push(warning);
            // The instance number usually follows the acquisition, and file names often do not.
            slices.sort_by_key(|s| s.instance);
        }
        info.spacing_mm[2] = slices[0].thickness_mm.and_then(spacing);
        return Ok(None);
    }
    let o = slices[0].orientation.unwrap_or_default();
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
        return Err(error(&slices[0].name, problem));
    }
    let stated = slices[0].pixel_mm.is_some();
    // Without a spacing the steps get 1 mm, and `stated` tells that they are not known.
    let [dy, dx] = slices[0].pixel_mm.unwrap_or([1.0; 2]);
    let (row_mm, column_mm) = (row * dx, column * dy);
    if slices.len() == 1 {
        let thickness = slices[0].thickness_mm.and_then(spacing);
        info.spacing_mm[2] = thickness;
        let origin_mm = vector(&slices[0].position.unwrap_or_default());
        let step_mm = [row_mm, column_mm, normal * thickness.unwrap_or(1.0)];
        return Ok(Some(Placement { origin_mm, step_mm, stated: [stated, stated, thickness.is_some()] }));
    }
    for s in slices.iter() {
        let p = s.orientation.unwrap_or_default();
        // 1e-3 is 0.06 degrees, which moves the border of a slice 300 mm wide by 0.3 mm.
        if (0..6).any(|k| (p[k] - o[k]).abs() > 1e-3) {
            return Err(error(&s.name, VolumeProblem::NotParallel { first: slices[0].name.clone() }));
        }
    }
    let place = |s: &Slice| vector(&s.position.unwrap_or_default());
    slices.sort_by(|a, b| normal.dot(place(a)).total_cmp(&normal.dot(place(b))));
    let origin = place(&slices[0]);
    let heights: Vec<f64> = slices.iter().map(|s| normal.dot(place(s) - origin)).collect();
    let gaps: Vec<f64> = heights.windows(2).map(|w| w[1] - w[0]).collect();
    // Two files at one position are two reconstructions of the same scan, or a copy.
    if let Some(i) = gaps.iter().position(|g| *g < 1e-4) {
        let other = slices[i].name.clone();
        return Err(error(&slices[i + 1].name, VolumeProblem::SamePosition { other }));
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
            return Err(error(&slices[i].name, problem));
        }
    }
    let height_mm = heights[heights.len() - 1];
    // Slices that drift sideways as they rise come from a tilted gantry; the drift is a shear of the
    // stack.
    let drift = (place(&slices[slices.len() - 1]) - origin) - normal * height_mm;
    for (s, z) in slices.iter().zip(&heights) {
        let off_mm = (place(s) - origin - normal * *z - drift * (z / height_mm)).length();
        // Half a pixel is the most that the nearest pixel hides.
        if off_mm > 0.5 * dx.min(dy) {
            return Err(error(&s.name, VolumeProblem::OffLine { off_mm }));
        }
    }
    let mut rise_mm = height_mm / gaps.len() as f64;
    // Below 1 % the positions are rounded, and an even spacing describes them better.
    if gaps.iter().any(|g| (g / usual - 1.0).abs() > 0.01) {
        let (low, high) = (sorted[0], sorted[sorted.len() - 1]);
        let text = format!("slices are unevenly spaced, {low:.3} to {high:.3} mm; their positions are kept");
        info.warnings.push(Warning::new(WarningId::ScanUnevenSlices, text));
        info.z_mm = heights;
        rise_mm = usual;
    }
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

impl Series {
    /// Slice `k`, and its frame within the file.
    fn slice(&self, k: usize) -> (&Slice, u64) {
        // One file with several frames; otherwise each slice is a file of its own.
        if self.slices.len() == 1 { (&self.slices[0], k as u64) } else { (&self.slices[k], 0) }
    }
}

impl AnySlice for Series {
    fn info(&self) -> &VolumeInfo {
        &self.info
    }

    fn read_slice(&mut self, k: usize, out: &mut Vec<f32>) -> Result<(), SliceError> {
        let (s, frame) = self.slice(k);
        let n_pixels = s.size[0] * s.size[1];
        let n_bytes = n_pixels * self.info.sample.n_bytes();
        let mut reader = self.files.open(&s.name)?;
        let at = s.data.0 + frame * n_bytes as u64;
        reader.seek(SeekFrom::Start(at)).map_err(|e| io_error(&s.name, &e))?;
        let mut bytes = Vec::new();
        // RLE has no fixed size; the length of the fragment bounds what is read.
        let limit = if s.rle { s.data.1.min(MAX_FILE) } else { n_bytes as u64 };
        reader.take(limit).read_to_end(&mut bytes).map_err(|e| io_error(&s.name, &e))?;
        if s.rle {
            bytes = unpack_rle(&s.name, &bytes, n_pixels, self.info.sample.n_bytes())?;
        }
        if bytes.len() < n_bytes {
            let problem = VolumeProblem::PixelsCutShort { found: bytes.len(), needed: n_bytes };
            return Err(error(&s.name, problem).into());
        }
        // The RLE decoder returns little endian whatever the file's byte order.
        sample::decode(self.info.sample, &bytes, s.big_endian && !s.rle, out);
        // MONOCHROME1 means that the lowest value is white. The sign makes dense material bright in every
        // scan.
        let sign = if s.inverted { -1.0 } else { 1.0 };
        let (slope, intercept) = ((s.slope * sign) as f32, (s.intercept * sign) as f32);
        // Rescale slope and intercept give Hounsfield units for CT (PS3.3, C.11.1). A slope of 1e38 overflows f32.
        out.iter_mut().for_each(|v| *v = *v * slope + intercept);
        Ok(())
    }
}

// Transfer syntaxes of PS3.5, annex A, that are read.
const EXPLICIT_LITTLE: &str = "1.2.840.10008.1.2.1";
const IMPLICIT_LITTLE: &str = "1.2.840.10008.1.2";
const EXPLICIT_BIG: &str = "1.2.840.10008.1.2.2";
const RLE: &str = "1.2.840.10008.1.2.5";

/// Names of transfer syntaxes that are refused, for the message.
fn syntax_name(uid: &str) -> &'static str {
    match uid {
        "1.2.840.10008.1.2.1.99" => "deflated",
        "1.2.840.10008.1.2.4.50" | "1.2.840.10008.1.2.4.51" => "JPEG",
        "1.2.840.10008.1.2.4.57" | "1.2.840.10008.1.2.4.70" => "lossless JPEG",
        "1.2.840.10008.1.2.4.80" | "1.2.840.10008.1.2.4.81" => "JPEG-LS",
        "1.2.840.10008.1.2.4.90" | "1.2.840.10008.1.2.4.91" => "JPEG 2000",
        _ => "an unknown encoding",
    }
}

/// An element: its tag and the length of its value; `u32::MAX` stands for an unknown length.
struct Element {
    tag: u32,
    length: u32,
}

struct Parser<'a> {
    reader: std::io::BufReader<Box<dyn super::ReadSeek>>,
    name: &'a str,
    implicit: bool,
    big_endian: bool,
}

impl Parser<'_> {
    fn damaged(&self, what: &str) -> VolumeError {
        damaged(self.name, FORMAT, what)
    }

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], VolumeError> {
        let mut b = [0; N];
        self.reader.read_exact(&mut b).map_err(|_| self.damaged("it ends before the pixels"))?;
        Ok(b)
    }

    fn u16(&mut self) -> Result<u16, VolumeError> {
        let b = self.bytes()?;
        Ok(if self.big_endian { u16::from_be_bytes(b) } else { u16::from_le_bytes(b) })
    }

    fn u32(&mut self) -> Result<u32, VolumeError> {
        let b = self.bytes()?;
        Ok(if self.big_endian { u32::from_be_bytes(b) } else { u32::from_le_bytes(b) })
    }

    fn element(&mut self) -> Result<Element, VolumeError> {
        let (group, number) = (self.u16()?, self.u16()?);
        let tag = u32::from(group) << 16 | u32::from(number);
        // Items and delimiters have no value representation, in no syntax (PS3.5, 7.5).
        if self.implicit || group == 0xfffe {
            return Ok(Element { tag, length: self.u32()? });
        }
        let vr: [u8; 2] = self.bytes()?;
        // These have two reserved bytes and a length of 32 bits (PS3.5, 7.1.2); all others a length of 16
        // bits.
        let long =
            [b"OB", b"OW", b"OF", b"OD", b"OL", b"SQ", b"UC", b"UR", b"UT", b"UN", b"OV", b"SV", b"UV"];
        let length = if long.contains(&&vr) {
            self.u16()?;
            self.u32()?
        } else {
            u32::from(self.u16()?)
        };
        Ok(Element { tag, length })
    }

    fn value(&mut self, length: u32) -> Result<Vec<u8>, VolumeError> {
        // None of the values that are read is longer. The bound keeps a damaged length from reserving 4
        // GB.
        if length > 1 << 16 {
            return Err(self.damaged("a header value of more than 64 kB"));
        }
        let mut bytes = Vec::new();
        let read = (&mut self.reader).take(length.into()).read_to_end(&mut bytes);
        read.map_err(|e| io_error(self.name, &e))?;
        if bytes.len() < length as usize {
            return Err(self.damaged("it ends in a value"));
        }
        Ok(bytes)
    }

    fn skip(&mut self, length: u32) -> Result<(), VolumeError> {
        self.reader.seek_relative(length.into()).map_err(|e| io_error(self.name, &e))
    }

    /// Skips a sequence of unknown length with everything nested in it.
    fn skip_sequence(&mut self) -> Result<(), VolumeError> {
        let mut depth = 1usize;
        while depth > 0 {
            let e = self.element()?;
            match (e.tag, e.length) {
                // Delimiters of a sequence and of an item.
                (0xfffe_e0dd | 0xfffe_e00d, _) => depth -= 1,
                (_, u32::MAX) => depth += 1,
                // An item of known length is skipped with its contents.
                (_, n) => self.skip(n)?,
            }
            // Each level costs a few bytes of file, so a damaged file could nest without end.
            if depth > 64 {
                return Err(self.damaged("sequences nested more than 64 deep"));
            }
        }
        Ok(())
    }

    fn at_end(&mut self) -> bool {
        self.reader.fill_buf().map_or(true, <[u8]>::is_empty)
    }
}

fn read_header(files: &Files, name: &str) -> Result<Slice, VolumeError> {
    let mut p = Parser { reader: files.open(name)?, name, implicit: false, big_endian: false };
    // Preamble of 128 bytes and the letters DICM (PS3.10, 7.1).
    p.skip(132)?;
    let mut syntax = String::new();
    let mut s = Slice { name: name.to_owned(), slope: 1.0, frames: 1, ..Slice::default() };
    let (mut samples, mut stored) = (1, 0);
    let mut meta = true;
    loop {
        if meta {
            // Group 0002 is always explicit little endian. The syntax it names holds from the first other
            // group on.
            let b = p.reader.fill_buf().map_err(|e| io_error(name, &e))?;
            if b.len() < 2 || b[..2] != [2, 0] {
                meta = false;
                (p.implicit, p.big_endian) = (syntax == IMPLICIT_LITTLE, syntax == EXPLICIT_BIG);
                (s.big_endian, s.rle) = (p.big_endian, syntax == RLE);
                if ![EXPLICIT_LITTLE, IMPLICIT_LITTLE, EXPLICIT_BIG, RLE].contains(&syntax.as_str()) {
                    return Err(error(
                        name,
                        VolumeProblem::Packed { encoding: syntax_name(&syntax), syntax },
                    ));
                }
            }
        }
        if p.at_end() {
            return Err(error(
                name,
                VolumeProblem::MissingField { format: FORMAT, field: "PixelData".to_owned() },
            ));
        }
        let e = p.element()?;
        // Pixel data come last among the elements that matter, so the header is complete here.
        if e.tag == 0x7fe0_0010 {
            if s.rle {
                // Encapsulated pixels: the offset table first, then a fragment for each frame (PS3.5,
                // A.4).
                let table = p.element()?;
                p.skip(table.length)?;
                let fragment = p.element()?;
                if fragment.tag != 0xfffe_e000 {
                    return Err(p.damaged("RLE pixels without a fragment"));
                }
                s.data.1 = fragment.length.into();
            } else {
                s.data.1 = e.length.into();
            }
            s.data.0 = p.reader.stream_position().map_err(|e| io_error(name, &e))?;
            break;
        }
        // Sequences describe procedures and references; none holds a field that is read.
        if e.length == u32::MAX {
            p.skip_sequence()?;
            continue;
        }
        // Transfer syntax, thickness, slice spacing, series, instance, position, orientation, samples,
        // photometric interpretation, frames, rows, columns, pixel spacing, bits, representation, slope.
        let wanted = [
            0x0002_0010,
            0x0018_0050,
            0x0018_0088,
            0x0020_000e,
            0x0020_0013,
            0x0020_0032,
            0x0020_0037,
            0x0028_0002,
            0x0028_0004,
            0x0028_0008,
            0x0028_0010,
            0x0028_0011,
            0x0028_0030,
            0x0028_0100,
            0x0028_0101,
            0x0028_0103,
            0x0028_1052,
            0x0028_1053,
        ];
        if !wanted.contains(&e.tag) {
            p.skip(e.length)?;
            continue;
        }
        let value = p.value(e.length)?;
        // Values are padded to an even length with a space or a zero byte.
        let text = String::from_utf8_lossy(&value).trim_matches(['\0', ' ']).to_owned();
        // Several values are separated by backslashes (PS3.5, 6.4).
        let numbers =
            || text.split('\\').filter_map(|w| w.trim().parse::<f64>().ok()).filter(|v| v.is_finite());
        let number = || numbers().next();
        let list = |n: usize| Some(numbers().collect::<Vec<f64>>()).filter(|v| v.len() == n);
        let short = || {
            let b = [value.first().copied().unwrap_or(0), value.get(1).copied().unwrap_or(0)];
            usize::from(if p.big_endian { u16::from_be_bytes(b) } else { u16::from_le_bytes(b) })
        };
        match e.tag {
            0x0002_0010 => syntax = text,
            // The distance between slices (0018,0088) wins over their thickness (0018,0050): slices may
            // overlap or leave gaps.
            0x0018_0050 => s.thickness_mm = s.thickness_mm.or(number()),
            0x0018_0088 => s.thickness_mm = number().or(s.thickness_mm),
            0x0020_000e => s.series = text,
            0x0020_0013 => s.instance = number().map_or(0, |v| v as i64),
            0x0020_0032 => s.position = list(3).and_then(|v| v.try_into().ok()),
            0x0020_0037 => s.orientation = list(6).and_then(|v| v.try_into().ok()),
            0x0028_0002 => samples = short(),
            0x0028_0004 => s.inverted = text == "MONOCHROME1",
            0x0028_0008 => s.frames = number().map_or(1, |v| (v as usize).clamp(1, super::MAX_SLICES)),
            0x0028_0010 => s.size[1] = short(),
            0x0028_0011 => s.size[0] = short(),
            0x0028_0030 => s.pixel_mm = list(2).and_then(|v| v.try_into().ok()),
            0x0028_0100 => s.bits = short(),
            0x0028_0101 => stored = short(),
            0x0028_0103 => s.signed = short() == 1,
            0x0028_1052 => s.intercept = number().unwrap_or(0.0),
            // A slope of 0 would erase the image; writers mean that it is not given.
            _ => s.slope = number().filter(|v| *v != 0.0).unwrap_or(1.0),
        }
    }
    if samples != 1 {
        return Err(unsupported(name, format!("{samples} values a pixel"), "slices of grey values have one"));
    }
    // The sign bit then stands inside the stored value, and the unused bits above may hold anything.
    if s.signed && stored != 0 && stored != s.bits {
        return Err(unsupported(
            name,
            format!("signed pixels of {stored} bits in {}", s.bits),
            "save the pixels with all bits in use",
        ));
    }
    if s.rle && s.frames > 1 {
        return Err(unsupported(name, "several RLE frames in one file", "save a slice a file"));
    }
    check_size(name, [s.size[0], s.size[1], 1])?;
    Ok(s)
}

/// Unpacks `PackBits` segments, one for each byte of a pixel, the most significant first. Returns
/// little-endian values. Source: PS3.5, annex G.
fn unpack_rle(name: &str, bytes: &[u8], n_pixels: usize, width: usize) -> Result<Vec<u8>, VolumeError> {
    let damaged = || damaged(name, "RLE pixels", "a run reaches past its end");
    let word = |i: usize| -> Option<usize> {
        let b: [u8; 4] = bytes.get(4 * i..4 * i + 4)?.try_into().ok()?;
        usize::try_from(u32::from_le_bytes(b)).ok()
    };
    // The header is 16 words: the number of segments and their offsets.
    let n_planes = word(0).ok_or_else(damaged)?;
    if n_planes != width {
        return Err(damaged());
    }
    let mut out = vec![0u8; n_pixels * width];
    for plane in 0..n_planes {
        let begin = word(1 + plane).ok_or_else(damaged)?;
        let end = if plane + 1 < n_planes { word(2 + plane).ok_or_else(damaged)? } else { bytes.len() };
        let mut packed = bytes.get(begin..end).ok_or_else(damaged)?;
        let mut at = 0;
        while at < n_pixels {
            let (&head, rest) = packed.split_first().ok_or_else(damaged)?;
            let n = usize::from(head);
            // Segments are bytes of the same significance; they are interleaved back into pixels.
            let put = |at: usize, v: u8, out: &mut Vec<u8>| out[at * width + width - 1 - plane] = v;
            // 0 to 127: n + 1 bytes as they are. 129 to 255: the next byte 257 - n times. 128 means
            // nothing (annex G.3.1).
            if n < 128 {
                let values = rest.get(..=n).ok_or_else(damaged)?;
                // A run may go past the last pixel through padding; the rest is dropped.
                values.iter().take(n_pixels - at).enumerate().for_each(|(k, v)| put(at + k, *v, &mut out));
                (at, packed) = (at + n + 1, &rest[n + 1..]);
            } else if n > 128 {
                let (&v, rest) = rest.split_first().ok_or_else(damaged)?;
                (0..(257 - n).min(n_pixels - at)).for_each(|k| put(at + k, v, &mut out));
                (at, packed) = (at + 257 - n, rest);
            } else {
                packed = rest;
            }
        }
    }
    Ok(out)
}
