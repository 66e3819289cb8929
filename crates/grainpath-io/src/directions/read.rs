//! Reads the samples of directions from the bytes of a file in any of the formats.

use grainpath_core::number::number;
use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec2, DVec3, Warning, WarningId};

use super::cloud::{Carrier, Cloud, Node, Sample, of_points, tensor};
use super::grid::{DirectionGrid, GridCell};
use super::model::{
    AngleUnit, DirectionError, DirectionOptions, DirectionProblem, DirectionSummary, GridAxes, MAX_CELLS,
    MAX_POINTS, MIN_IN_PLANE, MissingDirections, invalid, missing, within,
};
use super::npy::{Array, MAGIC, read_npy, read_npz};
use super::samples::DirectionSamples;
use super::table::{
    ANGLES, Column, SPACINGS, STRENGTHS, angle_reading, angle_unit_of, axis_of_angle, columns_read,
    coordinate, from_columns, is_known, length_unit_of, names_directions, split_unit, strength_scale,
};
use crate::fe::{Element, FeArray, FeError, FeFile, FeFormat, On, parse_fe, sniff_fe};
use crate::image::{Image, Samples, decode_within, sniff_image};
use crate::text::skip_space;

/// Whether a file holds directions: an array of numpy, a table whose header names a direction, or a CSV of numbers alone,
/// which is a matrix of angles. Pictures and finite-element files are not recognised, because they may hold other data.
pub fn sniff_directions(bytes: &[u8], name: &str) -> bool {
    let lower = name.to_ascii_lowercase();
    bytes.starts_with(MAGIC)
        || (bytes.starts_with(b"PK") && lower.ends_with(".npz"))
        || header(bytes).is_some_and(|(names, _)| names_directions(&names))
        || (lower.ends_with(".csv") && is_matrix(bytes))
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
        return from_arrays("npy", vec![(String::new(), read_npy(bytes, "")?)], options);
    }
    if bytes.starts_with(b"PK") {
        return from_arrays("npz", read_npz(bytes, "")?, options);
    }
    if sniff_image(bytes).is_some() {
        return picture(bytes);
    }
    if sniff_fe(bytes, Some(name)).is_some_and(|f| f != FeFormat::Csv) {
        return mesh(&parse_fe(bytes, Some(name))?, options);
    }
    if bytes.iter().take(4096).any(|b| *b == 0) {
        return Err(DirectionError::Unknown);
    }
    match header(bytes) {
        Some((names, separator)) => {
            let read = columns_read(&names, options);
            from_columns("CSV", &rows(bytes, &names, separator, &read)?, options)
        }
        None => matrices(files, options),
    }
}

// Tables.

/// Limit on the columns of a table. Source: the reader of stress tables, `fe::csv`.
const MAX_COLUMNS: usize = 256;

/// The names and the separator of the first line, unless it is made of numbers.
pub(super) fn header(bytes: &[u8]) -> Option<(Vec<String>, u8)> {
    first_line(bytes).filter(|(names, _)| !names.iter().all(|n| is_number(n)))
}

/// Whether the first line is made of numbers.
fn is_matrix(bytes: &[u8]) -> bool {
    first_line(bytes).is_some_and(|(names, _)| names.iter().all(|n| is_number(n)))
}

fn is_number(name: &str) -> bool {
    name.is_empty() || number(name.as_bytes()).is_some()
}

/// The cells of the first line and their separator.
fn first_line(bytes: &[u8]) -> Option<(Vec<String>, u8)> {
    let text = skip_space(bytes);
    let line = text[..text.len().min(1 << 16)].split(|b| matches!(b, b'\n' | b'\r')).next()?;
    let separator = separator_of(line)?;
    // Spreadsheets on Windows still write Latin 1, in which the signs for degrees and micro are one byte.
    let latin = |f: &[u8]| f.iter().map(|&b| char::from(b)).collect();
    let decoded = |f: &[u8]| std::str::from_utf8(f).map_or_else(|_| latin(f), str::to_owned);
    let name = |f: &[u8]| decoded(f.trim_ascii()).trim_matches(['"', '#', ' ']).to_owned();
    Some((cells(line.trim_ascii(), separator).take(MAX_COLUMNS).map(name).collect(), separator))
}

fn separator_of(line: &[u8]) -> Option<u8> {
    [b';', b'\t', b',', b' '].into_iter().find(|s| line.trim_ascii().contains(s))
}

/// The cells of a line; several spaces count as one.
fn cells(line: &[u8], separator: u8) -> impl Iterator<Item = &[u8]> {
    line.split(move |&b| b == separator).filter(move |f| separator != b' ' || !f.is_empty())
}

/// Words that stand for a missing number, in lower case. Source: what R, pandas, numpy and spreadsheets write.
const MISSING: [&[u8]; 8] = [b"", b"na", b"n/a", b"#n/a", b"null", b"none", b"-", b"--"];

/// A number, perhaps in quotes; NaN for an empty cell and a word for a missing number, `None` for any other word. Decimal
/// commas are read where another character separates columns.
fn cell(field: &[u8], separator: u8) -> Option<f64> {
    let text = unquoted(field);
    let point = || {
        let text: Vec<u8> = text.iter().map(|&b| if b == b',' { b'.' } else { b }).collect();
        number(&text)
    };
    number(text)
        .or_else(|| if separator == b',' { None } else { point() })
        .or_else(|| MISSING.contains(&&text.to_ascii_lowercase()[..]).then_some(f64::NAN))
}

/// A cell without the quotes and the space around it.
fn unquoted(field: &[u8]) -> &[u8] {
    let text = field.trim_ascii();
    text.strip_prefix(b"\"").and_then(|t| t.strip_suffix(b"\"")).unwrap_or(text).trim_ascii()
}

/// A word where a number should be, at most 40 characters of it.
fn not_a_number(place: String, field: &[u8]) -> DirectionError {
    let word = String::from_utf8_lossy(unquoted(field)).chars().take(40).collect();
    invalid(place, DirectionProblem::NotANumber(word))
}

/// The columns of a table. Those whose numbers in the list are `of_numbers` hold no words; words in the others are NaN.
pub(super) fn rows(
    bytes: &[u8],
    names: &[String],
    separator: u8,
    of_numbers: &[usize],
) -> Result<Vec<Column>, DirectionError> {
    let mut columns: Vec<Column> = names.iter().map(|n| (n.clone(), Vec::new())).collect();
    for (i, line) in skip_space(bytes).split(|&b| b == b'\n').enumerate().skip(1) {
        let line = line.trim_ascii();
        if line.is_empty() || line.starts_with(b"#") {
            continue;
        }
        let wrong = |found: usize| {
            let problem = DirectionProblem::Columns { found, wanted: names.len() };
            invalid(format!("line {}", i + 1), problem)
        };
        let mut fields = cells(line, separator);
        for (k, column) in columns.iter_mut().enumerate() {
            let field = fields.next().ok_or_else(|| wrong(k))?;
            let value = cell(field, separator);
            if value.is_none() && of_numbers.contains(&k) {
                return Err(not_a_number(format!("line {}", i + 1), field));
            }
            column.1.push(value.unwrap_or(f64::NAN));
        }
        // Some programs end every line with a separator. The names of a very wide header are not all read.
        let mut beyond = fields.filter(|f| !f.trim_ascii().is_empty()).peekable();
        if names.len() < MAX_COLUMNS && beyond.peek().is_some() {
            return Err(wrong(names.len() + beyond.count()));
        }
    }
    Ok(columns)
}

// Arrays of numpy.

/// Usual names of arrays of positions and of vectors, whose last index has two or three components.
const POSITIONS: [&str; 6] = ["points", "positions", "p", "xy", "xyz", "coordinates"];
const VECTORS: [&str; 4] = ["vector", "v", "d", "field"];
/// Names that arrays of directions usually have, in lower case.
const USUAL: [&str; 8] =
    ["directions", "direction", "fibre", "fiber", "orientation", "orientations", "vectors", "director"];

/// An array of an archive and its name.
type Named = (String, Array);

/// The name of an array in lower case, without its unit.
fn base(array: &Named) -> String {
    split_unit(&array.0).0
}

fn from_arrays(
    format: &'static str,
    arrays: Vec<Named>,
    options: &DirectionOptions,
) -> Result<DirectionSamples, DirectionError> {
    if arrays.is_empty() {
        return Err(missing(MissingDirections::Array));
    }
    // A structured array is a table.
    if let [(_, array)] = &arrays[..]
        && array.fields.len() > 1
    {
        return from_columns(format, &array.fields, options);
    }
    let names = || arrays.iter().map(|(n, _)| n.clone()).collect();
    if let Some(table) = with_positions(&arrays, options)? {
        let read = from_columns(format, &table.columns, options).map_err(|e| match e {
            // Arrays that became no columns are named too.
            DirectionError::Missing(m) if matches!(*m, MissingDirections::Direction(_)) => {
                missing(MissingDirections::KnownArray(names()))
            }
            e => e,
        });
        return Ok(read?.with_axes(table.axis_order, table.warning));
    }
    // A single array of a few columns and many rows is nearly always a table that lost its names. Read as a grid it would be
    // stretched over the part, and the beads would follow x and y as if these were angles.
    if let [array] = &arrays[..]
        && let [rows, columns] = array.1.shape[..]
        && options.axes.is_none()
        && options.cell_mm.is_none()
        && !ANGLES.contains(&base(array).as_str())
        && (is_table(rows, columns) || is_table(columns, rows))
    {
        return Err(invalid("", DirectionProblem::Nameless { shape: vec![rows, columns] }));
    }
    // What remains is a grid without places of its own, which is laid over the part.
    let find = |names: &[&str]| arrays.iter().find(|a| names.contains(&base(a).as_str()));
    let of_grid = |names: &[&str]| find(names).filter(|(_, a)| a.shape.len() == 2);
    let wanted = match &options.array {
        Some(array) => arrays.iter().find(|(name, _)| name.eq_ignore_ascii_case(array)),
        None => of_grid(&ANGLES)
            .or_else(|| arrays.iter().find(|(_, a)| a.shape.len() == 3))
            .or_else(|| if arrays.len() == 1 { arrays.first() } else { None }),
    };
    let strength = find(&STRENGTHS).or_else(|| of_grid(&["mask", "shape"]));
    let numbers =
        |x, y| GridNumbers { format, axes: None, unit: None, x, y, strength, spacing: find(&SPACINGS) };
    if let (None, None, Some(x), Some(y)) = (
        wanted,
        &options.array,
        of_grid(&["vx", "ux", "dx", "nx", "u"]),
        of_grid(&["vy", "uy", "dy", "ny", "v"]),
    ) {
        return grid(&format!("vectors {}, {}", x.0, y.0), &numbers(&x.1, Some(y)), options);
    }
    let Some((name, array)) = wanted else {
        return Err(missing(match &options.array {
            Some(name) => MissingDirections::NamedArray { name: name.clone(), names: names() },
            None if arrays.iter().filter(|(_, a)| a.shape.len() == 1).count() > 2 => {
                MissingDirections::Position(names())
            }
            None => MissingDirections::KnownArray(names()),
        }));
    };
    let name = if name.is_empty() { "angles" } else { name };
    grid(name, &numbers(array, None), options)
}

/// Arrays with positions of their own, as a table.
struct Table {
    columns: Vec<Column>,
    /// Order of the indices of a grid with an axis for each; empty for others.
    axis_order: String,
    /// The order was assumed.
    warning: Option<Warning>,
}

/// The columns of arrays that hold positions; `None` where there are none.
///
/// Positions are an array with usual names whose last index is x, y and perhaps z; arrays x, y and perhaps z of one shape;
/// or the places x and y along the two indices of a grid.
fn with_positions(arrays: &[Named], options: &DirectionOptions) -> Result<Option<Table>, DirectionError> {
    let at = |axis| arrays.iter().find(|(name, _)| coordinate(&[name.as_str()], axis).is_some());
    let is_points = |a: &&Named| !inner(&a.1).is_empty() && POSITIONS.contains(&base(a).as_str());
    let (points, x, y) = (arrays.iter().find(is_points), at(0), at(1));
    let plain = |shape: &[usize]| columns_of(arrays.iter(), points, shape, options);
    let table = |columns| Table { columns, axis_order: String::new(), warning: None };
    let (x, y) = match (points, x, y) {
        (Some(points), ..) => return Ok(Some(table(plain(inner(&points.1))?))),
        (None, Some(x), Some(y)) => (x, y),
        (None, None, None) => return Ok(None),
        (None, ..) => {
            let names = arrays.iter().map(|a| a.0.clone()).collect();
            return Err(missing(MissingDirections::Position(names)));
        }
    };
    // Names may repeat in an archive, so arrays are told apart by where they are and not by name.
    let is_other = |a: &&Named| !std::ptr::eq(x, *a) && !std::ptr::eq(y, *a);
    let grids = || arrays.iter().filter(is_other).filter(|a| a.1.shape.len() > 1);
    let found = grids().find(|a| is_known(&a.0)).or_else(|| grids().next());
    let flat = x.1.shape.len() == 1 && y.1.shape.len() == 1;
    let Some(wanted) = found.filter(|_| flat) else { return Ok(Some(table(plain(&x.1.shape)?))) };
    // Flat arrays are points, unless the directions have an index for each of x and y.
    if x.1.shape == y.1.shape
        && let Ok(columns) = plain(&x.1.shape)
        && (names_directions(&columns.iter().map(|c| c.0.clone()).collect::<Vec<_>>())
            || columns.iter().any(|c| options.array.as_ref().is_some_and(|a| a.eq_ignore_ascii_case(&c.0))))
    {
        return Ok(Some(table(columns)));
    }
    // The lengths of both axes tell which index of the grid runs along which; a square grid fits both ways.
    let (shape, places) = (&wanted.1.shape, [x.1.shape[0], y.1.shape[0]]);
    let (rows, columns) = (shape[0], shape[1]);
    let fits = [[columns, rows] == places, [rows, columns] == places];
    let rest = shape.len() == 2 || (shape.len() == 3 && [2, 3].contains(&shape[2]));
    let stated = options.axes.map(|axes| if axes == GridAxes::Xy { GridAxes::Xy } else { GridAxes::Yx });
    let axes = match (stated, fits) {
        (Some(GridAxes::Xy), [_, true]) | (None, [false, true]) => GridAxes::Xy,
        (Some(GridAxes::Yx), [true, _]) | (None, [true, _]) => GridAxes::Yx,
        _ => {
            let (name, shape) = (wanted.0.clone(), shape.clone());
            return Err(invalid(
                "",
                DirectionProblem::Axes { name, shape, places, stated: stated.is_some() },
            ));
        }
    };
    if !rest {
        let (name, shape) = (wanted.0.clone(), shape.clone());
        return Err(invalid("", DirectionProblem::Shape { name, shape }));
    }
    if rows.saturating_mul(columns) > MAX_POINTS {
        let found = (rows * columns) as u64;
        return Err(DirectionError::TooMany { what: "points", found, limit: MAX_POINTS });
    }
    // Each cell gets its own place, so that a grid with uneven axes is read like scattered points.
    let along = |a: &Named, by_row: bool| -> Named {
        let place = |i: usize| a.1.fields[0].1[if by_row { i / columns } else { i % columns }];
        let values = (0..rows * columns).map(place).collect();
        (a.0.clone(), Array { shape: vec![rows, columns], fields: vec![(String::new(), values)] })
    };
    let positions = [along(x, axes == GridAxes::Xy), along(y, axes == GridAxes::Yx)];
    let all = positions.iter().chain(arrays.iter().filter(is_other));
    let assumed = stated.is_none() && fits == [true, true] && rows > 1;
    let text = || format!("the order of the indices of {} was assumed: {}", wanted.0, axes.meaning());
    let warning =
        assumed.then(|| Warning::new(WarningId::FieldAssumed, text()).with_remedy("set guide.field.axes"));
    let axis_order = format!("{}{}", axes.meaning(), if assumed { " (assumed)" } else { "" });
    Ok(Some(Table { columns: columns_of(all, None, &[rows, columns], options)?, axis_order, warning }))
}

/// The shape of an array without its last index, where that has two or three components; else nothing.
fn inner(array: &Array) -> &[usize] {
    match &array.shape[..] {
        [inner @ .., 2 | 3] => inner,
        _ => &[],
    }
}

/// The columns of all arrays of one shape, and of those with components in a further index.
fn columns_of<'a>(
    arrays: impl Iterator<Item = &'a Named>,
    points: Option<&Named>,
    shape: &[usize],
    options: &DirectionOptions,
) -> Result<Vec<Column>, DirectionError> {
    let mut columns: Vec<Column> = Vec::new();
    for named in arrays {
        let (name, array) = named;
        let (values, lower) = (&array.fields[0].1, base(named));
        let is_points = points.is_some_and(|p| std::ptr::eq(p, named));
        let is_vector = USUAL.contains(&lower.as_str())
            || VECTORS.contains(&lower.as_str())
            || options.array.as_ref().is_some_and(|a| a.eq_ignore_ascii_case(name));
        if array.shape == shape {
            columns.push((name.clone(), values.clone()));
        } else if inner(array) == shape && (is_points || is_vector) {
            let n = array.shape[shape.len()];
            let unit = &split_unit(name).1;
            for (k, letter) in ["x", "y", "z"].into_iter().enumerate().take(n) {
                let name = match is_points {
                    true if unit.is_empty() => letter.to_owned(),
                    true => format!("{letter} [{unit}]"),
                    false => format!("{lower}_{letter}"),
                };
                columns.push((name, values.iter().skip(k).step_by(n).copied().collect()));
            }
        } else if is_points || is_vector || (is_known(name) && !(lower == "z" && values.len() == 1)) {
            let (name, found) = (name.clone(), array.shape.clone());
            return Err(invalid("", DirectionProblem::ShapesDiffer { name, found, wanted: shape.to_vec() }));
        }
    }
    Ok(columns)
}

/// The arrays of a grid: angles, vectors in the last index, or two arrays of components.
struct GridNumbers<'a> {
    /// Name of the format.
    format: &'static str,
    /// Order of the indices and unit of the angles that the format fixes. They apply where the job states none.
    axes: Option<GridAxes>,
    unit: Option<AngleUnit>,
    x: &'a Array,
    y: Option<&'a Named>,
    strength: Option<&'a Named>,
    spacing: Option<&'a Named>,
}

fn grid(
    name: &str,
    numbers: &GridNumbers<'_>,
    options: &DirectionOptions,
) -> Result<DirectionSamples, DirectionError> {
    let shape = &numbers.x.shape;
    let (n0, n1, parts) = match shape[..] {
        [a, b] => (a, b, 1),
        [a, b, c @ (2 | 3)] => (a, b, c),
        _ => {
            let problem = DirectionProblem::Shape { name: name.to_owned(), shape: shape.clone() };
            return Err(invalid("", problem));
        }
    };
    if n0 == 0 || n1 == 0 {
        return Err(missing(MissingDirections::Cells { name: name.to_owned(), shape: shape.clone() }));
    }
    if n0.saturating_mul(n1) > MAX_CELLS {
        return Err(DirectionError::TooMany { what: "cells", found: (n0 * n1) as u64, limit: MAX_CELLS });
    }
    for other in [numbers.y, numbers.strength, numbers.spacing].into_iter().flatten() {
        if other.1.shape[..] != [n0, n1] {
            let (name, found) = (other.0.clone(), other.1.shape.clone());
            return Err(invalid("", DirectionProblem::ShapesDiffer { name, found, wanted: vec![n0, n1] }));
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
    let reading = if vectors {
        None
    } else {
        let unit = if options.angle_unit.is_some() { None } else { angle_unit_of(name)? };
        Some(angle_reading(name, unit.or(numbers.unit), options, values))
    };
    let (columns, rows) = if axes == GridAxes::Xy { (n0, n1) } else { (n1, n0) };
    let index = |column: usize, row: usize| match axes {
        GridAxes::Yx => row * n1 + column,
        GridAxes::Xy => column * n1 + row,
        GridAxes::Image => (n0 - 1 - row) * n1 + column,
    };
    let scale = match numbers.strength {
        Some(s) => strength_scale(&s.1.fields[0].1)?,
        None => 1.0,
    };
    let cell = |column: usize, row: usize| -> GridCell {
        let i = index(column, row);
        let axis = match (&reading, numbers.y) {
            (Some(reading), _) => axis_of_angle(values[i], reading.unit),
            (None, Some(y)) => DVec3::new(values[i], y.1.fields[0].1[i], 0.0).normalize_or_zero(),
            (None, None) => {
                let part = |k: usize| if k < parts { values[i * parts + k] } else { 0.0 };
                DVec3::new(part(0), part(1), part(2)).normalize_or_zero()
            }
        };
        let strength = numbers.strength.map_or(1.0, |s| scale * s.1.fields[0].1[i]);
        // A vector that points out of the plane counts by the square of its part in the plane.
        let in_plane = axis.truncate().length_squared();
        let strength = strength * in_plane;
        (strength.is_finite() && strength > 0.0 && in_plane > MIN_IN_PLANE)
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
        let unit = length_unit_of(&spacing.0)?.or(options.length_unit).unwrap_or(LengthUnit::Millimetre).mm();
        let spacing_mm = |(c, r): (usize, usize)| (unit * spacing.1.fields[0].1[index(c, r)]) as f32;
        let all: Vec<f32> =
            (0..rows).flat_map(|r| (0..columns).map(move |c| (c, r))).map(spacing_mm).collect();
        if let Some(i) = all.iter().position(|s| !(s.is_finite() && *s > 0.0)) {
            return Err(invalid("", DirectionProblem::CellSpacing(i + 1)));
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
    let file = |name: &'_ str| name.rsplit(['/', '\\']).next().unwrap_or(name).to_owned();
    let is = |name: &str, wanted: &str| file(name).to_ascii_lowercase().replace('_', "") == wanted;
    let read = |wanted: &str| -> Result<Option<Named>, DirectionError> {
        let found = files.iter().find(|(name, _)| is(name, wanted));
        let read = |(name, bytes): &(&str, &[u8])| Ok((file(name), matrix(bytes, &file(name))?));
        found.map(read).transpose()
    };
    let (theta, shape) = match files {
        [(name, bytes)] => {
            let theta = matrix(bytes, "")?;
            let [rows, columns] = [theta.shape[0], theta.shape[1]];
            let stated = options.axes.is_some() || options.cell_mm.is_some() || is(name, "thetafield.csv");
            if !stated && is_table(rows, columns) {
                return Err(invalid("", DirectionProblem::Nameless { shape: theta.shape }));
            }
            (Some((file(name), theta)), None)
        }
        _ => (read("thetafield.csv")?, read("shape.csv")?),
    };
    let (x, y) = if theta.is_some() { (None, None) } else { (read("xfield.csv")?, read("yfield.csv")?) };
    let (name, x, y) = match (&theta, &x, &y) {
        (Some(theta), _, _) => ("theta", &theta.1, None),
        (None, Some(x), Some(y)) => ("vectors xField, yField", &x.1, Some(y)),
        _ => return Err(missing(MissingDirections::Matrices)),
    };
    let (axes, unit) = (Some(GridAxes::Xy), Some(AngleUnit::Radian));
    let strength = shape.as_ref();
    let numbers = GridNumbers { format: "vector_slicer", axes, unit, x, y, strength, spacing: None };
    grid(name, &numbers, options)
}

/// A table of points has at most this many columns: x, y, z, and an angle or a vector. Source: derived.
pub(super) const TABLE_COLUMNS: usize = 6;
/// Numbers without names are a table where they have so many times more rows than columns. Source: derived: a grid of at
/// most six cells across and twice as many along is rarer than a table of nine points or more, and a grid that is refused
/// costs a line in the job, where a table that is taken for a grid costs the part.
const TABLE_ROWS: usize = 2;

/// Whether numbers without names are more likely a table of points than a grid.
fn is_table(rows: usize, columns: usize) -> bool {
    (2..=TABLE_COLUMNS).contains(&columns) && rows > TABLE_ROWS * columns
}

/// A CSV of numbers alone; `place` is the name of the file where there are several.
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
            // A number that is missing from a matrix has no place of its own, unless it is written as such.
            let is_empty = unquoted(field).is_empty();
            let value = cell(field, separator).filter(|_| !is_empty);
            values.push(value.ok_or_else(|| not_a_number(within(place, format!("line {}", i + 1)), field))?);
        }
        let n = values.len() - before;
        if rows == 0 {
            columns = n;
        } else if n != columns {
            let problem = DirectionProblem::Numbers { found: n, wanted: columns };
            return Err(invalid(within(place, format!("line {}", i + 1)), problem));
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
    Ok(Array { shape: vec![rows, columns], fields: vec![(String::new(), values)] })
}

// Pictures.

/// A pixel is coloured, and not grey, where its channels differ by more than this share of white.
/// Source: derived. Rounding in a conversion costs up to half a step of eight bits; a tenth of a step more is room for the
/// arithmetic in single precision.
const GREY_TOLERANCE: f32 = 0.6 / 255.0;

/// The grey of every pixel, from 0 to 1, row by row from the top, and its alpha; `meaning` says what a grey picture is.
///
/// # Errors
/// For a coloured picture, and for floating-point grey below 0 or above 1.
pub(super) fn grey(image: &Image, meaning: &'static str) -> Result<Vec<(f32, f32)>, DirectionError> {
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
        return Err(invalid("", DirectionProblem::Colours(meaning)));
    }
    // Numbers that are no shares of a maximum would be turned round the circle in silence.
    if let Some(k) = (0..pixels).find(|&k| value(n * k) < 0.0 || value(n * k) > 1.0) {
        let (row, column) = (k / image.width + 1, k % image.width + 1);
        let grey = value(n * k);
        return Err(invalid("", DirectionProblem::Grey { grey, row, column }));
    }
    Ok((0..pixels).map(|k| (value(n * k), if alpha { value(n * k + n - 1) } else { 1.0 })).collect())
}

fn picture(bytes: &[u8]) -> Result<DirectionSamples, DirectionError> {
    let image = decode_within(bytes, MAX_CELLS as u64)?;
    let pixels = grey(&image, "an angle picture is grey, from 0 to the maximum for 0 to 180 degrees")?;
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
    let strength = scalar(file, array, &STRENGTHS)?;
    let spacing = scalar(file, array, &SPACINGS[..1])?;
    let has_strength = strength.is_some();
    let scale = strength.map_or(Ok(1.0), |s| strength_scale(&s.values))?;
    let strength = |i: usize| match strength {
        Some(s) => scale * s.values.get(i).copied().unwrap_or(f64::NAN),
        None => 1.0,
    };
    // A solid's file may hold its surface too; elements of the highest dimension alone fill the part.
    let dimension = file.elements.iter().map(|e| e.kind.dimension()).max().unwrap_or(0);
    let elements: Vec<Element> =
        file.elements.iter().copied().filter(|e| e.kind.dimension() == dimension).collect();
    let axis = |i: usize| {
        let part = |k: usize| {
            if k < array.components { array.values.get(i * array.components + k).copied() } else { Some(0.0) }
        };
        let v = DVec3::new(part(0)?, part(1)?, part(2)?).normalize_or_zero();
        (v.is_finite() && v != DVec3::ZERO && strength(i) > 0.0).then_some(v)
    };
    // Directions have no sign, so they are averaged as tensors: opposite vectors must not cancel.
    let mut sums = vec![([0.0; 6], 0.0); file.nodes.len()];
    let mut add = |node: usize, axis: DVec3, strength: f64| {
        let (sum, n) = &mut sums[node];
        sum.iter_mut().zip(tensor(axis, strength)).for_each(|(to, v)| *to += v);
        *n += 1.0;
    };
    let n = match array.on {
        On::Nodes => {
            (0..file.nodes.len())
                .filter_map(|i| Some((i, axis(i)?)))
                .for_each(|(i, a)| add(i, a, strength(i)));
            file.nodes.len()
        }
        On::Elements => {
            // A node gets the mean of the elements around it, so that directions are continuous between them.
            for (e, element) in file.elements.iter().enumerate() {
                if let Some(axis) = axis(e) {
                    element.nodes().iter().for_each(|&i| add(i as usize, axis, strength(e)));
                }
            }
            file.elements.len()
        }
    };
    let samples = (0..n).filter(|&i| axis(i).is_some()).count();
    if samples == 0 {
        return Err(DirectionError::NoDirection(n));
    }
    let spacing_mm = match spacing {
        Some(spacing) => Some(node_spacings(file, spacing, unit)?),
        None => None,
    };
    let spacing_of = |node: usize| spacing_mm.as_ref().map_or(1.0, |all| all[node]);
    let plane = file.nodes.iter().all(|p| p.z == file.nodes[0].z);
    let who = if options.length_unit.is_some() { "the job says so" } else { "stated nowhere" };
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
            let place_mm = unit.mm() * file.nodes[i];
            Some(Sample { place_mm, axis, strength: strength(i), spacing_mm: spacing_of(i) })
        };
        let all: Vec<Sample> = (0..file.nodes.len()).filter_map(sample).collect();
        if all.is_empty() {
            return Err(DirectionError::Mesh(FeError::NoNodes));
        }
        of_points(all, spacing_mm.is_some())
    } else {
        let node = |(i, (p, (sum, n))): (usize, (&DVec3, &([f64; 6], f64)))| Node {
            place_mm: unit.mm() * *p,
            tensor: sum.map(|v| if *n > 0.0 { v / n } else { 0.0 }),
            spacing_mm: spacing_of(i),
        };
        let nodes = file.nodes.iter().zip(&sums).enumerate().map(node).collect();
        Carrier::Cloud(Box::new(Cloud::new(nodes, elements, spacing_mm.is_some(), plane)))
    };
    let summary = DirectionSummary {
        format: file.format.name(),
        layout,
        samples,
        without_direction: n - samples,
        directions: format!("vectors {:?} on {}", array.name, words(array.on)),
        length_unit: format!("{} ({who})", unit.name()),
        axis_order: String::new(),
        has_strength,
        has_spacing: spacing_mm.is_some(),
    };
    Ok(DirectionSamples::new(carrier, summary, file.warnings.clone()).with_count_warning())
}

/// The scalar array with one of these names, which lies where the directions lie.
fn scalar<'a>(
    file: &'a FeFile,
    directions: &FeArray,
    names: &[&str],
) -> Result<Option<&'a FeArray>, DirectionError> {
    let is = |a: &&FeArray| a.components == 1 && names.contains(&split_unit(&a.name).0.as_str());
    let Some(found) = file.arrays.iter().find(is) else { return Ok(None) };
    if found.on == directions.on {
        return Ok(Some(found));
    }
    let (on, wanted) = (words(found.on), words(directions.on));
    Err(invalid("", DirectionProblem::OtherPlace { name: found.name.clone(), on, wanted }))
}

fn words(on: On) -> &'static str {
    if on == On::Nodes { "nodes" } else { "elements" }
}

/// The distance of beads at each node, mm; that of elements is averaged.
fn node_spacings(file: &FeFile, spacing: &FeArray, unit: LengthUnit) -> Result<Vec<f64>, DirectionError> {
    let mm = length_unit_of(&spacing.name)?.unwrap_or(unit).mm();
    if let Some(i) = spacing.values.iter().position(|s| !(s.is_finite() && *s > 0.0)) {
        return Err(invalid("", DirectionProblem::SampleSpacing(i + 1)));
    }
    let value = |i: usize| spacing.values.get(i).map_or(1.0, |s| mm * s);
    let n = file.nodes.len();
    if spacing.on == On::Nodes {
        return Ok((0..n).map(value).collect());
    }
    let mut sums = vec![(0.0, 0.0); n];
    for (e, element) in file.elements.iter().enumerate() {
        for &i in element.nodes() {
            sums[i as usize].0 += value(e);
            sums[i as usize].1 += 1.0;
        }
    }
    Ok(sums.into_iter().map(|(sum, n)| if n > 0.0 { sum / n } else { 1.0 }).collect())
}
