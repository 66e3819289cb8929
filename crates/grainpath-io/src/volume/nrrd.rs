//! NRRD: a text header, a blank line, voxels; or voxels in a file of their own.

use std::io::{BufRead, Seek};

use super::raw::{Layout, Packing, RawSource};
use super::{
    Files, SampleType, VolumeError, VolumeInfo, VolumeProblem, damaged, error, io_error, spacing, unsupported,
};

const FORMAT: &str = "NRRD";

/// Headers are short; a file without a blank line early on is damaged.
const MAX_HEADER: usize = 1 << 16;

pub(super) fn open(files: &Files, name: &str) -> Result<RawSource, VolumeError> {
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
        if n == 0 || text.is_empty() {
            break;
        }
        if read >= MAX_HEADER {
            return Err(damaged(name, "NRRD header", "no blank line ends it within 64 kB"));
        }
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
    if let Some(directions) = get(&["space directions"]) {
        let lengths = directions.split(')').map(|v| {
            let numbers =
                v.trim().trim_start_matches('(').split(',').filter_map(|w| w.trim().parse::<f64>().ok());
            numbers.map(|c| c * c).sum::<f64>().sqrt()
        });
        lengths.take(3).enumerate().for_each(|(k, mm)| info.spacing_mm[k] = spacing(mm));
    } else if let Some(spacings) = get(&["spacings"]) {
        let values = spacings.split_whitespace().map(|w| w.parse::<f64>().unwrap_or(0.0));
        values.take(3).enumerate().for_each(|(k, mm)| info.spacing_mm[k] = spacing(mm));
    }
    if let Some(unit) = get(&["space units", "units"]) {
        let words: Vec<&str> = unit.split('"').map(str::trim).filter(|w| !w.is_empty()).collect();
        let known = words.first().and_then(|w| grainpath_core::units::LengthUnit::from_name(w));
        if let Some(unit) = known {
            let mm = super::unit_mm(unit);
            info.spacing_mm.iter_mut().flatten().for_each(|s| *s *= mm);
        }
    }
    let encoding = need("encoding")?;
    let packing = match encoding.to_ascii_lowercase().as_str() {
        "raw" => Packing::None,
        "gzip" | "gz" => Packing::Gzip,
        _ => return Err(wrong("encoding", encoding.to_owned(), "raw and gzip")),
    };
    let skip: i64 = get(&["byte skip", "byteskip"]).and_then(|v| v.parse().ok()).unwrap_or(0);
    if skip < 0 || get(&["line skip", "lineskip"]).is_some_and(|v| v != "0") {
        return Err(unsupported(
            name,
            "line skip or a negative byte skip",
            "give the number of bytes as byte skip",
        ));
    }
    let (file, at) = match get(&["data file", "datafile"]) {
        None => (name.to_owned(), offset),
        Some(f) if f.contains('%') || f.to_ascii_uppercase().starts_with("LIST") => {
            return Err(unsupported(name, "data in several files", "keep the voxels in one file"));
        }
        Some(f) => (files.sibling(name, f), 0),
    };
    if packing == Packing::Gzip && skip > 0 && at > 0 {
        return Err(unsupported(
            name,
            "byte skip within attached gzip data",
            "write the file without byte skip",
        ));
    }
    let big_endian = get(&["endian"]).is_some_and(|e| e.eq_ignore_ascii_case("big"));
    let (offset, inside) =
        if packing == Packing::Gzip && skip > 0 { (skip as u64, true) } else { (at + skip as u64, false) };
    RawSource::new(files, info, Layout { file, offset, inside, packing, big_endian, scale: (1.0, 0.0) })
}

fn sample(name: &str) -> Option<SampleType> {
    Some(match name.to_ascii_lowercase().as_str() {
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
        std::io::Read::take(&mut **self, limit as u64).read_until(b'\n', line)
    }
}
