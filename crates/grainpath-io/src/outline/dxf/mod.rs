//! DXF: the lines and curves of a drawing as ASCII text, releases 9 to 2018.
//!
//! A file is pairs of lines, a group code and a value. Code 0 begins a record; records between `SECTION` and `ENDSEC` belong
//! together. Source: Autodesk, *DXF Reference*, "ENTITIES section". Read are `LINE`, `ARC`, `CIRCLE`, `ELLIPSE`,
//! `LWPOLYLINE` and `POLYLINE` with bulges, and `SPLINE` with control points.
//!
//! Units: `$INSUNITS` of the header; without it mm are assumed, with a warning. Entities on layers that are off or frozen,
//! on paper space or invisible are left out. Blocks, hatches, texts and dimensions are named in a warning. Entities that
//! are tilted out of the plane are left out with a warning; mirrored ones (normal along -Z) are read.
//!
//! Limits: 4 million points, splines up to degree 15. Binary DXF is refused.
//!
//! This reader is used instead of the crate `dxf` (0.6.2). Both were compared on 200 damaged drawings. Neither panicked. The
//! crate read 10 drawings that are refused here: two that were cut short, coordinates that were NaN, beyond 1e46 or missing,
//! and a spline with too few knots. It refused 6 that are read here, because of a damaged record in a table that says
//! nothing about shapes. The crate would add 21 packages and 138 s of processor time to a build, and would leave it to
//! grainpath to turn arcs, bulges and splines into polylines. It also reads binary DXF.

mod joining;
mod spline;

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use grainpath_core::math::{atan2, direction};
use grainpath_core::units::LengthUnit;
use grainpath_core::{DVec2, WarningId};

use self::joining::{JOINED_MM, ends, joined, likeness};
use self::spline::{MAX_DEGREE, Spline};
use super::drawing::{Drawing, Line, MAX_POINTS, OutlineError, OutlineOptions, OutlineProblem, invalid};
use super::path::pieces;
use crate::text::TextError;
use crate::text::skip_space;

/// Whether these bytes begin like an ASCII DXF.
pub(super) fn sniff(bytes: &[u8]) -> bool {
    let mut pairs = Pairs { bytes: skip_space(bytes), line: 0 };
    // Comments (code 999) may come first. A hundred are enough to tell a DXF from another text.
    let first = (0..100).find_map(|_| match pairs.next() {
        Some(Ok(Pair { code: 999, .. })) => None,
        other => Some(other),
    });
    matches!(first, Some(Some(Ok(Pair { code: 0, value: b"SECTION", .. }))))
}

/// Whether these bytes are a binary DXF, which is not read.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    bytes.starts_with(b"AutoCAD Binary DXF")
}

pub(super) fn read(bytes: &[u8], options: &OutlineOptions) -> Result<Drawing, OutlineError> {
    let bytes = skip_space(bytes);
    let mut records = Records { pairs: Pairs { bytes, line: 0 }, next: None };
    let mut dxf =
        Dxf { options, unit: None, hidden: BTreeSet::new(), polyline: None, lines: Vec::new(), n_points: 0 };
    let mut drawing = Drawing::default();
    let mut section: &[u8] = b"";
    let mut record = Record { kind: b"", line: 0, pairs: Vec::new() };
    loop {
        if !records.read(&mut record)? {
            return Err(invalid(format!("line {}", records.pairs.line), OutlineProblem::Ends));
        }
        match (section, record.kind) {
            (_, b"EOF") => break,
            (_, b"SECTION") => {
                section = record.text(2);
                if section == b"HEADER" {
                    dxf.unit = unit(&record)?;
                }
            }
            (_, b"ENDSEC") => section = b"",
            // Bit 1 of code 70 is frozen; a negative colour (code 62) means that the layer is off.
            (b"TABLES", b"LAYER") if record.whole(70)? & 1 == 1 || record.or(62, 1.0)? < 0.0 => {
                dxf.hidden.insert(record.text(2));
            }
            // Sections before this one define layers and units, so they are known by now.
            (b"ENTITIES", _) => dxf.entity(&record, &mut drawing)?,
            _ => {}
        }
    }
    dxf.finish(drawing)
}

/// A group code and its value.
struct Pair<'a> {
    line: usize,
    code: i32,
    value: &'a [u8],
}

/// The pairs of a file.
struct Pairs<'a> {
    bytes: &'a [u8],
    /// Number of lines read so far.
    line: usize,
}

impl<'a> Pairs<'a> {
    fn text_line(&mut self) -> Option<&'a [u8]> {
        if self.bytes.is_empty() {
            return None;
        }
        let end = self.bytes.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(self.bytes.len());
        let (text, rest) = self.bytes.split_at(end);
        let crlf = usize::from(rest.starts_with(b"\r\n"));
        self.bytes = &rest[(1 + crlf).min(rest.len())..];
        self.line += 1;
        Some(text.trim_ascii())
    }
}

impl<'a> Iterator for Pairs<'a> {
    type Item = Result<Pair<'a>, OutlineError>;

    fn next(&mut self) -> Option<Self::Item> {
        let code = self.text_line()?;
        // Empty lines at the end of the file are not read as a pair.
        if code.is_empty() && self.bytes.trim_ascii().is_empty() {
            return None;
        }
        let line = self.line;
        let number = std::str::from_utf8(code).ok().and_then(|c| c.parse().ok());
        let Some(code) = number else { return Some(Err(syntax(line, code, "a group code"))) };
        let Some(value) = self.text_line() else {
            let place = format!("line {line}");
            return Some(Err(TextError::UnexpectedEnd { place, expected: "a value" }.into()));
        };
        Some(Ok(Pair { line: line + 1, code, value }))
    }
}

fn syntax(line: usize, found: &[u8], expected: &'static str) -> OutlineError {
    let found = String::from_utf8_lossy(&found[..found.len().min(20)]).into_owned();
    TextError::Syntax { place: format!("line {line}"), found, expected }.into()
}

/// A record: everything from a code 0 up to the next one.
struct Record<'a> {
    kind: &'a [u8],
    line: usize,
    pairs: Vec<Pair<'a>>,
}

impl<'a> Record<'a> {
    /// The last text with this code; empty where there is none.
    fn text(&self, code: i32) -> &'a [u8] {
        self.pairs.iter().rfind(|p| p.code == code).map_or(b"", |p| p.value)
    }

    fn number(&self, code: i32) -> Result<Option<f64>, OutlineError> {
        self.pairs.iter().rfind(|p| p.code == code).map(Pair::number).transpose()
    }

    fn or(&self, code: i32, other: f64) -> Result<f64, OutlineError> {
        Ok(self.number(code)?.unwrap_or(other))
    }

    /// A whole number; 0 where it is missing, the default of every flag in the format.
    fn whole(&self, code: i32) -> Result<i64, OutlineError> {
        Ok(self.or(code, 0.0)? as i64)
    }

    fn needed(&self, code: i32, expected: &'static str) -> Result<f64, OutlineError> {
        let missing = || {
            let kind = String::from_utf8_lossy(self.kind).into_owned();
            invalid(format!("line {}", self.line), OutlineProblem::Lacks { kind, expected, code })
        };
        self.number(code)?.ok_or_else(missing)
    }

    fn point(&self, code: i32, expected: &'static str) -> Result<DVec2, OutlineError> {
        Ok(DVec2::new(self.needed(code, expected)?, self.needed(code + 10, expected)?))
    }

    /// All values of a code that occurs more than once.
    fn numbers(&self, code: i32) -> Result<Vec<f64>, OutlineError> {
        self.pairs.iter().filter(|p| p.code == code).map(Pair::number).collect()
    }
}

impl Pair<'_> {
    fn number(&self) -> Result<f64, OutlineError> {
        let value = std::str::from_utf8(self.value).ok().and_then(|v| v.parse::<f64>().ok());
        value.filter(|v| v.is_finite()).ok_or_else(|| syntax(self.line, self.value, "a number"))
    }
}

struct Records<'a> {
    pairs: Pairs<'a>,
    next: Option<(&'a [u8], usize)>,
}

impl<'a> Records<'a> {
    /// Reads the next record into `out`; false at the end of the file.
    fn read(&mut self, out: &mut Record<'a>) -> Result<bool, OutlineError> {
        out.pairs.clear();
        // Comments may come before the first record.
        while self.next.is_none() {
            let Some(pair) = self.pairs.next().transpose()? else { return Ok(false) };
            self.next = (pair.code == 0).then_some((pair.value, pair.line));
        }
        if let Some((kind, line)) = self.next.take() {
            (out.kind, out.line) = (kind, line);
        }
        for pair in &mut self.pairs {
            let pair = pair?;
            if pair.code == 0 {
                self.next = Some((pair.value, pair.line));
                break;
            }
            out.pairs.push(pair);
        }
        Ok(true)
    }
}

/// Unit of the drawing, where its header states it.
fn unit(header: &Record<'_>) -> Result<Option<LengthUnit>, OutlineError> {
    let Some(at) = header.pairs.iter().position(|p| p.code == 9 && p.value == b"$INSUNITS") else {
        return Ok(None);
    };
    // Source: *DXF Reference*, "HEADER section", $INSUNITS.
    let Some(value) = header.pairs.get(at + 1).filter(|p| p.code == 70) else { return Ok(None) };
    Ok(match value.number()? as i64 {
        1 => Some(LengthUnit::Inch),
        2 => Some(LengthUnit::Foot),
        4 => Some(LengthUnit::Millimetre),
        5 => Some(LengthUnit::Centimetre),
        6 => Some(LengthUnit::Metre),
        13 => Some(LengthUnit::Micron),
        _ => None,
    })
}

/// A vertex of a polyline and the bulge of the side after it. The bulge is the tangent of a quarter of the arc's
/// angle.
type Vertex = (DVec2, f64);

/// A POLYLINE whose VERTEX records are being read.
struct Polyline {
    vertices: Vec<Vertex>,
    closed: bool,
    mirrored: bool,
    /// Whether the polyline is of a kind that is not read.
    skipped: bool,
}

struct Dxf<'a> {
    options: &'a OutlineOptions,
    unit: Option<LengthUnit>,
    /// Layers that are off or frozen.
    hidden: BTreeSet<&'a [u8]>,
    polyline: Option<Polyline>,
    /// Lines in the drawing's unit.
    lines: Vec<Line>,
    n_points: usize,
}

impl Dxf<'_> {
    /// Length of the drawing's unit, mm.
    fn mm(&self) -> f64 {
        self.options.unit.or(self.unit).map_or(1.0, LengthUnit::mm)
    }

    fn entity(&mut self, record: &Record<'_>, drawing: &mut Drawing) -> Result<(), OutlineError> {
        match (record.kind, &mut self.polyline) {
            (b"VERTEX", Some(polyline)) => {
                // Flag 16 marks control points of a smoothed polyline, which do not lie on it.
                if !polyline.skipped && record.whole(70)? & 16 == 0 {
                    polyline.vertices.push((record.point(10, "a place")?, record.or(42, 0.0)?));
                }
                return Ok(());
            }
            (b"SEQEND" | b"VERTEX", None) => return Ok(()),
            // A polyline that lacks its SEQEND ends at the next entity.
            (_, Some(_)) => {
                if let Some(p) = self.polyline.take().filter(|p| !p.skipped) {
                    self.polygon(&p.vertices, p.closed, p.mirrored)?;
                }
                if record.kind == b"SEQEND" {
                    return Ok(());
                }
            }
            _ => {}
        }
        // Code 60 is invisible, 67 paper space, 8 the layer.
        let unseen = record.whole(60)? == 1 || record.whole(67)? == 1 || self.hidden.contains(record.text(8));
        // The extrusion direction. Coordinates of flat entities are in the plane across it.
        let up = [record.or(210, 0.0)?, record.or(220, 0.0)?, record.or(230, 1.0)?];
        let tilted = up[0].abs().max(up[1].abs()) > 1e-6 * up[2].abs();
        let mirrored = up[2] < 0.0;
        match record.kind {
            b"POLYLINE" => {
                let flags = record.whole(70)?;
                // Flags 16 and 64 are meshes of surfaces, not outlines.
                let skipped = unseen || tilted || flags & (16 | 64) != 0;
                let closed = flags & 1 == 1;
                self.polyline = Some(Polyline { vertices: Vec::new(), closed, mirrored, skipped });
            }
            _ if unseen => {}
            b"LINE" => {
                let (a, b) = (record.point(10, "a start")?, record.point(11, "an end")?);
                // Ends of a LINE are world coordinates, so a mirrored extrusion does not change them.
                self.push(vec![a, b], false, false)?;
            }
            b"LWPOLYLINE" | b"ARC" | b"CIRCLE" | b"ELLIPSE" if tilted => {
                let kind = String::from_utf8_lossy(record.kind);
                drawing.warn(
                    WarningId::OutlineNotRead,
                    format!("{kind} out of the drawing's plane is left out"),
                );
            }
            b"LWPOLYLINE" => {
                let mut vertices: Vec<Vertex> = Vec::new();
                for pair in &record.pairs {
                    // Codes 10, 20 and 42 repeat for each vertex; 42 belongs to the vertex before it.
                    match (pair.code, vertices.last_mut()) {
                        (10, _) => vertices.push((DVec2::new(pair.number()?, 0.0), 0.0)),
                        (20, Some(v)) => v.0.y = pair.number()?,
                        (42, Some(v)) => v.1 = pair.number()?,
                        _ => {}
                    }
                }
                self.polygon(&vertices, record.whole(70)? & 1 == 1, mirrored)?;
            }
            b"ARC" | b"CIRCLE" => {
                let radius = record.needed(40, "a radius")?;
                let (x, y) = (DVec2::new(radius, 0.0), DVec2::new(0.0, radius));
                let angles = if record.kind == b"ARC" {
                    [record.needed(50, "a start angle")?, record.needed(51, "an end angle")?]
                } else {
                    [0.0, 360.0]
                };
                self.ellipse(record.point(10, "a centre")?, x, y, angles.map(f64::to_radians), mirrored)?;
            }
            b"ELLIPSE" => {
                // Centre and major axis are world coordinates, so a mirrored extrusion only reverses the
                // direction of rotation.
                let x = record.point(11, "a greater radius")?;
                let y = record.needed(40, "a ratio")? * DVec2::new(-x.y, x.x);
                let y = if mirrored { -y } else { y };
                let angles = [record.or(41, 0.0)?, record.or(42, TAU)?];
                self.ellipse(record.point(10, "a centre")?, x, y, angles, false)?;
            }
            b"SPLINE" => self.spline(record, drawing)?,
            other => {
                let kind = String::from_utf8_lossy(&other[..other.len().min(20)]).into_owned();
                drawing.warn(
                    WarningId::OutlineNotRead,
                    format!("{kind} is not read; a drawing's parts are its lines, arcs and curves"),
                );
            }
        }
        Ok(())
    }

    fn push(&mut self, mut points: Vec<DVec2>, closed: bool, mirrored: bool) -> Result<(), OutlineError> {
        self.n_points += points.len();
        if self.n_points > MAX_POINTS {
            return Err(OutlineError::TooManyPoints);
        }
        // The arbitrary axis algorithm of the *DXF Reference* gives (-1, 0, 0) as x axis for the
        // extrusion (0, 0, -1).
        if mirrored {
            points.iter_mut().for_each(|p| p.x = -p.x);
        }
        self.lines.push(Line { points, closed });
        Ok(())
    }

    /// Largest distance of a curve from its polyline, in the drawing's unit.
    fn tolerance(&self) -> f64 {
        self.options.tolerance_mm / self.mm()
    }

    /// Adds an arc from one angle counter-clockwise to another, with `x` and `y` as its semi-axes. A full
    /// turn closes.
    fn ellipse(
        &mut self,
        centre: DVec2,
        x: DVec2,
        y: DVec2,
        [from, to]: [f64; 2],
        mirrored: bool,
    ) -> Result<(), OutlineError> {
        let turn = (to - from).rem_euclid(TAU);
        // Equal angles mean a full turn; rounding may leave a little less.
        let whole = !(1e-9..=TAU - 1e-9).contains(&turn);
        let turn = if whole { TAU } else { turn };
        let radius = x.length().max(y.length());
        if radius <= 0.0 {
            return Ok(());
        }
        let n = pieces(radius, turn, self.tolerance()).max(if whole { 8 } else { 1 });
        let at = |k: usize| {
            let d = direction(from + turn * k as f64 / n as f64);
            centre + d.x * x + d.y * y
        };
        self.push((0..n + usize::from(!whole)).map(at).collect(), whole, mirrored)
    }

    /// Adds a polyline of straight sides and arcs.
    fn polygon(&mut self, vertices: &[Vertex], closed: bool, mirrored: bool) -> Result<(), OutlineError> {
        let mut points = Vec::with_capacity(vertices.len());
        for (k, &(p, bulge)) in vertices.iter().enumerate() {
            points.push(p);
            let last = k + 1 == vertices.len();
            // An open polyline has no side after its last vertex.
            if bulge == 0.0 || (last && !closed) {
                continue;
            }
            let chord = vertices[(k + 1) % vertices.len()].0 - p;
            // The centre lies on the perpendicular bisector of the chord, to its left for an arc that
            // turns left.
            let away = DVec2::new(-chord.y, chord.x) * ((1.0 - bulge * bulge) / (4.0 * bulge));
            let centre = p + 0.5 * chord + away;
            let (radius, turn) = (p.distance(centre), 4.0 * atan2(bulge, 1.0));
            // A bulge so small that the radius overflows is a straight side.
            if !radius.is_finite() || radius <= 0.0 {
                continue;
            }
            let start = atan2(p.y - centre.y, p.x - centre.x);
            let n = pieces(radius, turn.abs(), self.tolerance());
            let at = |i: usize| centre + radius * direction(start + turn * i as f64 / n as f64);
            points.extend((1..n).map(at));
            if points.len() > MAX_POINTS {
                return Err(OutlineError::TooManyPoints);
            }
        }
        self.push(points, closed, mirrored)
    }

    fn spline(&mut self, record: &Record<'_>, drawing: &mut Drawing) -> Result<(), OutlineError> {
        let degree = record.or(71, 3.0)?;
        let (knots, weights) = (record.numbers(40)?, record.numbers(41)?);
        let (xs, ys) = (record.numbers(10)?, record.numbers(20)?);
        let points: Vec<DVec2> = xs.iter().zip(&ys).map(|(x, y)| DVec2::new(*x, *y)).collect();
        // Fit points alone do not determine the curve; each program interpolates them differently.
        if points.is_empty() {
            drawing
                .warn(WarningId::OutlineNotRead, "a SPLINE given only by the points it passes is left out");
            return Ok(());
        }
        let problem = if !(1.0..=MAX_DEGREE as f64).contains(&degree) {
            Some(OutlineProblem::SplineDegree { degree, max: MAX_DEGREE })
        } else if xs.len() != ys.len()
            || knots.len() != points.len() + degree as usize + 1
            || points.len() <= degree as usize
        {
            let (n, m) = (points.len(), knots.len());
            Some(OutlineProblem::SplineNumbers { degree, n, m })
        } else if !knots.is_sorted() || weights.iter().any(|w| *w <= 0.0) {
            Some(OutlineProblem::SplineKnots)
        } else {
            None
        };
        if let Some(problem) = problem {
            return Err(invalid(format!("line {}", record.line), problem));
        }
        let degree = degree as usize;
        let weighted = |k: usize| {
            let w = weights.get(k).copied().unwrap_or(1.0);
            [w * points[k].x, w * points[k].y, w]
        };
        let control: Vec<[f64; 3]> = (0..points.len()).map(weighted).collect();
        let spline = Spline { degree, knots: &knots, control: &control, tolerance: self.tolerance() };
        let left = MAX_POINTS.saturating_sub(self.n_points);
        let line = spline.points(left).ok_or(OutlineError::TooManyPoints)?;
        self.push(line, false, false)
    }

    /// Joins open lines into closed ones and adds all lines to the drawing, in mm.
    fn finish(self, mut drawing: Drawing) -> Result<Drawing, OutlineError> {
        if self.options.unit.or(self.unit).is_none() {
            drawing.warn(
                WarningId::UnitAssumed,
                "the drawing states no unit (or one that is not read); it is taken for mm",
            );
        }
        let mm = self.mm();
        let mut seen = BTreeSet::new();
        let (mut all, mut open, mut twice) = (Vec::new(), Vec::new(), 0);
        // Drawings often hold the same line twice (copied layers). Under even-odd two equal contours
        // would cancel out.
        for mut line in self.lines {
            line.points.iter_mut().for_each(|p| *p *= mm);
            line.points.dedup_by(|a, b| a.distance(*b) < 1e-9);
            let Some(key) = likeness(&line) else { continue };
            if !seen.insert(key) {
                twice += 1;
                continue;
            }
            // A line whose ends meet is closed whether or not the flag says so.
            let meets =
                line.points.len() > 2 && ends(&line.points)[0].distance(ends(&line.points)[1]) < JOINED_MM;
            if line.closed || meets {
                all.push(Line { closed: true, ..line })
            } else {
                open.push(line.points)
            }
        }
        if twice > 0 {
            drawing.warn(
                WarningId::OutlineDuplicate,
                format!("{twice} lines that lie on others of the same shape were left out"),
            );
        }
        all.extend(joined(open));
        drawing.add(all, None).map_err(|e| match e {
            OutlineError::Invalid { problem, .. } => invalid("the drawing", *problem),
            other => other,
        })?;
        Ok(drawing)
    }
}

#[cfg(test)]
mod tests;
