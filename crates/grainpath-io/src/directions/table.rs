//! Tables with named columns: finds the columns of positions, directions, spacing and strength.

use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec3, Warning, WarningId};

use super::cloud::{Sample, of_points};
use super::model::{
    AngleUnit, DirectionError, DirectionOptions, DirectionProblem, DirectionSummary, MAX_POINTS,
    MissingDirections, invalid, missing,
};
use super::samples::DirectionSamples;
use crate::position::checked;

/// A column: its name as the file has it, and a number for each row.
pub(super) type Column = (String, Vec<f64>);

/// A name without its unit, in lower case, and the unit.
pub(super) fn split_unit(name: &str) -> (String, String) {
    let lower = name.trim().to_ascii_lowercase();
    if let Some((base, rest)) = lower.split_once(['[', '(']) {
        return (
            base.trim().trim_end_matches('_').to_owned(),
            rest.trim_end_matches([']', ')', ' ']).to_owned(),
        );
    }
    match lower.rsplit_once('_') {
        Some((base, unit)) if length_unit(unit).is_some() || angle_unit(unit).is_some() => {
            (base.to_owned(), unit.to_owned())
        }
        _ => (lower, String::new()),
    }
}

fn length_unit(word: &str) -> Option<LengthUnit> {
    // Both signs for micro that Unicode has.
    if ["\u{b5}m", "\u{3bc}m"].contains(&word) {
        Some(LengthUnit::Micron)
    } else {
        LengthUnit::from_name(word)
    }
}

fn angle_unit(word: &str) -> Option<AngleUnit> {
    match word {
        // The sign for degrees, and the ordinal indicator that looks like it.
        "deg" | "degree" | "degrees" | "\u{b0}" | "\u{ba}" => Some(AngleUnit::Degree),
        "rad" | "radian" | "radians" => Some(AngleUnit::Radian),
        "mrad" | "milliradian" | "milliradians" => Some(AngleUnit::Milliradian),
        "turn" | "turns" => Some(AngleUnit::Turn),
        _ => None,
    }
}

/// The unit that a name states; an error for one that is not known.
fn stated<U>(
    name: &str,
    unit: fn(&str) -> Option<U>,
    known: &'static str,
) -> Result<Option<U>, DirectionError> {
    let word = split_unit(name).1;
    let wrong = || DirectionProblem::Unit { name: name.to_owned(), unit: word.clone(), known };
    if word.is_empty() { Ok(None) } else { unit(&word).map(Some).ok_or_else(|| invalid("", wrong())) }
}

/// The unit of lengths that a name states.
pub(super) fn length_unit_of(name: &str) -> Result<Option<LengthUnit>, DirectionError> {
    stated(name, length_unit, "mm, cm, m, um, in and ft")
}

/// The unit of angles that a name states.
pub(super) fn angle_unit_of(name: &str) -> Result<Option<AngleUnit>, DirectionError> {
    stated(name, angle_unit, "deg, rad, mrad and turns")
}

/// The unit of positions that the names of their columns state, that of x first. It is the same for all.
pub(super) fn unit_of_positions<'a>(
    names: impl IntoIterator<Item = &'a str>,
) -> Result<Option<LengthUnit>, DirectionError> {
    let mut names = names.into_iter();
    let Some(first) = names.next() else { return Ok(None) };
    let unit = length_unit_of(first)?;
    for other in names {
        if length_unit_of(other)?.is_some_and(|u| u != unit.unwrap_or(LengthUnit::Millimetre)) {
            let (first, other) = (first.to_owned(), other.to_owned());
            return Err(invalid("", DirectionProblem::UnitsDiffer { first, other }));
        }
    }
    Ok(unit)
}

/// Names of a single column that is an angle.
pub(super) const ANGLES: [&str; 6] = ["angle", "theta", "phi", "orientation", "direction", "axis"];
pub(super) const SPACINGS: [&str; 2] = ["spacing", "distance"];
pub(super) const STRENGTHS: [&str; 4] = ["strength", "weight", "confidence", "coherence"];
/// Names of vector components that share no stem, unlike `Fibre_x`, `Fibre_y`.
const VECTORS: [[&str; 3]; 6] = [
    ["vx", "vy", "vz"],
    ["dx", "dy", "dz"],
    ["ux", "uy", "uz"],
    ["nx", "ny", "nz"],
    ["tx", "ty", "tz"],
    ["u", "v", "w"],
];

/// Whether a name is that of a coordinate: `x`, `X [mm]`, `coord_x`, or `Points:0` as ParaView
/// writes.
fn is_coordinate(base: &str, axis: usize) -> bool {
    let letter = ["x", "y", "z"][axis];
    base == letter
        || ["coord_", "coord", "node_", "pos_", "position_"]
            .iter()
            .any(|stem| base == format!("{stem}{letter}"))
        || [":", "_"].iter().any(|mark| base == format!("points{mark}{axis}"))
}

/// The column of a coordinate, 0 to 2, among these names.
pub(super) fn coordinate(names: &[&str], axis: usize) -> Option<usize> {
    names.iter().position(|n| is_coordinate(&split_unit(n).0, axis))
}

/// The stem and the component of a name such as `Fibre_x` or `Directions:1`, in lower case.
fn component(base: &str) -> Option<(&str, usize)> {
    let (stem, last) = base.rsplit_once(['_', ':', '.'])?;
    let axis = match last {
        "x" | "0" => 0,
        "y" | "1" => 1,
        "z" | "2" => 2,
        _ => return None,
    };
    (!stem.is_empty() && !(0..3).any(|k| is_coordinate(base, k))).then_some((stem, axis))
}

/// The columns of a vector.
struct VectorColumns {
    name: String,
    columns: [Option<usize>; 3],
}

fn vectors(bases: &[String]) -> Vec<VectorColumns> {
    let find = |name: &str| bases.iter().position(|b| b == name);
    let mut out = Vec::new();
    for names in VECTORS {
        if let (Some(x), Some(y)) = (find(names[0]), find(names[1])) {
            out.push(VectorColumns {
                name: names[..2].join(", "),
                columns: [Some(x), Some(y), find(names[2])],
            });
        }
    }
    for (i, base) in bases.iter().enumerate() {
        if let Some((stem, 0)) = component(base) {
            let column_of = |axis| bases.iter().position(|b| component(b) == Some((stem, axis)));
            if let Some(y) = column_of(1) {
                out.push(VectorColumns { name: stem.to_owned(), columns: [Some(i), Some(y), column_of(2)] });
            }
        }
    }
    out
}

/// Whether a header names coordinates and a direction.
pub(super) fn names_directions(names: &[String]) -> bool {
    let bases: Vec<String> = names.iter().map(|n| split_unit(n).0).collect();
    let has = |axis| bases.iter().any(|b| is_coordinate(b, axis));
    has(0) && has(1) && (bases.iter().any(|b| ANGLES.contains(&b.as_str())) || !vectors(&bases).is_empty())
}

/// Whether an array's name is that of a coordinate, an angle, a part of a vector, a strength or a spacing.
pub(super) fn is_known(name: &str) -> bool {
    let base = split_unit(name).0;
    let known = [&ANGLES[..], &SPACINGS, &STRENGTHS].into_iter().flatten().chain(VECTORS.iter().flatten());
    (0..3).any(|axis| is_coordinate(&base, axis)) || known.into_iter().any(|k| *k == base)
}

/// The columns that are read for directions: those with known names, parts of vectors, and that which the job names.
pub(super) fn columns_read(names: &[String], options: &DirectionOptions) -> Vec<usize> {
    let bases: Vec<String> = names.iter().map(|n| split_unit(n).0).collect();
    let parts: Vec<usize> = vectors(&bases).iter().flat_map(|v| v.columns).flatten().collect();
    let named = |i: usize| options.array.as_ref().is_some_and(|array| array.eq_ignore_ascii_case(&names[i]));
    (0..names.len()).filter(|&i| is_known(&names[i]) || parts.contains(&i) || named(i)).collect()
}

/// The unit in which angles are read, a text on it for reports, and a warning where it was assumed.
pub(super) struct AngleReading {
    pub unit: AngleUnit,
    pub text: String,
    pub warning: Option<Warning>,
}

/// The unit of angles: stated by the file or by the job, else assumed from their size.
pub(super) fn angle_reading(
    name: &str,
    stated: Option<AngleUnit>,
    options: &DirectionOptions,
    values: &[f64],
) -> AngleReading {
    if let Some(unit) = options.angle_unit.or(stated) {
        return AngleReading { unit, text: format!("{name} in {}", unit.name()), warning: None };
    }
    let max = values.iter().filter(|v| v.is_finite()).fold(0.0f64, |m, v| m.max(v.abs()));
    let unit = if max > std::f64::consts::TAU { AngleUnit::Degree } else { AngleUnit::Radian };
    let text = format!("{name} in {} (assumed)", unit.name());
    let max = if max < 1e9 { format!("{max:.4}") } else { format!("{max:.3e}") };
    let reason = format!(
        "the unit of {name} is stated nowhere; it was taken for {}, since the largest value is {max}",
        unit.name()
    );
    AngleReading { unit, text, warning: Some(Warning::new(WarningId::FieldAssumed, reason)) }
}

/// The axis of an angle.
pub(super) fn axis_of_angle(angle: f64, unit: AngleUnit) -> DVec3 {
    grainpath_core::math::direction(angle * unit.rad()).extend(0.0)
}

/// Strengths above 1 are shares of the largest one.
pub(super) fn strength_scale(strengths: &[f64]) -> Result<f64, DirectionError> {
    if let Some(row) = strengths.iter().position(|s| *s < 0.0) {
        return Err(invalid("", DirectionProblem::NegativeStrength(row + 1)));
    }
    let max = strengths.iter().filter(|s| s.is_finite()).fold(1.0f64, |m, s| m.max(*s));
    Ok(1.0 / max)
}

/// Samples from columns; all columns have the same number of rows.
pub(super) fn from_columns(
    format: &'static str,
    columns: &[Column],
    options: &DirectionOptions,
) -> Result<DirectionSamples, DirectionError> {
    let n = columns.first().map_or(0, |c| c.1.len());
    if n > MAX_POINTS {
        return Err(DirectionError::TooMany { what: "points", found: n as u64, limit: MAX_POINTS });
    }
    let bases: Vec<String> = columns.iter().map(|c| split_unit(&c.0).0).collect();
    let values = |i: usize| &columns[i].1;
    let named = |names: &[&str]| bases.iter().position(|b| names.contains(&b.as_str()));
    let coordinate = |axis| bases.iter().position(|b| is_coordinate(b, axis));
    let all_names = || columns.iter().map(|c| c.0.clone()).collect();
    let (Some(x), Some(y)) = (coordinate(0), coordinate(1)) else {
        return Err(missing(MissingDirections::Position(all_names())));
    };
    let z = coordinate(2);
    // Of two columns for one coordinate the first would be taken in silence.
    for (axis, taken) in [Some(x), Some(y), z].into_iter().enumerate() {
        let Some(taken) = taken else { continue };
        let differs = |&i: &usize| values(i) != values(taken) && is_coordinate(&bases[i], axis);
        if let Some(other) = (taken + 1..columns.len()).find(differs) {
            let names = [taken, other].map(|i| columns[i].0.clone());
            return Err(invalid(
                "",
                DirectionProblem::Coordinates { coordinate: ["x", "y", "z"][axis], names },
            ));
        }
    }
    let mut warnings = Vec::new();

    // Positions.
    let stated = match options.length_unit {
        Some(_) => None,
        None => {
            unit_of_positions([Some(x), Some(y), z].into_iter().flatten().map(|i| columns[i].0.as_str()))?
        }
    };
    let unit = options.length_unit.or(stated).unwrap_or(LengthUnit::Millimetre);
    let who = if options.length_unit.is_some() {
        "the job says so"
    } else if stated.is_some() {
        "the file says so"
    } else {
        "stated nowhere"
    };
    let place_of = |i: usize| {
        let p = [values(x)[i], values(y)[i], z.map_or(0.0, |z| values(z)[i])].map(|v| v * unit.mm());
        checked(p, || format!("sample {}", i + 1)).map_err(|e| invalid("", DirectionProblem::Coordinate(e)))
    };

    // Directions.
    let mut found = vectors(&bases);
    if let Some(wanted) = &options.array {
        let wanted = split_unit(wanted).0;
        found.retain(|v| v.name == wanted || v.columns[0].is_some_and(|i| bases[i] == wanted));
    }
    let angles: Vec<usize> = match &options.array {
        Some(_) if !found.is_empty() => Vec::new(),
        Some(wanted) => columns.iter().position(|c| c.0.eq_ignore_ascii_case(wanted)).into_iter().collect(),
        None => (0..bases.len()).filter(|&i| ANGLES.contains(&bases[i].as_str())).collect(),
    };
    if found.len() + angles.len() > 1 {
        let mut names: Vec<String> = found.iter().map(|v| v.name.clone()).collect();
        names.extend(angles.iter().map(|&i| columns[i].0.clone()));
        return Err(invalid("", DirectionProblem::Several(names)));
    }
    let angle = angles.first().copied();
    let (directions, axis_of): (String, Box<dyn Fn(usize) -> DVec3 + '_>) = match (found.first(), angle) {
        (Some(vector), _) => {
            let at = vector.columns;
            let part = move |k: usize, i: usize| at[k].map_or(0.0, |c| values(c)[i]);
            let text = format!("vectors {}", vector.name);
            (text, Box::new(move |i| DVec3::new(part(0, i), part(1, i), part(2, i)).normalize_or_zero()))
        }
        (None, Some(a)) => {
            let name = &columns[a].0;
            // The job's word also stands where the header names a unit that is not known.
            let stated = if options.angle_unit.is_some() { None } else { angle_unit_of(name)? };
            let reading = angle_reading(name, stated, options, values(a));
            warnings.extend(reading.warning);
            (reading.text, Box::new(move |i| axis_of_angle(values(a)[i], reading.unit)))
        }
        (None, None) => {
            return Err(missing(match &options.array {
                Some(name) => MissingDirections::NamedArray { name: name.clone(), names: all_names() },
                None => MissingDirections::Direction(all_names()),
            }));
        }
    };

    // Strength and spacing.
    let (strength, spacing) = (named(&STRENGTHS), named(&SPACINGS));
    let scale = strength.map_or(Ok(1.0), |s| strength_scale(values(s)))?;
    let spacing_mm = match spacing {
        Some(s) => length_unit_of(&columns[s].0)?.unwrap_or(unit).mm(),
        None => 1.0,
    };
    let mut samples = Vec::with_capacity(n);
    for i in 0..n {
        let axis = axis_of(i);
        let strength = strength.map_or(1.0, |s| scale * values(s)[i]);
        let counts = strength.is_finite() && strength > 0.0;
        if !axis.is_finite() || axis == DVec3::ZERO || !counts {
            continue;
        }
        let spacing_mm = spacing.map_or(1.0, |s| spacing_mm * values(s)[i]);
        if !(spacing_mm.is_finite() && spacing_mm > 0.0) {
            return Err(invalid("", DirectionProblem::SampleSpacing(i + 1)));
        }
        samples.push(Sample { place_mm: place_of(i)?, axis, strength, spacing_mm });
    }
    if n == 0 {
        return Err(missing(MissingDirections::Rows));
    }
    if samples.is_empty() {
        return Err(DirectionError::NoDirection(n));
    }
    let n_samples = samples.len();
    let first = samples[0].place_mm;
    if samples.iter().all(|s| s.place_mm == first) {
        let text = "all samples are at one place, so the direction is the same everywhere";
        warnings.push(Warning::new(WarningId::FieldOneSample, text));
    }
    let heights = of_heights(&samples);
    let carrier = of_points(samples, spacing.is_some());
    let summary = DirectionSummary {
        format,
        layout: heights,
        samples: n_samples,
        without_direction: n - n_samples,
        directions,
        length_unit: format!("{} ({who})", unit.name()),
        axis_order: String::new(),
        has_strength: strength.is_some(),
        has_spacing: spacing.is_some(),
    };
    Ok(DirectionSamples::new(carrier, summary, warnings).with_count_warning())
}

fn of_heights(samples: &[Sample]) -> String {
    let mut all: Vec<f64> = samples.iter().map(|s| s.place_mm.z).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    match all.len() {
        1 => "points in a plane, for all heights".into(),
        n => format!("points at {n} heights"),
    }
}
