//! Measures known dimensions of a part on the beads of a program.
//!
//! Dimensions are measured to the edge of a bead, half a width from its centreline. Lengths are in mm.
//! Cost: linear in the outer walls of the measured layers.

use grainpath_core::math::cross;
use grainpath_core::spelling::meaning;
use grainpath_core::{DVec2, Role};
use serde::Serialize;
use toml::{Table, Value};

use crate::{Bead, BeadLayer, Program};

/// The allowed words for `kind` in a file of dimensions.
const KINDS: [(&str, KindWord); 4] = [
    ("outside", KindWord::Outside),
    ("bore", KindWord::Bore),
    ("width", KindWord::Width),
    ("height", KindWord::Height),
];

#[derive(Clone, Copy)]
enum KindWord {
    Outside,
    Bore,
    Width,
    Height,
}

/// Kind and place of a dimension. Heights `z_mm` are above the bed, on which the part's lowest point stands
/// unless the part is lifted. Positions are in the shape's own coordinates, mm.
#[derive(Debug, Clone, PartialEq)]
enum Kind {
    /// Diameter of a round outline.
    Outside { centre: DVec2, z_mm: f64 },
    /// Diameter of a round hole.
    Bore { centre: DVec2, z_mm: f64 },
    /// Thickness along a straight line between two points outside the part.
    Width { from: DVec2, to: DVec2, z_mm: f64 },
    /// Height of the top layer above the bed.
    Height,
}

/// A dimension whose true value is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Dimension {
    name: String,
    kind: Kind,
    true_mm: f64,
}

/// A dimension measured on the printed beads.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measured {
    /// Name of the dimension in the file.
    pub name: String,
    /// True value, mm.
    pub true_mm: f64,
    /// Measured value, mm; left out if no wall (for a height, no layer) was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub printed_mm: Option<f64>,
    /// Relative error, %: 100 times (printed over true value, minus 1). Left out with `printed_mm`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_percent: Option<f64>,
}

/// All dimensions of a file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Dimensions {
    /// Mean of the absolute errors, %, over the dimensions that were found. Left out if none was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_error_percent: Option<f64>,
    /// Each dimension, in the order of the file.
    pub each: Vec<Measured>,
}

/// Why a file of true dimensions cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {problem}")]
pub struct DimensionError {
    /// Name of the file.
    pub file: String,
    /// The problem, and what the file should say instead.
    pub problem: DimensionProblem,
}

/// What is wrong with a file of true dimensions.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)]
pub enum DimensionProblem {
    #[error("{0}")]
    Toml(String),
    #[error("no [[dimension]] in it")]
    Empty,
    #[error("dimension {number} {name:?}: {key} should be {right}")]
    Key { number: usize, name: String, key: &'static str, right: &'static str },
    #[error("middle_mm should be [x, y], the middle of the part's box")]
    NoMiddle,
    #[error("the program has no outer walls")]
    NoOuterWalls,
}

impl DimensionProblem {
    fn from_toml(e: &toml::de::Error) -> Self {
        Self::Toml(e.message().replace('\n', "; "))
    }
}

/// Reads a file of true dimensions: `[[dimension]]` with `name`, `kind` ("outside", "bore",
/// "width", "height"), `true_mm`, and `z_mm` with `centre_mm` or `from_mm` and `to_mm`.
///
/// # Errors
/// [`DimensionError`] that names the file and the dimension.
pub fn parse(text: &str, name: &str) -> Result<Vec<Dimension>, DimensionError> {
    let error = |problem| DimensionError { file: name.to_owned(), problem };
    let table: Table = text.parse().map_err(|e| error(DimensionProblem::from_toml(&e)))?;
    let rows =
        table.get("dimension").and_then(Value::as_array).ok_or_else(|| error(DimensionProblem::Empty))?;
    if rows.is_empty() {
        return Err(error(DimensionProblem::Empty));
    }
    rows.iter()
        .enumerate()
        .map(|(i, row)| {
            let label = row.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
            let wrong =
                |key, right| error(DimensionProblem::Key { number: i + 1, name: label.clone(), key, right });
            let number =
                |key: &'static str| row.get(key).and_then(real).ok_or_else(|| wrong(key, "a number"));
            let point = |key: &'static str| row.get(key).and_then(point).ok_or_else(|| wrong(key, "[x, y]"));
            let word = row.get("kind").and_then(Value::as_str).unwrap_or_default();
            let kind = match meaning(&KINDS, word) {
                Some(KindWord::Outside) => {
                    Kind::Outside { centre: point("centre_mm")?, z_mm: number("z_mm")? }
                }
                Some(KindWord::Bore) => Kind::Bore { centre: point("centre_mm")?, z_mm: number("z_mm")? },
                Some(KindWord::Width) => {
                    Kind::Width { from: point("from_mm")?, to: point("to_mm")?, z_mm: number("z_mm")? }
                }
                Some(KindWord::Height) => Kind::Height,
                None => return Err(wrong("kind", "outside, bore, width or height")),
            };
            let true_mm = number("true_mm")?;
            if true_mm <= 0.0 {
                return Err(wrong("true_mm", "more than 0"));
            }
            Ok(Dimension { name: label, kind, true_mm })
        })
        .collect()
}

/// A finite number, with or without a decimal point.
fn real(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|n| n as f64)).filter(|v| v.is_finite())
}

/// A list of two numbers.
fn point(value: &Value) -> Option<DVec2> {
    let list: Vec<f64> = value.as_array()?.iter().map(real).collect::<Option<_>>()?;
    let [x, y] = list.try_into().ok()?;
    Some(DVec2::new(x, y))
}

/// Finds the position of the shape's origin on the plate, mm, in a program of any slicer. The centre of the
/// bounding box of the outer walls is taken as the part's centre. The file of true dimensions states the same
/// centre in the shape's coordinates (`middle_mm`), and the difference of the two is the position.
///
/// # Errors
/// [`DimensionError`] where the file does not state `middle_mm`, or the program has no outer walls.
pub fn shift_of(text: &str, name: &str, program: &Program) -> Result<DVec2, DimensionError> {
    let error = |problem| DimensionError { file: name.to_owned(), problem };
    let table: Table = text.parse().map_err(|e| error(DimensionProblem::from_toml(&e)))?;
    let middle = table.get("middle_mm").and_then(point).ok_or_else(|| error(DimensionProblem::NoMiddle))?;
    let ends = program.layers.iter().flat_map(|l| outer(l).flat_map(|b| [b.start(), b.end()]));
    let bounds =
        grainpath_core::Bounds2::around_points(ends).ok_or_else(|| error(DimensionProblem::NoOuterWalls))?;
    Ok(bounds.centre() - middle)
}

/// Measures dimensions on the beads of a program; `shift` is the position of the shape's origin on
/// the plate, mm.
pub fn measure(dimensions: &[Dimension], program: &Program, shift: DVec2) -> Dimensions {
    // Layers are in ascending order, so the first one whose top lies above the height contains that height.
    let at = |z: f64| program.layers.iter().find(|l| z < l.z_mm + 1e-6);
    let each: Vec<Measured> = dimensions
        .iter()
        .map(|d| {
            let found = match d.kind {
                Kind::Outside { centre, z_mm } => {
                    at(z_mm).and_then(|l| diameter(l, centre + shift, d.true_mm, 1.0))
                }
                Kind::Bore { centre, z_mm } => {
                    at(z_mm).and_then(|l| diameter(l, centre + shift, d.true_mm, -1.0))
                }
                Kind::Width { from, to, z_mm } => at(z_mm).and_then(|l| width(l, from + shift, to + shift)),
                Kind::Height => program.layers.last().map(|l| l.z_mm),
            };
            let round = |v: f64| (v * 1e4).round() * 1e-4;
            Measured {
                name: d.name.clone(),
                true_mm: d.true_mm,
                printed_mm: found.map(round),
                error_percent: found.map(|v| round(100.0 * (v / d.true_mm - 1.0))),
            }
        })
        .collect();
    let errors: Vec<f64> = each.iter().filter_map(|m| m.error_percent).map(f64::abs).collect();
    let mean = || errors.iter().sum::<f64>() / errors.len() as f64;
    let mean_error_percent = (!errors.is_empty()).then(|| (mean() * 1e4).round() * 1e-4);
    Dimensions { mean_error_percent, each }
}

fn outer(layer: &BeadLayer) -> impl Iterator<Item = &Bead> {
    layer.beads.iter().filter(|b| b.role == Role::OuterWall)
}

/// Diameter of the round wall about `centre` whose diameter is near `true_mm`. It is the mean, weighted
/// by length, over the outer edges (`side` 1) or the inner edges (`side` -1) of the beads, which lie half
/// a width from the centrelines. `None` if less than a sixth of the circle is found.
fn diameter(layer: &BeadLayer, centre: DVec2, true_mm: f64, side: f64) -> Option<f64> {
    // Largest difference between a bead's radius and the true one, mm. Source: chosen; a larger one would include
    // neighbouring walls.
    let reach = (0.1 * true_mm).min(0.6);
    let (mut sum, mut length) = (0.0, 0.0);
    for b in outer(layer) {
        let (p, q) = (b.start(), b.end());
        let half = 0.5 * side * b.width_mm(layer.height_mm);
        let r = |p: DVec2| p.distance(centre) + half;
        let along = (q - p).normalize_or_zero().dot((0.5 * (p + q) - centre).normalize_or_zero()).abs();
        // Only beads within 17 degrees of the tangent (sine 0.3) count. The others are straight walls near the
        // circle.
        if (r(p) - 0.5 * true_mm).abs() < reach && (r(q) - 0.5 * true_mm).abs() < reach && along < 0.3 {
            let l = p.distance(q);
            // The middle of a chord lies nearer to the centre than its ends. Simpson's rule gives the mean radius.
            sum += l * (r(p) + 4.0 * r(0.5 * (p + q)) + r(q)) / 6.0;
            length += l;
        }
    }
    // Half a diameter is a sixth of the circle. If less is found, the stated centre or diameter is wrong.
    (length > 0.5 * true_mm).then(|| 2.0 * sum / length)
}

/// Thickness along the line, mm: from the outer edge of the first outer wall that crosses it to that of the last.
fn width(layer: &BeadLayer, from: DVec2, to: DVec2) -> Option<f64> {
    let way = (to - from).normalize_or_zero();
    let mut ends: Option<(f64, f64)> = None;
    for b in outer(layer) {
        let (p, q) = (b.start(), b.end());
        let (u, v) = (cross(way, p - from), cross(way, q - from));
        if (u > 0.0) == (v > 0.0) {
            continue;
        }
        let at = way.dot(p.lerp(q, u / (u - v)) - from);
        if (0.0..=from.distance(to)).contains(&at) {
            // A bead that crosses the line at an angle is wider along the line: by 1 over the sine of that angle,
            // here at most 5, so that beads almost along the line do not count as endless.
            let slant = cross(way, (q - p).normalize_or_zero()).abs().max(0.2);
            let half = 0.5 * b.width_mm(layer.height_mm) / slant;
            let (low, high) = (at - half, at + half);
            ends = Some(ends.map_or((low, high), |(a, b): (f64, f64)| (a.min(low), b.max(high))));
        }
    }
    ends.map(|(a, b)| b - a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::math::direction;

    #[test]
    fn a_printed_ring_has_the_diameters_of_its_beads_edges() {
        let mut layer = BeadLayer { z_mm: 0.2, height_mm: 0.2, ..BeadLayer::default() };
        let (w, h) = (0.45, 0.2);
        let area = grainpath_core::units::bead_area_mm2(w, h);
        for r in [5.0 + 0.5 * w, 10.0 - 0.5 * w] {
            for k in 0..90 {
                let p = |k: i32| direction(f64::from(k) / 90.0 * std::f64::consts::TAU) * r + 50.0;
                let (a, b) = (p(k), p(k + 1));
                layer.beads.push(Bead {
                    a: [a.x as f32, a.y as f32],
                    b: [b.x as f32, b.y as f32],
                    volume_mm3: (area * a.distance(b)) as f32,
                    speed_mm_s: 40.0,
                    role: Role::OuterWall,
                    starts: k == 0,
                    raise_mm: [0.0; 2],
                });
            }
        }
        let program = Program { layers: vec![layer], ..Program::default() };
        let text = "[[dimension]]\nname = \"o\"\nkind = \"outside\"\ncentre_mm = [0, 0]\ntrue_mm = 20\nz_mm = 0.1\n\
                    [[dimension]]\nname = \"b\"\nkind = \"bore\"\ncentre_mm = [0, 0]\ntrue_mm = 10.0\nz_mm = 0.1\n\
                    [[dimension]]\nname = \"w\"\nkind = \"width\"\nfrom_mm = [-12, 0]\nto_mm = [12, 0]\ntrue_mm = 20\nz_mm = 0.1\n\
                    [[dimension]]\nname = \"h\"\nkind = \"height\"\ntrue_mm = 0.2\n\
                    [[dimension]]\nname = \"none\"\nkind = \"bore\"\ncentre_mm = [30, 0]\ntrue_mm = 4\nz_mm = 0.1\n";
        let found = measure(&parse(text, "t.toml").expect("good"), &program, DVec2::splat(50.0));
        assert!(found.each[..4].iter().all(|m| m.error_percent.is_some_and(|e| e.abs() < 0.1)), "{found:?}");
        assert!(
            found.each[4].printed_mm.is_none() && found.mean_error_percent.is_some_and(|mean| mean < 0.1)
        );
        let bad = parse("[[dimension]]\nname = \"x\"\nkind = \"bore\"\ntrue_mm = 4\n", "t.toml")
            .expect_err("no centre");
        assert!(bad.to_string().contains("t.toml: dimension 1 \"x\": centre_mm should be [x, y]"), "{bad}");
        assert!(parse("dimension = []\n", "t.toml").is_err(), "a file without dimensions measures nothing");
        let words = text.replacen("[0, 0]", "[0, \"a\", 0]", 1);
        assert!(parse(&words, "t.toml").is_err(), "a word is no coordinate");
        let bore =
            "[[dimension]]\nname = \"b\"\nkind = \"bore\"\ncentre_mm = [30, 0]\ntrue_mm = 4\nz_mm = 0.1\n";
        let found = measure(&parse(bore, "t.toml").expect("good"), &program, DVec2::splat(50.0));
        assert_eq!(found.mean_error_percent, None, "a mean over nothing");
        let whole =
            shift_of(&format!("middle_mm = [1, 2]\n{text}"), "t.toml", &program).expect("whole numbers");
        assert!(
            whole.is_finite() && shift_of(&format!("middle_mm = [nan, 2.0]\n{text}"), "t", &program).is_err()
        );
    }
}
