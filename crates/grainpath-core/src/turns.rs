//! Measures the radii of a path's turns, and rounds turns that are sharper than a least radius.
//!
//! A polyline stands for a curve. At a vertex that turns by `a` between two segments of length `p` and `q`,
//! the curve has the radius `(p + q) / 4 / tan(a / 2)`: the circle of this radius touches both segments.
//! With long segments the circle would make a sharp corner look wide, so it may not leave the corner by
//! more than `CORNER_MM`.

use crate::math::{acos, atan2, cos, cross, direction, rotated, tan};
use crate::poly::simplify_line;
use crate::{Bounds2, DVec2};

/// A vertex nearer than this to a straight line does not count as a turn, mm. Source: derived. Coordinates
/// in G-code are rounded to 0.001 mm, so both ends and the vertex move by up to 0.0007 mm each.
const ROUNDING_MM: f64 = 5e-3;
/// Vertices nearer than this to the line between their neighbours are left out, mm. Source:
/// derived: coordinates with three decimals move a point by at most 0.71 um, so a vertex of a
/// straight line lies at most 1.41 um off.
const STRAIGHT_MM: f64 = 1.5e-3;
/// Greatest distance between a corner and the arc by which its radius is measured, mm.
const CORNER_MM: f64 = 0.05;
/// A turn is sharp if its radius is below this share of the least radius. Source: derived: a turn written
/// as chords within `CHORD_MM` of its circle measures smaller by that amount, which is 2 % at a radius of
/// 0.5 mm and less at larger radii.
const SHY: f64 = 0.98;
/// Greatest turn of an arc, radians. A path that turns back on itself has no space for an arc.
const MOST_RAD: f64 = 2.6;
/// Greatest distance of an arc from its chords, mm. It is larger than for other curves, because
/// short chords would bend visibly once their ends are rounded to micrometres.
/// Source: derived. A chord of 1 mm that is off by 0.01 mm turns by 2 degrees.
const CHORD_MM: f64 = 1e-2;
/// Arcs are laid with this multiple of the least radius. Source: derived: chords reduce the measured radius
/// by `CHORD_MM`, so 3 % more is enough for radii from 0.33 mm on.
const WIDER: f64 = 1.03;

/// The search for a radius that fits multiplies it by this factor in each step. Source: derived; bisection
/// then refines between the last two radii.
const SMALLER: f64 = 0.75;
/// Smallest radius for which an arc is laid, mm. Source: derived: a smaller arc lies within `CORNER_MM` of
/// a right-angled corner, so its measured radius is the same as the corner's.
pub const SMALLEST_MM: f64 = 0.12;

/// A turn of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// The vertex.
    pub vertex: usize,
    /// Its position, mm.
    pub at: DVec2,
    /// Its radius, mm.
    pub radius_mm: f64,
}

/// The angle by which a line turns at `b`, radians, positive to the left.
fn angle(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let (u, v) = (b - a, c - b);
    atan2(cross(u, v), u.dot(v))
}

/// Radius of the turn at `b`, mm; infinite where it goes straight.
fn radius_mm(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    // A straight line has no radius; a half angle this small is only a rounding error of the arctangent.
    let half = 0.5 * angle(a, b, c).abs();
    if half < 1e-9 {
        return f64::INFINITY;
    }
    // Two estimates: the circle that touches both segments at their middles, and the circle that comes
    // within `CORNER_MM` of the vertex. Long segments make the first one too large.
    let touching = 0.25 * (a.distance(b) + b.distance(c)) / tan(half).max(0.0);
    let near = CORNER_MM * cos(half) / (1.0 - cos(half));
    touching.min(near)
}

/// All turns of a path with a radius below `least_mm`, in order. The points of a closed path do not repeat
/// the first point at the end.
pub fn sharp_turns(points: &[DVec2], closed: bool, least_mm: f64) -> Vec<Turn> {
    let all = turns(points, closed);
    all.into_iter().filter(|t| t.radius_mm < SHY * least_mm).collect()
}

/// All turns of a path with a radius below `least_mm`, in order. Neighbouring vertices within that distance
/// that bend to the same side count as one turn, for example the two corners of a hairpin or the chords of
/// an arc. The sharpest of the vertices is returned.
pub fn sharp_bends(points: &[DVec2], closed: bool, least_mm: f64) -> Vec<Turn> {
    let all = turns(points, closed);
    let n = points.len();
    let side = |t: &Turn| {
        let (a, b) = (points[(t.vertex + n - 1) % n], points[(t.vertex + 1) % n]);
        cross(t.at - a, b - t.at).signum()
    };
    let mut out: Vec<Turn> = Vec::new();
    // The last vertex that is sharp.
    let mut before: Option<Turn> = None;
    for turn in all.into_iter().filter(|turn| turn.radius_mm < SHY * least_mm) {
        let joins = |b: &Turn| b.at.distance(turn.at) <= least_mm && side(b) == side(&turn);
        match out.last_mut().filter(|_| before.as_ref().is_some_and(joins)) {
            Some(bend) if turn.radius_mm < bend.radius_mm => *bend = turn,
            Some(_) => {}
            None => out.push(turn),
        }
        before = Some(turn);
    }
    out
}

/// Every turn of a path.
pub fn turns(points: &[DVec2], closed: bool) -> Vec<Turn> {
    let mut line = points.to_vec();
    if closed && !line.is_empty() {
        line.push(line[0]);
    }
    // The vertices of divided moves go first, since the line that is simplified could keep one of them instead of the end of a
    // chord beside it.
    let kept = without_straight(simplify_line(&without_straight(line.clone()), ROUNDING_MM));
    if kept.len() < 3 {
        return Vec::new();
    }
    let mut out = Vec::with_capacity(kept.len());
    let mut vertex = 0;
    for k in 0..kept.len() - 1 {
        // The kept points are a subsequence of the line's points.
        vertex += line[vertex..].iter().position(|p| *p == kept[k]).unwrap_or(0);
        let before = match k {
            0 if !closed => continue,
            0 => kept[kept.len() - 2],
            _ => kept[k - 1],
        };
        out.push(Turn { vertex, at: kept[k], radius_mm: radius_mm(before, kept[k], kept[k + 1]) });
        vertex += 1;
    }
    out
}

/// Removes the vertices at which a line goes straight on, for instance where a move was divided. Such
/// vertices would shorten the segments from which a turn's radius is measured.
fn without_straight(line: Vec<DVec2>) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = Vec::with_capacity(line.len());
    for (k, &p) in line.iter().enumerate() {
        let straight = match (out.last(), line.get(k + 1)) {
            (Some(&before), Some(&after)) => {
                let way = (after - before).normalize_or_zero();
                cross(way, p - before).abs() < STRAIGHT_MM
                    && way.dot(p - before) > 0.0
                    && way.dot(after - p) > 0.0
            }
            _ => false,
        };
        if !straight {
            out.push(p);
        }
    }
    out
}

/// Replaces the turns of an open line that are below the least radius by arcs, and returns the number of
/// arcs too. A turn becomes an arc only if the arc begins and ends on the line, stays `inside` and does not
/// cross the line. Corners near each other share one arc. If an arc of the least radius does not fit, the
/// largest that fits is taken, down to `smallest_mm`.
pub fn rounded(
    line: &[DVec2],
    least_mm: f64,
    smallest_mm: f64,
    inside: &dyn Fn(DVec2, DVec2) -> bool,
) -> (Vec<DVec2>, usize) {
    let line = simplify_line(line, ROUNDING_MM);
    let n = line.len();
    if n < 3 {
        return (line, 0);
    }
    let mut out = vec![line[0]];
    // Points before this index belong to an arc already.
    let (mut floor, mut n_rounded) = (0, 0);
    let mut i = 1;
    while i + 1 < n {
        let last = out[out.len() - 1];
        let own_mm = radius_mm(last, line[i], line[i + 1]);
        if own_mm >= SHY * least_mm {
            out.push(line[i]);
            i += 1;
            continue;
        }
        let fits =
            |r_mm: f64| arc_around(&line, i, &out, floor, r_mm).filter(|arc| free(arc, &line, &out, inside));
        match largest(least_mm, smallest_mm.max(own_mm), &fits) {
            Some(arc) => {
                out.truncate(out.len() - arc.back);
                out.extend(arc.points);
                floor = out.len() - 1;
                n_rounded += 1;
                i = arc.last + 1;
            }
            _ => {
                out.push(line[i]);
                i += 1;
            }
        }
    }
    out.push(line[n - 1]);
    out.dedup_by(|a, b| a.distance_squared(*b) < 1e-12);
    (out, n_rounded)
}

/// The arc of the largest radius that fits, between `smallest_mm` and `least_mm`.
fn largest(least_mm: f64, smallest_mm: f64, fits: &dyn Fn(f64) -> Option<Arc>) -> Option<Arc> {
    if let Some(arc) = fits(least_mm) {
        return Some(arc);
    }
    let (mut low, mut high, mut found) = (0.0, least_mm, None);
    while found.is_none() {
        low = SMALLER * high;
        if low < smallest_mm {
            return None;
        }
        found = fits(low);
        if found.is_none() {
            high = low;
        }
    }
    // Four bisections find the radius to 2 %, which is less than the loss by the chords.
    for _ in 0..4 {
        let middle = 0.5 * (low + high);
        match fits(middle) {
            Some(arc) => (low, found) = (middle, Some(arc)),
            None => high = middle,
        }
    }
    found
}

/// An arc that replaces some vertices of the line.
struct Arc {
    points: Vec<DVec2>,
    /// How many of the points already laid the arc replaces.
    back: usize,
    /// The last vertex of the line that the arc replaces.
    last: usize,
}

/// The arc that rounds the corner at vertex `i`. Vertices on both sides are added to the corner until the
/// arc fits.
fn arc_around(line: &[DVec2], i: usize, out: &[DVec2], floor: usize, least_mm: f64) -> Option<Arc> {
    let (mut back, mut hi) = (0, i);
    let mut turn = angle(out[out.len() - 1], line[i], line[i + 1]);
    loop {
        let before = out[out.len() - 1 - back];
        let first = if back == 0 { line[i] } else { out[out.len() - back] };
        let (last, after) = (line[hi], line[hi + 1]);
        // The turn is checked in every round, because it grows with each vertex added.
        if turn.abs() > MOST_RAD {
            return None;
        }
        let (u, v) = ((first - before).normalize_or_zero(), (after - last).normalize_or_zero());
        let sine = cross(u, v);
        let (mut grow_back, mut grow_on) = (true, true);
        if sine.abs() > 1e-6 && sine.signum() == turn.signum() {
            // Distances to the point at which the lines before and after meet.
            let d = last - first;
            let (alpha, beta) = (cross(d, v) / sine, cross(u, d) / sine);
            let half = tan(0.5 * turn.abs());
            // The tangent length of the arc, or more if the replaced vertices lie farther from the meeting
            // point.
            let reach = (WIDER * least_mm * half).max(alpha).max(beta);
            grow_back = reach - alpha > before.distance(first);
            // A sharp corner ahead that turns to the same side needs a share of the segment between the two
            // corners for its own arc.
            let share = line.get(hi + 2).map_or(0.0, |&p| {
                let next = angle(last, after, p);
                let alike = next.signum() == turn.signum() && next.abs() < MOST_RAD;
                let sharp = radius_mm(last, after, p) < SHY * least_mm;
                if alike && sharp { least_mm * tan(0.5 * next.abs()) } else { 0.0 }
            });
            grow_on = reach - beta + share > last.distance(after);
            if !grow_back && !grow_on {
                let meet = first + alpha * u;
                let points = arc(meet - reach * u, u, turn, reach / half);
                return Some(Arc { points, back, last: hi });
            }
        }
        // The search has run into an earlier arc or the end of the line: this corner stays sharp
        // and is reported.
        if (grow_back && out.len() - 1 - back <= floor) || (grow_on && hi + 2 >= line.len()) {
            return None;
        }
        if grow_back {
            back += 1;
            let first = out[out.len() - back];
            let next = if back == 1 { line[i] } else { out[out.len() - back + 1] };
            turn += angle(out[out.len() - 1 - back], first, next);
        }
        if grow_on {
            hi += 1;
            turn += angle(line[hi - 1], line[hi], line[hi + 1]);
        }
    }
}

/// Points of an arc that begins at `start` along `u` and turns by `turn` radians at this radius.
fn arc(start: DVec2, u: DVec2, turn: f64, radius_mm: f64) -> Vec<DVec2> {
    let step = 2.0 * acos((1.0 - CHORD_MM / radius_mm).clamp(0.5, 1.0)).max(1e-3);
    let n = (turn.abs() / step).ceil().max(2.0);
    let normal = DVec2::new(-u.y, u.x) * turn.signum();
    let centre = start + radius_mm * normal;
    let from = start - centre;
    (0..=n as usize).map(|k| centre + rotated(from, direction(turn * k as f64 / n))).collect()
}

/// Whether an arc stays inside and meets the line only at the arc's ends.
fn free(arc: &Arc, line: &[DVec2], out: &[DVec2], inside: &dyn Fn(DVec2, DVec2) -> bool) -> bool {
    let points = &arc.points;
    if !points.windows(2).all(|w| inside(w[0], w[1])) {
        return false;
    }
    let Some(around) = Bounds2::around_points(points.iter().copied()) else { return false };
    let meets = |a: DVec2, b: DVec2| {
        let near = Bounds2 { min: a.min(b), max: a.max(b) }.meets(around);
        near && points.windows(2).any(|w| crosses(a, b, w[0], w[1]))
    };
    // The parts of the line that remain: the segments before the one on which the arc begins, and the
    // segments after the one on which it ends.
    let kept = out.len() - arc.back;
    let before = out[..kept].windows(2);
    let after = line[arc.last + 1..].windows(2);
    !before.chain(after).any(|w| meets(w[0], w[1]))
}

fn crosses(a: DVec2, b: DVec2, p: DVec2, q: DVec2) -> bool {
    let side = |a: DVec2, b: DVec2, p: DVec2| cross(b - a, p - a);
    side(a, b, p) * side(a, b, q) < 0.0 && side(p, q, a) * side(p, q, b) < 0.0
}
