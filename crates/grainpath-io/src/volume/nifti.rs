//! NIfTI-1 and -2, in one file, plain or gzipped, or in a pair of files (.hdr and .img), plain.
//!
//! Source: `nifti1.h` and `nifti2.h` of the NIfTI reference library. The size of the header in its first
//! field gives version and byte order. The position of the voxels comes from the sform (method 3, an
//! affine map), otherwise from the qform (method 2, a quaternion and spacings). Without both the axes are
//! assumed to be right-handed, with a warning. Where both are given and differ by more than half a voxel,
//! a warning says so. Values are scaled by slope and intercept unless the slope is 0.
//!
//! NIfTI's frame is RAS; it is converted to LPS. Lengths are converted to mm by `xyzt_units`. The cost is
//! a slice at a time in memory. Gzipped pairs, time series, colours and complex values are refused.

use grainpath_core::{Warning, WarningId};
use std::io::Read;

use flate2::bufread::MultiGzDecoder;

use grainpath_core::DVec3;
use grainpath_core::slices::SliceSource;
use grainpath_core::units::LengthUnit;

use super::finite::Finite;
use super::placement::{Placement, oriented};
use super::raw::{Layout, Packing, RawSource};
use super::{
    Files, SampleType, VolumeError, VolumeInfo, VolumeProblem, check_size, damaged, error, io_error, spacing,
    unsupported,
};

const FORMAT: &str = "NIfTI";

/// Whether a file begins like a NIfTI header.
pub(super) fn is(head: &[u8]) -> bool {
    head.get(344..347) == Some(b"n+1") || head.get(4..7) == Some(b"n+2") || is_header_of_pair(head)
}

/// Whether a file is the header of a pair, whose voxels are in the file of the same name that ends in `.img`.
fn is_header_of_pair(head: &[u8]) -> bool {
    head.get(344..347) == Some(b"ni1") || head.get(4..7) == Some(b"ni2")
}

/// The file of the same name with another ending, in the case of the one it has.
fn beside(files: &Files, name: &str, ending: &str) -> Result<String, VolumeError> {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let (stem, old) = file.rsplit_once('.').unwrap_or((file, ""));
    let is_upper = !old.is_empty() && old == old.to_ascii_uppercase();
    let ending = if is_upper { ending.to_ascii_uppercase() } else { ending.to_owned() };
    files.sibling(name, &format!("{stem}.{ending}"))
}

/// The header of a pair whose file of voxels is `name`.
pub(super) fn header_of(files: &Files, name: &str) -> Result<Option<String>, VolumeError> {
    if !name.to_ascii_lowercase().ends_with(".img") {
        return Ok(None);
    }
    let header = beside(files, name, "hdr")?;
    let mut head = Vec::new();
    if let Some(reader) = files.open_or_none(&header)? {
        reader.take(540).read_to_end(&mut head).map_err(|e| io_error(&header, &e))?;
    }
    Ok(is_header_of_pair(&head).then_some(header))
}

pub(super) fn open(files: &Files, name: &str) -> Result<Box<dyn SliceSource>, VolumeError> {
    // The header of NIfTI-2 has 540 bytes, that of NIfTI-1 has 348.
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
    let second = head.get(4..7).is_some_and(|magic| magic == b"n+2" || magic == b"ni2");
    if packed && is_header_of_pair(&head) {
        return Err(unsupported(name, "a gzipped pair of NIfTI files", "unpack both files"));
    }
    let voxels_in = if is_header_of_pair(&head) { beside(files, name, "img")? } else { name.to_owned() };
    // A NIfTI-1 file may end before byte 540; the missing fields are never read for it.
    head.resize(540, 0);
    // The first field is the size of the header, in the byte order of the file.
    let big_endian = head[..4] == if second { 540i32.to_be_bytes() } else { 348i32.to_be_bytes() };
    let h = Header { bytes: &head, big_endian, second };
    let dims: Vec<i64> =
        (0..8).map(|i| if second { h.i64(16 + 8 * i) } else { i64::from(h.i16(40 + 2 * i)) }).collect();
    // Axes 4 to 7 are time and other series. An extent of 1 is no series.
    let more = (4..8).any(|k| (k as i64) <= dims[0] && dims[k] > 1);
    if !(2..=7).contains(&dims[0]) || more {
        let n_axes = usize::try_from(dims[0]).unwrap_or(0);
        return Err(error(name, VolumeProblem::OtherAxes { format: FORMAT, n_axes }));
    }
    let size = [1, 2, 3].map(|k| if k as i64 > dims[0] { 1 } else { usize::try_from(dims[k]).unwrap_or(0) });
    check_size(name, size)?;
    let code = h.i16(if second { 12 } else { 70 });
    // Source: `nifti1.h`, datatype codes.
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
    // The low three bits of xyzt_units are the unit of space, the others that of time.
    let units = if second { h.i32(500) } else { i32::from(head[123]) } & 7;
    let unit_mm = match units {
        1 => Some(LengthUnit::Metre.mm()),
        2 => Some(LengthUnit::Millimetre.mm()),
        3 => Some(LengthUnit::Micron.mm()),
        _ => None,
    };
    let mm = unit_mm.unwrap_or(1.0);
    info.spacing_mm = [1, 2, 3].map(|k| spacing(h.pixdim(k) * mm));
    let placement = placement_of(name, &h, mm, &mut info);
    if unit_mm.is_none() {
        let text = "the file states no unit of length; its spacing is taken for mm";
        info.warnings.push(Warning::new(WarningId::UnitAssumed, text).in_file(name));
    }
    // NIfTI-1 stores vox_offset as a float.
    let offset = if second { h.i64(168) as f64 } else { f64::from(h.f32(108)) };
    if !(0.0..1e9).contains(&offset) {
        return Err(wrong("vox_offset", offset.to_string(), "a place within 1 GB"));
    }
    let (slope, intercept) =
        if second { (h.f64(176) as f32, h.f64(184) as f32) } else { (h.f32(112), h.f32(116)) };
    // `nifti1.h`: a slope of 0 means that values are not scaled.
    let sound = slope != 0.0 && slope.is_finite() && intercept.is_finite();
    let voxels = RawSource::new(
        files,
        info,
        Layout {
            file: voxels_in,
            offset: offset as u64,
            // In a packed file the offset counts unpacked bytes.
            inside: packed,
            packing: if packed { Packing::Gzip } else { Packing::None },
            big_endian,
            scale: if sound { (slope, intercept) } else { (1.0, 0.0) },
        },
    )?;
    match placement {
        Some(placement) => oriented(voxels, &placement, name),
        None => Ok(Box::new(Finite::new(voxels))),
    }
}

/// Position of the voxels that the header states: the sform if there is one, otherwise the qform.
///
/// The standard allows a file to state both and leaves the choice to the reader. After a registration the sform holds its
/// result, and ITK, `FSL` and `nibabel` prefer it too.
fn placement_of(name: &str, h: &Header, mm: f64, info: &mut VolumeInfo) -> Option<Placement> {
    let (qform, sform) = (h.qform(mm), h.sform(mm));
    match (qform, sform) {
        (Some(q), Some(s)) => {
            // The two maps are compared at the eight corners, where a difference of affine maps is
            // greatest.
            let last = info.size.map(|n| (n - 1) as f64);
            let corner = |p: &Placement, bits: usize| {
                let along =
                    |axis: usize| p.step_mm[axis] * if bits >> axis & 1 == 1 { last[axis] } else { 0.0 };
                p.origin_mm + along(0) + along(1) + along(2)
            };
            let apart_mm = (0..8).map(|b| corner(&q, b).distance(corner(&s, b))).fold(0.0, f64::max);
            // Half a voxel: smaller differences come from rounding of the quaternion.
            if apart_mm > 0.5 * s.step_mm.iter().map(|v| v.length()).fold(f64::INFINITY, f64::min) {
                let text =
                    format!("sform and qform place voxels up to {apart_mm:.3} mm apart; the sform is taken");
                info.warnings.push(Warning::new(WarningId::ScanDirectionsAssumed, text).in_file(name));
            }
            Some(s)
        }
        (None, None) => {
            let text =
                "states no directions (qform_code and sform_code are 0); the axes are taken for right-handed";
            info.warnings.push(Warning::new(WarningId::ScanDirectionsAssumed, text).in_file(name));
            None
        }
        (q, s) => s.or(q),
    }
}

struct Header<'a> {
    bytes: &'a [u8],
    big_endian: bool,
    /// Whether this is NIfTI-2.
    second: bool,
}

impl Header<'_> {
    fn array<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut b: [u8; N] = self.bytes[at..at + N].try_into().unwrap_or([0; N]);
        if self.big_endian {
            b.reverse();
        }
        b
    }
    /// Reads a real number. Its offset and precision differ between NIfTI-1 (single) and NIfTI-2
    /// (double).
    fn real(&self, first: usize, second: usize, index: usize) -> f64 {
        if self.second { self.f64(second + 8 * index) } else { f64::from(self.f32(first + 4 * index)) }
    }

    fn code(&self, first: usize, second: usize) -> i32 {
        if self.second { self.i32(second) } else { i32::from(self.i16(first)) }
    }

    fn pixdim(&self, index: usize) -> f64 {
        self.real(76, 104, index)
    }

    /// Method 2 of `nifti1.h`: a rotation as a quaternion, the spacing, and the position of the first voxel.
    fn qform(&self, mm: f64) -> Option<Placement> {
        if self.code(252, 344) <= 0 {
            return None;
        }
        // Only three parts of the unit quaternion are stored; the fourth follows from its length.
        let [b, c, d] = [0, 1, 2].map(|i| self.real(256, 352, i));
        let squares = b * b + c * c + d * d;
        // In single precision a half turn has an `a` of up to 3e-4 instead of 0; below the limit it is
        // rounding. Source: `nifti_quatern_to_mat44` of the reference library, which has the same limit.
        let (a, shrink) =
            if 1.0 - squares < 1e-7 { (0.0, 1.0 / squares.sqrt()) } else { ((1.0 - squares).sqrt(), 1.0) };
        let (b, c, d) = (b * shrink, c * shrink, d * shrink);
        let rotation = [
            DVec3::new(a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)),
            DVec3::new(2.0 * (b * c - a * d), a * a + c * c - b * b - d * d, 2.0 * (c * d + a * b)),
            DVec3::new(2.0 * (b * d + a * c), 2.0 * (c * d - a * b), a * a + d * d - b * b - c * c),
        ];
        // pixdim[0] holds qfac, -1 for a left-handed order; 0 counts as 1.
        let handedness = if self.pixdim(0) < 0.0 { -1.0 } else { 1.0 };
        let length_mm = [1.0, 1.0, handedness];
        let step_mm = [0, 1, 2].map(|k| rotation[k] * (self.pixdim(k + 1) * length_mm[k] * mm));
        let origin_mm = DVec3::from([0, 1, 2].map(|i| self.real(268, 376, i))) * mm;
        Some(Placement { origin_mm, step_mm, stated: [true; 3] }.ras_to_lps())
    }

    /// Method 3 of `nifti1.h`: a general affine map, row by row.
    fn sform(&self, mm: f64) -> Option<Placement> {
        if self.code(254, 348) <= 0 {
            return None;
        }
        let column = |k: usize| DVec3::from([0, 1, 2].map(|row| self.real(280, 400, 4 * row + k))) * mm;
        let placement =
            Placement { origin_mm: column(3), step_mm: [column(0), column(1), column(2)], stated: [true; 3] };
        Some(placement.ras_to_lps())
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
