//! DXF: the lines and curves of a drawing as ASCII text, releases 9 to 2018.
//!
//! A file is pairs of lines, a code and a value. Code 0 begins a record; records between SECTION and ENDSEC belong
//! together. What an entity's codes mean is in the DXF reference of AutoCAD, "ENTITIES section".

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use grainpath_core::math::{atan2, direction};
use grainpath_core::units::LengthUnit;
use grainpath_core::{Bounds2, DVec2};

use super::path::pieces;
use super::{Drawing, Line, MAX_POINTS, OutlineOptions, SAME_MM, invalid};
use crate::mesh::MeshError;
use crate::text::skip_space;

/// Ends of lines and arcs nearer than this are joined, mm.
const JOINED_MM: f64 = 0.01;
/// No spline of use has a higher degree.
const MAX_DEGREE: usize = 15;
/// A spline's pieces between knots are halved this often at most.
const MAX_HALVINGS: usize = 10;

/// Whether these bytes begin like a DXF drawing as text.
pub(super) fn sniff(bytes: &[u8]) -> bool {
    let mut pairs = Pairs { bytes: skip_space(bytes), line: 0 };
    // Comments may come first.
    let first = (0..100).find_map(|_| match pairs.next() {
        Some(Ok(Pair { code: 999, .. })) => None,
        other => Some(other),
    });
    matches!(first, Some(Some(Ok(Pair { code: 0, value: b"SECTION", .. }))))
}

/// Whether these bytes are the binary kind, which is not read.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    bytes.starts_with(b"AutoCAD Binary DXF")
}

pub(super) fn read(bytes: &[u8], options: &OutlineOptions) -> Result<Drawing, MeshError> {
    let bytes = skip_space(bytes);
    let mut records = Records { pairs: Pairs { bytes, line: 0 }, next: None };
    let mut dxf =
        Dxf { options, unit: None, hidden: BTreeSet::new(), polyline: None, lines: Vec::new(), n_points: 0 };
    let mut drawing = Drawing::default();
    let mut section: &[u8] = b"";
    let mut record = Record { kind: b"", line: 0, pairs: Vec::new() };
    loop {
        if !records.read(&mut record)? {
            return Err(invalid(format!("line {}", records.pairs.line), "the drawing ends in the middle"));
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
            // Frozen, or switched off: then its colour is negative.
            (b"TABLES", b"LAYER") if record.whole(70)? & 1 == 1 || record.or(62, 1.0)? < 0.0 => {
                dxf.hidden.insert(record.text(2));
            }
            (b"ENTITIES", _) => dxf.entity(&record, &mut drawing)?,
            _ => {}
        }
    }
    dxf.finish(drawing)
}

/// A code and its value.
struct Pair<'a> {
    line: usize,
    code: i32,
    value: &'a [u8],
}

/// The pairs of a file.
struct Pairs<'a> {
    bytes: &'a [u8],
    /// Lines read.
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
    type Item = Result<Pair<'a>, MeshError>;

    fn next(&mut self) -> Option<Self::Item> {
        let code = self.text_line()?;
        if code.is_empty() && self.bytes.trim_ascii().is_empty() {
            return None;
        }
        let line = self.line;
        let number = std::str::from_utf8(code).ok().and_then(|c| c.parse().ok());
        let Some(code) = number else { return Some(Err(syntax(line, code, "a group code"))) };
        let Some(value) = self.text_line() else {
            let place = format!("line {line}");
            return Some(Err(MeshError::UnexpectedEnd { place, wanted: "a value" }));
        };
        Some(Ok(Pair { line: line + 1, code, value }))
    }
}

fn syntax(line: usize, found: &[u8], wanted: &'static str) -> MeshError {
    let found = String::from_utf8_lossy(&found[..found.len().min(20)]).into_owned();
    MeshError::Syntax { place: format!("line {line}"), found, wanted }
}

/// What follows a code 0, up to the next.
struct Record<'a> {
    kind: &'a [u8],
    line: usize,
    pairs: Vec<Pair<'a>>,
}

impl<'a> Record<'a> {
    /// The last text of a code, empty when there is none.
    fn text(&self, code: i32) -> &'a [u8] {
        self.pairs.iter().rfind(|p| p.code == code).map_or(b"", |p| p.value)
    }

    fn number(&self, code: i32) -> Result<Option<f64>, MeshError> {
        self.pairs.iter().rfind(|p| p.code == code).map(Pair::number).transpose()
    }

    fn or(&self, code: i32, other: f64) -> Result<f64, MeshError> {
        Ok(self.number(code)?.unwrap_or(other))
    }

    /// A whole number, 0 when it is not given.
    fn whole(&self, code: i32) -> Result<i64, MeshError> {
        Ok(self.or(code, 0.0)? as i64)
    }

    fn needed(&self, code: i32, wanted: &'static str) -> Result<f64, MeshError> {
        let missing = || {
            let kind = String::from_utf8_lossy(self.kind);
            invalid(format!("line {}", self.line), format!("{kind} lacks {wanted} (code {code})"))
        };
        self.number(code)?.ok_or_else(missing)
    }

    fn point(&self, code: i32, wanted: &'static str) -> Result<DVec2, MeshError> {
        Ok(DVec2::new(self.needed(code, wanted)?, self.needed(code + 10, wanted)?))
    }

    /// All values of codes that come again and again.
    fn numbers(&self, code: i32) -> Result<Vec<f64>, MeshError> {
        self.pairs.iter().filter(|p| p.code == code).map(Pair::number).collect()
    }
}

impl Pair<'_> {
    fn number(&self) -> Result<f64, MeshError> {
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
    fn read(&mut self, out: &mut Record<'a>) -> Result<bool, MeshError> {
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

/// What one unit of the drawing is, where its header says so.
fn unit(header: &Record<'_>) -> Result<Option<LengthUnit>, MeshError> {
    let Some(at) = header.pairs.iter().position(|p| p.code == 9 && p.value == b"$INSUNITS") else {
        return Ok(None);
    };
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

/// A vertex of a polyline and how far the side after it bulges: the tangent of a quarter of its arc's angle.
type Vertex = (DVec2, f64);

/// A POLYLINE whose vertices are being read.
struct Polyline {
    vertices: Vec<Vertex>,
    closed: bool,
    mirrored: bool,
    /// Whether it is one that is not read.
    skipped: bool,
}

struct Dxf<'a> {
    options: &'a OutlineOptions,
    unit: Option<LengthUnit>,
    /// Layers that are not shown.
    hidden: BTreeSet<&'a [u8]>,
    polyline: Option<Polyline>,
    /// In the drawing's unit.
    lines: Vec<Line>,
    n_points: usize,
}

impl Dxf<'_> {
    /// One of the drawing's units, mm.
    fn mm(&self) -> f64 {
        self.options.unit.or(self.unit).map_or(1.0, LengthUnit::mm)
    }

    fn entity(&mut self, record: &Record<'_>, drawing: &mut Drawing) -> Result<(), MeshError> {
        match (record.kind, &mut self.polyline) {
            (b"VERTEX", Some(polyline)) => {
                // Points of the frame around a smoothed line are not on it.
                if !polyline.skipped && record.whole(70)? & 16 == 0 {
                    polyline.vertices.push((record.point(10, "a place")?, record.or(42, 0.0)?));
                }
                return Ok(());
            }
            (b"SEQEND" | b"VERTEX", None) => return Ok(()),
            // One that is not ended by SEQEND is ended by what follows.
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
        let unseen = record.whole(60)? == 1 || record.whole(67)? == 1 || self.hidden.contains(record.text(8));
        let up = [record.or(210, 0.0)?, record.or(220, 0.0)?, record.or(230, 1.0)?];
        let tilted = up[0].abs().max(up[1].abs()) > 1e-6 * up[2].abs();
        let mirrored = up[2] < 0.0;
        match record.kind {
            b"POLYLINE" => {
                let flags = record.whole(70)?;
                // Meshes of surfaces.
                let skipped = unseen || tilted || flags & (16 | 64) != 0;
                let closed = flags & 1 == 1;
                self.polyline = Some(Polyline { vertices: Vec::new(), closed, mirrored, skipped });
            }
            _ if unseen => {}
            b"LINE" => {
                let (a, b) = (record.point(10, "a start")?, record.point(11, "an end")?);
                self.push(vec![a, b], false, false)?;
            }
            b"LWPOLYLINE" | b"ARC" | b"CIRCLE" | b"ELLIPSE" if tilted => {
                let kind = String::from_utf8_lossy(record.kind);
                drawing.warn(format!("{kind} out of the drawing's plane is left out"));
            }
            b"LWPOLYLINE" => {
                let mut vertices: Vec<Vertex> = Vec::new();
                for pair in &record.pairs {
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
                // Places and the greater radius are those of space, so mirrored is only the way round.
                let x = record.point(11, "a greater radius")?;
                let y = record.needed(40, "a ratio")? * DVec2::new(-x.y, x.x);
                let y = if mirrored { -y } else { y };
                let angles = [record.or(41, 0.0)?, record.or(42, TAU)?];
                self.ellipse(record.point(10, "a centre")?, x, y, angles, false)?;
            }
            b"SPLINE" => self.spline(record, drawing)?,
            other => {
                let kind = String::from_utf8_lossy(&other[..other.len().min(20)]).into_owned();
                drawing.warn(format!("{kind} is not read; a drawing's parts are its lines, arcs and curves"));
            }
        }
        Ok(())
    }

    fn push(&mut self, mut points: Vec<DVec2>, closed: bool, mirrored: bool) -> Result<(), MeshError> {
        self.n_points += points.len();
        if self.n_points > MAX_POINTS {
            return Err(MeshError::TooMany { what: "points", limit: MAX_POINTS as u64 });
        }
        if mirrored {
            points.iter_mut().for_each(|p| p.x = -p.x);
        }
        self.lines.push(Line { points, closed });
        Ok(())
    }

    fn tolerance(&self) -> f64 {
        self.options.tolerance_mm / self.mm()
    }

    /// An arc from an angle counter-clockwise to another, `x` and `y` its radii; a whole one closes.
    fn ellipse(
        &mut self,
        centre: DVec2,
        x: DVec2,
        y: DVec2,
        [from, to]: [f64; 2],
        mirrored: bool,
    ) -> Result<(), MeshError> {
        let turn = (to - from).rem_euclid(TAU);
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

    /// Straight sides and arcs.
    fn polygon(&mut self, vertices: &[Vertex], closed: bool, mirrored: bool) -> Result<(), MeshError> {
        let mut points = Vec::with_capacity(vertices.len());
        for (k, &(p, bulge)) in vertices.iter().enumerate() {
            points.push(p);
            let last = k + 1 == vertices.len();
            if bulge == 0.0 || (last && !closed) {
                continue;
            }
            let chord = vertices[(k + 1) % vertices.len()].0 - p;
            // From the middle of the side to the left lies the centre of an arc that turns left.
            let away = DVec2::new(-chord.y, chord.x) * ((1.0 - bulge * bulge) / (4.0 * bulge));
            let centre = p + 0.5 * chord + away;
            let (radius, turn) = (p.distance(centre), 4.0 * atan2(bulge, 1.0));
            if !radius.is_finite() || radius <= 0.0 {
                continue;
            }
            let start = atan2(p.y - centre.y, p.x - centre.x);
            let n = pieces(radius, turn.abs(), self.tolerance());
            let at = |i: usize| centre + radius * direction(start + turn * i as f64 / n as f64);
            points.extend((1..n).map(at));
            if points.len() > MAX_POINTS {
                return Err(MeshError::TooMany { what: "points", limit: MAX_POINTS as u64 });
            }
        }
        self.push(points, closed, mirrored)
    }

    fn spline(&mut self, record: &Record<'_>, drawing: &mut Drawing) -> Result<(), MeshError> {
        let degree = record.or(71, 3.0)?;
        let (knots, weights) = (record.numbers(40)?, record.numbers(41)?);
        let (xs, ys) = (record.numbers(10)?, record.numbers(20)?);
        let points: Vec<DVec2> = xs.iter().zip(&ys).map(|(x, y)| DVec2::new(*x, *y)).collect();
        if points.is_empty() {
            drawing.warn("a SPLINE given by points it passes alone is left out".into());
            return Ok(());
        }
        let problem = if !(1.0..=MAX_DEGREE as f64).contains(&degree) {
            Some(format!("a SPLINE of degree {degree}; 1 to {MAX_DEGREE} are read"))
        } else if xs.len() != ys.len()
            || knots.len() != points.len() + degree as usize + 1
            || points.len() <= degree as usize
        {
            let (n, m) = (points.len(), knots.len());
            Some(format!("a SPLINE of degree {degree} with {n} points and {m} knots: the numbers do not fit"))
        } else if !knots.is_sorted() || weights.iter().any(|w| *w <= 0.0) {
            Some("the knots of a SPLINE fall, or a weight is not positive".into())
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
        let room = MAX_POINTS.saturating_sub(self.n_points);
        let line =
            spline.points(room).ok_or(MeshError::TooMany { what: "points", limit: MAX_POINTS as u64 })?;
        self.push(line, false, false)
    }

    /// Joins lines to closed ones and hands all over, in mm.
    fn finish(self, mut drawing: Drawing) -> Result<Drawing, MeshError> {
        if self.options.unit.or(self.unit).is_none() {
            drawing.warn(
                "the drawing states no unit (or one that is not read); it is taken for mm (shape.unit says otherwise)".into(),
            );
        }
        let mm = self.mm();
        let mut seen = BTreeSet::new();
        let (mut all, mut open, mut twice) = (Vec::new(), Vec::new(), 0);
        for mut line in self.lines {
            line.points.iter_mut().for_each(|p| *p *= mm);
            line.points.dedup_by(|a, b| a.distance(*b) < 1e-9);
            let Some(key) = likeness(&line) else { continue };
            if !seen.insert(key) {
                twice += 1;
                continue;
            }
            let meets =
                line.points.len() > 2 && ends(&line.points)[0].distance(ends(&line.points)[1]) < JOINED_MM;
            if line.closed || meets {
                all.push(Line { closed: true, ..line })
            } else {
                open.push(line.points)
            }
        }
        if twice > 0 {
            drawing.warn(format!("{twice} lines that lie on others of the same shape were left out"));
        }
        all.extend(joined(open));
        drawing.add(all, None).map_err(|e| match e {
            MeshError::Invalid { problem, .. } => invalid("the drawing", problem),
            other => other,
        })?;
        Ok(drawing)
    }
}

fn ends(points: &[DVec2]) -> [DVec2; 2] {
    [points[0], points[points.len() - 1]]
}

/// Ends and bounds, rounded: the same for a line that was drawn twice, whichever way.
fn likeness(line: &Line) -> Option<[i64; 9]> {
    let bounds = Bounds2::of(line.points.iter().copied())?;
    let [a, b] = ends(&line.points);
    let round = |p: DVec2| [(p.x / SAME_MM).round() as i64, (p.y / SAME_MM).round() as i64];
    let (a, b, low, high) = (round(a), round(b), round(bounds.min), round(bounds.max));
    let (a, b) = if line.closed { (low, high) } else { (a.min(b), a.max(b)) };
    Some([a[0], a[1], b[0], b[1], low[0], low[1], high[0], high[1], i64::from(line.closed)])
}

/// Open lines joined at ends that meet; those that come back to where they began are closed.
fn joined(lines: Vec<Vec<DVec2>>) -> Vec<Line> {
    let cell = |p: DVec2| {
        let q = (p / (0.5 * JOINED_MM)).floor();
        (q.x as i64, q.y as i64)
    };
    // Ends by cell, those of the first lines last: twice the line's number, and one more for its last point.
    let mut at: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
    for (i, line) in lines.iter().enumerate().rev() {
        for (side, p) in ends(line).into_iter().enumerate() {
            at.entry(cell(p)).or_default().push(2 * i + side);
        }
    }
    // An end in the cell of `p` or, if there is none, in one beside it. What is used is looked at once, however many
    // lines meet in a point.
    let mut take = |p: DVec2, used: &[bool]| {
        let (x, y) = cell(p);
        let beside = [0, -1, 1].into_iter().flat_map(|j| [0, -1, 1].map(|i| (i, j)));
        for (i, j) in beside {
            let Some(ends) = at.get_mut(&(x.saturating_add(i), y.saturating_add(j))) else { continue };
            while ends.pop_if(|e| used[*e / 2]).is_some() {}
            if let Some(end) = ends.last() {
                return Some(*end);
            }
        }
        None
    };
    let mut used = vec![false; lines.len()];
    let mut out = Vec::new();
    for first in 0..lines.len() {
        if std::mem::replace(&mut used[first], true) {
            continue;
        }
        let mut points = lines[first].clone();
        let mut closed = false;
        // Onwards from its last point, then from its first.
        for _ in 0..2 {
            while !closed {
                let [start, end] = ends(&points);
                closed = points.len() > 2 && start.distance(end) <= JOINED_MM;
                if closed {
                    break;
                }
                let Some(next) = take(end, &used) else { break };
                used[next / 2] = true;
                let other = lines[next / 2].iter().copied();
                if next % 2 == 0 { points.extend(other.skip(1)) } else { points.extend(other.rev().skip(1)) }
            }
            points.reverse();
        }
        if closed {
            points.pop();
        }
        out.push(Line { points, closed });
    }
    out
}

/// A rational B-spline.
struct Spline<'a> {
    degree: usize,
    knots: &'a [f64],
    /// Weighted: x w, y w, w.
    control: &'a [[f64; 3]],
    tolerance: f64,
}

impl Spline<'_> {
    /// Points on it, pieces between them within the tolerance; `None` for more than `most`.
    fn points(&self, most: usize) -> Option<Vec<DVec2>> {
        let spans = self.degree..self.control.len();
        let mut out = vec![self.at(self.degree, self.knots[self.degree])];
        for span in spans.filter(|&s| self.knots[s] < self.knots[s + 1]) {
            let (a, b) = (self.knots[span], self.knots[span + 1]);
            // Four pieces first: the middle of an S lies on its chord.
            for k in 0..4 {
                let t = |k: usize| a + (b - a) * k as f64 / 4.0;
                let (from, to) = (t(k), t(k + 1));
                self.halve(
                    span,
                    [from, to],
                    [self.at(span, from), self.at(span, to)],
                    MAX_HALVINGS,
                    &mut out,
                );
            }
            if out.len() > most {
                return None;
            }
        }
        Some(out)
    }

    fn halve(&self, span: usize, [a, b]: [f64; 2], [p, q]: [DVec2; 2], depth: usize, out: &mut Vec<DVec2>) {
        let t = 0.5 * (a + b);
        let middle = self.at(span, t);
        if depth > 0 && middle.distance(p.midpoint(q)) > self.tolerance {
            self.halve(span, [a, t], [p, middle], depth - 1, out);
            self.halve(span, [t, b], [middle, q], depth - 1, out);
        } else {
            out.push(q);
        }
    }

    /// The point at a parameter between two knots (de Boor).
    fn at(&self, span: usize, t: f64) -> DVec2 {
        let p = self.degree;
        let mut d = [[0.0; 3]; MAX_DEGREE + 1];
        d[..=p].copy_from_slice(&self.control[span - p..=span]);
        for r in 1..=p {
            for j in (r..=p).rev() {
                let (low, high) = (self.knots[j + span - p], self.knots[j + 1 + span - r]);
                let share = if high > low { (t - low) / (high - low) } else { 0.0 };
                d[j] = std::array::from_fn(|c| d[j - 1][c] + share * (d[j][c] - d[j - 1][c]));
            }
        }
        DVec2::new(d[p][0], d[p][1]) / d[p][2]
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::outline::{Outline, parse_outline};

    const OPTIONS: OutlineOptions = OutlineOptions { unit: None, tolerance_mm: 0.002, even_odd: false };

    /// A file of these entities, each a word of codes and values.
    fn file(unit: &str, layers: &str, entities: &str) -> String {
        let lines = |text: &str| text.split_whitespace().map(|w| format!("{w}\n")).collect::<String>();
        format!(
            "999\nby hand\n{}{}{}{}",
            lines("0 SECTION 2 HEADER 9 $ACADVER 1 AC1015"),
            lines(unit),
            lines(&format!("0 ENDSEC 0 SECTION 2 TABLES 0 TABLE 2 LAYER {layers} 0 ENDTAB 0 ENDSEC")),
            lines(&format!("0 SECTION 2 ENTITIES {entities} 0 ENDSEC 0 EOF"))
        )
    }

    fn read(entities: &str) -> Result<Outline, String> {
        let text = file("9 $INSUNITS 70 4", "", entities);
        parse_outline(text.as_bytes(), &OPTIONS).map_err(|e| e.to_string())
    }

    fn area(entities: &str) -> f64 {
        read(entities).unwrap_or_else(|e| panic!("{entities}: {e}")).region.area_mm2()
    }

    const PLATE: &str = "0 LWPOLYLINE 8 0 90 4 70 1 10 0 20 0 10 40 20 0 10 40 20 30 10 0 20 30";

    #[test]
    fn every_kind_of_entity_has_its_area() {
        let knots = "40 0 40 0 40 0 40 1 40 1 40 2 40 2 40 3 40 3 40 4 40 4 40 4";
        // A circle of radius 5 as four rational arcs of second degree.
        let round = [(5, 0), (5, 5), (0, 5), (-5, 5), (-5, 0), (-5, -5), (0, -5), (5, -5), (5, 0)];
        let points: String = round.iter().map(|(x, y)| format!(" 10 {x} 20 {y} 30 0")).collect();
        let weights: String =
            (0..9).map(|k| format!(" 41 {}", if k % 2 == 0 { 1.0 } else { 0.5f64.sqrt() })).collect();
        let circle_of_splines = format!("0 SPLINE 70 12 71 2 72 12 73 9 {knots}{weights}{points}");
        for (entities, expect) in [
            (PLATE, 1200.0),
            ("0 CIRCLE 10 3 20 4 40 5", 25.0 * PI),
            ("0 CIRCLE 10 3 20 4 40 5 230 -1", 25.0 * PI),
            // A half disc, its sides drawn in opposite ways.
            ("0 ARC 10 0 20 0 40 6 50 0 51 180 0 LINE 10 6 20 0 11 -6 21 0", 18.0 * PI),
            ("0 ARC 10 0 20 0 40 6 50 270 51 90 0 LINE 10 0 20 6 11 0 21 -6", 18.0 * PI),
            // A slot: two straight sides and two half circles, once to the right and once to the left.
            ("0 LWPOLYLINE 70 1 10 0 20 0 10 20 20 0 42 1 10 20 20 10 10 0 20 10 42 1", 200.0 + 25.0 * PI),
            ("0 LWPOLYLINE 70 1 10 0 20 0 42 -1 10 0 20 10 10 20 20 10 42 -1 10 20 20 0", 200.0 + 25.0 * PI),
            // Mirrored as a whole: the same area.
            (
                "0 LWPOLYLINE 70 1 230 -1 10 0 20 0 10 20 20 0 42 1 10 20 20 10 10 0 20 10 42 1",
                200.0 + 25.0 * PI,
            ),
            // As release 12 has it; the point of a frame is not on the line.
            (
                "0 POLYLINE 8 0 66 1 70 1 0 VERTEX 10 0 20 0 0 VERTEX 10 9 20 9 70 16 0 VERTEX 10 10 20 0 42 0.41421356237 \
                 0 VERTEX 10 10 20 10 0 VERTEX 10 0 20 10 0 SEQEND",
                100.0 + 12.5 * PI - 25.0,
            ),
            ("0 ELLIPSE 10 1 20 2 11 6 21 8 40 0.5 41 0 42 6.283185307179586", 50.0 * PI),
            (
                "0 ELLIPSE 10 0 20 0 11 10 21 0 40 0.5 41 0 42 3.141592653589793 0 LINE 10 10 20 0 11 -10 21 0",
                25.0 * PI,
            ),
            (&circle_of_splines, 25.0 * PI),
            // A Bezier curve and its chord: 3/20 of its control polygon's product.
            (
                "0 SPLINE 70 8 71 3 40 0 40 0 40 0 40 0 40 1 40 1 40 1 40 1 10 0 20 0 10 0 20 20 10 20 20 20 10 20 20 0 \
                 0 LINE 10 0 20 0 11 20 21 0",
                0.6 * 400.0,
            ),
        ] {
            let found = area(entities);
            assert!((found / expect - 1.0).abs() < 2e-3, "{entities}: {found}, {expect} expected");
        }
    }

    #[test]
    fn loose_lines_are_joined_and_holes_cut() {
        // The sides of a square in any order and way, one end 4 um off; a hole; a centre line that bounds nothing.
        let square = "0 LINE 10 0 20 0 11 10 21 0 0 LINE 10 0 20 10 11 0 21 0 0 LINE 10 10 20 0.004 11 10 21 10 \
                      0 LINE 10 0 20 10 11 10 21 10";
        let hole = "0 CIRCLE 10 5 20 5 40 2";
        let axis = "0 LINE 10 -5 20 5 11 15 21 5";
        let outline = read(&format!("{square} {hole} {axis}")).expect("a plate");
        assert!((outline.region.area_mm2() - (100.0 - 4.0 * PI)).abs() < 0.03);
        assert_eq!(outline.region.polygons[0].holes.len(), 1);
        assert_eq!(outline.warnings, ["1 open lines without fill bound nothing and were left out"]);
        // Drawn twice they are there once.
        let outline = read(&format!("{square} {hole} {hole} {square}")).expect("a plate");
        assert!((outline.region.area_mm2() - (100.0 - 4.0 * PI)).abs() < 0.03);
        assert!(outline.warnings[0].starts_with("5 lines that lie on others"), "{:?}", outline.warnings);
    }

    #[test]
    fn places_and_units_are_those_of_the_file() {
        let shifted = "0 LINE 10 1 20 1 11 3 21 1 0 LINE 10 3 20 1 11 3 21 2 0 LINE 10 3 20 2 11 1 21 1";
        for (unit, factor, said) in [
            ("9 $INSUNITS 70 4", 1.0, 0),
            ("9 $INSUNITS 70 1", 25.4, 0),
            ("9 $INSUNITS 70 5", 10.0, 0),
            ("9 $INSUNITS 70 0", 1.0, 1),
            ("", 1.0, 1),
        ] {
            let outline = parse_outline(file(unit, "", shifted).as_bytes(), &OPTIONS).expect("a triangle");
            let b = outline.region.bounds().expect("area");
            assert!((b.min - DVec2::splat(factor)).length() < 1e-3, "{unit}: {b:?}");
            assert!((b.max - DVec2::new(3.0, 2.0) * factor).length() < 1e-3, "{unit}: {b:?}");
            assert_eq!(outline.warnings.len(), said, "{:?}", outline.warnings);
        }
        let inch = OutlineOptions { unit: Some(LengthUnit::Inch), ..OPTIONS };
        let outline = parse_outline(file("", "", shifted).as_bytes(), &inch).expect("a triangle");
        assert!((outline.region.area_mm2() - 645.16).abs() < 0.01 && outline.warnings.is_empty());
    }

    #[test]
    fn what_is_not_shown_is_not_there() {
        let layers = "0 LAYER 2 frozen 70 1 62 7 0 LAYER 2 off 70 0 62 -7 0 LAYER 2 on 70 0 62 7";
        let circle = |extra: &str| format!("0 CIRCLE {extra} 10 9 20 9 40 3 ");
        for (extra, there) in
            [("8 frozen", false), ("8 off", false), ("8 on", true), ("60 1", false), ("67 1", false)]
        {
            let text = file("9 $INSUNITS 70 4", layers, &format!("{PLATE} {}", circle(extra)));
            let outline = parse_outline(text.as_bytes(), &OPTIONS).expect("a plate");
            assert_eq!(outline.region.polygons[0].holes.len(), usize::from(there), "{extra}");
        }
        let outline = read(&format!("{PLATE} 0 TEXT 1 plate 0 INSERT 2 block 10 0 20 0")).expect("a plate");
        assert!(
            outline.warnings.len() == 2 && outline.warnings[1].starts_with("INSERT"),
            "{:?}",
            outline.warnings
        );
    }

    #[test]
    fn damage_is_named() {
        for (entities, expect) in [
            ("0 LINE 10 0 20 0 11 4", "LINE lacks an end (code 21)"),
            ("0 LINE 10 0 20 x 11 4 21 4", "found \"x\" where a number should be"),
            ("0 LINE 10 0 20 inf 11 4 21 4", "found \"inf\""),
            ("0 CIRCLE 10 0 20 0 40 1e9", "beyond"),
            ("0 SPLINE 71 3 40 0 40 1 10 0 20 0", "the numbers do not fit"),
            ("0 SPLINE 71 99 40 0 40 1 10 0 20 0", "degree 99"),
            ("0 LINE 10 0 20 0 11 4 21 4 x y", "where a group code should be"),
            ("0 LINE 10 0 20 0 11 4 21 4", "1 open lines"),
            ("0 INSERT 2 plate", "INSERT is not read"),
        ] {
            let found = read(entities).expect_err(expect);
            assert!(found.contains(expect) && !found.contains('\n'), "{found:?}, {expect:?} expected");
        }
        let whole = file("9 $INSUNITS 70 4", "", PLATE);
        let cut = &whole[..whole.len() - "0\nEOF\n".len()];
        let found = parse_outline(cut.as_bytes(), &OPTIONS).expect_err("cut").to_string();
        assert!(found.contains("ends in the middle"), "{found}");
        let found =
            parse_outline(b"AutoCAD Binary DXF\r\n\x1a\0\0\0", &OPTIONS).expect_err("binary").to_string();
        assert!(found.contains("binary DXF"), "{found}");
        // Ends of lines as other systems have them.
        for end in ["\r\n", "\r"] {
            assert!(parse_outline(whole.replace('\n', end).as_bytes(), &OPTIONS).is_ok());
        }
    }

    proptest::proptest! {
        #[test]
        fn any_entities_are_survived(
            kinds in proptest::collection::vec("LINE|ARC|CIRCLE|LWPOLYLINE|POLYLINE|VERTEX|ELLIPSE|SPLINE", 1..5),
            pairs in proptest::collection::vec((0usize..14, "-?[0-9]{1,3}|1e300|1e-300|x"), 0..40),
        ) {
            let codes = [10, 20, 11, 21, 40, 41, 42, 50, 51, 70, 71, 210, 230, 8];
            let mut text = String::new();
            for (k, kind) in kinds.iter().enumerate() {
                text += &format!(" 0 {kind}");
                for (code, value) in pairs.iter().skip(k) {
                    text += &format!(" {} {value}", codes[*code]);
                }
            }
            let _ = read(&text);
        }
    }
}
