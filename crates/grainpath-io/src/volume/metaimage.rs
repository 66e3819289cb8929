//! MetaImage: MHD with its data beside it, or MHA with both in one.

use super::raw::{Layout, Packing, RawSource};
use super::{Files, SampleType, VolumeError, VolumeInfo, VolumeProblem, error, spacing, unsupported};

const FORMAT: &str = "MetaImage";

const MAX_HEADER: u64 = 1 << 16;

pub(super) fn is(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(&head[..head.len().min(256)]);
    text.lines().next().is_some_and(|l| {
        l.split_once('=').is_some_and(|(k, _)| ["ObjectType", "NDims", "Comment"].contains(&k.trim()))
    })
}

pub(super) fn open(files: &Files, name: &str) -> Result<RawSource, VolumeError> {
    let head = files.head(name, MAX_HEADER)?;
    let mut fields: Vec<(String, String)> = Vec::new();
    let mut at = 0;
    // The data file is named last; in an MHA its voxels follow that line.
    while let Some(end) = head[at..]
        .iter()
        .position(|c| *c == b'\n')
        .map(|n| at + n)
        .or((at < head.len()).then_some(head.len()))
    {
        let line = String::from_utf8_lossy(&head[at..end]).trim().to_owned();
        at = (end + 1).min(head.len());
        if let Some((key, value)) = line.split_once('=') {
            fields.push((key.trim().to_ascii_lowercase(), value.trim().to_owned()));
        }
        if fields.last().is_some_and(|(k, _)| k == "elementdatafile") {
            break;
        }
    }
    let get = |key: &str| fields.iter().find(|(k, _)| k == key).map(|(_, v)| v.as_str());
    let wrong = |field: &'static str, found: String, expected: &str| {
        error(name, VolumeProblem::Field { format: FORMAT, field, found, expected: expected.to_owned() })
    };
    let need = |key: &str| {
        get(&key.to_ascii_lowercase())
            .ok_or_else(|| error(name, VolumeProblem::MissingField { format: FORMAT, field: key.to_owned() }))
    };
    let sizes: Vec<usize> = need("DimSize")?.split_whitespace().filter_map(|w| w.parse().ok()).collect();
    let &[nx, ny, nz] = sizes.as_slice() else {
        return Err(error(name, VolumeProblem::OtherAxes { format: FORMAT, n_axes: sizes.len() }));
    };
    if get("elementnumberofchannels").is_some_and(|n| n != "1") {
        return Err(unsupported(name, "several channels", "a volume of grey values has one"));
    }
    let stored = need("ElementType")?;
    let sample = match stored {
        "MET_UCHAR" => SampleType::U8,
        "MET_CHAR" => SampleType::I8,
        "MET_USHORT" => SampleType::U16,
        "MET_SHORT" => SampleType::I16,
        "MET_UINT" | "MET_ULONG" => SampleType::U32,
        "MET_INT" | "MET_LONG" => SampleType::I32,
        "MET_FLOAT" => SampleType::F32,
        "MET_DOUBLE" => SampleType::F64,
        _ => {
            return Err(wrong("ElementType", stored.to_owned(), "MET_UCHAR to MET_DOUBLE"));
        }
    };
    let mut info = VolumeInfo::new(FORMAT, [nx, ny, nz], sample);
    if let Some(text) = get("elementspacing").or(get("elementsize")) {
        let values = text.split_whitespace().map(|w| w.parse::<f64>().unwrap_or(0.0));
        values.take(3).enumerate().for_each(|(k, mm)| info.spacing_mm[k] = spacing(mm));
    }
    let yes = |key: &str| get(key).is_some_and(|v| v.eq_ignore_ascii_case("true"));
    let packing = if yes("compresseddata") { Packing::Zlib } else { Packing::None };
    let data = need("ElementDataFile")?;
    let skip: i64 = get("headersize").and_then(|v| v.parse().ok()).unwrap_or(0);
    let (file, offset) = match data {
        "LOCAL" | "Local" | "local" => (name.to_owned(), at as u64),
        f if f.contains('%') || f.starts_with("LIST") => {
            return Err(unsupported(name, "data in several files", "keep the voxels in one file"));
        }
        f => (files.sibling(name, f), skip.max(0) as u64),
    };
    if skip < 0 {
        return Err(wrong("HeaderSize", skip.to_string(), "a number of bytes"));
    }
    let big_endian = yes("binarydatabyteordermsb") || yes("elementbyteordermsb");
    RawSource::new(
        files,
        info,
        Layout { file, offset, inside: false, packing, big_endian, scale: (1.0, 0.0) },
    )
}
