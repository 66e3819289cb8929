//! Rational B-splines, divided into chords.
//!
//! # Method
//! Points come from de Boor's algorithm in homogeneous coordinates, which make the rational curve a
//! polynomial one; the division comes last. Each span between two knots begins with four pieces, because
//! the middle of an S lies on its chord and one piece would seem straight. A piece is halved until its
//! middle lies within the tolerance of its chord.
//!
//! # Units, cost and limits
//! Coordinates are in the unit of the drawing, as is the tolerance. The cost of a point is quadratic in the degree, which is
//! 15 at most. Halving ends after ten steps, even where a weight makes the curve turn so sharply that only rounding is left.
//! Repeated knots give spans of no length, which are skipped.

use grainpath_core::DVec2;

/// Limit on the degree. CAD programs write cubic and quintic splines; the bound keeps the table of de
/// Boor's algorithm on the stack. Source: chosen; files of real programs stay far below it.
pub(super) const MAX_DEGREE: usize = 15;
/// Limit on the halvings of a piece between two knots. Source: derived. 1024 chords for each of four quarters. It stops the
/// recursion where a weight makes the curve turn within a length that rounds to zero.
const MAX_HALVINGS: usize = 10;

/// A rational B-spline.
pub(super) struct Spline<'a> {
    pub(super) degree: usize,
    pub(super) knots: &'a [f64],
    /// Control points in homogeneous form: x w, y w, w.
    pub(super) control: &'a [[f64; 3]],
    pub(super) tolerance: f64,
}

impl Spline<'_> {
    /// Points on the curve whose chords lie within the tolerance; `None` for more than `most`.
    pub(super) fn points(&self, most: usize) -> Option<Vec<DVec2>> {
        let spans = self.degree..self.control.len();
        let mut out = vec![self.at(self.degree, self.knots[self.degree])];
        // Repeated knots leave spans of no length.
        for span in spans.filter(|&s| self.knots[s] < self.knots[s + 1]) {
            let (a, b) = (self.knots[span], self.knots[span + 1]);
            // Four pieces to begin with: the middle of an S lies on its chord, and one piece would seem
            // straight.
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
        // Homogeneous coordinates make the rational curve a polynomial one; the division comes last.
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
