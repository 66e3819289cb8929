//! MetaImage: MHD is a header with its voxels in a file beside it; MHA holds both in one file.
//!
//! Source: Kitware, *MetaIO documentation*, and ITK's reader where the two differ. The header has one
//! `Key = value` in each line and ends with `ElementDataFile`. `TransformMatrix` lists the direction of
//! one axis after another, and `Offset` is the position of the first voxel. Without a matrix
//! `AnatomicalOrientation` gives the axes. It comes with a warning, because MetaIO and ITK read its letters in
//! opposite senses. Compressed data are zlib.
//!
//! Axes are LPS (x to the left, y to the back, z to the head) as in ITK. Lengths are in mm unless
//! `DistanceUnits` says otherwise. Cost: one slice at a time is held in memory. Several channels, data in
//! several files, and a `HeaderSize` of -1 (voxels at the end of the file) are refused, and so
//! are voxels written as text (`BinaryData = False`).

use grainpath_core::slices::SliceSource;
use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec3, Warning, WarningId};

use super::finite::Finite;
use super::placement::{Placement, oriented};
use super::raw::{Layout, Packing, RawSource};
use super::{Files, SampleType, VolumeError, VolumeInfo, VolumeProblem, error, spacing, unsupported};

const FORMAT: &str = "MetaImage";

// Limit on the header, bytes: ElementDataFile, its last line, has to come within it.
// Source: chosen; headers of real programs are far shorter.
const MAX_HEADER: u64 = 1 << 16;

pub(super) fn is(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(&head[..head.len().min(256)]);
    text.lines().next().is_some_and(|l| {
        // MetaIO writes one of these keys first.
        l.split_once('=').is_some_and(|(k, _)| ["ObjectType", "NDims", "Comment"].contains(&k.trim()))
    })
}

pub(super) fn open(files: &Files, name: &str) -> Result<Box<dyn SliceSource>, VolumeError> {
    let head = files.head(name, MAX_HEADER)?;
    let mut fields: Vec<(String, String)> = Vec::new();
    let mut at = 0;
    // ElementDataFile is the last field. In an MHA the voxels follow its line, from byte `at`.
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
    let text = need("DimSize")?;
    let sizes: Option<Vec<usize>> = text.split_whitespace().map(|w| w.parse().ok()).collect();
    let sizes = sizes.ok_or_else(|| wrong("DimSize", text.to_owned(), "whole numbers"))?;
    let &[nx, ny, nz] = sizes.as_slice() else {
        return Err(error(name, VolumeProblem::OtherAxes { format: FORMAT, n_axes: sizes.len() }));
    };
    if get("elementnumberofchannels").is_some_and(|n| n != "1") {
        return Err(unsupported(name, "several channels", "a volume of grey values has one"));
    }
    if get("binarydata").is_some_and(|v| !is_true(v)) {
        return Err(unsupported(name, "voxels written as text", "save the file with binary data"));
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
    let unit_mm = match get("distanceunits") {
        None | Some("?" | "mm") => 1.0,
        Some("um") => LengthUnit::Micron.mm(),
        Some("cm") => LengthUnit::Centimetre.mm(),
        Some(other) => return Err(wrong("DistanceUnits", other.to_owned(), "um, mm and cm")),
    };
    // ElementSize is the extent of a voxel. In files that give only ElementSize it equals the spacing.
    let mut signed_mm = [0.0; 3];
    if let Some(text) = get("elementspacing").or(get("elementsize")) {
        let values = text.split_whitespace().map(|w| w.parse::<f64>().unwrap_or(0.0));
        values.take(3).enumerate().for_each(|(k, value)| signed_mm[k] = value * unit_mm);
    }
    info.spacing_mm = signed_mm.map(spacing);
    let placement = placement_of(name, &get, unit_mm, signed_mm, &mut info)?;
    let packing = if get("compresseddata").is_some_and(is_true) { Packing::Zlib } else { Packing::None };
    let data = need("ElementDataFile")?;
    let skip: i64 = match get("headersize") {
        None => 0,
        Some(text) => text.parse().map_err(|_| wrong("HeaderSize", text.to_owned(), "a number of bytes"))?,
    };
    let (file, offset) = match data {
        "LOCAL" | "Local" | "local" => (name.to_owned(), at as u64),
        // A printf pattern or LIST names one file for each slice.
        f if f.contains('%') || f.starts_with("LIST") => {
            return Err(unsupported(name, "data in several files", "keep the voxels in one file"));
        }
        f => (files.sibling(name, f)?, skip.max(0) as u64),
    };
    // -1 would mean that the voxels are the last bytes of the file. It is refused.
    if skip < 0 {
        return Err(wrong("HeaderSize", skip.to_string(), "a number of bytes"));
    }
    // Where both keys are there, MetaIO takes the first of these.
    let big_endian = get("binarydatabyteordermsb").or(get("elementbyteordermsb")).is_some_and(is_true);
    let layout = Layout { file, offset, inside: false, packing, big_endian, scale: (1.0, 0.0) };
    let voxels = RawSource::new(files, info, layout)?;
    match placement {
        Some(placement) => oriented(voxels, &placement, name),
        None => Ok(Box::new(Finite::new(voxels))),
    }
}

/// Whether a value is true. Source: `MetaObject::M_Read` of MetaIO, which looks at the first letter alone.
fn is_true(value: &str) -> bool {
    value.starts_with(['T', 't', '1'])
}

/// Position of the voxels that the header states, in LPS as in ITK; `None` if it states no directions and no axis of
/// negative spacing, which runs backwards.
/// `TransformMatrix` lists the direction of one axis after another and overrules `AnatomicalOrientation`.
fn placement_of<'a>(
    name: &str,
    get: &dyn Fn(&str) -> Option<&'a str>,
    unit_mm: f64,
    signed_mm: [f64; 3],
    info: &mut VolumeInfo,
) -> Result<Option<Placement>, VolumeError> {
    let wrong = |field: &'static str, found: &str, expected: &str| {
        let (found, expected) = (found.to_owned(), expected.to_owned());
        error(name, VolumeProblem::Field { format: FORMAT, field, found, expected })
    };
    let numbers = |text: &str| text.split_whitespace().map(|w| w.parse().ok()).collect::<Option<Vec<f64>>>();
    // Of several keys for one thing, MetaIO takes the first of these.
    let matrix = get("transformmatrix").or(get("rotation")).or(get("orientation"));
    // Programs write `???` if they do not know the orientation.
    let letters = get("anatomicalorientation").filter(|text| !text.contains('?'));
    let directions = match (matrix, letters) {
        (Some(text), _) => {
            let found = numbers(text).filter(|m| m.len() == 9);
            let m = found.ok_or_else(|| wrong("TransformMatrix", text, "nine numbers"))?;
            [0, 3, 6].map(|k| DVec3::new(m[k], m[k + 1], m[k + 2]))
        }
        (None, Some(text)) => {
            // MetaIO's documentation and ITK disagree on whether a letter is the beginning or the end of
            // an axis; most files come from ITK.
            let told = format!(
                "AnatomicalOrientation = {text} is read as ITK writes it: each letter is the side where an axis begins"
            );
            info.warnings.push(Warning::new(WarningId::ScanDirectionsAssumed, told).in_file(name));
            directions_from(text)
                .ok_or_else(|| wrong("AnatomicalOrientation", text, "one letter each of RL, AP and IS"))?
        }
        (None, None) if signed_mm.iter().all(|mm| *mm >= 0.0 || spacing(*mm).is_none()) => return Ok(None),
        (None, None) => [DVec3::X, DVec3::Y, DVec3::Z],
    };
    let origin = match get("origin").or(get("offset")).or(get("position")) {
        None => DVec3::ZERO,
        Some(text) => match numbers(text).as_deref() {
            Some(&[x, y, z]) => DVec3::new(x, y, z),
            _ => return Err(wrong("Offset", text, "three numbers")),
        },
    };
    // ITK turns the direction of an axis of negative spacing, too.
    let length_mm = |k: usize| info.spacing_mm[k].map_or(1.0, |_| signed_mm[k]);
    let step_mm = [0, 1, 2].map(|k| directions[k] * length_mm(k));
    let stated = info.spacing_mm.map(|mm| mm.is_some());
    Ok(Some(Placement { origin_mm: origin * unit_mm, step_mm, stated }))
}

/// The directions of three axes in LPS. Each letter names the side at which its axis begins.
fn directions_from(letters: &str) -> Option<[DVec3; 3]> {
    let direction = |letter: char| {
        Some(match letter {
            // An axis that begins at the right runs to the left, which is +x in LPS.
            'R' => DVec3::X,
            'L' => DVec3::NEG_X,
            'A' => DVec3::Y,
            'P' => DVec3::NEG_Y,
            'I' => DVec3::Z,
            'S' => DVec3::NEG_Z,
            _ => return None,
        })
    };
    let all: Option<Vec<DVec3>> = letters.trim().to_ascii_uppercase().chars().map(direction).collect();
    all?.try_into().ok()
}
