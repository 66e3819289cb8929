//! Densities at points: the same files as directions, with one number between 0 and 1 at each place.
//!
//! A CSV has columns x, y, perhaps z, and the density; a CSV of numbers alone and an array of numpy are grids `a[y][x]`;
//! a picture is a grid whose grey, from 0 to the maximum, is 0 to 1; a finite-element file has a scalar array on nodes or
//! elements. What is interpolated is the number, by the rules of the directions. Every place needs a density: an optimiser that leaves
//! places out has them at 0.

use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec2, DVec3, Warning, WarningId};

use super::cloud::{Carrier, Cloud, Node, Sample, of_points};
use super::grid::DirectionGrid;
use super::model::{
    DirectionError, DirectionProblem, DirectionSummary, GridAxes, MAX_CELLS, MAX_POINTS, invalid,
};
use super::npy::{MAGIC, read_npy};
use super::read::{TABLE_COLUMNS, grey, header, matrix, rows};
use super::samples::DirectionSamples;
use super::table::{Column, coordinate, unit_of_positions};
use crate::fe::{Element, FeArray, FeFile, FeFormat, On, parse_fe, sniff_fe};
use crate::image::{decode_within, sniff_image};

/// Names that densities usually have, in lower case.
const USUAL: [&str; 5] = ["density", "rho", "densities", "infill", "fill"];

/// Densities at points, interpolated anywhere, in the coordinates of their file in mm.
///
/// ```
/// use grainpath_core::DVec3;
/// use grainpath_io::directions::parse_densities;
///
/// let table = "x_mm,y_mm,density\n0,0,0.2\n10,0,0.6\n0,10,0.2\n10,10,0.6\n";
/// let densities = parse_densities(table.as_bytes(), "rho.csv", None).unwrap();
/// assert!((densities.at(DVec3::new(5.0, 5.0, 0.0)) - 0.4).abs() < 1e-6);
/// assert!(parse_densities(b"x,y,density\n0,0,nan\n", "rho.csv", None).is_err());
/// ```
#[derive(Debug, Clone)]
pub struct DensitySamples(DirectionSamples);

/// A name that was not asked for and is not usual for a density, but the only one.
struct Assumed<'a>(Option<&'a str>);

impl Assumed<'_> {
    fn warnings(&self) -> Vec<Warning> {
        let text = |name: &str| format!("{name:?}, the only value of the file, is taken for the density");
        self.0.map(|name| Warning::new(WarningId::DensityAssumed, text(name))).into_iter().collect()
    }
}

impl DensitySamples {
    /// Whether the densities are the same at all heights.
    pub fn is_plane(&self) -> bool {
        self.0.is_plane()
    }

    /// How the file was read.
    pub fn summary(&self) -> &DirectionSummary {
        self.0.summary()
    }

    /// Lowest and highest corner of the box around the samples, mm; `None` for a grid that was not placed.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        self.0.bounds()
    }

    /// What was assumed while the file was read.
    pub fn warnings(&self) -> &[Warning] {
        self.0.warnings()
    }

    /// Lays a grid without a place of its own over the box between two corners, mm.
    pub fn stretch_over(&mut self, low: DVec2, high: DVec2) {
        if let Some([columns, rows]) = self.0.unplaced_grid() {
            self.0.place_grid(
                low,
                (high - low).max(DVec2::splat(1e-6)) / DVec2::new(columns as f64, rows as f64),
            );
        }
    }

    /// The density at a point, mm; outside the samples, that of the nearest place.
    pub fn at(&self, p: DVec3) -> f64 {
        // Densities are stored in the field that holds the bead spacing of directions.
        self.0.sample(p).spacing_mm.unwrap_or(0.0)
    }
}

/// Reads densities; `array` names the column or array that holds them.
///
/// # Errors
/// [`DirectionError`] with what is wrong and where, also for a density that is no number from 0 to 1.
pub fn parse_densities(
    bytes: &[u8],
    name: &str,
    array: Option<&str>,
) -> Result<DensitySamples, DirectionError> {
    if bytes.is_empty() {
        return Err(DirectionError::Empty);
    }
    if bytes.starts_with(MAGIC) {
        let read = read_npy(bytes, "")?;
        return match (&read.fields[..], &read.shape[..]) {
            ([(_, values)], &[n0, n1]) => grid("npy", GridAxes::Yx, [n0, n1], |i| values[i]),
            ([_], _) => Err(invalid("the array", DirectionProblem::NotTwoIndices)),
            (fields, _) => columns("npy", fields, array),
        };
    }
    if sniff_image(bytes).is_some() {
        let image = decode_within(bytes, MAX_CELLS as u64)?;
        let values = grey(&image, "a picture of densities is grey, from 0 to the maximum for 0 to 1")?;
        return grid(image.format.name(), GridAxes::Image, [image.height, image.width], |i| {
            f64::from(values[i].0)
        });
    }
    if sniff_fe(bytes, Some(name)).is_some_and(|f| f != FeFormat::Csv) {
        return mesh(&parse_fe(bytes, Some(name))?, array);
    }
    if bytes.iter().take(4096).any(|b| *b == 0) {
        return Err(invalid("the file", DirectionProblem::NoDensityFile));
    }
    match header(bytes) {
        Some((names, separator)) => columns("CSV", &rows(bytes, &names, separator, &[])?, array),
        None => {
            let read = matrix(bytes, "")?;
            let [rows, columns] = [read.shape[0], read.shape[1]];
            if columns <= TABLE_COLUMNS && rows > 10 * columns {
                return Err(invalid("", DirectionProblem::NoHeader { rows, columns }));
            }
            grid("CSV", GridAxes::Yx, [rows, columns], |i| read.fields[0].1[i])
        }
    }
}

/// A density, checked.
fn checked(value: f64, place: impl FnOnce() -> String) -> Result<f64, DirectionError> {
    if (0.0..=1.0).contains(&value) {
        Ok(value)
    } else {
        Err(invalid(place(), DirectionProblem::Density(value)))
    }
}

/// Index of the name that is the density: the one asked for, one with a usual name, or the only one, which is then told.
fn chosen<'a>(names: &[&'a str], array: Option<&str>) -> Result<(usize, Assumed<'a>), DirectionError> {
    let find = |wanted: &str| names.iter().position(|n| n.eq_ignore_ascii_case(wanted));
    let named = match array {
        Some(array) => find(array),
        None => USUAL.iter().find_map(|n| find(n)),
    };
    let only = || (array.is_none() && names.len() == 1).then(|| (0, Assumed(Some(names[0]))));
    let found = named.map(|i| (i, Assumed(None))).or_else(only);
    found.ok_or_else(|| {
        let what = array.map_or("no density".to_owned(), |a| format!("no array {a:?}"));
        invalid(what, DirectionProblem::NoDensity(names.iter().map(|n| (*n).to_owned()).collect()))
    })
}

fn summary(format: &'static str, layout: String, samples: usize, length_unit: String) -> DirectionSummary {
    DirectionSummary {
        format,
        layout,
        samples,
        length_unit,
        has_spacing: true,
        ..DirectionSummary::default()
    }
}

fn grid(
    format: &'static str,
    axes: GridAxes,
    [n0, n1]: [usize; 2],
    value: impl Fn(usize) -> f64,
) -> Result<DensitySamples, DirectionError> {
    if n0 == 0 || n1 == 0 {
        return Err(DirectionError::Empty);
    }
    if n0.saturating_mul(n1) > MAX_CELLS {
        return Err(DirectionError::TooMany { what: "cells", found: (n0 * n1) as u64, limit: MAX_CELLS });
    }
    let mut all = Vec::with_capacity(n0 * n1);
    for row in 0..n0 {
        let from = if axes == GridAxes::Image { n0 - 1 - row } else { row };
        for column in 0..n1 {
            let place = || format!("row {}, column {}", from + 1, column + 1);
            all.push(checked(value(from * n1 + column), place)? as f32);
        }
    }
    let grid = DirectionGrid::new(n1, n0, |_, _| Some((DVec2::X, 1.0))).with_spacing(all);
    let summary = summary(format, format!("a grid of {n1} x {n0} cells (x, y)"), n0 * n1, String::new());
    Ok(DensitySamples(DirectionSamples::new(Carrier::Grid(grid), summary, Vec::new())))
}

fn columns(
    format: &'static str,
    all: &[Column],
    array: Option<&str>,
) -> Result<DensitySamples, DirectionError> {
    let n = all.first().map_or(0, |c| c.1.len());
    if n == 0 {
        return Err(invalid("the table", DirectionProblem::NoRows));
    }
    if n > MAX_POINTS {
        return Err(DirectionError::TooMany { what: "points", found: n as u64, limit: MAX_POINTS });
    }
    let names: Vec<&str> = all.iter().map(|c| c.0.as_str()).collect();
    let at = [0, 1, 2].map(|axis| coordinate(&names, axis));
    let (Some(x), Some(y)) = (at[0], at[1]) else {
        let names = names.iter().map(|n| (*n).to_owned()).collect();
        return Err(invalid("the table", DirectionProblem::NoPosition(names)));
    };
    let others: Vec<usize> = (0..all.len()).filter(|i| !at.contains(&Some(*i))).collect();
    let (found, assumed) = chosen(&others.iter().map(|&i| names[i]).collect::<Vec<_>>(), array)?;
    let values = &all[others[found]].1;
    let positions = [Some(x), Some(y), at[2]].into_iter().flatten().map(|i| names[i]);
    let unit = unit_of_positions(positions)?.unwrap_or(LengthUnit::Millimetre);
    let sample = |i: usize| {
        let p = DVec3::new(all[x].1[i], all[y].1[i], at[2].map_or(0.0, |z| all[z].1[i])) * unit.mm();
        if !p.is_finite() {
            return Err(invalid(format!("sample {}", i + 1), DirectionProblem::Position));
        }
        let density = checked(values[i], || format!("sample {}", i + 1))?;
        Ok(Sample { place_mm: p, axis: DVec3::X, strength: 1.0, spacing_mm: density })
    };
    let samples = (0..n).map(sample).collect::<Result<Vec<_>, _>>()?;
    let summary = summary(format, format!("{n} points"), n, unit.name().to_owned());
    Ok(DensitySamples(DirectionSamples::new(of_points(samples, true), summary, assumed.warnings())))
}

fn mesh(file: &FeFile, array: Option<&str>) -> Result<DensitySamples, DirectionError> {
    let scalars: Vec<&FeArray> = file.arrays.iter().filter(|a| a.components == 1).collect();
    let names: Vec<&str> = scalars.iter().map(|a| a.name.as_str()).collect();
    let (found, assumed) = chosen(&names, array)?;
    let array = scalars[found];
    let value = |i: usize| {
        let density = array.values.get(i).copied().unwrap_or(f64::NAN);
        checked(density, || {
            format!(
                "{} {} of {:?}",
                if array.on == On::Nodes { "node" } else { "element" },
                i + 1,
                array.name
            )
        })
    };
    // Values on elements are averaged: a node takes the mean of the elements around it.
    let mut sums = vec![(0.0, 0.0); file.nodes.len()];
    match array.on {
        On::Nodes => {
            for (i, sum) in sums.iter_mut().enumerate() {
                *sum = (value(i)?, 1.0);
            }
        }
        On::Elements => {
            for (e, element) in file.elements.iter().enumerate() {
                let density = value(e)?;
                for &i in element.nodes() {
                    sums[i as usize].0 += density;
                    sums[i as usize].1 += 1.0;
                }
            }
        }
    }
    let of_node = |(sum, n): (f64, f64)| if n > 0.0 { sum / n } else { 0.0 };
    let dimension = file.elements.iter().map(|e| e.kind.dimension()).max().unwrap_or(0);
    let elements: Vec<Element> =
        file.elements.iter().copied().filter(|e| e.kind.dimension() == dimension).collect();
    let plane = file.nodes.iter().all(|p| p.z == file.nodes[0].z);
    let layout = format!("a mesh of {} elements", elements.len());
    let carrier = if elements.is_empty() {
        let sample = |(p, sum): (&DVec3, &(f64, f64))| Sample {
            place_mm: *p,
            axis: DVec3::X,
            strength: 1.0,
            spacing_mm: of_node(*sum),
        };
        of_points(file.nodes.iter().zip(&sums).map(sample).collect(), true)
    } else {
        let node = |(p, sum): (&DVec3, &(f64, f64))| Node {
            place_mm: *p,
            tensor: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            spacing_mm: of_node(*sum),
        };
        let nodes = file.nodes.iter().zip(&sums).map(node).collect();
        Carrier::Cloud(Box::new(Cloud::new(nodes, elements, true, plane)))
    };
    let summary = summary(file.format.name(), layout, sums.len(), LengthUnit::Millimetre.name().to_owned());
    Ok(DensitySamples(DirectionSamples::new(carrier, summary, assumed.warnings())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_lie_over_the_box_and_pictures_stand_upright() {
        // Rows rise with y in a table of numbers.
        let mut read = parse_densities(b"0.1 0.3\n0.5 0.7\n", "rho.csv", None).expect("a matrix");
        assert!(read.is_plane() && read.bounds().is_none());
        read.stretch_over(DVec2::ZERO, DVec2::new(20.0, 10.0));
        for (p, density) in [((5.0, 2.5), 0.1), ((15.0, 2.5), 0.3), ((5.0, 7.5), 0.5), ((10.0, 5.0), 0.4)] {
            assert!((read.at(DVec2::from(p).extend(3.0)) - density).abs() < 1e-6, "{p:?}");
        }
    }

    #[test]
    fn a_value_with_another_name_is_taken_only_if_it_is_the_only_one_and_told() {
        let told = |text: &str, array: Option<&str>| {
            let read = parse_densities(text.as_bytes(), "rho.csv", array).expect("densities");
            read.warnings().iter().map(|w| (w.id.name(), w.text.clone())).collect::<Vec<_>>()
        };
        for usual in ["density", "Rho", "infill"] {
            assert!(told(&format!("x,y,{usual}\n0,0,0.5\n9,0,0.2\n"), None).is_empty(), "{usual}");
        }
        assert!(told("x,y,foo\n0,0,0.5\n9,0,0.2\n", Some("foo")).is_empty());
        assert!(told("x,y,foo,density\n0,0,7,0.5\n9,0,7,0.2\n", None).is_empty());
        let found = told("x,y,foo\n0,0,0.5\n9,0,0.2\n", None);
        let text = "\"foo\", the only value of the file, is taken for the density";
        assert_eq!(found, [("density-assumed", text.to_owned())]);
    }

    #[test]
    fn what_is_no_density_is_named_with_its_place() {
        let message = |bytes: &[u8], array: Option<&str>| {
            parse_densities(bytes, "rho.csv", array).map(|_| ()).expect_err("wrong").to_string()
        };
        assert_eq!(
            message(b"x,y,density\n0,0,0.5\n1,0,nan\n", None),
            "sample 2: the density should be from 0 to 1, is NaN"
        );
        assert_eq!(
            message(b"x,y,rho\n0,0,1.5\n", None),
            "sample 1: the density should be from 0 to 1, is 1.5"
        );
        assert_eq!(
            message(b"x,y,a,b\n0,0,0.5,1\n", None),
            "no density: there are: a, b; name one with fill.density.array"
        );
        assert_eq!(
            message(b"x,z,rho\n0,0,1\n", Some("rho")),
            "the table: no columns x and y among x, z, rho"
        );
        assert_eq!(
            message(b"0.5 2\n0 0\n", None),
            "row 1, column 2: the density should be from 0 to 1, is 2.0"
        );
    }
}
