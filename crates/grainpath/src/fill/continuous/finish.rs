//! From a ring of stretches to beads: moved to the middle of their room, smoothed where they do not turn, as wide as
//! the room there is.

use grainpath_core::math::cross;
use grainpath_core::poly::{Join, LineClipper, perimeter_mm};
use grainpath_core::units::bead_width_mm;
use grainpath_core::{BeadWidth, DVec2, Polygon, Region, Toolpath};

use super::super::field::stripes::simplified;
use super::super::field::widths::{Line, Neighbours};
use crate::fill::FillContext;

/// The narrowest and widest bead, as shares of the nominal one.
const NARROWEST: f64 = 0.6;
const WIDEST: f64 = 1.6;
/// Rounds of moving beads to the middle of their room.
const ROUNDS: usize = 4;
/// A turn of more than this is a corner and stays one: the cosine.
const CORNER: f64 = 0.64;
/// Most neighbours are nearer than this, in beads, and nothing further than that is one.
const NEAR: f64 = 1.2;
const FAR: f64 = 2.6;
/// Further than this from the next bead there is a gap, if it is as wide as it is deep, in beads.
const GAP: f64 = 1.3;
const GAP_WIDTH: f64 = 1.5;
/// Nearer than this nothing lies between a bead and what was its neighbour a step before, in beads.
const CLOSE: f64 = 1.1;
/// Sides that differ by more than this are evened out, in beads.
const UNEVEN: f64 = 0.08;
/// How far out of its room a line may lie and still count as in it, mm.
const ON_EDGE_MM: f64 = 0.002;
/// A line may lose a loop over itself up to this long, in beads.
const SMALL_LOOP: f64 = 5.0;
/// A line that turns back on itself within this distance is cut short, mm.
const SPIKE_MM: f64 = 0.005;
/// Of two points closer than this one goes, in beads.
const CLOSEST: f64 = 0.015;

/// Room beside a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Room {
    /// Nothing runs along here.
    Open,
    /// Half way to the next bead, mm.
    Bead(f64),
    /// To the border, mm.
    Border(f64),
}

impl Room {
    fn mm(self) -> Option<f64> {
        match self {
            Self::Open => None,
            Self::Bead(mm) | Self::Border(mm) => Some(mm),
        }
    }
}

/// Room to the left and right of a segment's middle.
type Sides = [Room; 2];

/// Lays rings that do not cross as beads. `room` holds their centrelines, `border` what they are to fill; `thinned`
/// leaves out spikes and points that lie on the line without them.
pub fn lay(
    rings: Vec<Vec<DVec2>>,
    room: &Polygon,
    border: &Region,
    variable: bool,
    thinned: bool,
    context: &FillContext<'_>,
) -> Vec<Toolpath> {
    let spacing = context.spacing_mm() / context.density;
    let mut lines: Vec<Line> = rings
        .into_iter()
        .map(|points| Line { points: without_near(&points, CLOSEST * spacing), closed: true })
        .filter(|l| l.points.len() > 2)
        .collect();
    let inside = LineClipper::new(&Region::from(room.clone()));
    let laid = lines.clone();
    let neighbours = |lines: &[Line]| Neighbours::new(lines, border, 1.5 * spacing);
    let first = neighbours(&lines);
    let mut sides = rooms(&lines, &first, spacing, None);
    for round in 0..ROUNDS {
        if round > 0 {
            let uneven = uneven(&sides, spacing);
            let near = first.near(&lines, &marked(&lines, &uneven));
            sides = rooms(&lines, &near, spacing, Some((sides, uneven)));
        }
        lines =
            lines.iter().zip(&sides).map(|(line, sides)| centred(line, sides, &inside, spacing)).collect();
    }
    // What lies on the room's edge is not to count as out.
    let grown = LineClipper::new(&Region::from(room.clone()).offset(ON_EDGE_MM, Join::Miter(2.0)));
    let settled = undo_trouble(&laid, &mut lines, &grown, &neighbours).unwrap_or_else(|| {
        let changed = cut_small_loops(&mut lines, spacing);
        let settled = neighbours(&lines);
        if changed {
            sides = rooms(&lines, &settled, spacing, None);
        }
        settled
    });
    let nominal = context.bead_width_mm;
    if !variable || context.density < 0.999 {
        let path = |l: Line| {
            let l = if thinned { without_spikes(l, &mut Vec::new()) } else { l };
            let widths = vec![nominal; l.points.len()];
            let points = if thinned { simplified(&l.points, &widths, true).0 } else { l.points };
            Toolpath::new(points, nominal, context.role, true)
        };
        return lines.into_iter().map(path).collect();
    }
    // What was even lies as it lay.
    let uneven = uneven(&sides, spacing);
    let sides = rooms(&lines, &settled, spacing, Some((sides, uneven)));
    let path = |(line, sides): (Line, Vec<Sides>)| {
        let n = line.points.len();
        let of_segment: Vec<f64> = sides.iter().map(|s| width(s, spacing, context)).collect();
        let width = |v: usize| 0.5 * (of_segment[v] + of_segment[(v + n - 1) % n]);
        let mut widths: Vec<f64> = (0..n).map(width).collect();
        let line = if thinned { without_spikes(line, &mut widths) } else { line };
        let (points, widths) =
            if thinned { simplified(&line.points, &widths, true) } else { (line.points, widths) };
        Toolpath { width: BeadWidth::PerVertex(widths), ..Toolpath::new(points, nominal, context.role, true) }
    };
    lines.into_iter().zip(sides).map(path).collect()
}

/// How wide a bead is in its room.
fn width(sides: &Sides, spacing_mm: f64, context: &FillContext<'_>) -> f64 {
    let nominal = context.bead_width_mm;
    let strip: f64 = sides.iter().map(|r| r.mm().unwrap_or(0.5 * spacing_mm)).sum();
    let mut width = bead_width_mm(strip, context.height_mm);
    for side in sides {
        // Over the border it may not reach; there a bead of the nominal width just touches.
        if let Room::Border(mm) = *side {
            width = width.min(2.0 * mm.max(context.border_mm));
        }
    }
    width.clamp(NARROWEST * nominal, WIDEST * nominal)
}

/// Rooms as they were, and which of them are to be looked at again, by line and segment.
type Known = (Vec<Vec<Sides>>, Vec<Vec<bool>>);

/// Segments whose sides differ, and those around them.
fn uneven(sides: &[Vec<Sides>], spacing_mm: f64) -> Vec<Vec<bool>> {
    let of_line = |sides: &Vec<Sides>| {
        let n = sides.len();
        let mut out = vec![false; n];
        for (k, s) in sides.iter().enumerate() {
            let [left, right] = s.map(|r| r.mm().unwrap_or(0.5 * spacing_mm));
            if (left - right).abs() > UNEVEN * spacing_mm {
                (0..7.min(n)).for_each(|j| out[(k + n + j - 3.min(n)) % n] = true);
            }
        }
        out
    };
    sides.iter().map(of_line).collect()
}

/// Where the segments are that are to be looked at again.
fn marked(lines: &[Line], uneven: &[Vec<bool>]) -> Vec<DVec2> {
    let of_line = |(line, marks): (&Line, &Vec<bool>)| {
        let at = |s: usize| marks[s].then(|| line.points[s]);
        (0..marks.len()).filter_map(at).collect::<Vec<_>>()
    };
    lines.iter().zip(uneven).flat_map(of_line).collect()
}

/// The room beside every segment: half way to the next bead along it, or to the border. With `known`, only that of
/// the segments marked is sought anew.
fn rooms(lines: &[Line], neighbours: &Neighbours, spacing_mm: f64, known: Option<Known>) -> Vec<Vec<Sides>> {
    let of_line = |(l, line): (usize, &Line)| {
        let n = line.n_segments();
        let side = |s: usize, left: bool, last: &mut Option<(usize, usize)>| {
            let (a, b) = line.segment(s);
            let way = (b - a).normalize_or(DVec2::X);
            let look = if left { DVec2::new(-way.y, way.x) } else { DVec2::new(way.y, -way.x) };
            let near = |o: usize| o.abs_diff(s) <= 1 || o.abs_diff(s) >= n - 1;
            let middle = 0.5 * (a + b);
            if let Some((other, before)) = *last {
                let m = lines[other].n_segments();
                for o in [before, before + m - 1, before + 1, before + m - 2].map(|o| o % m) {
                    if other == l && near(o) {
                        continue;
                    }
                    let (p, q) = lines[other].segment(o);
                    if let Some(d) = beside(middle, look, p, q).filter(|d| *d < CLOSE * spacing_mm) {
                        *last = Some((other, o));
                        return Room::Bead(0.5 * d);
                    }
                }
            }
            *last = None;
            let sees = |far: f64| neighbours.hit(middle, look, far * spacing_mm, |k, o| k == l && near(o));
            let Some(hit) = sees(NEAR).or_else(|| sees(FAR)) else { return Room::Open };
            let Some(other) = hit.line else { return Room::Border(hit.distance_mm) };
            *last = Some((other, hit.segment));
            if hit.distance_mm > GAP * spacing_mm {
                // Along the way between two beads one sees far too, but nothing is missing there.
                let inside = middle + 0.5 * hit.distance_mm * look;
                let far = GAP_WIDTH * spacing_mm;
                let free = |way: DVec2| {
                    neighbours.hit(inside, way, far, |_, _| false).map_or(far, |h| h.distance_mm)
                };
                let is_gap = free(way) + free(-way) > far;
                return if is_gap { Room::Bead(0.5 * hit.distance_mm) } else { Room::Open };
            }
            let (p, q) = lines[other].segment(hit.segment);
            let along = (q - p).normalize_or(DVec2::X).dot(way).abs() > 0.6;
            if along { Room::Bead(0.5 * hit.distance_mm) } else { Room::Open }
        };
        // Along a bead its neighbour mostly goes on as it did.
        let mut last = [None; 2];
        let sought = |s: usize| match &known {
            Some((sides, marked)) if !marked[l][s] => sides[l][s],
            _ => [side(s, true, &mut last[0]), side(s, false, &mut last[1])],
        };
        (0..n).map(sought).collect()
    };
    lines.iter().enumerate().map(of_line).collect()
}

/// How far the segment from `p` to `q` is from `at` in the direction `look`, where it runs across it.
fn beside(at: DVec2, look: DVec2, p: DVec2, q: DVec2) -> Option<f64> {
    let d = q - p;
    let det = cross(look, d);
    if det.abs() < 0.6 * d.length() {
        return None;
    }
    let to = p - at;
    let (t, u) = (cross(to, d) / det, cross(to, look) / det);
    ((0.0..=1.0).contains(&u) && t > 0.0).then_some(t)
}

/// A line moved towards the middle of its room, and smoothed between its corners.
fn centred(line: &Line, sides: &[Sides], inside: &LineClipper, spacing_mm: f64) -> Line {
    let n = line.points.len();
    let most = 0.25 * spacing_mm;
    // Shift of each segment across its way. A side without a neighbour pushes nothing away: there a bead only follows
    // a gap on its other side.
    let shift = |s: &Sides| match s.map(Room::mm) {
        [Some(left), Some(right)] => 0.5 * (left - right).clamp(-most, most),
        [Some(left), None] => (left - 0.5 * spacing_mm).clamp(0.0, most),
        [None, Some(right)] => (0.5 * spacing_mm - right).clamp(-most, 0.0),
        [None, None] => 0.0,
    };
    let shifts: Vec<f64> = sides.iter().map(shift).collect();
    let way = |s: usize| {
        let (a, b) = line.segment(s);
        (b - a).normalize_or(DVec2::X)
    };
    let is_corner: Vec<bool> = (0..n).map(|v| way((v + n - 1) % n).dot(way(v)) < CORNER).collect();
    let moved: Vec<DVec2> = (0..n)
        .map(|v| {
            let (before, after) = ((v + n - 1) % n, v);
            let [u, w] = [way(before), way(after)];
            let [p, q] = [(before, u), (after, w)].map(|(s, t)| shifts[s] * DVec2::new(-t.y, t.x));
            line.points[v] + if is_corner[v] { 0.5 * (p + q) } else { 0.25 * (p + q) }
        })
        .collect();
    let smooth = |v: usize| {
        let (a, p, b) = (moved[(v + n - 1) % n], moved[v], moved[(v + 1) % n]);
        if is_corner[v] {
            return p;
        }
        // Towards the middle of its neighbours, across the line only, so that steps stay even.
        let across = (b - a).perp().normalize_or_zero();
        p + 0.35 * (a.midpoint(b) - p).dot(across) * across
    };
    let points = (0..n)
        .map(|v| {
            let p = smooth(v);
            // Between other beads there is nothing to leave.
            let enclosed =
                [v, (v + n - 1) % n].iter().all(|&s| sides[s].iter().all(|r| matches!(r, Room::Bead(_))));
            if enclosed || inside.segment_inside(line.points[v], p) { p } else { line.points[v] }
        })
        .collect();
    Line { points, closed: true }
}

/// Takes moves back where lines cross, or leave the room, because of them: the lines as they lie then; `None` where
/// some cross all the same.
fn undo_trouble(
    before: &[Line],
    after: &mut [Line],
    room: &LineClipper,
    neighbours: &impl Fn(&[Line]) -> Neighbours,
) -> Option<Neighbours> {
    for round in 0..8 {
        let found = neighbours(after);
        let pairs = found.crossings();
        let is_moved = |&(l, s): &(usize, usize)| {
            let n = after[l].points.len();
            [s, (s + 1) % n].iter().any(|&v| after[l].points[v] != before[l].points[v])
        };
        let leaves = |&(l, s): &(usize, usize)| {
            let (a, b) = after[l].segment(s);
            !room.crossings(a, b).is_empty()
        };
        let all = after.iter().enumerate().flat_map(|(l, line)| (0..line.n_segments()).map(move |s| (l, s)));
        // What lies as it did cannot be helped by taking it back.
        let leaving = all.filter(|at| is_moved(at) && leaves(at));
        let crossing = pairs.iter().filter(|p| p.iter().any(is_moved)).flatten().copied();
        let trouble: Vec<(usize, usize)> = crossing.chain(leaving).collect();
        if trouble.is_empty() {
            return pairs.is_empty().then_some(found);
        }
        for (l, s) in trouble {
            let n = after[l].points.len();
            let reach = (1 << round).min(n / 2);
            for k in 0..2 * reach {
                let v = (s + n + 1 + k - reach) % n;
                after[l].points[v] = before[l].points[v];
            }
        }
    }
    after.iter_mut().zip(before).for_each(|(a, b)| a.points.clone_from(&b.points));
    None
}

/// Takes out short loops that a line makes over itself, and spikes; whether there were any.
fn cut_small_loops(lines: &mut [Line], spacing_mm: f64) -> bool {
    let mut changed = false;
    for _ in 0..8 {
        let pairs = Neighbours::new(lines, &Region::default(), 1.5 * spacing_mm).crossings();
        let mut done: Vec<usize> = Vec::new();
        for [(l, i), (m, j)] in pairs {
            // Numbers of segments change with the first loop taken out.
            if l != m || done.contains(&l) {
                continue;
            }
            done.push(l);
            let line = &lines[l];
            let ((a, b), (c, d)) = (line.segment(i), line.segment(j));
            let det = cross(b - a, d - c);
            let t = if det == 0.0 { 1.0 } else { (cross(c - a, d - c) / det).clamp(0.0, 1.0) };
            let at = a.lerp(b, t);
            let inner = || line.points[i + 1..=j].iter().copied().chain([at]);
            let outer = || line.points[j + 1..].iter().chain(&line.points[..=i]).copied().chain([at]);
            let length = |points: Vec<DVec2>| perimeter_mm(&points);
            let (inside, outside) = (length(inner().collect()), length(outer().collect()));
            if inside.min(outside) < SMALL_LOOP * spacing_mm {
                let kept = if inside < outside { outer().collect() } else { inner().collect() };
                lines[l].points = kept;
                changed = true;
            }
        }
        if done.is_empty() {
            break;
        }
    }
    changed
}

/// A closed line without points that lie on each other.
fn without_near(points: &[DVec2], near_mm: f64) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = Vec::with_capacity(points.len());
    for &p in points {
        if out.last().is_none_or(|l| l.distance(p) > near_mm) {
            out.push(p);
        }
    }
    while out.len() > 3 && out[0].distance(out[out.len() - 1]) <= near_mm {
        out.pop();
    }
    let keep = unspiked(&out, 1e-9);
    out.iter().zip(keep).filter_map(|(&p, k)| k.then_some(p)).collect()
}

/// A line without spikes; `widths` loses what belongs to them.
fn without_spikes(line: Line, widths: &mut Vec<f64>) -> Line {
    let keep = unspiked(&line.points, SPIKE_MM);
    let mut kept = keep.iter().copied();
    widths.retain(|_| kept.next().unwrap_or(true));
    let points = line.points.into_iter().zip(keep).filter_map(|(p, k)| k.then_some(p)).collect();
    Line { points, ..line }
}

/// Which points of a closed line are more than the tip of a way there and back along itself.
fn unspiked(points: &[DVec2], thin_mm: f64) -> Vec<bool> {
    let n = points.len();
    let is_spike = |v: usize| {
        let (a, b) = (points[v] - points[(v + n - 1) % n], points[(v + 1) % n] - points[v]);
        a.dot(b) < 0.0 && cross(a, b).abs() <= thin_mm * a.length().max(b.length())
    };
    (0..n).map(|v| !is_spike(v)).collect()
}
