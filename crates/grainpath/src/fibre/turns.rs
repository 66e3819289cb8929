//! How sharply a path turns, and rounding it to a least radius.
//!
//! A polyline stands for a curve: at a vertex that turns by `a` between pieces of length `p` and `q` the curve has
//! the radius `(p + q) / 4 / tan(a / 2)`, that of the circle which touches both pieces. Long pieces would make a sharp
//! corner look wide, so the circle may not leave the corner by more than [`CORNER_MM`].

use grainpath_core::math::{acos, atan2, cos, cross, direction, rotated, tan};
use grainpath_core::poly::simplify_line;
use grainpath_core::{Bounds2, DVec2};

/// Coordinates in G-code are rounded; vertices that lie so near to a straight line do not turn it, mm.
const ROUNDING_MM: f64 = 5e-3;
/// Vertices that lie so near to the line past them do not turn it at all, mm.
const STRAIGHT_MM: f64 = 1.5e-3;
/// A corner counts as the arc that stays within this of it, mm.
const CORNER_MM: f64 = 0.05;
/// Arcs of chords measure a little less than their circle.
const SHY: f64 = 0.98;
/// Arcs turn by no more than this, radians: where a path turns back there is no room to round it.
const MOST_RAD: f64 = 2.6;
/// Arcs are written in chords that lie so near to them, mm: longer ones than of other curves, so that rounding their
/// ends to micrometres does not bend them.
const CHORD_MM: f64 = 1e-2;
/// Arcs are a little wider than asked for, by what their chords and rounding take away.
const WIDER: f64 = 1.03;

/// A turn of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// The vertex.
    pub vertex: usize,
    /// Where it is, mm.
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
    let half = 0.5 * angle(a, b, c).abs();
    if half < 1e-9 {
        return f64::INFINITY;
    }
    let touching = 0.25 * (a.distance(b) + b.distance(c)) / tan(half).max(0.0);
    let near = CORNER_MM * cos(half) / (1.0 - cos(half));
    touching.min(near)
}

/// Every turn of a path whose radius is less than this, in order; a closed path does not repeat its first point.
pub fn sharp_turns(points: &[DVec2], closed: bool, least_mm: f64) -> Vec<Turn> {
    let all = turns(points, closed);
    all.into_iter().filter(|t| t.radius_mm < SHY * least_mm).collect()
}

/// Every turn of a path.
pub fn turns(points: &[DVec2], closed: bool) -> Vec<Turn> {
    let mut line = points.to_vec();
    if closed && !line.is_empty() {
        line.push(line[0]);
    }
    let kept = without_straight(simplify_line(&line, ROUNDING_MM));
    if kept.len() < 3 {
        return Vec::new();
    }
    let mut out = Vec::with_capacity(kept.len());
    let mut vertex = 0;
    for k in 0..kept.len() - 1 {
        // Kept points are some of the line's, in order.
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

/// A line without the vertices between which it goes straight, as where a move was divided: they would take from the
/// length that a turn has.
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

/// An open line whose turns below the radius are arcs of it, where such an arc ends on the line before and after,
/// stays `inside` and does not cross the line. Also how many arcs there are. Corners that are near each other become
/// one arc.
pub fn rounded(line: &[DVec2], least_mm: f64, inside: &dyn Fn(DVec2, DVec2) -> bool) -> (Vec<DVec2>, usize) {
    let line = simplify_line(line, ROUNDING_MM);
    let n = line.len();
    if n < 3 {
        return (line, 0);
    }
    let mut out = vec![line[0]];
    // Points before this one are the end of an arc already.
    let (mut floor, mut n_rounded) = (0, 0);
    let mut i = 1;
    while i + 1 < n {
        let last = out[out.len() - 1];
        if radius_mm(last, line[i], line[i + 1]) >= SHY * least_mm {
            out.push(line[i]);
            i += 1;
            continue;
        }
        match arc_around(&line, i, &out, floor, least_mm) {
            Some(arc) if free(&arc, &line, &out, inside) => {
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

/// An arc in place of some vertices.
struct Arc {
    points: Vec<DVec2>,
    /// How many points already laid it replaces.
    back: usize,
    /// The last vertex it replaces.
    last: usize,
}

/// The arc that rounds the corner at vertex `i`, which takes in more vertices on both sides until it fits.
fn arc_around(line: &[DVec2], i: usize, out: &[DVec2], floor: usize, least_mm: f64) -> Option<Arc> {
    let (mut back, mut hi) = (0, i);
    let mut turn = angle(out[out.len() - 1], line[i], line[i + 1]);
    loop {
        let before = out[out.len() - 1 - back];
        let first = if back == 0 { line[i] } else { out[out.len() - back] };
        let (last, after) = (line[hi], line[hi + 1]);
        if turn.abs() > MOST_RAD {
            return None;
        }
        let (u, v) = ((first - before).normalize_or_zero(), (after - last).normalize_or_zero());
        let sine = cross(u, v);
        let (mut grow_back, mut grow_on) = (true, true);
        if sine.abs() > 1e-6 && sine.signum() == turn.signum() {
            // Where the lines before and after meet.
            let d = last - first;
            let (alpha, beta) = (cross(d, v) / sine, cross(u, d) / sine);
            let half = tan(0.5 * turn.abs());
            let reach = (WIDER * least_mm * half).max(alpha).max(beta);
            grow_back = reach - alpha > before.distance(first);
            grow_on = reach - beta > last.distance(after);
            if !grow_back && !grow_on {
                let meet = first + alpha * u;
                let points = arc(meet - reach * u, u, turn, reach / half);
                return Some(Arc { points, back, last: hi });
            }
        }
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

/// Points of an arc from `start` along `u` that turns by `turn` with a radius.
fn arc(start: DVec2, u: DVec2, turn: f64, radius_mm: f64) -> Vec<DVec2> {
    let step = 2.0 * acos((1.0 - CHORD_MM / radius_mm).clamp(0.5, 1.0)).max(1e-3);
    let n = (turn.abs() / step).ceil().max(2.0);
    let normal = DVec2::new(-u.y, u.x) * turn.signum();
    let centre = start + radius_mm * normal;
    let from = start - centre;
    (0..=n as usize).map(|k| centre + rotated(from, direction(turn * k as f64 / n))).collect()
}

/// Whether an arc stays inside and meets the line nowhere but at its ends.
fn free(arc: &Arc, line: &[DVec2], out: &[DVec2], inside: &dyn Fn(DVec2, DVec2) -> bool) -> bool {
    let points = &arc.points;
    if !points.windows(2).all(|w| inside(w[0], w[1])) {
        return false;
    }
    let Some(around) = Bounds2::of(points.iter().copied()) else { return false };
    let meets = |a: DVec2, b: DVec2| {
        let near = Bounds2 { min: a.min(b), max: a.max(b) }.meets(around);
        near && points.windows(2).any(|w| crosses(a, b, w[0], w[1]))
    };
    // What stays of the line: before the piece the arc begins on, and after the one it ends on.
    let kept = out.len() - arc.back;
    let before = out[..kept].windows(2);
    let after = line[arc.last + 1..].windows(2);
    !before.chain(after).any(|w| meets(w[0], w[1]))
}

fn crosses(a: DVec2, b: DVec2, p: DVec2, q: DVec2) -> bool {
    let side = |a: DVec2, b: DVec2, p: DVec2| cross(b - a, p - a);
    side(a, b, p) * side(a, b, q) < 0.0 && side(p, q, a) * side(p, q, b) < 0.0
}
