//! Reads the samples of directions from the bytes of a file in any of the formats.

use grainpath_core::number::number;
use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec2, DVec3, Warning, WarningId};

use super::cloud::{Carrier, Cloud, Node, Sample, of_points, tensor};
use super::grid::{DirectionGrid, GridCell};
use super::model::{
    AngleUnit, DirectionError, DirectionOptions, DirectionProblem, DirectionSummary, GridAxes, MAX_CELLS,
    MissingDirections, invalid, missing,
};
use super::npy::{Array, MAGIC, read_npy, read_npz};
use super::samples::DirectionSamples;
use super::table::{
    ANGLES, Column, angle_reading, angle_unit, axis_of_angle, from_columns, names_directions, strength_scale,
};
use crate::fe::{Element, FeArray, FeError, FeFile, FeFormat, On, parse_fe, sniff_fe};
use crate::image::{Image, Samples, decode_within, sniff_image};
use crate::text::skip_space;

/// Whether a file certainly holds directions: an array of numpy, or a table whose header names a direction. Pictures and
/// finite-element files are not recognised, because they may hold other data.
pub fn sniff_directions(bytes: &[u8], name: &str) -> bool {
    let lower = name.to_ascii_lowercase();
    bytes.starts_with(MAGIC)
        || (bytes.starts_with(b"PK") && lower.ends_with(".npz"))
        || header(bytes).is_some_and(|(names, _)| names_directions(&names))
}

/// Reads directions. One file is told by its content; several are the matrices of a `vector_slicer`
/// folder, told by their names: `thetaField.csv`, or `xField.csv` and `yField.csv`, and perhaps
/// `shape.csv`, whose zeros have no direction.
///
/// # Errors
/// [`DirectionError`] with what is wrong and where.
pub fn parse_directions(
    files: &[(&str, &[u8])],
    options: &DirectionOptions,
) -> Result<DirectionSamples, DirectionError> {
    let [(name, bytes)] = files else { return matrices(files, options) };
    if bytes.is_empty() {
        return Err(DirectionError::Empty);
    }
    if bytes.starts_with(MAGIC) {
        return from_arrays("npy", vec![(String::new(), read_npy(bytes, name)?)], options, name);
    }
    if bytes.starts_with(b"PK") {
        return from_arrays("npz", read_npz(bytes, name)?, options, name);
    }
    if sniff_image(bytes).is_some() {
        return picture(bytes, name);
    }
    if sniff_fe(bytes, Some(name)).is_some_and(|f| f != FeFormat::Csv) {
        return mesh(&parse_fe(bytes, Some(name))?, options);
    }
    if bytes.iter().take(4096).any(|b| *b == 0) {
        return Err(DirectionError::Unknown);
    }
    match header(bytes) {
        Some((names, separator)) => {
            from_columns("CSV", &rows(bytes, &names, separator, name)?, options, name)
        }
        None => matrices(files, options),
    }
}

// Tables.

/// Limit on the columns of a table. Source: the reader of stress tables, `fe::csv`.
const MAX_COLUMNS: usize = 256;

/// The names and the separator of the first line, unless it is made of numbers.
pub(super) fn header(bytes: &[u8]) -> Option<(Vec<String>, u8)> {
    let text = skip_space(bytes);
    let line = text[..text.len().min(1 << 16)].split(|b| matches!(b, b'\n' | b'\r')).next()?;
    let separator = separator_of(line)?;
    let name = |f: &[u8]| String::from_utf8_lossy(f.trim_ascii()).trim_matches(['"', '#', ' ']).to_owned();
    let names: Vec<String> = cells(line.trim_ascii(), separator).take(MAX_COLUMNS).map(name).collect();
    let is_number = |n: &String| n.is_empty() || number(n.as_bytes()).is_some();
    (!names.iter().all(is_number)).then_some((names, separator))
}

fn separator_of(line: &[u8]) -> Option<u8> {
    [b';', b'\t', b',', b' '].into_iter().find(|s| line.trim_ascii().contains(s))
}

/// The cells of a line; several spaces count as one.
fn cells(line: &[u8], separator: u8) -> impl Iterator<Item = &[u8]> {
    line.split(move |&b| b == separator).filter(move |f| separator != b' ' || !f.is_empty())
}

/// A number; NaN for a word and for an empty cell. Decimal commas are read where another character
/// separates columns.
fn cell(field: &[u8], separator: u8) -> f64 {
    let text = field.trim_ascii();
    let point = || {
        let text: Vec<u8> = text.iter().map(|&b| if b == b',' { b'.' } else { b }).collect();
        number(&text)
    };
    number(text).or_else(|| if separator == b',' { None } else { point() }).unwrap_or(f64::NAN)
}

pub(super) fn rows(
    bytes: &[u8],
    names: &[String],
    separator: u8,
    place: &str,
) -> Result<Vec<Column>, DirectionError> {
    let mut columns: Vec<Column> = names.iter().map(|n| (n.clone(), Vec::new())).collect();
    for (i, line) in skip_space(bytes).split(|&b| b == b'\n').enumerate().skip(1) {
        let line = line.trim_ascii();
        if line.is_empty() || line.starts_with(b"#") {
            continue;
        }
        let mut fields = cells(line, separator);
        for (k, column) in columns.iter_mut().enumerate() {
            let Some(field) = fields.next() else {
                let problem = DirectionProblem::Columns { found: k, wanted: names.len() };
                return Err(invalid(format!("{place}, line {}", i + 1), problem));
            };
            column.1.push(cell(field, separator));
        }
    }
    Ok(columns)
}

// Arrays of numpy.

/// Usual names of arrays of positions and of vectors, each with two or three columns.
const POSITIONS: [&str; 6] = ["points", "positions", "p", "xy", "xyz", "coordinates"];
const VECTORS: [&str; 6] = ["directions", "vectors", "director", "v", "d", "field"];

fn from_arrays(
    format: &'static str,
    arrays: Vec<(String, Array)>,
    options: &DirectionOptions,
    place: &str,
) -> Result<DirectionSamples, DirectionError> {
    if arrays.is_empty() {
        return Err(missing(MissingDirections::Array));
    }
    // A structured array is a table.
    if let [(_, array)] = &arrays[..]
        && array.fields.len() > 1
    {
        return from_columns(format, &array.fields, options, place);
    }
    let flat = |a: &Array| a.shape.len() == 1;
    let pairs = |a: &Array| a.shape.len() == 2 && [2, 3].contains(&a.shape[1]);
    let is_position =
        |name: &str, a: &Array| pairs(a) && POSITIONS.contains(&name.to_ascii_lowercase().as_str());
    let table = arrays.iter().any(|(name, a)| is_position(name, a))
        || (arrays.iter().filter(|(_, a)| flat(a)).count() > 2);
    if table {
        let mut columns: Vec<Column> = Vec::new();
        for (name, array) in &arrays {
            let lower = name.to_ascii_lowercase();
            let values = |k: usize, n: usize| -> Vec<f64> {
                array.fields[0].1.iter().skip(k).step_by(n).copied().collect()
            };
            let letters: &[&str] = if is_position(name, array) {
                &["x", "y", "z"]
            } else if pairs(array)
                && (VECTORS.contains(&lower.as_str()) || options.array.as_ref() == Some(name))
            {
                &["vx", "vy", "vz"]
            } else {
                &[]
            };
            if flat(array) {
                columns.push((name.clone(), array.fields[0].1.clone()));
            } else if !letters.is_empty() {
                let n = array.shape[1];
                columns.extend((0..n).map(|k| (letters[k].to_owned(), values(k, n))));
            }
        }
        let options = DirectionOptions { array: None, ..options.clone() };
        return from_columns(format, &columns, &options, place);
    }
    let lower = |name: &str| name.to_ascii_lowercase();
    let find = |names: &[&str]| {
        arrays.iter().find(|(name, a)| a.shape.len() == 2 && names.contains(&split_base(name).as_str()))
    };
    let wanted = match &options.array {
        Some(array) => arrays.iter().find(|(name, _)| lower(name) == lower(array)),
        None => find(&ANGLES)
            .or_else(|| arrays.iter().find(|(_, a)| a.shape.len() == 3))
            .or_else(|| if arrays.len() == 1 { arrays.first() } else { None }),
    };
    let strength = find(&["strength", "weight", "confidence", "coherence", "mask", "shape"]).map(|(_, a)| a);
    let spacing = find(&["spacing", "distance", "spacing_mm"]).map(|(_, a)| a);
    if let (None, None, Some(x), Some(y)) =
        (wanted, &options.array, find(&["vx", "ux", "dx", "nx", "u"]), find(&["vy", "uy", "dy", "ny", "v"]))
    {
        let read = GridNumbers { format, axes: None, unit: None, x: &x.1, y: Some(&y.1), strength, spacing };
        return grid(&format!("vectors {}, {}", x.0, y.0), &read, options, place);
    }
    let Some((name, array)) = wanted else {
        let names = arrays.iter().map(|(n, _)| n.clone()).collect();
        return Err(missing(MissingDirections::KnownArray(names)));
    };
    let name = if name.is_empty() { "angles" } else { name };
    let read = GridNumbers { format, axes: None, unit: None, x: array, y: None, strength, spacing };
    grid(name, &read, options, place)
}

/// The name of an array without its unit.
fn split_base(name: &str) -> String {
    let lower = name.to_ascii_lowercase();
    let base =
        lower.rsplit_once('_').filter(|(_, unit)| angle_unit(unit).is_some()).map(|(b, _)| b.to_owned());
    base.unwrap_or(lower)
}

/// The arrays of a grid: angles, vectors in the last index, or two arrays of components.
struct GridNumbers<'a> {
    /// Name of the format.
    format: &'static str,
    /// Order of the indices and unit of the angles that the format fixes. They apply where the job states none.
    axes: Option<GridAxes>,
    unit: Option<AngleUnit>,
    x: &'a Array,
    y: Option<&'a Array>,
    strength: Option<&'a Array>,
    spacing: Option<&'a Array>,
}

fn grid(
    name: &str,
    numbers: &GridNumbers<'_>,
    options: &DirectionOptions,
    place: &str,
) -> Result<DirectionSamples, DirectionError> {
    let shape = &numbers.x.shape;
    let (n0, n1, parts) = match shape[..] {
        [a, b] => (a, b, 1),
        [a, b, c @ (2 | 3)] => (a, b, c),
        _ => {
            let problem = DirectionProblem::Shape { name: name.to_owned(), shape: shape.clone() };
            return Err(invalid(place, problem));
        }
    };
    if n0 == 0 || n1 == 0 {
        return Err(missing(MissingDirections::Cells { name: name.to_owned(), shape: shape.clone() }));
    }
    if n0.saturating_mul(n1) > MAX_CELLS {
        return Err(DirectionError::TooMany { what: "cells", found: (n0 * n1) as u64, limit: MAX_CELLS });
    }
    for other in [numbers.y, numbers.strength, numbers.spacing].into_iter().flatten() {
        if other.shape[..] != [n0, n1] {
            return Err(invalid(place, DirectionProblem::ShapesDiffer(shape.clone())));
        }
    }
    let mut warnings = Vec::new();
    let stated = options.axes.or(numbers.axes);
    let axes = stated.unwrap_or(GridAxes::Yx);
    if stated.is_none() && n0 > 1 && n1 > 1 {
        let text = format!("the order of the indices of {name} was assumed: {}", axes.meaning());
        warnings.push(Warning::new(WarningId::FieldAssumed, text).with_remedy("set guide.field.axes"));
    }
    let values = &numbers.x.fields[0].1;
    let vectors = parts > 1 || numbers.y.is_some();
    let reading = (!vectors).then(|| {
        let unit = name.rsplit_once('_').and_then(|(_, unit)| angle_unit(unit));
        angle_reading(name, unit.or(numbers.unit), options, values)
    });
    let (columns, rows) = if axes == GridAxes::Xy { (n0, n1) } else { (n1, n0) };
    let index = |column: usize, row: usize| match axes {
        GridAxes::Yx => row * n1 + column,
        GridAxes::Xy => column * n1 + row,
        GridAxes::Image => (n0 - 1 - row) * n1 + column,
    };
    let scale = match numbers.strength {
        Some(s) => strength_scale(&s.fields[0].1, place)?,
        None => 1.0,
    };
    let cell = |column: usize, row: usize| -> GridCell {
        let i = index(column, row);
        let axis = match (&reading, numbers.y) {
            (Some(reading), _) => axis_of_angle(values[i], reading.unit),
            (None, Some(y)) => DVec3::new(values[i], y.fields[0].1[i], 0.0).normalize_or_zero(),
            (None, None) => {
                let part = |k: usize| if k < parts { values[i * parts + k] } else { 0.0 };
                DVec3::new(part(0), part(1), part(2)).normalize_or_zero()
            }
        };
        let strength = numbers.strength.map_or(1.0, |s| scale * s.fields[0].1[i]);
        // A vector that points out of the plane counts by the square of its part in the plane.
        let strength = strength * axis.truncate().length_squared();
        (strength.is_finite() && strength > 0.0)
            .then(|| (DVec2::new(axis.x * axis.x - axis.y * axis.y, 2.0 * axis.x * axis.y), strength))
    };
    let known = (0..rows).flat_map(|r| (0..columns).map(move |c| (c, r)));
    let samples = known.filter(|&(c, r)| cell(c, r).is_some()).count();
    if samples == 0 {
        return Err(DirectionError::NoDirection(columns * rows));
    }
    if columns * rows == 1 {
        let text = "the grid has one cell, so the direction is the same everywhere";
        warnings.push(Warning::new(WarningId::FieldOneSample, text));
    }
    let mut grid = DirectionGrid::new(columns, rows, cell);
    if let Some(spacing) = numbers.spacing {
        let unit = options.length_unit.unwrap_or(LengthUnit::Millimetre).mm();
        let spacing_mm = |(c, r): (usize, usize)| (unit * spacing.fields[0].1[index(c, r)]) as f32;
        let all: Vec<f32> =
            (0..rows).flat_map(|r| (0..columns).map(move |c| (c, r))).map(spacing_mm).collect();
        if let Some(i) = all.iter().position(|s| !(s.is_finite() && *s > 0.0)) {
            return Err(invalid(place, DirectionProblem::CellSpacing(i + 1)));
        }
        grid = grid.with_spacing(all);
    }
    let directions = match &reading {
        Some(reading) => reading.text.clone(),
        None if parts > 1 => format!("vectors {name}"),
        None => name.to_owned(),
    };
    warnings.extend(reading.and_then(|r| r.warning));
    let summary = DirectionSummary {
        format: numbers.format,
        layout: format!("a grid of {columns} x {rows} cells (x, y)"),
        samples,
        without_direction: columns * rows - samples,
        directions,
        length_unit: String::new(),
        axis_order: format!("{}{}", axes.meaning(), if stated.is_some() { "" } else { " (assumed)" }),
        has_strength: numbers.strength.is_some(),
        has_spacing: numbers.spacing.is_some(),
    };
    Ok(DirectionSamples::new(Carrier::Grid(grid), summary, warnings).with_count_warning())
}

// Matrices of vector_slicer.

fn matrices(files: &[(&str, &[u8])], options: &DirectionOptions) -> Result<DirectionSamples, DirectionError> {
    let read = |wanted: &str| -> Result<Option<Array>, DirectionError> {
        let is = |name: &str| {
            let file = name.rsplit(['/', '\\']).next().unwrap_or(name).to_ascii_lowercase();
            file.replace('_', "") == wanted
        };
        let found = files.iter().find(|(name, _)| is(name));
        found.map(|(name, bytes)| matrix(bytes, name)).transpose()
    };
    let (theta, shape) = match files {
        [(name, bytes)] => (Some(matrix(bytes, name)?), None),
        _ => (read("thetafield.csv")?, read("shape.csv")?),
    };
    let (x, y) = if theta.is_some() { (None, None) } else { (read("xfield.csv")?, read("yfield.csv")?) };
    let place = files.first().map_or("the folder", |f| f.0);
    let (name, x, y) = match (&theta, &x, &y) {
        (Some(theta), _, _) => ("theta", theta, None),
        (None, Some(x), Some(y)) => ("vectors xField, yField", x, Some(y)),
        _ => return Err(missing(MissingDirections::Matrices)),
    };
    let (axes, unit) = (Some(GridAxes::Xy), Some(AngleUnit::Radian));
    let strength = shape.as_ref();
    let numbers = GridNumbers { format: "vector_slicer", axes, unit, x, y, strength, spacing: None };
    grid(name, &numbers, options, place)
}

/// A CSV of numbers alone. Tables of two to six columns without a header are refused, because they are more likely lists of
/// points than matrices.
pub(super) fn matrix(bytes: &[u8], place: &str) -> Result<Array, DirectionError> {
    let text = skip_space(bytes);
    let first = text.split(|&b| b == b'\n').next().unwrap_or_default();
    let separator = separator_of(first).ok_or(DirectionError::Unknown)?;
    let (mut values, mut columns, mut rows) = (Vec::new(), 0, 0);
    for (i, line) in text.split(|&b| b == b'\n').enumerate() {
        let line = line.trim_ascii();
        // Some programs end every line with a separator.
        let line = line.strip_suffix(&[separator]).unwrap_or(line);
        if line.is_empty() || line.starts_with(b"#") {
            continue;
        }
        let before = values.len();
        for field in cells(line, separator) {
            let v = cell(field, separator);
            if v.is_nan() && !field.trim_ascii().eq_ignore_ascii_case(b"nan") {
                let word: String = String::from_utf8_lossy(field).chars().take(40).collect();
                return Err(invalid(format!("{place}, line {}", i + 1), DirectionProblem::NotANumber(word)));
            }
            values.push(v);
        }
        let n = values.len() - before;
        if rows == 0 {
            columns = n;
        } else if n != columns {
            let problem = DirectionProblem::Numbers { found: n, wanted: columns };
            return Err(invalid(format!("{place}, line {}", i + 1), problem));
        }
        rows += 1;
        if values.len() > MAX_CELLS {
            return Err(DirectionError::TooMany {
                what: "cells",
                found: values.len() as u64,
                limit: MAX_CELLS,
            });
        }
    }
    if columns <= 6 && rows > 10 * columns {
        return Err(invalid(place, DirectionProblem::NoHeader { rows, columns }));
    }
    Ok(Array { shape: vec![rows, columns], fields: vec![(String::new(), values)] })
}

// Pictures.

/// A pixel is coloured, and not grey, where its channels differ by more than this share of white.
/// Source: derived. Rounding in a conversion costs up to half a step of eight bits; a tenth of a step more is room for the
/// arithmetic in single precision.
const GREY_TOLERANCE: f32 = 0.6 / 255.0;

/// The grey of every pixel, from 0 to 1, row by row from the top, and its alpha; `meaning` says what a grey picture is.
pub(super) fn grey(
    image: &Image,
    place: &str,
    meaning: &'static str,
) -> Result<Vec<(f32, f32)>, DirectionError> {
    let scale = 1.0 / image.samples.full_scale();
    let value = |i: usize| match &image.samples {
        Samples::U8(v) => scale * f32::from(v[i]),
        Samples::U16(v) => scale * f32::from(v[i]),
        Samples::F32(v) => v[i],
    };
    let (n, colour, alpha) = match image.channels {
        1 => (1, false, false),
        2 => (2, false, true),
        3 => (3, true, false),
        _ => (4, true, true),
    };
    let coloured = |k: usize| {
        let [r, g, b] = [value(n * k), value(n * k + 1), value(n * k + 2)];
        (r - g).abs().max((g - b).abs()) > GREY_TOLERANCE
    };
    let pixels = image.width * image.height;
    if colour && (0..pixels).any(coloured) {
        return Err(invalid(place, DirectionProblem::Colours(meaning)));
    }
    Ok((0..pixels).map(|k| (value(n * k), if alpha { value(n * k + n - 1) } else { 1.0 })).collect())
}

fn picture(bytes: &[u8], place: &str) -> Result<DirectionSamples, DirectionError> {
    let image = decode_within(bytes, MAX_CELLS as u64)?;
    let pixels = grey(&image, place, "an angle picture is grey, from 0 to the maximum for 0 to 180 degrees")?;
    let (columns, rows) = (image.width, image.height);
    let alpha = ![1, 3].contains(&image.channels);
    let cell = |column: usize, row: usize| -> GridCell {
        let (grey, strength) = pixels[(rows - 1 - row) * columns + column];
        let (grey, strength) = (f64::from(grey), f64::from(strength));
        (grey.is_finite() && strength > 0.0)
            .then(|| (grainpath_core::math::direction(std::f64::consts::TAU * grey), strength.min(1.0)))
    };
    let all = || (0..rows).flat_map(|r| (0..columns).map(move |c| (c, r)));
    let samples = all().filter(|&(c, r)| cell(c, r).is_some()).count();
    if samples == 0 {
        return Err(DirectionError::NoDirection(columns * rows));
    }
    let mut warnings = Vec::new();
    if image.format == crate::ImageFormat::Jpeg {
        let text = "a JPEG changes the grey values, and with them the angles";
        warnings
            .push(Warning::new(WarningId::FieldAssumed, text).with_remedy("save the angle picture as PNG"));
    }
    let grid = DirectionGrid::new(columns, rows, cell);
    let summary = DirectionSummary {
        format: image.format.name(),
        layout: format!("a grid of {columns} x {rows} cells (x, y)"),
        samples,
        without_direction: columns * rows - samples,
        directions: "grey 0 to maximum is 0 to 180 degrees counter-clockwise from x".into(),
        length_unit: String::new(),
        axis_order: GridAxes::Image.meaning().into(),
        has_strength: alpha,
        has_spacing: false,
    };
    // Alpha 0 marks pixels without a direction on purpose, so they raise no warning.
    Ok(DirectionSamples::new(Carrier::Grid(grid), summary, warnings))
}

// Meshes.

/// Names that arrays of directions usually have, in lower case.
const USUAL: [&str; 8] =
    ["directions", "direction", "fibre", "fiber", "orientation", "orientations", "vectors", "director"];

fn mesh(file: &FeFile, options: &DirectionOptions) -> Result<DirectionSamples, DirectionError> {
    let vectors: Vec<&FeArray> = file.arrays.iter().filter(|a| [2, 3].contains(&a.components)).collect();
    let names = || vectors.iter().map(|a| a.name.clone()).collect();
    let find = |name: &str| vectors.iter().find(|a| a.name.eq_ignore_ascii_case(name)).copied();
    let array = match &options.array {
        Some(name) => find(name)
            .ok_or_else(|| missing(MissingDirections::NamedArray { name: name.clone(), names: names() }))?,
        None => match (USUAL.iter().find_map(|n| find(n)), &vectors[..]) {
            (Some(array), _) => array,
            (None, [only]) => only,
            (None, []) => {
                return Err(missing(MissingDirections::Vector));
            }
            (None, _) => return Err(missing(MissingDirections::OneVector(names()))),
        },
    };
    let unit = options.length_unit.unwrap_or(LengthUnit::Millimetre);
    // A solid's file may hold its surface too; elements of the highest dimension alone fill the part.
    let dimension = file.elements.iter().map(|e| e.kind.dimension()).max().unwrap_or(0);
    let elements: Vec<Element> =
        file.elements.iter().copied().filter(|e| e.kind.dimension() == dimension).collect();
    let axis = |i: usize| {
        let part = |k: usize| {
            if k < array.components { array.values.get(i * array.components + k).copied() } else { Some(0.0) }
        };
        let v = DVec3::new(part(0)?, part(1)?, part(2)?).normalize_or_zero();
        (v.is_finite() && v != DVec3::ZERO).then_some(v)
    };
    // Directions have no sign, so they are averaged as tensors: opposite vectors must not cancel.
    let mut sums = vec![([0.0; 6], 0.0); file.nodes.len()];
    let mut add = |node: usize, axis: DVec3| {
        let (sum, n) = &mut sums[node];
        sum.iter_mut().zip(tensor(axis, 1.0)).for_each(|(to, v)| *to += v);
        *n += 1.0;
    };
    let n = match array.on {
        On::Nodes => {
            (0..file.nodes.len()).filter_map(|i| Some((i, axis(i)?))).for_each(|(i, a)| add(i, a));
            file.nodes.len()
        }
        On::Elements => {
            // A node gets the mean of the elements around it, so that directions are continuous between them.
            for (e, element) in file.elements.iter().enumerate() {
                if let Some(axis) = axis(e) {
                    element.nodes().iter().for_each(|&i| add(i as usize, axis));
                }
            }
            file.elements.len()
        }
    };
    let samples = (0..n).filter(|&i| axis(i).is_some()).count();
    if samples == 0 {
        return Err(DirectionError::NoDirection(n));
    }
    let plane = file.nodes.iter().all(|p| p.z == file.nodes[0].z);
    let who = if options.length_unit.is_some() { "the job says so" } else { "stated nowhere" };
    let on = if array.on == On::Nodes { "nodes" } else { "elements" };
    let layout = if elements.is_empty() {
        format!("{} points", file.nodes.len())
    } else {
        format!(
            "a mesh of {} elements{}",
            elements.len(),
            if plane { " in a plane, for all heights" } else { "" }
        )
    };
    let carrier = if elements.is_empty() {
        let sample = |i: usize| {
            let axis = axis(i)?;
            Some(Sample { place_mm: unit.mm() * file.nodes[i], axis, strength: 1.0, spacing_mm: 1.0 })
        };
        let all: Vec<Sample> = (0..file.nodes.len()).filter_map(sample).collect();
        if all.is_empty() {
            return Err(DirectionError::Mesh(FeError::NoNodes));
        }
        of_points(all, false)
    } else {
        let node = |(p, (sum, n)): (&DVec3, &([f64; 6], f64))| Node {
            place_mm: unit.mm() * *p,
            tensor: sum.map(|v| if *n > 0.0 { v / n } else { 0.0 }),
            spacing_mm: 1.0,
        };
        let nodes = file.nodes.iter().zip(&sums).map(node).collect();
        Carrier::Cloud(Box::new(Cloud::new(nodes, elements, false, plane)))
    };
    let summary = DirectionSummary {
        format: file.format.name(),
        layout,
        samples,
        without_direction: n - samples,
        directions: format!("vectors {:?} on {on}", array.name),
        length_unit: format!("{} ({who})", unit.name()),
        axis_order: String::new(),
        has_strength: false,
        has_spacing: false,
    };
    Ok(DirectionSamples::new(carrier, summary, file.warnings.clone()).with_count_warning())
}
