//! `grainpath inspect` for CT scans.

use std::path::Path;

use grainpath_core::slices::SampleType;
use grainpath_core::{DVec3, Warning, WarningId};
use grainpath_imaging::scan::{
    ContactSheet, Histogram, Implausible, Plausibility, SAMPLED, ScanError, is_sampled,
};
use grainpath_io::directions::{DirectionOptions, parse_directions};
use grainpath_io::image::sniff_image;
use grainpath_io::volume::RawHeader;
use grainpath_view::histogram::{Mark, histogram_png};
use serde_json::{Value, json};

use crate::args::Inspect;
use crate::inputs::open_scan;
use crate::{Failure, files, outputs};

/// Number of bars in the histogram picture. Source: chosen; one bar for each grey value of 8 bits.
const HISTOGRAM_BINS: usize = 256;
/// Width of the histogram picture, pixels. Source: derived; three pixels for each bar, and a margin for the axis.
const IMAGE_PX: u32 = 900;

/// Whether a path is a scan: a folder, or a file with the ending of a volume format.
pub(super) fn is_scan(path: &Path) -> Result<bool, Failure> {
    if path.is_dir() {
        return Ok(true);
    }
    let name = path.display().to_string().to_ascii_lowercase();
    let named = [
        ".nrrd", ".nhdr", ".mhd", ".mha", ".nii", ".nii.gz", ".hdr", ".img", ".tif", ".tiff", ".dcm", ".zip",
    ];
    Ok(named.iter().any(|e| name.ends_with(e)))
}

/// The header given on the command line, for a raw file without a header.
pub(super) fn raw_header(args: &Inspect) -> Result<Option<RawHeader>, Failure> {
    let Some(size) = &args.size else { return Ok(None) };
    let &[x, y, z] = size.as_slice() else {
        return Err(Failure::usage("--size should be columns,rows,slices"));
    };
    let sample = SampleType::from_name(&args.sample)
        .ok_or_else(|| Failure::usage(format!("--sample {} is not a voxel type", args.sample)))?;
    Ok(Some(RawHeader { size: [x, y, z], sample, big_endian: false, offset_bytes: 0 }))
}

/// Describes a scan, which is read once from the first slice to the last.
pub(super) fn inspect(args: &Inspect, raw: Option<&RawHeader>) -> Result<Value, Failure> {
    let mut source = open_scan(&args.file, raw, false)?;
    let info = source.info().clone();
    // Histogram and contact sheet are collected slice by slice, so that a scan larger than the memory can
    // be inspected.
    let mut histogram = Histogram::default();
    let mut plausibility = Plausibility::new(info.sample);
    let mut sheet = args.sheet.is_some().then(|| ContactSheet::new(info.size));
    let mut slice = Vec::new();
    let mut k = 0;
    while source.next_known(&mut slice).map_err(grainpath::Error::from)? {
        histogram.add(&slice, info.size[0]);
        if is_sampled(k, info.size[2], SAMPLED) {
            plausibility.add(&slice, info.size[0]);
        }
        if let Some(sheet) = &mut sheet {
            sheet.add(k, &slice);
        }
        k += 1;
    }
    let n_replaced = source.n_not_finite();
    let absent = Some(source.n_absent()).filter(|n| *n > 0);
    let replaced = |is_counted: bool| Some(n_replaced).filter(|n| is_counted && *n > 0);
    let voxels = info.size.iter().map(|n| *n as u64).product();
    let (section, is_blank) = ("shape.ct", n_replaced >= voxels);
    let fault = match plausibility.verdict() {
        _ if is_blank => Some(ScanError::NotFinite { voxels }),
        Some(Implausible::ByteOrder) => Some(ScanError::ByteOrder { section }),
        Some(Implausible::Noise) => Some(ScanError::Noise { section }),
        None => None,
    };
    let mut warnings = info.warnings.clone();
    warnings.extend(fault.map(|fault| Warning::new(WarningId::ScanImplausible, fault.to_string())));
    let (low, high) = histogram.range().unwrap_or((0.0, 0.0));
    let (air, material) = histogram.materials();
    if let (Some(sheet), Some(path)) = (sheet, &args.sheet) {
        outputs::save(path, &sheet.png(low, high))?;
    }
    let iso50 = 0.5 * (air + material);
    if let Some(path) = &args.image {
        let mark = |value, colour| Mark { value, colour };
        // The grey values of air and material are marked blue, the thresholds between them red and yellow.
        let marks = [
            mark(air, [90, 150, 255]),
            mark(material, [90, 150, 255]),
            mark(histogram.otsu(), [255, 200, 70]),
            mark(iso50, [255, 90, 80]),
        ];
        let range = (f64::from(low), f64::from(high));
        outputs::save(path, &histogram_png(&histogram.binned(HISTOGRAM_BINS), range, &marks, IMAGE_PX))?;
    }
    let round = |v: f64| (v * 1e4).round() / 1e4;
    // Without a single grey value there are no thresholds.
    let told = |value: Value| if is_blank { Value::Null } else { value };
    // Nine decimals of a millimetre are a picometre: the rounding removes only the noise of binary
    // fractions.
    let spacing_mm = info.spacing_mm.map(|mm| mm.map(|mm| (mm * 1e9).round() / 1e9));
    let size_mm: Vec<Option<f64>> =
        (0..3).map(|i| info.spacing_mm[i].map(|mm| round(mm * info.size[i] as f64))).collect();
    let world = info.world.map(|w| {
        let vector = |v: DVec3| v.to_array().map(|c| (c * 1e9).round() / 1e9);
        // Source: DICOM PS3.3, C.7.6.2: x to the left, y to the back, z to the head. All readers convert
        // to this frame.
        json!({ "frame": "LPS", "origin_mm": vector(w.origin_mm), "columns": vector(w.axes.x_axis),
                "rows": vector(w.axes.y_axis), "slices": vector(w.axes.z_axis) })
    });
    let stored: serde_json::Map<String, Value> =
        info.stored.iter().map(|(what, value)| ((*what).to_owned(), json!(value))).collect();
    // A single slice may be a picture of angles as well.
    let guide_field = if raw.is_none() && info.size[2] == 1 && args.file.is_file() {
        as_field(&files::read(&args.file)?)
    } else {
        None
    };
    Ok(json!({
        "ok": true, "file": args.file.display().to_string(), "kind": "scan", "format": info.format,
        "voxels": info.size, "sample": info.sample.name(), "spacing_mm": spacing_mm, "size_mm": size_mm,
        "world": world, "not_finite": replaced(!info.padded), "padding": replaced(info.padded),
        "stored": stored, "absent": absent,
        "grey": told(json!([low, high])), "otsu": told(json!(round(histogram.otsu()))),
        "materials": told(json!([round(air), round(material)])),
        // Both thresholds that `shape.ct.threshold` can name are listed, so that the user can choose
        // beforehand.
        "iso50": told(json!(round(iso50))), "histogram": told(json!(histogram.binned(32))),
        "guide_field": guide_field,
        "sheet": args.sheet.as_ref().map(|p| p.display().to_string()),
        "image": args.image.as_ref().map(|p| format!(
            "{}: counts on a logarithmic scale; iso50 red, otsu yellow, air and material blue", p.display()
        )),
        "warnings": warnings,
    }))
}

/// How `guide.field` reads a picture, or why it does not; `None` for other files. A picture does not say whether its grey is
/// angles.
pub(super) fn as_field(bytes: &[u8]) -> Option<String> {
    sniff_image(bytes)?;
    Some(match parse_directions(&[("", bytes)], &DirectionOptions::default()) {
        Ok(samples) => {
            let s = samples.summary();
            format!("{}; {}; {}", s.layout, s.directions, s.axis_order)
        }
        Err(e) => format!("not read: {e}"),
    })
}
