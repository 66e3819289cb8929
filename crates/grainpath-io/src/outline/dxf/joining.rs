//! Joins separately drawn lines and arcs into closed lines.

use std::collections::BTreeMap;

use grainpath_core::{Bounds2, DVec2};

use crate::outline::drawing::{Line, SAME_MM};

/// Largest gap between the ends of lines and arcs that are joined, mm. Source: chosen. A smaller value leaves
/// contours open where coordinates are rounded; a larger one would close gaps that were drawn on purpose, such as
/// slots of a laser cut.
pub(super) const JOINED_MM: f64 = 0.01;

/// Of the free ends in a cell this number is looked at. Source: derived: a drawing has a few ends within 10 um of each
/// other; a file with thousands of them there would take time in proportion to their square.
const MOST_TRIED: usize = 64;

/// The first and the last point of a line.
pub(super) fn ends(points: &[DVec2]) -> [DVec2; 2] {
    [points[0], points[points.len() - 1]]
}

/// A key from the ends and bounds of a line, rounded to `SAME_MM`. Two copies of a line have equal keys, whatever their
/// direction.
pub(super) fn likeness(line: &Line) -> Option<[i64; 9]> {
    let bounds = Bounds2::around_points(line.points.iter().copied())?;
    let [a, b] = ends(&line.points);
    let round = |p: DVec2| [(p.x / SAME_MM).round() as i64, (p.y / SAME_MM).round() as i64];
    let (a, b, low, high) = (round(a), round(b), round(bounds.min), round(bounds.max));
    // A closed line may begin anywhere, so its bounds stand for its ends.
    let (a, b) = if line.closed { (low, high) } else { (a.min(b), a.max(b)) };
    Some([a[0], a[1], b[0], b[1], low[0], low[1], high[0], high[1], i64::from(line.closed)])
}

/// Joins open lines at ends that meet. Lines that return to their beginning are closed.
pub(super) fn joined(lines: Vec<Vec<DVec2>>) -> Vec<Line> {
    // Ends at most the joining distance from `p` lie in the cell of `p` or in one of the eight around it.
    let cell = |p: DVec2| {
        let q = (p / JOINED_MM).floor();
        (q.x as i64, q.y as i64)
    };
    // Ends by cell, in reverse order, so that the search from the back takes the first line first. An entry is
    // twice the line's index, plus one for its last point. This is a map, because cells of 10 um over a drawing of
    // metres are too many for the grids of `grainpath_core::buckets`, and because used ends are removed.
    let mut at: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
    for (i, line) in lines.iter().enumerate().rev() {
        for (side, p) in ends(line).into_iter().enumerate() {
            at.entry(cell(p)).or_default().push(2 * i + side);
        }
    }
    // Finds the nearest end within the joining distance; of equally near ones, that of the first line. Used ends
    // are removed when they are met, from among the last few of a cell, so removing one is cheap.
    let mut take = |p: DVec2, used: &[bool]| {
        let (x, y) = cell(p);
        let mut best: Option<(f64, usize)> = None;
        for (i, j) in (-1..=1).flat_map(|j| (-1..=1).map(move |i| (i, j))) {
            let Some(there) = at.get_mut(&(x.saturating_add(i), y.saturating_add(j))) else { continue };
            let (mut k, mut tried) = (there.len(), 0);
            while k > 0 && tried < MOST_TRIED {
                k -= 1;
                let end = there[k];
                if used[end / 2] {
                    there.remove(k);
                    continue;
                }
                tried += 1;
                let mm = ends(&lines[end / 2])[end % 2].distance(p);
                if mm <= JOINED_MM && best.is_none_or(|b| (mm, end) < b) {
                    best = Some((mm, end));
                }
            }
        }
        best.map(|(_, end)| end)
    };
    let mut used = vec![false; lines.len()];
    let mut out = Vec::new();
    for first in 0..lines.len() {
        if std::mem::replace(&mut used[first], true) {
            continue;
        }
        let mut points = lines[first].clone();
        let mut closed = false;
        // The line is extended from its last point, reversed, and extended from its former first point.
        // The second reversal restores its direction.
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
