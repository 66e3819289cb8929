//! Radii of a path's turns, and rounding turns to a least radius.
//!
//! A polyline stands for a curve: at a vertex that turns by `a` between pieces of length `p` and
//! `q` the curve has the radius `(p + q) / 4 / tan(a / 2)`, that of the circle which touches both
//! pieces. Long pieces would make a sharp corner look wide, so the circle may not leave the corner
//! by more than [`CORNER_MM`].

use grainpath_core::math::{acos, atan2, cos, cross, direction, rotated, tan};
use grainpath_core::poly::simplify_line;
use grainpath_core::{Bounds2, DVec2};

/// Vertices nearer than this to a straight line do not turn it, mm. Source: derived. Coordinates in
/// G-code are rounded to 0.001 mm, so both ends and the vertex move by up to 0.0007 mm each.
const ROUNDING_MM: f64 = 5e-3;
/// Vertices nearer than this to the line between their neighbours are left out, mm. Source:
/// derived: coordinates with three decimals move a point by at most 0.71 um, so a vertex of a
/// straight line lies at most 1.41 um off.
const STRAIGHT_MM: f64 = 1.5e-3;
/// The arc that stands for a corner stays this near to it, mm.
const CORNER_MM: f64 = 0.05;
/// Share of the least radius that a turn must reach. Source: derived: a turn written in chords
/// within `CHORD_MM` of its circle measures that much less, which is 2 % at a radius of 0.5 mm and
/// less beyond.
const SHY: f64 = 0.98;
/// Greatest turn of an arc, radians. A path that turns back on itself has no space for an arc.
const MOST_RAD: f64 = 2.6;
/// Greatest distance of an arc from its chords, mm. It is larger than for other curves, because
/// short chords would bend visibly once their ends are rounded to micrometres.
/// Source: derived. A chord of 1 mm that is off by 0.01 mm turns by 2 degrees.
const CHORD_MM: f64 = 1e-2;
/// Arcs get this multiple of the least radius. Source: derived: chords take away `CHORD_MM`, so 3 %
/// are enough for radii from 0.33 mm on.
const WIDER: f64 = 1.03;

/// Radii are tried from the one asked for downwards by this factor. Source: derived; between two of
/// them the radius is halved into.
const SMALLER: f64 = 0.75;
/// Arcs below this radius are not worth their vertices, mm. Source: derived: such an arc leaves a
/// right-angled corner by `CORNER_MM`, so it measures as the corner does.
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
    // A straight line has no radius; half of a turn below this is rounding of the arctangent.
    let half = 0.5 * angle(a, b, c).abs();
    if half < 1e-9 {
        return f64::INFINITY;
    }
    // Two estimates: the circle that touches both pieces at their middles, and the circle that
    // comes within `CORNER_MM` of the vertex. Long pieces make the first one too large.
    let touching = 0.25 * (a.distance(b) + b.distance(c)) / tan(half).max(0.0);
    let near = CORNER_MM * cos(half) / (1.0 - cos(half));
    touching.min(near)
}

/// Every turn of a path whose radius is less than this, in order; a closed path does not repeat its
/// first point.
pub fn sharp_turns(points: &[DVec2], closed: bool, least_mm: f64) -> Vec<Turn> {
    let all = turns(points, closed);
    all.into_iter().filter(|t| t.radius_mm < SHY * least_mm).collect()
}

/// Every turn of a path below this radius, in order. Neighbouring vertices that bend the same way
/// within that radius are one turn, such as the two corners of a hairpin or the chords of an arc;
/// the sharpest stands for it.
pub fn sharp_bends(points: &[DVec2], closed: bool, least_mm: f64) -> Vec<Turn> {
    let all = turns(points, closed);
    let n = points.len();
    let side = |t: &Turn| {
        let (a, b) = (points[(t.vertex + n - 1) % n], points[(t.vertex + 1) % n]);
        cross(t.at - a, b - t.at).signum()
    };
    let mut out: Vec<Turn> = Vec::new();
    // The vertex before, where it is part of the last bend.
    let mut before: Option<Turn> = None;
    for turn in all {
        if turn.radius_mm >= SHY * least_mm {
            before = None;
            continue;
        }
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
    let kept = without_straight(simplify_line(&line, ROUNDING_MM));
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

/// A line without the vertices at which it goes straight on, for instance where a move was divided.
/// Such vertices would shorten the pieces from which a turn's radius is measured.
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

/// An open line in which turns below the least radius are arcs, and the number of arcs. A turn
/// becomes an arc only where the arc ends on the line before and after, stays `inside` and does not
/// cross the line. Corners near each other share one arc. Where an arc of the least radius does not
/// fit, the largest that does is taken, down to `smallest_mm`.
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

/// The arc of the largest radius that fits, from the least radius asked for down to the smallest.
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
    // Halving the rest four times over finds the radius to 2 %, less than chords take away.
    for _ in 0..4 {
        let middle = 0.5 * (low + high);
        match fits(middle) {
            Some(arc) => (low, found) = (middle, Some(arc)),
            None => high = middle,
        }
    }
    found
}

/// An arc in place of some vertices.
struct Arc {
    points: Vec<DVec2>,
    /// Number of points already laid that it replaces.
    back: usize,
    /// The last vertex that it replaces.
    last: usize,
}

/// The arc that rounds the corner at vertex `i`. It takes in more vertices on both sides until the
/// arc fits.
fn arc_around(line: &[DVec2], i: usize, out: &[DVec2], floor: usize, least_mm: f64) -> Option<Arc> {
    let (mut back, mut hi) = (0, i);
    let mut turn = angle(out[out.len() - 1], line[i], line[i + 1]);
    loop {
        let before = out[out.len() - 1 - back];
        let first = if back == 0 { line[i] } else { out[out.len() - back] };
        let (last, after) = (line[hi], line[hi + 1]);
        // Checked in every round, because the turn grows with each vertex taken in.
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
            // The tangent length of the arc, or more where the vertices in between stick out
            // farther.
            let reach = (WIDER * least_mm * half).max(alpha).max(beta);
            grow_back = reach - alpha > before.distance(first);
            // A sharp corner ahead that turns the same way needs its own share of the piece between
            // the two.
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

/// Whether an arc stays inside and meets the line at its ends alone.
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
    // The parts of the line that stay: before the piece on which the arc begins, and after the one
    // on which it ends.
    let kept = out.len() - arc.back;
    let before = out[..kept].windows(2);
    let after = line[arc.last + 1..].windows(2);
    !before.chain(after).any(|w| meets(w[0], w[1]))
}

fn crosses(a: DVec2, b: DVec2, p: DVec2, q: DVec2) -> bool {
    let side = |a: DVec2, b: DVec2, p: DVec2| cross(b - a, p - a);
    side(a, b, p) * side(a, b, q) < 0.0 && side(p, q, a) * side(p, q, b) < 0.0
}
