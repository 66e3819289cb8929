//! Dense fill of one bead width along a field.
//!
//! With `fill.widths = "constant"` all beads have one width. They cannot widen where the field diverges or
//! narrow where it converges, so lines have to end. Whether one more bead fits between two others follows
//! from the distance `d` of their centrelines in spacings: without it `d - 1` of a bead stays open, with it
//! `2 - d` of a bead is laid twice. Both are equal at `d` = 1.5; the additional bead then has half of that,
//! [`LEAST_ROOM`], as its own space.
//!
//! ```text
//!    ------------------------------- bead
//!            ======================= new bead: it begins where the two are 1.5 spacings apart
//!    ------------------------------- bead
//! ```
//!
//! The lines are those of the phase ([`super::phase`]). The following steps replace the centring and
//! widening of beads. They are this project's own; only the idea that lines a bead apart end for lack of
//! space is from `Jobard1997`:
//!
//! 1. the phase keeps to one spacing, without the drift that beads of any width allow;
//! 2. a line is cut where it deviates from the field by more than [`FARTHEST_RAD`]: there the phase has
//!    joined the ends of two lines;
//! 3. stretches of lines with less space than [`LEAST_ROOM`] are removed;
//! 4. lines that end inside the region are extended along the field as long as they have that much space
//!    ([`drawn_on`]);
//! 5. a gap that then remains gets a bead too if it is at least half a bead wide.
//!
//! Lengths are in mm. Cost: linear in the length of all lines; each step of an extension looks at the
//! neighbours in a few cells. Limits: on a field that diverges like that of a radial disk of 50 beads,
//! about 4 % of the area stays open and 4 % is laid twice.

use grainpath_core::buckets::PointGrid2;
use grainpath_core::poly::LineClipper;
use grainpath_core::polyline::length_mm;
use grainpath_core::{Bounds2, DVec2, Region};

use super::widths::{CELL_BEADS, FAR_BEADS, Line, Neighbours, OWN_SEGMENTS, stretches_along};

/// The least space of a line, in spacings: half of the distance between its two neighbours. Source:
/// derived, see the head of this file.
const LEAST_ROOM: f64 = 0.75;
/// The narrowest gap that gets a bead, in beads. Source: derived as [`LEAST_ROOM`]: a bead in such a gap
/// overlaps others by as much as it fills.
pub(super) const LEAST_GAP: f64 = 0.5;
/// A line is cut where it deviates from the field by more than this. Source: measured on a radial disk.
/// With 45 degrees the round turns of lines that go back would stay: the mean deviation is 3.2 degrees
/// instead of 3.0, with the same gaps.
const FARTHEST_RAD: f64 = std::f64::consts::FRAC_PI_6;
/// Length of a step by which an end is extended, in spacings. Source: derived. The end is then misplaced by
/// an eighth of a bead on average.
const STEP: f64 = 0.25;
/// An end is extended by at most this number of steps. Source: derived. Within ten beads a line can only
/// return to itself on a circle three beads wide, on which no bead is laid.
const MAX_STEPS: usize = 40;
/// Least distance of two extended lines side by side, in spacings. Source: derived as [`LEAST_ROOM`]:
/// closer lines would overlap by more than half.
const LEAST_APART: f64 = 0.5;

/// Turns lines of the phase into centrelines of beads of one width. Pieces shorter than `shortest_mm` are
/// dropped.
pub(super) fn packed(
    lines: Vec<Line>,
    inside: &LineClipper,
    border: &Region,
    axis: &dyn Fn(DVec2) -> DVec2,
    spacing_mm: f64,
    shortest_mm: f64,
) -> Vec<Line> {
    let along = |line| stretches_along(line, axis, FARTHEST_RAD, shortest_mm);
    let lines = lines.into_iter().flat_map(along).collect();
    let mut lines = without_crowded(lines, border, spacing_mm, shortest_mm);
    let neighbours = Neighbours::new(&lines, border, CELL_BEADS * spacing_mm);
    drawn_on(&mut lines, &neighbours, inside, axis, spacing_mm);
    lines
}

/// Keeps the stretches of lines that have at least [`LEAST_ROOM`].
fn without_crowded(lines: Vec<Line>, border: &Region, spacing_mm: f64, shortest_mm: f64) -> Vec<Line> {
    let neighbours = Neighbours::new(&lines, border, CELL_BEADS * spacing_mm);
    let strips = neighbours.strips(&lines, spacing_mm);
    let crowded = |width: &f64| *width < LEAST_ROOM * spacing_mm;
    let mut kept = Vec::with_capacity(lines.len());
    // All crowded stretches are removed at once, even if two of them lie side by side. The ends that remain
    // are then extended into the free space.
    for (line, widths) in lines.into_iter().zip(strips) {
        if !widths.iter().any(crowded) {
            kept.push(line);
            continue;
        }
        let points = line.points.iter().zip(&widths);
        let stretches = points.collect::<Vec<_>>();
        for stretch in stretches.split(|(_, width)| crowded(width)) {
            let points: Vec<DVec2> = stretch.iter().map(|(p, _)| **p).collect();
            if length_mm(&points, false) > shortest_mm {
                kept.push(Line { points, closed: false });
            }
        }
    }
    kept
}

/// Extends the ends of lines along the field, up to the border of the region or to where the space between
/// the neighbours is less than [`LEAST_ROOM`].
fn drawn_on(
    lines: &mut [Line],
    neighbours: &Neighbours,
    inside: &LineClipper,
    axis: &dyn Fn(DVec2) -> DVec2,
    spacing_mm: f64,
) {
    let points = lines.iter().flat_map(|l| l.points.iter().copied());
    let Some(bounds) = Bounds2::around_points(points) else { return };
    // Ends of lines and the points added to them, which `neighbours` does not contain: for each point its
    // line, and whether it is an original end.
    let mut added = PointGrid2::new(bounds, spacing_mm);
    for (l, line) in lines.iter().enumerate().filter(|l| !l.1.closed) {
        let ends = line.points.first().into_iter().chain(line.points.last());
        ends.for_each(|&p| added.insert(p, (l, true)));
    }
    // Ends are extended one by one in the order of the lines, so the result does not depend on threads.
    for l in 0..lines.len() {
        if lines[l].closed || lines[l].points.len() < 2 {
            continue;
        }
        for at_start in [true, false] {
            let end = End { lines, line: l, at_start, neighbours, inside, axis, spacing_mm };
            let more = end.drawn_on(&added);
            more.iter().for_each(|&p| added.insert(p, (l, false)));
            if at_start {
                lines[l].points.splice(0..0, more.into_iter().rev());
            } else {
                lines[l].points.extend(more);
            }
        }
    }
}

/// One end of an open line.
struct End<'a> {
    lines: &'a [Line],
    line: usize,
    at_start: bool,
    neighbours: &'a Neighbours,
    inside: &'a LineClipper,
    axis: &'a dyn Fn(DVec2) -> DVec2,
    spacing_mm: f64,
}

impl End<'_> {
    /// The points by which the end is extended.
    fn drawn_on(&self, added: &PointGrid2<(usize, bool)>) -> Vec<DVec2> {
        let points = &self.lines[self.line].points;
        let n = points.len();
        let (mut at, before) =
            if self.at_start { (points[0], points[1]) } else { (points[n - 1], points[n - 2]) };
        let mut heading = (at - before).normalize_or(DVec2::X);
        let step = STEP * self.spacing_mm;
        let mut out = Vec::new();
        for _ in 0..MAX_STEPS {
            let axis = (self.axis)(at);
            let along = if axis.dot(heading) < 0.0 { -axis } else { axis };
            let next = at + step * along;
            // Around a singular point the field turns faster than a bead can follow.
            let turns = along.dot(heading) < std::f64::consts::FRAC_1_SQRT_2;
            if turns || self.meets_line(at, along, step) || self.crowds(next, added) {
                break;
            }
            if let Some(border) = self.inside.crossings(at, next).first() {
                out.push(at.lerp(next, border.t));
                break;
            }
            if !self.inside.contains(next) || self.room(next, along) < LEAST_ROOM * self.spacing_mm {
                break;
            }
            out.push(next);
            (at, heading) = (next, along);
        }
        out
    }

    /// Whether another line lies across the way directly ahead.
    fn meets_line(&self, at: DVec2, along: DVec2, step_mm: f64) -> bool {
        let reach_mm = step_mm + 0.5 * self.spacing_mm;
        self.neighbours
            .hit(at, along, reach_mm, |l, s| self.is_own(l, s))
            .is_some_and(|hit| hit.line.is_some())
    }

    /// Whether a point is too near to the end of another line, or to an extension of one.
    fn crowds(&self, p: DVec2, added: &PointGrid2<(usize, bool)>) -> bool {
        let apart_mm = LEAST_APART * self.spacing_mm;
        added.within(p, apart_mm).any(|(q, (line, is_end))| {
            // Two lines whose ends face each other may come as near as a step.
            line != self.line && (!is_end || q.distance(p) < STEP * self.spacing_mm)
        })
    }

    /// The space between the neighbours of a point, mm: on each side half of the distance to a line, or the
    /// whole distance to the border, or half a spacing where nothing is near.
    fn room(&self, p: DVec2, along: DVec2) -> f64 {
        let left = DVec2::new(-along.y, along.x);
        let side = |way: DVec2| {
            let hit =
                self.neighbours.hit(p, way, FAR_BEADS.value() * self.spacing_mm, |l, s| self.is_own(l, s));
            hit.map_or(0.5 * self.spacing_mm, |hit| {
                if hit.line.is_some() { 0.5 * hit.distance_mm } else { hit.distance_mm }
            })
        };
        side(left) + side(-left)
    }

    /// Whether a segment is one of the last [`OWN_SEGMENTS`] before this end.
    fn is_own(&self, line: usize, segment: usize) -> bool {
        line == self.line
            && if self.at_start {
                segment < OWN_SEGMENTS
            } else {
                segment + OWN_SEGMENTS >= self.lines[line].n_segments()
            }
    }
}
