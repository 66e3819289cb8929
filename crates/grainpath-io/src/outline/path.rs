//! SVG path data and other lists of numbers, curves cut into straight pieces.
//!
//! # Method
//! Source: SVG 1.1, chapter 8.3 and implementation notes F.6. All commands are read, absolute and
//! relative. Quadratic curves become cubic ones by degree elevation. A cubic is divided into equal steps
//! of its parameter, their number from a bound on its second derivative. Arcs given by their ends are
//! converted to a centre and angles, and divided so that each chord's sagitta stays within the tolerance.
//!
//! # Units, cost and limits
//! Coordinates and tolerance are in the path's own unit. The cost is linear in the chords. A cubic has at
//! most 1000 of them. Radii that are too small are scaled up, zero radii make straight lines, and arcs
//! without length are left out, as F.6 demands. Path data that do not begin with a move, and numbers
//! without a command, are errors with their place.

use grainpath_core::DVec2;
use grainpath_core::math::{acos, atan2, direction, sin_cos};
use grainpath_core::number::{Exponent, leading_number};

use super::drawing::{Line, MAX_POINTS, OutlineError, OutlineProblem, invalid};
use crate::text::TextError;

/// Reads numbers that are separated by space and commas, or by nothing where a sign or point begins the
/// next (`1-2.5.5`).
pub(super) struct Numbers<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Numbers<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { bytes: text.as_bytes(), at: 0 }
    }

    fn peek(&mut self) -> Option<u8> {
        while self.bytes.get(self.at).is_some_and(|b| b.is_ascii_whitespace() || *b == b',') {
            self.at += 1;
        }
        self.bytes.get(self.at).copied()
    }

    fn wrong(&self, expected: &'static str) -> TextError {
        let place = format!("character {}", self.at + 1);
        let rest = &self.bytes[self.at.min(self.bytes.len())..];
        match rest.first() {
            None => TextError::UnexpectedEnd { place, expected },
            Some(_) => {
                let end = rest.iter().position(|b| b.is_ascii_whitespace()).unwrap_or(rest.len()).min(20);
                let found = String::from_utf8_lossy(&rest[..end.max(1)]).into_owned();
                TextError::Syntax { place, found, expected }
            }
        }
    }

    /// Whether only separators are left.
    pub(super) fn is_done(&mut self) -> bool {
        self.peek().is_none()
    }

    pub(super) fn number(&mut self) -> Result<f64, TextError> {
        self.peek();
        let found = leading_number(&self.bytes[self.at..], Exponent::Allowed).filter(|(v, _)| v.is_finite());
        let (value, n_bytes) = found.ok_or_else(|| self.wrong("a number"))?;
        self.at += n_bytes;
        Ok(value)
    }

    pub(super) fn point(&mut self) -> Result<DVec2, TextError> {
        Ok(DVec2::new(self.number()?, self.number()?))
    }

    fn flag(&mut self) -> Result<bool, TextError> {
        let flag = match self.peek() {
            Some(b'0') => false,
            // Flags need no separator: `a1 1 0 01 2 2` is legal (SVG 1.1, section 8.3.9).
            Some(b'1') => true,
            _ => return Err(self.wrong("0 or 1")),
        };
        self.at += 1;
        Ok(flag)
    }
}

/// The lines of path data. Chords lie within `tolerance` of their curve, in the path's own unit.
pub(super) fn lines(data: &str, tolerance: f64) -> Result<Vec<Line>, OutlineError> {
    let mut words = Numbers::new(data);
    let mut pen =
        Pen { lines: Vec::new(), at: DVec2::ZERO, start: DVec2::ZERO, control: None, tolerance, n_points: 0 };
    let mut command = 0u8;
    while let Some(next) = words.peek() {
        if next.is_ascii_alphabetic() {
            command = next;
            words.at += 1;
        // Numbers that follow Z belong to no command.
        } else if command.eq_ignore_ascii_case(&b'z') {
            return Err(words.wrong("a command").into());
        }
        if pen.lines.is_empty() && !command.eq_ignore_ascii_case(&b'm') {
            let place = format!("character {}", words.at);
            return Err(invalid(place, OutlineProblem::NoMove));
        }
        pen.draw(command, &mut words)?;
        if pen.n_points > MAX_POINTS {
            return Err(OutlineError::TooManyPoints);
        }
        // Further pairs after a move are lines (SVG 1.1, section 8.3.2).
        command = match command {
            b'M' => b'L',
            b'm' => b'l',
            c => c,
        };
    }
    Ok(pen.lines)
}

struct Pen {
    lines: Vec<Line>,
    at: DVec2,
    /// The beginning of the current line, to which Z returns.
    start: DVec2,
    /// The last control point and whether its curve was cubic; the commands S and T mirror it.
    control: Option<(DVec2, bool)>,
    tolerance: f64,
    n_points: usize,
}

impl Pen {
    fn draw(&mut self, command: u8, words: &mut Numbers<'_>) -> Result<(), TextError> {
        let base = if command.is_ascii_lowercase() { self.at } else { DVec2::ZERO };
        // A control point is mirrored only if the curve comes directly before, so every command clears it.
        let (from, control) = (self.at, self.control.take());
        let mirrored = |cubic: bool| match control {
            // S after Q or T after C has no point to mirror and begins at the current point (section
            // 8.3.6).
            Some((c, kind)) if kind == cubic => 2.0 * from - c,
            _ => from,
        };
        match command.to_ascii_lowercase() {
            b'm' => {
                self.at = base + words.point()?;
                self.start = self.at;
                self.lines.push(Line { points: vec![self.at], closed: false });
            }
            b'z' => {
                if let Some(line) = self.lines.last_mut() {
                    line.closed = true;
                }
                self.at = self.start;
            }
            b'l' => self.line_to(base + words.point()?),
            b'h' => {
                let x = base.x + words.number()?;
                self.line_to(DVec2::new(x, from.y));
            }
            b'v' => {
                let y = base.y + words.number()?;
                self.line_to(DVec2::new(from.x, y));
            }
            b'c' => {
                let (a, b, to) = (words.point()?, words.point()?, words.point()?);
                self.cubic(base + a, base + b, base + to);
                self.control = Some((base + b, true));
            }
            b's' => {
                let (b, to) = (words.point()?, words.point()?);
                self.cubic(mirrored(true), base + b, base + to);
                self.control = Some((base + b, true));
            }
            b'q' => {
                let (c, to) = (words.point()?, words.point()?);
                self.quadratic(base + c, base + to);
            }
            b't' => {
                let to = words.point()?;
                self.quadratic(mirrored(false), base + to);
            }
            b'a' => {
                let (radii, turn) = (words.point()?, words.number()?);
                let (large, sweep) = (words.flag()?, words.flag()?);
                let to = base + words.point()?;
                self.arc(radii, turn.to_radians(), large, sweep, to);
            }
            _ => {
                words.at -= 1;
                return Err(words.wrong("a command"));
            }
        }
        Ok(())
    }

    fn line_to(&mut self, to: DVec2) {
        // After Z, a line begins anew where the last one began.
        if self.lines.last().is_none_or(|l| l.closed) {
            self.lines.push(Line { points: vec![self.at], closed: false });
        }
        if let Some(line) = self.lines.last_mut() {
            line.points.push(to);
        }
        self.n_points += 1;
        self.at = to;
    }

    fn quadratic(&mut self, control: DVec2, to: DVec2) {
        let from = self.at;
        // Degree elevation: the cubic with these control points is the same curve.
        self.cubic(from + 2.0 / 3.0 * (control - from), to + 2.0 / 3.0 * (control - to), to);
        self.control = Some((control, false));
    }

    fn cubic(&mut self, a: DVec2, b: DVec2, to: DVec2) {
        let from = self.at;
        // The second derivative of the cubic is at most 6 bend. A chord over 1/n of the parameter is then at most 6 bend /
        // (8 n^2) from the curve.
        let bend = (from - 2.0 * a + b).length().max((a - 2.0 * b + to).length());
        // 1000 chords bound the work on a curve of absurd size.
        let n = (0.75 * bend / self.tolerance).sqrt().ceil().clamp(1.0, 1000.0) as usize;
        for k in 1..n {
            let t = k as f64 / n as f64;
            let s = 1.0 - t;
            self.line_to(s * s * s * from + 3.0 * s * s * t * a + 3.0 * s * t * t * b + t * t * t * to);
        }
        self.line_to(to);
    }

    /// An arc given by its ends. Source: SVG 1.1, implementation notes F.6.
    fn arc(&mut self, radii: DVec2, turn: f64, large: bool, sweep: bool, to: DVec2) {
        let from = self.at;
        let mut radii = radii.abs();
        // F.6.2: an arc of no length is left out.
        if from == to {
            return;
        }
        // F.6.2: a zero radius makes it a straight line.
        if !radii.cmpgt(DVec2::ZERO).all() {
            return self.line_to(to);
        }
        let (sin, cos) = sin_cos(turn);
        let into = |p: DVec2| DVec2::new(cos * p.x + sin * p.y, cos * p.y - sin * p.x);
        let half = into(0.5 * (from - to));
        let excess = (half / radii).length_squared();
        // F.6.6: radii too small to reach are scaled up.
        if excess > 1.0 {
            radii *= excess.sqrt();
        }
        // From here on the ellipse is the unit circle.
        let h = half / radii;
        // F.6.5, step 2; `max` removes a negative square of rounding size.
        let away = (1.0 / h.length_squared() - 1.0).max(0.0).sqrt() * if large == sweep { -1.0 } else { 1.0 };
        let middle = away * DVec2::new(h.y, -h.x);
        let (first, last) = (h - middle, -h - middle);
        let begin = atan2(first.y, first.x);
        let mut angle = atan2(last.y, last.x) - begin;
        if sweep && angle < 0.0 {
            angle += std::f64::consts::TAU;
        } else if !sweep && angle > 0.0 {
            angle -= std::f64::consts::TAU;
        }
        let n = pieces(radii.max_element(), angle.abs(), self.tolerance);
        let centre = 0.5 * (from + to) + out(middle * radii, sin, cos);
        for k in 1..n {
            let p = direction(begin + angle * k as f64 / n as f64) * radii;
            self.line_to(centre + out(p, sin, cos));
        }
        // The given end point is used, not the computed one, so that lines meet exactly.
        self.line_to(to);
    }
}

fn out(p: DVec2, sin: f64, cos: f64) -> DVec2 {
    DVec2::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y)
}

/// Number of chords of an arc that lie within `tolerance` of it.
pub(super) fn pieces(radius: f64, angle: f64, tolerance: f64) -> usize {
    // The sagitta of a chord over the angle s is r (1 - cos(s/2)).
    let step = 2.0 * acos((1.0 - tolerance / radius).clamp(0.0, 1.0));
    (angle / step.max(1e-3)).ceil().clamp(1.0, 10_000.0) as usize
}

/// A whole ellipse as a closed line.
pub(super) fn ellipse(centre: DVec2, radii: DVec2, tolerance: f64) -> Line {
    // Eight chords at least: a tiny circle should not become a triangle.
    let n = pieces(radii.max_element(), std::f64::consts::TAU, tolerance).max(8);
    let point = |k: usize| centre + direction(std::f64::consts::TAU * k as f64 / n as f64) * radii;
    Line { points: (0..n).map(point).collect(), closed: true }
}
