//! NIfTI-1 and -2, in one file, plain or gzipped.

use grainpath_core::{Warning, WarningId};
use std::io::Read;

use flate2::bufread::MultiGzDecoder;

use super::raw::{Layout, Packing, RawSource};
use super::{Files, SampleType, VolumeError, VolumeInfo, VolumeProblem, damaged, error, spacing};

const FORMAT: &str = "NIfTI";

/// Whether a file begins like a NIfTI header.
pub(super) fn is(head: &[u8]) -> bool {
    head.get(344..347) == Some(b"n+1") || head.get(4..7) == Some(b"n+2")
}

pub(super) fn open(files: &Files, name: &str) -> Result<RawSource, VolumeError> {
    let plain = files.head(name, 540)?;
    let packed = plain.starts_with(b"\x1f\x8b");
    let mut head = plain;
    if packed {
        head = Vec::new();
        let unpacked = MultiGzDecoder::new(files.open(name)?).take(540).read_to_end(&mut head);
        unpacked.map_err(|e| damaged(name, "gzip data", e))?;
    }
    if !is(&head) {
        let expected = if packed { "NIfTI in gzip" } else { "NIfTI" };
        return Err(error(name, VolumeProblem::OtherFormat { expected }));
    }
    let wrong = |field: &'static str, found: String, expected: &str| {
        error(name, VolumeProblem::Field { format: FORMAT, field, found, expected: expected.to_owned() })
    };
    let second = head.get(4..7) == Some(b"n+2");
    head.resize(540, 0);
    let big_endian = head[..4] == if second { 540i32.to_be_bytes() } else { 348i32.to_be_bytes() };
    let h = Header { bytes: &head, big_endian };
    let dims: Vec<i64> =
        (0..8).map(|i| if second { h.i64(16 + 8 * i) } else { i64::from(h.i16(40 + 2 * i)) }).collect();
    let more = (4..8).any(|k| (k as i64) <= dims[0] && dims[k] > 1);
    if !(2..=7).contains(&dims[0]) || more {
        let n_axes = usize::try_from(dims[0]).unwrap_or(0);
        return Err(error(name, VolumeProblem::OtherAxes { format: FORMAT, n_axes }));
    }
    let size = [1, 2, 3].map(|k| if k as i64 > dims[0] { 1 } else { usize::try_from(dims[k]).unwrap_or(0) });
    let code = h.i16(if second { 12 } else { 70 });
    let sample = match code {
        2 => SampleType::U8,
        256 => SampleType::I8,
        512 => SampleType::U16,
        4 => SampleType::I16,
        768 => SampleType::U32,
        8 => SampleType::I32,
        16 => SampleType::F32,
        64 => SampleType::F64,
        _ => {
            return Err(wrong("datatype", code.to_string(), "8 to 32 bit integers, float and double"));
        }
    };
    let mut info = VolumeInfo::new(FORMAT, size, sample);
    let units = if second { h.i32(500) } else { i32::from(head[123]) } & 7;
    let unit_mm = match units {
        1 => Some(1e3),
        2 => Some(1.0),
        3 => Some(1e-3),
        _ => None,
    };
    for k in 0..3 {
        let pixdim = if second { h.f64(104 + 8 * (k + 1)) } else { f64::from(h.f32(76 + 4 * (k + 1))) };
        info.spacing_mm[k] = spacing(pixdim * unit_mm.unwrap_or(1.0));
    }
    if unit_mm.is_none() {
        let text = "the file states no unit of length; its spacing is taken for mm";
        info.warnings.push(Warning::new(WarningId::UnitAssumed, text).in_file(name));
    }
    let offset = if second { h.i64(168) as f64 } else { f64::from(h.f32(108)) };
    if !(0.0..1e9).contains(&offset) {
        return Err(wrong("vox_offset", offset.to_string(), "a place within 1 GB"));
    }
    let (slope, intercept) =
        if second { (h.f64(176) as f32, h.f64(184) as f32) } else { (h.f32(112), h.f32(116)) };
    let sound = slope != 0.0 && slope.is_finite() && intercept.is_finite();
    RawSource::new(
        files,
        info,
        Layout {
            file: name.to_owned(),
            offset: offset as u64,
            inside: packed,
            packing: if packed { Packing::Gzip } else { Packing::None },
            big_endian,
            scale: if sound { (slope, intercept) } else { (1.0, 0.0) },
        },
    )
}

struct Header<'a> {
    bytes: &'a [u8],
    big_endian: bool,
}

impl Header<'_> {
    fn array<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut b: [u8; N] = self.bytes[at..at + N].try_into().unwrap_or([0; N]);
        if self.big_endian {
            b.reverse();
        }
        b
    }
    fn i16(&self, at: usize) -> i16 {
        i16::from_le_bytes(self.array(at))
    }
    fn i32(&self, at: usize) -> i32 {
        i32::from_le_bytes(self.array(at))
    }
    fn i64(&self, at: usize) -> i64 {
        i64::from_le_bytes(self.array(at))
    }
    fn f32(&self, at: usize) -> f32 {
        f32::from_le_bytes(self.array(at))
    }
    fn f64(&self, at: usize) -> f64 {
        f64::from_le_bytes(self.array(at))
    }
}
