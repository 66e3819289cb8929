//! Turns joined rings into beads: centres them in their space, smooths them and sets their widths.
//!
//! Joined rings have corners, and their beads do not lie quite in the middle between their neighbours.
//! For each segment the space to its left and right is measured ([`Neighbours`]), and the segment is
//! moved by half the difference. Corners stay corners, straight stretches are smoothed. Where a moved
//! line crosses another or leaves the infill region, the moves around that place are undone. Small loops
//! in which a line crosses itself are cut off. With variable width each bead then becomes as wide as its
//! space.
//!
//! Constants are in bead spacings unless they end in `_MM`. They bound how far a bead may move at once, and
//! the distances that count as a neighbour, a gap or a corner. Cost: linear in the points, with a few rays
//! for each.

use grainpath_core::math::cross;
use grainpath_core::poly::{Join, LineClipper, perimeter_mm};
use grainpath_core::tuned::Tuned;
use grainpath_core::units::bead_width_mm;
use grainpath_core::{BeadWidth, DVec2, Polygon, Region, Toolpath};

use super::super::field::stripes::{SIMPLIFY_MM, SMALL_LOOP, simplified};
use super::super::field::widths::{Line, Neighbours};
use super::rings::{ALONGSIDE, CLOSE, SEEN_BEADS, beside};
use crate::fill::FillContext;

/// The narrowest bead, as a share of the nominal one. Source: as in
/// [`stripes`](super::super::field::stripes), from `Kuipers2020`.
const NARROWEST: f64 = 0.6;
/// The widest bead, as a share of the nominal one. Source: `Kuipers2020`, as for the narrowest.
const WIDEST: f64 = 1.6;
/// How many times beads are moved to the middle of the space between their neighbours.
/// Measured: row `fill.continuous.finish.ROUNDS` of `cargo xtask bench constants`.
static ROUNDS: Tuned<usize> = Tuned::new("fill.continuous.finish.ROUNDS", 2);
/// A turn whose cosine is below this is a corner and stays one (0.64: 50 degrees).
/// Measured: row `fill.continuous.finish.CORNER` of `cargo xtask bench constants`.
static CORNER: Tuned<f64> = Tuned::new("fill.continuous.finish.CORNER", 0.64);
/// Neighbours are looked for within this distance first, in beads, because nearly all lie nearer. Source:
/// chosen; it changes speed only, because the search up to [`FAR`] finds the same neighbours.
const NEAR: f64 = 1.2;
/// If no neighbour lies within [`NEAR`], the search goes up to this distance, in beads.
/// Measured: row `fill.continuous.finish.FAR` of `cargo xtask bench constants`.
static FAR: Tuned<f64> = Tuned::new("fill.continuous.finish.FAR", 2.6);
/// A gap begins where the next bead is further away than this, in beads.
/// Measured: row `fill.continuous.finish.GAP` of `cargo xtask bench constants`.
static GAP: Tuned<f64> = Tuned::new("fill.continuous.finish.GAP", 1.3);
/// A gap is filled by wider beads only where it is at most this wide, in beads.
/// Measured: row `fill.continuous.finish.GAP_WIDTH` of `cargo xtask bench constants`.
static GAP_WIDTH: Tuned<f64> = Tuned::new("fill.continuous.finish.GAP_WIDTH", 1.5);
/// Within this distance of a corner the points of a line are placed closer together, in beads.
/// Measured: row `fill.continuous.finish.AT_CORNERS` of `cargo xtask bench constants`.
static AT_CORNERS: Tuned<f64> = Tuned::new("fill.continuous.finish.AT_CORNERS", 5.0);
/// A bead is moved where the free space on its two sides differs by more than this, in beads.
/// Measured: row `fill.continuous.finish.UNEVEN` of `cargo xtask bench constants`.
static UNEVEN: Tuned<f64> = Tuned::new("fill.continuous.finish.UNEVEN", 0.08);
/// This number of segments before and after an uneven one is measured again with it. Measured: row
/// `fill.continuous.finish.AROUND_UNEVEN` of `cargo xtask bench constants`.
static AROUND_UNEVEN: Tuned<usize> = Tuned::new("fill.continuous.finish.AROUND_UNEVEN", 3);
/// The space that pushes a bead is counted up to this, in beads. Measured: row `fill.continuous.finish.MOST_MOVE` of
/// `cargo xtask bench constants`.
static MOST_MOVE: Tuned<f64> = Tuned::new("fill.continuous.finish.MOST_MOVE", 0.25);
/// A point that is no corner moves by this share of the sum of the shifts of its two segments. Measured: row
/// `fill.continuous.finish.STRAIGHT_MOVE` of `cargo xtask bench constants`.
static STRAIGHT_MOVE: Tuned<f64> = Tuned::new("fill.continuous.finish.STRAIGHT_MOVE", 0.25);
/// A point that is no corner moves by this share of the way to the middle of its neighbours, across the line. Measured:
/// row `fill.continuous.finish.SMOOTHING` of `cargo xtask bench constants`.
static SMOOTHING: Tuned<f64> = Tuned::new("fill.continuous.finish.SMOOTHING", 0.35);
/// A line that lies this far outside its infill region counts as inside, mm. Source: derived. Twenty
/// times the grid that regions are rounded to ([`GRID_MM`](grainpath_core::poly::GRID_MM)).
const ON_EDGE_MM: f64 = 0.002;
/// One of two points of a line that lie closer than this is dropped, in beads.
/// Measured: row `fill.continuous.finish.CLOSEST` of `cargo xtask bench constants`.
static CLOSEST: Tuned<f64> = Tuned::new("fill.continuous.finish.CLOSEST", 0.015);

/// The space beside a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Space {
    /// Open: neither a bead nor the border runs along this side.
    Open,
    /// Half the distance to the next bead, mm.
    Bead(f64),
    /// Distance to the border, mm.
    Border(f64),
}

impl Space {
    fn mm(self) -> Option<f64> {
        match self {
            Self::Open => None,
            Self::Bead(mm) | Self::Border(mm) => Some(mm),
        }
    }
}

/// The space to the left and right of a segment's middle.
type Sides = [Space; 2];

/// A closed bead.
pub(super) struct ClosedBead {
    line: Line,
    /// Width at each point, mm; `None` where all have the nominal width.
    widths: Option<Vec<f64>>,
}

impl ClosedBead {
    /// The bead as a path; `thinned` leaves out spikes and points on a straight line. `None` for a bead that is one spike,
    /// as in a sliver of a region: no points are left of it.
    pub(super) fn path(&self, thinned: bool, context: &FillContext<'_>) -> Option<Toolpath> {
        let nominal = context.bead_width_mm;
        let mut points = self.line.points.clone();
        let mut widths = self.widths.clone().unwrap_or_else(|| vec![nominal; points.len()]);
        if thinned {
            leave_out_spikes(&mut points, &mut widths);
            (points, widths) = simplified(&points, &widths, true);
        }
        if points.len() < 3 {
            return None;
        }
        let path = Toolpath::new(points, nominal, context.role, true);
        Some(if self.widths.is_some() {
            Toolpath { width: BeadWidth::PerVertex(widths), ..path }
        } else {
            path
        })
    }
}

/// Turns rings that do not cross into beads. `infill_region` is the area in which centrelines may lie,
/// `border` the area to be filled.
pub(super) fn lay(
    rings: Vec<Vec<DVec2>>,
    infill_region: &Polygon,
    border: &Region,
    variable: bool,
    context: &FillContext<'_>,
) -> Vec<ClosedBead> {
    let spacing = context.spacing_mm() / context.density.fraction();
    let laid: Vec<Line> = rings
        .into_iter()
        .map(|points| without_near(&points, CLOSEST.value() * spacing))
        .filter(|points| points.len() > 2)
        .map(|points| Line { points: dense_at_corners(&points, spacing), closed: true })
        .collect();
    let inside = LineClipper::new(&Region::from(infill_region.clone()));
    let neighbours = |lines: &[Line]| Neighbours::new(lines, border, SEEN_BEADS * spacing);
    let first = neighbours(&laid);
    let mut sides = spaces_beside(&laid, &first, spacing, None);
    let mut lines = Vec::new();
    for round in 0..ROUNDS.value() {
        let from = if round == 0 { &laid } else { &lines };
        // Only segments with unequal space on their two sides are measured again. The others hardly moved,
        // and each measurement costs two rays.
        if round > 0 {
            let uneven = uneven(&sides, spacing);
            let near = first.near(from, &marked(from, &uneven));
            sides = spaces_beside(from, &near, spacing, Some((sides, uneven)));
        }
        lines = from.iter().zip(&sides).map(|(line, sides)| centred(line, sides, &inside, spacing)).collect();
    }
    drop(first);
    // A point exactly on the region's edge counts as inside.
    let grown = LineClipper::new(&Region::from(infill_region.clone()).offset(ON_EDGE_MM, Join::Miter(2.0)));
    let settled = undo_trouble(&laid, &mut lines, &grown, &neighbours).unwrap_or_else(|| {
        let changed = cut_small_loops(&mut lines, spacing);
        let settled = neighbours(&lines);
        if changed {
            sides = spaces_beside(&lines, &settled, spacing, None);
        }
        settled
    });
    if !variable || !context.density.is_dense() {
        return lines.into_iter().map(|line| ClosedBead { line, widths: None }).collect();
    }
    // Segments with equal space on both sides keep the space measured before.
    let uneven = uneven(&sides, spacing);
    let near = settled.near(&lines, &marked(&lines, &uneven));
    let sides = spaces_beside(&lines, &near, spacing, Some((sides, uneven)));
    let bead = |(line, sides): (Line, Vec<Sides>)| {
        let n = line.points.len();
        let of_segment: Vec<f64> = sides.iter().map(|s| width(s, spacing, context)).collect();
        let width = |v: usize| 0.5 * (of_segment[v] + of_segment[(v + n - 1) % n]);
        let widths = Some((0..n).map(width).collect());
        ClosedBead { line, widths }
    };
    lines.into_iter().zip(sides).map(bead).collect()
}

/// The width of a bead in the space it has.
fn width(sides: &Sides, spacing_mm: f64, context: &FillContext<'_>) -> f64 {
    let nominal = context.bead_width_mm;
    let strip: f64 = sides.iter().map(|r| r.mm().unwrap_or(0.5 * spacing_mm)).sum();
    let mut width = bead_width_mm(strip, context.height_mm);
    for side in sides {
        // A bead may not reach over the border. A bead of the nominal width just touches it.
        if let Space::Border(mm) = *side {
            width = width.min(2.0 * mm.max(context.border_mm));
        }
    }
    width.clamp(NARROWEST * nominal, WIDEST * nominal)
}

/// The space measured before, and whether it is to be measured again, for each line and segment.
type Known = (Vec<Vec<Sides>>, Vec<Vec<bool>>);

/// Marks segments with unequal space on their sides, and [`AROUND_UNEVEN`] segments before and after each.
fn uneven(sides: &[Vec<Sides>], spacing_mm: f64) -> Vec<Vec<bool>> {
    // Segments near an uneven one have moved with it, because lines are smoothed.
    let around = AROUND_UNEVEN.value();
    let of_line = |sides: &Vec<Sides>| {
        let n = sides.len();
        let mut out = vec![false; n];
        for (k, s) in sides.iter().enumerate() {
            let [left, right] = s.map(|r| r.mm().unwrap_or(0.5 * spacing_mm));
            if (left - right).abs() > UNEVEN.value() * spacing_mm {
                (0..(2 * around + 1).min(n)).for_each(|j| out[(k + n + j - around.min(n)) % n] = true);
            }
        }
        out
    };
    sides.iter().map(of_line).collect()
}

/// The first points of all marked segments.
fn marked(lines: &[Line], uneven: &[Vec<bool>]) -> Vec<DVec2> {
    let of_line = |(line, marks): (&Line, &Vec<bool>)| {
        let at = |s: usize| marks[s].then(|| line.points[s]);
        (0..marks.len()).filter_map(at).collect::<Vec<_>>()
    };
    lines.iter().zip(uneven).flat_map(of_line).collect()
}

/// The space beside every segment: half the distance to the next parallel bead, or the distance to the
/// border. If `known` is given, only the segments marked in it are measured again.
fn spaces_beside(
    lines: &[Line],
    neighbours: &Neighbours,
    spacing_mm: f64,
    known: Option<Known>,
) -> Vec<Vec<Sides>> {
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
                    if let Some(d) = beside(middle, look, p, q).filter(|d| *d < CLOSE.value() * spacing_mm) {
                        *last = Some((other, o));
                        return Space::Bead(0.5 * d);
                    }
                }
            }
            *last = None;
            let sees = |far: f64| neighbours.hit(middle, look, far * spacing_mm, |k, o| k == l && near(o));
            let Some(hit) = sees(NEAR).or_else(|| sees(FAR.value())) else { return Space::Open };
            let Some(other) = hit.line else { return Space::Border(hit.distance_mm) };
            *last = Some((other, hit.segment));
            if hit.distance_mm > GAP.value() * spacing_mm {
                // A ray that runs along the gap between two beads also goes far before it meets one. A real
                // gap is also wide in the direction square to the ray.
                let inside = middle + 0.5 * hit.distance_mm * look;
                let far = GAP_WIDTH.value() * spacing_mm;
                let free = |way: DVec2| {
                    neighbours.hit(inside, way, far, |_, _| false).map_or(far, |h| h.distance_mm)
                };
                let is_gap = free(way) + free(-way) > far;
                return if is_gap { Space::Bead(0.5 * hit.distance_mm) } else { Space::Open };
            }
            let (p, q) = lines[other].segment(hit.segment);
            let along = (q - p).normalize_or(DVec2::X).dot(way).abs() > ALONGSIDE.value();
            if along { Space::Bead(0.5 * hit.distance_mm) } else { Space::Open }
        };
        // From one segment of a bead to the next, the neighbour is mostly the same.
        let mut last = [None; 2];
        let sought = |s: usize| match &known {
            Some((sides, marked)) if !marked[l][s] => sides[l][s],
            _ => [side(s, true, &mut last[0]), side(s, false, &mut last[1])],
        };
        (0..n).map(sought).collect()
    };
    lines.iter().enumerate().map(of_line).collect()
}

/// Moves a line towards the middle of its space, and smooths it between its corners.
fn centred(line: &Line, sides: &[Sides], inside: &LineClipper, spacing_mm: f64) -> Line {
    let n = line.points.len();
    let most = MOST_MOVE.value() * spacing_mm;
    // Sideways shift of each segment. On a side without a neighbour nothing pushes the bead away; the bead
    // is then only pulled towards a gap on its other side.
    let shift = |s: &Sides| match s.map(Space::mm) {
        [Some(left), Some(right)] => 0.5 * (left - right).clamp(-most, most),
        [Some(left), None] => (left - 0.5 * spacing_mm).clamp(0.0, most),
        [None, Some(right)] => (0.5 * spacing_mm - right).clamp(-most, 0.0),
        [None, None] => 0.0,
    };
    let shifts: Vec<f64> = sides.iter().map(shift).collect();
    let ways: Vec<DVec2> = (0..n)
        .map(|s| {
            let (a, b) = line.segment(s);
            (b - a).normalize_or(DVec2::X)
        })
        .collect();
    let is_corner: Vec<bool> = (0..n).map(|v| ways[(v + n - 1) % n].dot(ways[v]) < CORNER.value()).collect();
    let moved: Vec<DVec2> = (0..n)
        .map(|v| {
            let [p, q] = [(v + n - 1) % n, v].map(|s| shifts[s] * DVec2::new(-ways[s].y, ways[s].x));
            line.points[v] + if is_corner[v] { 0.5 * (p + q) } else { STRAIGHT_MOVE.value() * (p + q) }
        })
        .collect();
    let smooth = |v: usize| {
        let (a, p, b) = (moved[(v + n - 1) % n], moved[v], moved[(v + 1) % n]);
        if is_corner[v] {
            return p;
        }
        // The point moves towards the middle of its two neighbours, but only across the line, so that the
        // steps along the line stay even.
        let across = (b - a).perp().normalize_or_zero();
        p + SMOOTHING.value() * (a.midpoint(b) - p).dot(across) * across
    };
    let points = (0..n)
        .map(|v| {
            let p = smooth(v);
            // A point between other beads is far from the border and needs no test.
            let enclosed =
                [v, (v + n - 1) % n].iter().all(|&s| sides[s].iter().all(|r| matches!(r, Space::Bead(_))));
            if enclosed || inside.segment_inside(line.points[v], p) { p } else { line.points[v] }
        })
        .collect();
    Line { points, closed: true }
}

/// Undoes moves after which lines cross or leave the region. Returns the neighbours of the lines as they
/// then lie, or `None` if some lines still cross.
fn undo_trouble(
    before: &[Line],
    after: &mut [Line],
    infill_region: &LineClipper,
    neighbours: &impl Fn(&[Line]) -> Neighbours,
) -> Option<Neighbours> {
    let all = neighbours(after);
    let mut pairs = all.crossings();
    // The first round checks all segments, later rounds only those that were moved back.
    let mut touched: Option<Vec<(usize, usize)>> = None;
    let mut stuck = false;
    for round in 0..8 {
        let is_moved = |&(l, s): &(usize, usize)| {
            let n = after[l].points.len();
            [s, (s + 1) % n].iter().any(|&v| after[l].points[v] != before[l].points[v])
        };
        let leaves = |&(l, s): &(usize, usize)| {
            let (a, b) = after[l].segment(s);
            infill_region.meets(a, b)
        };
        // A segment still at its old place cannot be improved by undoing moves.
        let leaving = |at: &(usize, usize)| is_moved(at) && leaves(at);
        let mut trouble: Vec<(usize, usize)> = match &touched {
            Some(touched) => touched.iter().copied().filter(leaving).collect(),
            None => segments_of(after).filter(leaving).collect(),
        };
        trouble.extend(pairs.iter().filter(|p| p.iter().any(is_moved)).flatten());
        stuck |= pairs.iter().any(|p| !p.iter().any(is_moved));
        if trouble.is_empty() {
            return (!stuck).then_some(all);
        }
        let mut back = Vec::new();
        for (l, s) in trouble {
            let n = after[l].points.len();
            // The stretch that is moved back doubles with each round, so that eight rounds reach
            // 128 points to either side.
            let reach = (1 << round).min(n / 2);
            for k in 0..2 * reach {
                let v = (s + n + 1 + k - reach) % n;
                after[l].points[v] = before[l].points[v];
                back.extend([(l, (v + n - 1) % n), (l, v)]);
            }
        }
        back.sort_unstable();
        back.dedup();
        let places: Vec<DVec2> = back.iter().map(|&(l, s)| after[l].points[s]).collect();
        pairs = all.near(after, &places).crossings();
        touched = Some(back);
    }
    // If lines still cross after eight rounds, all moves of all lines are undone.
    after.iter_mut().zip(before).for_each(|(a, b)| a.points.clone_from(&b.points));
    None
}

fn segments_of(lines: &[Line]) -> impl Iterator<Item = (usize, usize)> + '_ {
    lines.iter().enumerate().flat_map(|(l, line)| (0..line.n_segments()).map(move |s| (l, s)))
}

/// Cuts off spikes and short loops in which a line crosses itself. Returns whether there were
/// any.
fn cut_small_loops(lines: &mut [Line], spacing_mm: f64) -> bool {
    let mut changed = false;
    for _ in 0..8 {
        let pairs = Neighbours::new(lines, &Region::default(), SEEN_BEADS * spacing_mm).crossings();
        let mut done: Vec<usize> = Vec::new();
        for [(l, i), (m, j)] in pairs {
            // Cutting a loop renumbers the segments of its line, so each line is cut once a round.
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

/// Adds points to a closed line near its corners, where beads move most, so that they lie about one bead apart.
fn dense_at_corners(points: &[DVec2], spacing_mm: f64) -> Vec<DVec2> {
    let n = points.len();
    let step = |s: usize| points[(s + 1) % n] - points[s];
    let turns = |v: usize| {
        let (a, b) = (step((v + n - 1) % n), step(v));
        a.dot(b) < CORNER.value() * a.length() * b.length()
    };
    let mut near = vec![false; n];
    let reach = AT_CORNERS.value() * spacing_mm;
    for v in (0..n).filter(|&v| turns(v)) {
        for way in [1, n - 1] {
            let (mut s, mut walked) = (if way == 1 { v } else { (v + n - 1) % n }, 0.0);
            while walked < reach {
                near[s] = true;
                walked += step(s).length();
                s = (s + way) % n;
                if s == v {
                    break;
                }
            }
        }
    }
    let mut out = Vec::with_capacity(n);
    for s in 0..n {
        let pieces = if near[s] { (step(s).length() / spacing_mm).round().max(1.0) } else { 1.0 };
        out.extend((0..pieces as usize).map(|k| points[s] + k as f64 / pieces * step(s)));
    }
    out
}

/// Removes the points of a closed line that lie within `near_mm` of the previous point, and spikes.
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

/// Removes the tips of spikes from a closed line, together with their widths. A spike thinner than a
/// printer can show is removed like a point on a straight line.
fn leave_out_spikes(points: &mut Vec<DVec2>, widths: &mut Vec<f64>) {
    let keep = unspiked(points, SIMPLIFY_MM);
    let each = || keep.iter().copied();
    let (mut of_points, mut of_widths) = (each(), each());
    points.retain(|_| of_points.next().unwrap_or(true));
    widths.retain(|_| of_widths.next().unwrap_or(true));
}

/// Which points of a closed line are kept: all but the tips where the line turns back along itself.
fn unspiked(points: &[DVec2], thin_mm: f64) -> Vec<bool> {
    let n = points.len();
    let is_spike = |v: usize| {
        let (a, b) = (points[v] - points[(v + n - 1) % n], points[(v + 1) % n] - points[v]);
        a.dot(b) < 0.0 && cross(a, b).abs() <= thin_mm * a.length().max(b.length())
    };
    (0..n).map(|v| !is_spike(v)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::continuous::tests::context;
    use grainpath_core::UniformField;

    #[test]
    fn a_bead_that_is_one_spike_is_no_path() {
        let part = Region::rectangle(DVec2::ZERO, DVec2::ONE);
        let context = context(&part, 0.45, &UniformField { axis_rad: 0.0 });
        let path = |points: &[DVec2]| {
            let line = Line { points: points.to_vec(), closed: true };
            ClosedBead { line, widths: None }.path(true, &context)
        };
        // From a gap between two teeth of a pinion.
        let spike =
            [DVec2::new(-4.07518, 8.2822), DVec2::new(-4.03931, 8.28306), DVec2::new(-4.1312, 8.2822)];
        assert_eq!(path(&spike), None);
        let ring = [DVec2::ZERO, DVec2::new(4.0, 0.0), DVec2::new(4.0, 4.0)];
        assert_eq!(path(&ring).map(|p| p.points.len()), Some(3));
    }
}
