//! CSV: one point with its stress in each line. The header names the columns.
//!
//! Columns are separated by commas, semicolons or tabs, and numbers may have decimal commas where the separator is another
//! character. Coordinates may be named as ParaView writes them (`Points:0`). Limits: 256
//! columns. A table has no elements; the stress between its points is an average of the nearest eight.

use super::model::{FeArray, FeError, FeFile, FeFormat, MAX_COUNT, On, invalid, position};
use super::problem::FeProblem;
use grainpath_core::number::number;

/// Header columns that are read; a wider file is not a table of stresses. The bound keeps a line without
/// line breaks from becoming millions of names. Source: chosen; files of real programs stay far below it.
const MAX_COLUMNS: usize = 256;

/// Whether the first line is a header with coordinates and a stress.
pub(crate) fn looks_like(head: &[u8]) -> bool {
    let line = head.split(|b| matches!(b, b'\n' | b'\r')).next().unwrap_or_default();
    let Some(separator) = separator(line) else { return false };
    let names: Vec<String> = names(line, separator);
    axis(&names, 0).is_some() && axis(&names, 1).is_some() && names.len() >= 4
}

// The comma comes last, because it is the decimal sign in files that separate columns by semicolons or
// tabs.
fn separator(line: &[u8]) -> Option<u8> {
    [b';', b'\t', b','].into_iter().find(|s| line.contains(s))
}

fn names(line: &[u8], separator: u8) -> Vec<String> {
    let name = |f: &[u8]| String::from_utf8_lossy(f.trim_ascii()).trim_matches(['"', '#', ' ']).to_owned();
    line.split(|&b| b == separator).take(MAX_COLUMNS).map(name).collect()
}

/// The column of a coordinate: `x`, `X [mm]`, `coord_x`, `Points:0` as ParaView writes.
fn axis(names: &[String], which: usize) -> Option<usize> {
    let letter = ["x", "y", "z"][which];
    let is = |name: &String| {
        let lower = name.to_ascii_lowercase();
        let bare = lower.split(['[', '(']).next().unwrap_or_default().trim().to_owned();
        let unit = bare.strip_suffix("_mm").or_else(|| bare.strip_suffix("_m")).unwrap_or(&bare);
        unit == letter
            || [format!("coord_{letter}"), format!("coord{letter}"), format!("node_{letter}")]
                .contains(&unit.to_owned())
            || lower == format!("points:{which}")
            || lower == format!("points_{which}")
    };
    names.iter().position(is)
}

pub(crate) fn read(bytes: &[u8]) -> Result<FeFile, FeError> {
    let bytes = crate::text::skip_space(bytes);
    let mut lines = bytes.split(|&b| b == b'\n').enumerate();
    let (_, header) = lines.next().unwrap_or_default();
    let separator = separator(header).ok_or_else(|| invalid("line 1", FeProblem::NoHeader))?;
    let names = names(header.trim_ascii(), separator);
    let (Some(x), Some(y)) = (axis(&names, 0), axis(&names, 1)) else {
        return Err(invalid("line 1", FeProblem::NoXAndY));
    };
    // A table without z is plane; its points get z = 0.
    let z = axis(&names, 2);
    let columns: Vec<usize> = (0..names.len()).filter(|&i| i != x && i != y && Some(i) != z).collect();
    let mut file = FeFile::empty(FeFormat::Csv);
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); columns.len()];
    let mut row: Vec<f64> = Vec::new();
    for (i, line) in lines {
        let place = || format!("line {}", i + 1);
        let line = line.trim_ascii();
        if line.is_empty() || line.starts_with(b"#") {
            continue;
        }
        row.clear();
        // Fields beyond the header have no name and cannot be assigned; they are skipped.
        for (k, field) in line.split(|&b| b == separator).enumerate().take(names.len()) {
            let text = field.trim_ascii();
            let comma = || {
                // A decimal comma, as spreadsheets of many European locales write it. The separator is
                // another character then.
                let point: Vec<u8> = text.iter().map(|&b| if b == b',' { b'.' } else { b }).collect();
                number(&point)
            };
            // An empty cell means that there is no value; NaN keeps that apart from zero stress.
            let v = if text.is_empty() { Some(f64::NAN) } else { number(text).or_else(comma) };
            let needed = k == x || k == y || Some(k) == z;
            // Columns of words (names, dates) become NaN; a coordinate must be a number.
            let v = v.or((!needed).then_some(f64::NAN)).ok_or_else(|| {
                let shown = String::from_utf8_lossy(&text[..text.len().min(40)]).into_owned();
                invalid(place(), FeProblem::NotANumberInColumn { found: shown, column: k + 1 })
            })?;
            row.push(v);
        }
        if row.len() < names.len() {
            let problem = FeProblem::Columns { found: row.len(), wanted: names.len() };
            return Err(invalid(place(), problem));
        }
        file.nodes.push(position([row[x], row[y], z.map_or(0.0, |z| row[z])], place)?);
        if file.nodes.len() as u64 > MAX_COUNT {
            return Err(FeError::TooMany { what: "points", limit: MAX_COUNT });
        }
        for (to, &k) in values.iter_mut().zip(&columns) {
            to.push(row[k]);
        }
    }
    for (values, k) in values.into_iter().zip(columns) {
        // Columns without a single number would only lengthen the list of arrays shown to the user.
        if values.iter().any(|v| !v.is_nan()) {
            file.arrays.push(FeArray {
                name: names[k].clone(),
                on: On::Nodes,
                components: 1,
                component_names: Vec::new(),
                values,
                step: None,
            });
        }
    }
    Ok(file)
}
