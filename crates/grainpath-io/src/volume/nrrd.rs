//! NRRD: a text header and a blank line, followed by the voxels, which may also be in a separate file.
//!
//! Source: Teem, *Definition of NRRD File Format*. The header has fields `key: value`, key-value pairs
//! and comments. `space directions` and `space origin` place the voxels in the space that `space` names;
//! a left-handed space is mirrored along y, so that its z stays up. Encodings raw and gzip are read; a
//! byte skip counts unpacked bytes.
//!
//! Lengths are converted to mm by `space units`; patient spaces without a unit are in mm. The cost is a
//! slice at a time in memory. The header may take 64 kB. Axes that are not spatial, such as colours, data
//! in several files, and a byte skip from the end of a packed file are refused.

use std::io::{BufRead, Seek};

use grainpath_core::slices::SliceSource;
use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec3, Warning, WarningId};

use super::finite::Finite;
use super::placement::{Placement, oriented};
use super::raw::{Layout, Packing, RawSource};
use super::{
    Files, SampleType, VolumeError, VolumeInfo, VolumeProblem, damaged, error, io_error, spacing, unsupported,
};

const FORMAT: &str = "NRRD";

/// Limit on the header, bytes. Headers are short; a file with no empty line in this range is damaged.
/// Source: chosen; files of real programs stay far below it.
const MAX_HEADER: usize = 1 << 16;

pub(super) fn open(files: &Files, name: &str) -> Result<Box<dyn SliceSource>, VolumeError> {
    let mut reader = files.open(name)?;
    let mut fields: Vec<(String, String)> = Vec::new();
    let mut read = 0;
    loop {
        let mut line = Vec::new();
        let n = (&mut reader as &mut dyn BufRead)
            .take_line(MAX_HEADER - read, &mut line)
            .map_err(|e| io_error(name, &e))?;
        read += n;
        let text = String::from_utf8_lossy(&line);
        let text = text.trim();
        // An empty line ends the header. A detached header may end with the file instead.
        if n == 0 || text.is_empty() {
            break;
        }
        if read >= MAX_HEADER {
            return Err(damaged(name, "NRRD header", "no blank line ends it within 64 kB"));
        }
        // Fields are `key: value`, key-value pairs `key:=value`, comments begin with #.
        if let Some((key, value)) = text.split_once(':').filter(|_| !text.starts_with('#')) {
            fields.push((key.trim().to_ascii_lowercase(), value.trim_start_matches('=').trim().to_owned()));
        }
    }
    let offset = reader.stream_position().map_err(|e| io_error(name, &e))?;
    let get =
        |keys: &[&str]| fields.iter().find(|(k, _)| keys.contains(&k.as_str())).map(|(_, v)| v.as_str());
    let wrong = |field: &'static str, found: String, expected: &str| {
        error(name, VolumeProblem::Field { format: FORMAT, field, found, expected: expected.to_owned() })
    };
    let need = |key: &str| {
        get(&[key])
            .ok_or_else(|| error(name, VolumeProblem::MissingField { format: FORMAT, field: key.to_owned() }))
    };
    let sizes: Vec<usize> = need("sizes")?.split_whitespace().filter_map(|w| w.parse().ok()).collect();
    let &[nx, ny, nz] = sizes.as_slice() else {
        return Err(error(name, VolumeProblem::OtherAxes { format: FORMAT, n_axes: sizes.len() }));
    };
    let stored = need("type")?;
    let sample = sample(stored)
        .ok_or_else(|| wrong("type", stored.to_owned(), "8 to 32 bit integers, float and double"))?;
    let mut info = VolumeInfo::new(FORMAT, [nx, ny, nz], sample);
    let placement = placement_of(name, &get, &mut info)?;
    let encoding = need("encoding")?;
    let packing = match encoding.to_ascii_lowercase().as_str() {
        "raw" => Packing::None,
        "gzip" | "gz" => Packing::Gzip,
        _ => return Err(wrong("encoding", encoding.to_owned(), "raw and gzip")),
    };
    // A byte skip of -1 means that the voxels stand at the end of the file; it cannot be resolved in a
    // packed stream.
    let skip: i64 = get(&["byte skip", "byteskip"]).and_then(|v| v.parse().ok()).unwrap_or(0);
    if skip < 0 || get(&["line skip", "lineskip"]).is_some_and(|v| v != "0") {
        return Err(unsupported(
            name,
            "line skip or a negative byte skip",
            "give the number of bytes as byte skip",
        ));
    }
    // Without a data file the voxels follow the header in the same file.
    let (file, at) = match get(&["data file", "datafile"]) {
        None => (name.to_owned(), offset),
        Some(f) if f.contains('%') || f.to_ascii_uppercase().starts_with("LIST") => {
            return Err(unsupported(name, "data in several files", "keep the voxels in one file"));
        }
        Some(f) => (files.sibling(name, f)?, 0),
    };
    if packing == Packing::Gzip && skip > 0 && at > 0 {
        return Err(unsupported(
            name,
            "byte skip within attached gzip data",
            "write the file without byte skip",
        ));
    }
    let big_endian = get(&["endian"]).is_some_and(|e| e.eq_ignore_ascii_case("big"));
    // The format counts a byte skip after unpacking, so in packed data it is skipped while inflating.
    let (offset, inside) =
        if packing == Packing::Gzip && skip > 0 { (skip as u64, true) } else { (at + skip as u64, false) };
    let layout = Layout { file, offset, inside, packing, big_endian, scale: (1.0, 0.0) };
    let voxels = RawSource::new(files, info, layout)?;
    match placement {
        Some(placement) => oriented(voxels, &placement, name),
        None => Ok(Box::new(Finite::new(voxels))),
    }
}

/// Position of the voxels that the header states. Without `space directions` only the spacing is known; an axis of
/// negative spacing runs backwards.
fn placement_of<'a>(
    name: &str,
    get: &dyn Fn(&[&str]) -> Option<&'a str>,
    info: &mut VolumeInfo,
) -> Result<Option<Placement>, VolumeError> {
    let wrong = |field: &'static str, found: &str, expected: &str| {
        let (found, expected) = (found.to_owned(), expected.to_owned());
        error(name, VolumeProblem::Field { format: FORMAT, field, found, expected })
    };
    let Some(directions) = get(&["space directions"]) else {
        let unit_mm = units_mm(name, get(&["units"]), info);
        let mut signed_mm = [0.0; 3];
        if let Some(spacings) = get(&["spacings"]) {
            let values = spacings.split_whitespace().map(|w| w.parse::<f64>().unwrap_or(0.0));
            values.take(3).enumerate().for_each(|(k, value)| signed_mm[k] = value * unit_mm[k]);
        }
        info.spacing_mm = signed_mm.map(spacing);
        return Ok(Placement::of_signed(signed_mm));
    };
    let three = "three vectors of three numbers";
    let vectors: Option<Vec<DVec3>> = split_vectors(directions).map(vector).collect();
    let vectors = vectors.ok_or_else(|| wrong("space directions", directions, three))?;
    // `none` stands for an axis that is not spatial, such as colour; such volumes are refused.
    let &[a, b, c] = vectors.as_slice() else { return Err(wrong("space directions", directions, three)) };
    let origin = match get(&["space origin"]) {
        None => DVec3::ZERO,
        Some(text) => vector(text).ok_or_else(|| wrong("space origin", text, "a vector of three numbers"))?,
    };
    let space = get(&["space"]);
    // Factors that convert the space to LPS. A left-handed space is mirrored along y, so that its z stays
    // up.
    let to_lps = match space.map(str::to_ascii_lowercase).as_deref() {
        None | Some("left-posterior-superior" | "lps" | "scanner-xyz" | "3d-right-handed") => [1.0, 1.0, 1.0],
        Some("right-anterior-superior" | "ras") => [-1.0, -1.0, 1.0],
        Some("left-anterior-superior" | "las" | "3d-left-handed") => [1.0, -1.0, 1.0],
        Some(other) => return Err(wrong("space", other, "a space of three axes, such as LPS or RAS,")),
    };
    // Patient spaces are in mm by convention where no unit is stated.
    let unit_mm = match (get(&["space units"]), space) {
        (None, Some(_)) => [1.0; 3],
        (units, _) => units_mm(name, units, info),
    };
    let scale = DVec3::from(to_lps) * DVec3::from(unit_mm);
    Ok(Some(Placement {
        origin_mm: origin * scale,
        step_mm: [a, b, c].map(|v| v * scale),
        stated: [true; 3],
    }))
}

/// The words of `space directions`, `(1,0,0)` or `none`, each as one piece.
fn split_vectors(text: &str) -> impl Iterator<Item = &str> {
    text.split_inclusive(')').map(str::trim).filter(|word| !word.is_empty())
}

fn vector(text: &str) -> Option<DVec3> {
    let numbers = text.trim().strip_prefix('(')?.strip_suffix(')')?.split(',');
    let numbers: Option<Vec<f64>> = numbers.map(|word| word.trim().parse().ok()).collect();
    let &[x, y, z] = numbers?.as_slice() else { return None };
    Some(DVec3::new(x, y, z))
}

/// Length in mm of the units of three axes. Warns where a unit is assumed.
fn units_mm(name: &str, units: Option<&str>, info: &mut VolumeInfo) -> [f64; 3] {
    let words: Vec<&str> =
        units.unwrap_or("").split('"').map(str::trim).filter(|word| !word.is_empty()).collect();
    let mut unknown = words.is_empty().then(|| "no unit".to_owned());
    let unit_mm = [0, 1, 2].map(|axis| {
        // A single unit counts for all axes.
        let Some(word) = words.get(axis).or(words.last()) else { return 1.0 };
        match (*word, LengthUnit::from_name(word)) {
            // The micro sign and the Greek letter mu look alike and are both in use.
            ("inches", _) => LengthUnit::Inch.mm(),
            ("\u{b5}m" | "\u{3bc}m" | "microns" | "micrometer", _) => LengthUnit::Micron.mm(),
            (_, Some(unit)) => unit.mm(),
            _ => {
                unknown = Some(format!("the unit {word:?}, which is not known"));
                1.0
            }
        }
    });
    if let Some(stated) = unknown {
        let text = format!("states {stated}; lengths are taken for mm");
        info.warnings.push(Warning::new(WarningId::UnitAssumed, text).in_file(name));
    }
    unit_mm
}

fn sample(name: &str) -> Option<SampleType> {
    Some(match name.to_ascii_lowercase().as_str() {
        // Names of types as the format lists them, section "type".
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => SampleType::U8,
        "signed char" | "int8" | "int8_t" => SampleType::I8,
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => SampleType::U16,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => SampleType::I16,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => SampleType::U32,
        "int" | "signed int" | "int32" | "int32_t" => SampleType::I32,
        "float" => SampleType::F32,
        "double" => SampleType::F64,
        _ => return None,
    })
}

trait TakeLine {
    fn take_line(&mut self, limit: usize, line: &mut Vec<u8>) -> std::io::Result<usize>;
}

impl TakeLine for &mut dyn BufRead {
    fn take_line(&mut self, limit: usize, line: &mut Vec<u8>) -> std::io::Result<usize> {
        // The limit stops a file without line breaks from being read as one line.
        std::io::Read::take(&mut **self, limit as u64).read_until(b'\n', line)
    }
}
