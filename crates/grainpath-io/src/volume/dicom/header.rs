//! The header of a DICOM file: the elements before the pixels, and where the pixels lie.
//!
//! Source: DICOM PS3.5, 7 (elements, sequences) and A (transfer syntaxes), PS3.10, 7.1 (files). Elements are read in file
//! order; for elements that are not needed only the length is read. Values are held in memory one at a time, at most 64 kB
//! each. A header that ends before the pixels, nests sequences deeper than 64 levels or states impossible bits is refused.

use std::io::BufRead;

use super::super::{Files, MAX_SLICES, VolumeError, VolumeProblem, check_size, error, io_error, unsupported};
use super::FORMAT;
use super::codec::Codec;
use super::data_elements::Parser;
use super::fragments::Packed;

/// The header of a slice file.
#[derive(Debug, Clone)]
pub(super) struct Slice {
    pub(super) name: String,
    pub(super) series: String,
    pub(super) size: [usize; 2],
    /// Bits allocated to a pixel.
    pub(super) bits: usize,
    pub(super) signed: bool,
    /// Number of bits of a value, and number of unused bits below them.
    pub(super) stored: u32,
    pub(super) shift: u32,
    pub(super) big_endian: bool,
    pub(super) slope: f64,
    pub(super) intercept: f64,
    pub(super) pixel_mm: Option<[f64; 2]>,
    pub(super) thickness_mm: Option<f64>,
    pub(super) position: Option<[f64; 3]>,
    pub(super) orientation: Option<[f64; 6]>,
    pub(super) instance: i64,
    pub(super) pixels: Pixels,
    pub(super) frames: usize,
    pub(super) inverted: bool,
}

/// Where the pixels of a file lie.
#[derive(Debug, Clone)]
pub(super) enum Pixels {
    /// The frames follow one another from this byte on.
    Plain(u64),
    Packed(Packed),
}

/// How a transfer syntax stores elements and pixels. Source: PS3.5, annex A, and the registry in PS3.6, annex A.
enum Syntax {
    Plain {
        implicit: bool,
        big_endian: bool,
    },
    /// The elements are explicit and little endian.
    Packed(Codec),
    /// JPEG 2000, which this build does not read.
    #[cfg(not(feature = "jpeg2000"))]
    LeftOut,
    /// A syntax that is not read, with its name.
    Other(&'static str),
}

impl Syntax {
    fn new(uid: &str) -> Self {
        let Some(number) = uid.strip_prefix("1.2.840.10008.1.2") else {
            return Self::Other("an unknown encoding");
        };
        match number {
            "" => Self::Plain { implicit: true, big_endian: false },
            ".1" => Self::Plain { implicit: false, big_endian: false },
            ".2" => Self::Plain { implicit: false, big_endian: true },
            ".5" => Self::Packed(Codec::Rle),
            // Baseline, extended, lossless, lossless with the default predictor.
            ".4.50" | ".4.51" | ".4.57" | ".4.70" => Self::Packed(Codec::Jpeg),
            ".4.80" | ".4.81" => Self::Packed(Codec::JpegLs),
            #[cfg(feature = "jpeg2000")]
            ".4.90" | ".4.91" => Self::Packed(Codec::Jpeg2000),
            #[cfg(not(feature = "jpeg2000"))]
            ".4.90" | ".4.91" => Self::LeftOut,
            ".1.99" => Self::Other("deflate"),
            ".4.92" | ".4.93" => Self::Other("JPEG 2000 of several components"),
            ".4.110" | ".4.111" | ".4.112" => Self::Other("JPEG XL"),
            ".4.201" | ".4.202" | ".4.203" => Self::Other("high-throughput JPEG 2000"),
            _ => Self::Other("an unknown encoding"),
        }
    }
}

/// Reads the header of a file.
pub(super) fn read(files: &Files, name: &str) -> Result<Slice, VolumeError> {
    let mut p = Parser { reader: files.open(name)?, name, implicit: false, big_endian: false };
    // Preamble of 128 bytes and the letters DICM (PS3.10, 7.1).
    p.skip(132)?;
    let mut s = Slice {
        name: name.to_owned(),
        series: String::new(),
        size: [0, 0],
        bits: 0,
        signed: false,
        stored: 0,
        shift: 0,
        big_endian: false,
        slope: 1.0,
        intercept: 0.0,
        pixel_mm: None,
        thickness_mm: None,
        position: None,
        orientation: None,
        instance: 0,
        pixels: Pixels::Plain(0),
        frames: 1,
        inverted: false,
    };
    let (mut samples, mut stored, mut highest) = (1, 0, None);
    let (mut syntax, mut codec, mut colours) = (String::new(), None, String::new());
    let mut meta = true;
    loop {
        if meta {
            // Group 0002 is always explicit little endian. The syntax it names holds from the first other
            // group on.
            let b = p.reader.fill_buf().map_err(|e| io_error(name, &e))?;
            if b.len() < 2 || b[..2] != [2, 0] {
                meta = false;
                match Syntax::new(&syntax) {
                    Syntax::Plain { implicit, big_endian } => {
                        (p.implicit, p.big_endian, s.big_endian) = (implicit, big_endian, big_endian);
                    }
                    Syntax::Packed(found) => codec = Some(found),
                    #[cfg(not(feature = "jpeg2000"))]
                    Syntax::LeftOut => {
                        let what = "JPEG 2000 in DICOM slices";
                        return Err(error(name, VolumeProblem::LeftOut { what, feature: "jpeg2000" }));
                    }
                    Syntax::Other(encoding) => {
                        return Err(error(name, VolumeProblem::Packed { encoding, syntax }));
                    }
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
            s.pixels = match codec {
                Some(codec) => Pixels::Packed(Packed::read(&mut p, codec, s.frames)?),
                None => Pixels::Plain(p.position()?),
            };
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
            0x0028_0102,
            0x0028_0103,
            0x0028_1052,
            0x0028_1053,
        ];
        if !wanted.contains(&e.tag) {
            p.skip(e.length)?;
            continue;
        }
        let value = p.value(e.length)?;
        // The writer pads values to an even length with a space or a zero byte.
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
            0x0028_0004 => colours = text,
            0x0028_0008 => s.frames = number().map_or(1, |v| (v as usize).clamp(1, MAX_SLICES)),
            0x0028_0010 => s.size[1] = short(),
            0x0028_0011 => s.size[0] = short(),
            0x0028_0030 => s.pixel_mm = list(2).and_then(|v| v.try_into().ok()),
            0x0028_0100 => s.bits = short(),
            0x0028_0101 => stored = short(),
            0x0028_0102 => highest = Some(short()),
            0x0028_0103 => s.signed = short() == 1,
            0x0028_1052 => s.intercept = number().unwrap_or(0.0),
            // A slope of 0 would erase the image; files that state 0 mean that no slope is given.
            _ => s.slope = number().filter(|v| *v != 0.0).unwrap_or(1.0),
        }
    }
    if samples != 1 {
        return Err(unsupported(name, format!("{samples} values a pixel"), "slices of grey values have one"));
    }
    match colours.as_str() {
        "MONOCHROME1" => s.inverted = true,
        // Some files lack this element; their pixels are grey too.
        "MONOCHROME2" | "" => {}
        _ => return Err(unsupported(name, format!("{colours} pixels"), "slices have grey values")),
    }
    check_size(name, [s.size[0], s.size[1], 1])?;
    // A value occupies the bits from the highest one down; the bits above and below it may be anything (PS3.5, 8.1.1).
    let stored = if stored == 0 { s.bits } else { stored };
    let highest = highest.unwrap_or(stored.saturating_sub(1));
    if stored > s.bits || highest + 1 < stored || highest >= s.bits.max(1) {
        let problem = VolumeProblem::Field {
            format: FORMAT,
            field: "BitsStored",
            found: format!("{stored} up to bit {highest} of {}", s.bits),
            expected: "values within the bits allocated".to_owned(),
        };
        return Err(error(name, problem));
    }
    (s.stored, s.shift) = (stored as u32, (highest + 1 - stored) as u32);
    Ok(s)
}
