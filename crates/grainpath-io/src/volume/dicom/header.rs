//! The header of a DICOM file: the elements before the pixels, and where the pixels lie.
//!
//! Source: DICOM PS3.5, 7 (elements, sequences) and A (transfer syntaxes), PS3.10, 7.1 (files). Elements are read in file
//! order; for elements that are not needed only the length is read. Values are held in memory one at a time, at most 64 kB
//! each. Files of several frames state spacing, orientation, positions and rescaling in functional groups (PS3.3,
//! C.7.6.16.1), once for all frames and once for each; the latter win. A header that ends before the pixels, nests sequences
//! deeper than 64 levels or states impossible bits is refused.

use std::io::BufRead;
use std::sync::Arc;

use super::super::{Files, MAX_SLICES, VolumeError, VolumeProblem, check_size, error, io_error, unsupported};
use super::FORMAT;
use super::codec::Codec;
use super::data_elements::Parser;
use super::fragments::Packed;

/// What the header states about a slice, or about one frame of several.
#[derive(Debug, Clone, Default)]
pub(super) struct Geometry {
    /// Distances of rows and of columns, mm.
    pub(super) pixel_mm: Option<[f64; 2]>,
    thickness_mm: Option<f64>,
    distance_mm: Option<f64>,
    pub(super) position: Option<[f64; 3]>,
    pub(super) orientation: Option<[f64; 6]>,
    slope: Option<f64>,
    intercept: Option<f64>,
}

impl Geometry {
    /// The elements of a geometry: thickness, distance of slices, position, orientation, pixel spacing, intercept, slope.
    /// Source: DICOM PS3.6.
    const TAGS: [u32; 7] =
        [0x0018_0050, 0x0018_0088, 0x0020_0032, 0x0020_0037, 0x0028_0030, 0x0028_1052, 0x0028_1053];
    /// The sequences of functional groups that hold them: pixel measures, plane orientation, plane position, pixel value
    /// transformation. Source: DICOM PS3.3, C.7.6.16.2.
    const GROUPS: [u32; 4] = [0x0028_9110, 0x0020_9116, 0x0020_9113, 0x0028_9145];

    /// Takes the value of one of [`Self::TAGS`].
    fn take(&mut self, tag: u32, value: &Value) {
        match tag {
            0x0018_0050 => self.thickness_mm = value.number(),
            0x0018_0088 => self.distance_mm = value.number(),
            0x0020_0032 => self.position = value.list(),
            0x0020_0037 => self.orientation = value.list(),
            0x0028_0030 => self.pixel_mm = value.list(),
            0x0028_1052 => self.intercept = value.number(),
            _ => self.slope = value.number(),
        }
    }

    /// Takes what an item of functional groups states.
    fn take_groups(&mut self, parser: &mut Parser<'_>, length: u32) -> Result<(), VolumeError> {
        parser.item(length, |p, group| {
            if !Self::GROUPS.contains(&group.tag) {
                return Ok(false);
            }
            p.sequence(group.length, |p, length| {
                p.item(length, |p, e| {
                    let is_wanted = Self::TAGS.contains(&e.tag);
                    if is_wanted {
                        let value = Value::read(p, e.length)?;
                        self.take(e.tag, &value);
                    }
                    Ok(is_wanted)
                })
            })?;
            Ok(true)
        })
    }

    /// Distance of slices, mm. The distance that is stated wins over the thickness: slices may overlap or leave gaps.
    pub(super) fn rise_mm(&self) -> Option<f64> {
        self.distance_mm.or(self.thickness_mm)
    }

    /// Slope and intercept of the grey values.
    pub(super) fn rescale(&self) -> (f64, f64) {
        // A slope of 0 would erase the image; files that state 0 mean that no slope is given.
        (self.slope.filter(|v| *v != 0.0).unwrap_or(1.0), self.intercept.unwrap_or(0.0))
    }
}

/// The value of an element.
struct Value {
    bytes: Vec<u8>,
    big_endian: bool,
}

impl Value {
    fn read(parser: &mut Parser<'_>, length: u32) -> Result<Self, VolumeError> {
        Ok(Self { bytes: parser.value(length)?, big_endian: parser.big_endian })
    }

    fn text(&self) -> String {
        // The writer pads values to an even length with a space or a zero byte.
        String::from_utf8_lossy(&self.bytes).trim_matches(['\0', ' ']).to_owned()
    }

    fn numbers(&self) -> Vec<f64> {
        // Several values are separated by backslashes (PS3.5, 6.4).
        let text = self.text();
        text.split('\\').filter_map(|w| w.trim().parse().ok()).filter(|v: &f64| v.is_finite()).collect()
    }

    fn number(&self) -> Option<f64> {
        self.numbers().first().copied()
    }

    fn list<const N: usize>(&self) -> Option<[f64; N]> {
        self.numbers().try_into().ok()
    }

    fn short(&self) -> u16 {
        let b = [self.bytes.first().copied().unwrap_or(0), self.bytes.get(1).copied().unwrap_or(0)];
        if self.big_endian { u16::from_be_bytes(b) } else { u16::from_le_bytes(b) }
    }
}

/// Stored values that stand for no measurement, as outside the round field of view of a scanner (PS3.3, C.7.5.1.1.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Padding {
    pub(super) lowest: i64,
    pub(super) highest: i64,
    /// The values lie outside the bits stored, so all allocated bits of a pixel are compared.
    pub(super) of_whole_word: bool,
}

/// The header of a slice.
#[derive(Debug, Clone)]
pub(super) struct Slice {
    pub(super) name: String,
    /// Which frame of the file it is, where frames have positions of their own.
    pub(super) frame: Option<usize>,
    pub(super) series: String,
    pub(super) size: [usize; 2],
    /// Bits allocated to a pixel.
    pub(super) bits: usize,
    pub(super) signed: bool,
    /// Number of bits of a value, and number of unused bits below them.
    pub(super) stored: u32,
    pub(super) shift: u32,
    pub(super) big_endian: bool,
    pub(super) geometry: Geometry,
    pub(super) padding: Option<Padding>,
    /// Place of the slice on a line whose direction is not stated, mm.
    pub(super) location_mm: Option<f64>,
    pub(super) instance: i64,
    pub(super) pixels: Pixels,
    pub(super) frames: usize,
    pub(super) inverted: bool,
}

impl Slice {
    /// What messages call it.
    pub(super) fn place(&self) -> String {
        match self.frame {
            Some(frame) => format!("{}, frame {}", self.name, frame + 1),
            None => self.name.clone(),
        }
    }
}

/// Where the pixels of a file lie.
#[derive(Debug, Clone)]
pub(super) enum Pixels {
    /// The frames follow one another from this byte on.
    Plain(u64),
    Packed(Arc<Packed>),
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

/// Reads the header of a file: one slice, or one for each frame if the frames have functional groups of their own.
pub(super) fn read(files: &Files, name: &str) -> Result<Vec<Slice>, VolumeError> {
    let mut p = Parser { reader: files.open(name)?, name, implicit: false, big_endian: false };
    // Preamble of 128 bytes and the letters DICM (PS3.10, 7.1).
    p.skip(132)?;
    let mut s = Slice {
        name: name.to_owned(),
        frame: None,
        series: String::new(),
        size: [0, 0],
        bits: 0,
        signed: false,
        stored: 0,
        shift: 0,
        big_endian: false,
        geometry: Geometry::default(),
        padding: None,
        location_mm: None,
        instance: 0,
        pixels: Pixels::Plain(0),
        frames: 1,
        inverted: false,
    };
    let (mut samples, mut stored, mut highest) = (1, 0, None);
    let (mut padding, mut padding_limit) = (None, None);
    let mut frames: Vec<Geometry> = Vec::new();
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
                Some(codec) => Pixels::Packed(Arc::new(Packed::read(&mut p, codec, s.frames)?)),
                None => Pixels::Plain(p.position()?),
            };
            break;
        }
        // Functional groups of all frames, and of each.
        match e.tag {
            0x5200_9229 => {
                p.sequence(e.length, |p, length| s.geometry.take_groups(p, length))?;
                continue;
            }
            0x5200_9230 => {
                p.sequence(e.length, |p, length| {
                    let mut frame = s.geometry.clone();
                    // A position that all frames share is none of a stack.
                    frame.position = frame.position.filter(|_| s.frames == 1);
                    frame.take_groups(p, length)?;
                    frames.push(frame);
                    // Also bounds the memory that a damaged file can take.
                    if frames.len() > s.frames {
                        return Err(p.damaged("more functional groups than frames"));
                    }
                    Ok(())
                })?;
                continue;
            }
            _ => {}
        }
        // Other sequences describe procedures and references; none holds a field that is read.
        if e.length == u32::MAX {
            p.skip_sequence()?;
            continue;
        }
        // Transfer syntax, series, instance, location, samples, photometric interpretation, frames, rows, columns, bits,
        // representation, padding and its limit.
        let wanted = [
            0x0002_0010,
            0x0020_000e,
            0x0020_0013,
            0x0020_1041,
            0x0028_0002,
            0x0028_0004,
            0x0028_0008,
            0x0028_0010,
            0x0028_0011,
            0x0028_0100,
            0x0028_0101,
            0x0028_0102,
            0x0028_0103,
            0x0028_0120,
            0x0028_0121,
        ];
        if !wanted.contains(&e.tag) && !Geometry::TAGS.contains(&e.tag) {
            p.skip(e.length)?;
            continue;
        }
        let value = Value::read(&mut p, e.length)?;
        let short = || usize::from(value.short());
        match e.tag {
            0x0002_0010 => syntax = value.text(),
            0x0020_000e => s.series = value.text(),
            0x0020_0013 => s.instance = value.number().map_or(0, |v| v as i64),
            0x0020_1041 => s.location_mm = value.number(),
            0x0028_0002 => samples = short(),
            0x0028_0004 => colours = value.text(),
            0x0028_0008 => s.frames = value.number().map_or(1, |v| (v as usize).clamp(1, MAX_SLICES)),
            0x0028_0010 => s.size[1] = short(),
            0x0028_0011 => s.size[0] = short(),
            0x0028_0100 => s.bits = short(),
            0x0028_0101 => stored = short(),
            0x0028_0102 => highest = Some(short()),
            0x0028_0103 => s.signed = short() == 1,
            0x0028_0120 => padding = Some(value.short()),
            0x0028_0121 => padding_limit = Some(value.short()),
            tag => s.geometry.take(tag, &value),
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
    s.padding = padding.map(|value| padding_of(&s, value, padding_limit.unwrap_or(value)));
    if frames.is_empty() {
        return Ok(vec![s]);
    }
    if frames.len() != s.frames {
        return Err(p.damaged(&format!(
            "functional groups of {} frames, where {} are stated",
            frames.len(),
            s.frames
        )));
    }
    let slice =
        |(k, geometry)| Slice { frame: Some(k).filter(|_| s.frames > 1), geometry, frames: 1, ..s.clone() };
    Ok(frames.into_iter().enumerate().map(slice).collect())
}

/// The values between `value` and `limit`, which have the sign of the pixels, whatever their representation.
fn padding_of(s: &Slice, value: u16, limit: u16) -> Padding {
    let [value, limit] =
        [value, limit].map(|v| if s.signed { i64::from(v.cast_signed()) } else { i64::from(v) });
    let (lowest, highest) = (value.min(limit), value.max(limit));
    // Bits beyond 32 are refused later.
    let n_values = 1i64 << s.stored.min(32);
    let first = if s.signed { -n_values / 2 } else { 0 };
    Padding { lowest, highest, of_whole_word: lowest < first || highest >= first + n_values }
}
