//! Closed lines (rings) with positions along them, and places where two rings can be joined.
//!
//! A joint takes two stretches, each one bead long, that face each other a bead apart and run in opposite
//! directions. The stretches are replaced by two connections between their ends. This makes one ring of two
//! rings, or two of one, and crosses nothing:
//!
//! ```text
//!     ----->----->-----            ----->  +  ----->
//!                            ->            |  ^
//!     -----<-----<-----            -----<--+  +-<----
//! ```
//!
//! Stretches must be straight enough (the cosine of their turn) and nearly parallel, and both connections
//! must lie inside the infill region. A ray in square buckets ([`Neighbours`]) finds what faces a place. A
//! walk along a ring first checks whether the neighbour of the previous step is still there, and mostly
//! needs no ray.
//!
//! Positions are mm along a ring from its first point. Cost: constant for a place whose neighbour
//! stays the same.

use grainpath_core::math::{cross, direction, rotated};
use grainpath_core::poly::LineClipper;
use grainpath_core::segment::{self, Meeting};
use grainpath_core::tuned::Tuned;
use grainpath_core::{DVec2, Polygon, Region};

use super::super::field::widths::{Line, Neighbours};

/// Two beads nearer than this have no other bead between them, in beads. The neighbour of the previous
/// step is then kept. Measured: row `fill.continuous.rings.CLOSE` of `cargo xtask bench
/// constants`.
pub(super) static CLOSE: Tuned<f64> = Tuned::new("fill.continuous.rings.CLOSE", 1.1);
/// Side of the squares of the grid that segments are sorted into, in beads.
/// Source: chosen; it changes speed alone.
pub(super) const SEEN_BEADS: f64 = 2.0;

/// A place on a ring, seen from another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub ring: usize,
    pub segment: usize,
    /// Position along the ring from its first point, mm.
    pub at_mm: f64,
    /// Distance from the place that it faces, mm.
    pub distance_mm: f64,
}

/// State of a walk along a ring.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Walk {
    /// The segment of the ring.
    segment: usize,
    /// The ring and the segment that faced the previous place of the walk.
    facing: Option<(usize, usize)>,
}

/// Two stretches of about one bead's length that face each other about a bead apart and run in opposite
/// directions. Replacing them by two connections between their ends makes one ring of two, or two of one,
/// without a crossing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Facing {
    /// Start, middle and end of the first stretch, mm along its ring.
    pub one: [f64; 3],
    pub one_ring: usize,
    /// Start, middle and end of the second stretch. Its start faces the end of the first one.
    pub other: [f64; 3],
    pub other_ring: usize,
    /// Start and end of the first stretch, then of the second.
    pub corners: [DVec2; 4],
    /// About half the length of a stretch, mm.
    pub half_mm: f64,
}

impl Facing {
    /// The two connections from ring to ring.
    fn ways(&self) -> [[DVec2; 2]; 2] {
        let [a0, a1, b0, b1] = self.corners;
        [[a0, b1], [b0, a1]]
    }

    /// Whether one of the two connections crosses a connection of `other`.
    pub(super) fn crosses(&self, other: &Self) -> bool {
        self.ways().iter().any(|w| other.ways().iter().any(|o| segment::meeting(*w, *o) != Meeting::Apart))
    }
}

/// A side of a ring. The strip that the ring outlines lies on its left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
}

impl Side {
    /// The unit vector towards this side of a ring that runs along `way`.
    fn normal(self, way: DVec2) -> DVec2 {
        if self == Self::Left { DVec2::new(-way.y, way.x) } else { DVec2::new(way.y, -way.x) }
    }
}

/// Two beads run side by side if the cosine of the angle between them is more than this (0.6: 53 degrees). A ray square
/// to one then meets the other at 37 degrees or more. Measured: row `fill.continuous.rings.ALONGSIDE` of `cargo xtask
/// bench constants`.
pub(super) static ALONGSIDE: Tuned<f64> = Tuned::new("fill.continuous.rings.ALONGSIDE", 0.6);

/// Distance from `at` along `look` to the segment from `p` to `q`; `None` where the ray misses it
/// or where the segment does not run [`ALONGSIDE`].
pub(super) fn beside(at: DVec2, look: DVec2, p: DVec2, q: DVec2) -> Option<f64> {
    let d = q - p;
    let det = cross(look, d);
    // At flatter angles the two beads do not run side by side.
    if det.abs() < ALONGSIDE.value() * d.length() {
        return None;
    }
    let to = p - at;
    let (t, u) = (cross(to, d) / det, cross(to, look) / det);
    ((0.0..=1.0).contains(&u) && t > 0.0).then_some(t)
}

/// The number of leading entries, out of `n`, for which `below` holds. The search starts at `guess` and
/// widens in growing steps. If entries have about even steps, the guess is mostly right or wrong by one.
pub(super) fn bracket(n: usize, guess: usize, below: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, n);
    let (mut at, mut step) = (guess.min(n.saturating_sub(1)), 1);
    while low < high {
        if below(at) {
            low = at + 1;
            at += step;
        } else {
            high = at;
            at = at.saturating_sub(step);
        }
        step *= 2;
        if at < low || at >= high {
            at = low.midpoint(high);
        }
    }
    low
}

/// Rings run in opposite directions if the cosine of the angle between them is below minus this value.
/// Measured: row `fill.continuous.rings.AGAINST` of `cargo xtask bench constants`.
static AGAINST: Tuned<f64> = Tuned::new("fill.continuous.rings.AGAINST", 0.7);
/// A stretch is straight if the cosine of its turn within half a bead is at least this (0.8: 37 degrees). Measured: row
/// `fill.continuous.rings.STRAIGHT` of `cargo xtask bench constants`.
static STRAIGHT: Tuned<f64> = Tuned::new("fill.continuous.rings.STRAIGHT", 0.8);
/// Share of a connection that is left out at either end where it is tested. Source: derived. Of a connection of 0.4 mm
/// that is 0.008 mm, eighty times the grid that regions are rounded to ([`GRID_MM`](grainpath_core::poly::GRID_MM)).
const LEFT_OUT: f64 = 0.02;
/// Factor on the angles of the rays that search for short joints: 0, 0.5 and 1 radians to both sides. Measured: row
/// `fill.continuous.rings.SHORT_TURN` of `cargo xtask bench constants`.
static SHORT_TURN: Tuned<f64> = Tuned::new("fill.continuous.rings.SHORT_TURN", 1.0);
/// Factor on half the lengths of the stretches that short joints replace: 0.4, 0.2 and 0.08 of a bead. Measured: row
/// `fill.continuous.rings.SHORT_HALF` of `cargo xtask bench constants`.
static SHORT_HALF: Tuned<f64> = Tuned::new("fill.continuous.rings.SHORT_HALF", 1.0);
/// Rings shorter than this many half stretches get no short joint. Source: derived. A ring is a triangle at least:
/// where one of three stretches is replaced, two are left.
const LEAST_RING: f64 = 6.0;
/// For the last joints, only segments within this distance of a ring other than the longest are searched,
/// in beads. Source: derived. The widest search looks 3.2 beads far, and the connections between stretches
/// lie within one more bead of that. A larger value changes speed only.
const FURTHEST: f64 = 5.0;

fn longest(arcs: &[Vec<f64>]) -> usize {
    let length = |r: usize| arcs[r].last().copied().unwrap_or(0.0);
    (0..arcs.len()).fold(0, |m, r| if length(r) > length(m) { r } else { m })
}

/// Closed lines that do not cross.
pub(super) struct Rings {
    pub lines: Vec<Line>,
    /// For each ring the length from its first point to each point, and its whole length as the last entry.
    arcs: Vec<Vec<f64>>,
    neighbours: Neighbours,
    infill_region: LineClipper,
    spacing_mm: f64,
}

impl Rings {
    pub(super) fn new(outlines: Vec<Vec<DVec2>>, infill_region: &Polygon, spacing_mm: f64) -> Self {
        Self::seeing(outlines, infill_region, spacing_mm, |lines, _, cell_mm| {
            Neighbours::new(lines, &Region::default(), cell_mm)
        })
    }

    /// Rings for a search that starts from all rings except the longest. Only segments near the shorter
    /// rings are indexed.
    pub(super) fn around_short(outlines: Vec<Vec<DVec2>>, infill_region: &Polygon, spacing_mm: f64) -> Self {
        Self::seeing(outlines, infill_region, spacing_mm, |lines, arcs, cell_mm| {
            let longest = longest(arcs);
            Neighbours::around(lines, |l| l != longest, FURTHEST * spacing_mm, cell_mm)
        })
    }

    fn seeing(
        outlines: Vec<Vec<DVec2>>,
        infill_region: &Polygon,
        spacing_mm: f64,
        neighbours: impl Fn(&[Line], &[Vec<f64>], f64) -> Neighbours,
    ) -> Self {
        let lines: Vec<Line> = outlines.into_iter().map(|points| Line { points, closed: true }).collect();
        let arc = |line: &Line| {
            let mut sum = 0.0;
            let mut all = vec![0.0];
            all.extend((0..line.n_segments()).map(|i| {
                let (a, b) = line.segment(i);
                sum += a.distance(b);
                sum
            }));
            all
        };
        let arcs: Vec<Vec<f64>> = lines.iter().map(arc).collect();
        let neighbours = neighbours(&lines, &arcs, SEEN_BEADS * spacing_mm);
        let infill_region = LineClipper::new(&Region::from(infill_region.clone()));
        Self { lines, arcs, neighbours, infill_region, spacing_mm }
    }

    /// The longest ring; if several are equally long, the first of them.
    pub(super) fn longest(&self) -> usize {
        longest(&self.arcs)
    }

    /// Points where rings cross or touch themselves or each other.
    pub(super) fn crossings(&self) -> Vec<DVec2> {
        self.neighbours.crossings().into_iter().map(|[a, b]| self.meeting(a, b)).collect()
    }

    /// The point that two segments have in common, each given as ring and segment.
    fn meeting(&self, a: (usize, usize), b: (usize, usize)) -> DVec2 {
        let ((p, q), (r, s)) = (self.lines[a.0].segment(a.1), self.lines[b.0].segment(b.1));
        let det = cross(q - p, s - r);
        let t = if det == 0.0 { 0.5 } else { (cross(r - p, s - r) / det).clamp(0.0, 1.0) };
        p.lerp(q, t)
    }

    pub(super) fn length_mm(&self, ring: usize) -> f64 {
        self.arcs[ring].last().copied().unwrap_or(0.0)
    }

    /// Estimates the segment on which a position lies: segments are about equally long.
    fn likely_segment(&self, ring: usize, at_mm: f64) -> usize {
        let arc = &self.arcs[ring];
        let n = arc.len() - 1;
        (at_mm / arc[n].max(1e-12) * n as f64) as usize
    }

    /// A position brought into the range from 0 to the ring's length.
    pub(super) fn wrapped(&self, ring: usize, at_mm: f64) -> f64 {
        at_mm.rem_euclid(self.length_mm(ring).max(1e-12))
    }

    /// The point at a position, the direction of the ring there, and the segment.
    pub(super) fn point(&self, ring: usize, at_mm: f64) -> (DVec2, DVec2, usize) {
        let at_mm = self.wrapped(ring, at_mm);
        self.point_near(ring, at_mm, self.likely_segment(ring, at_mm))
    }

    /// As [`Self::point`], for a position within the ring's length; the search starts at `segment`.
    fn point_near(&self, ring: usize, at_mm: f64, segment: usize) -> (DVec2, DVec2, usize) {
        let arc = &self.arcs[ring];
        let s = bracket(arc.len(), segment + 1, |k| arc[k] <= at_mm).saturating_sub(1).min(arc.len() - 2);
        let (a, b) = self.lines[ring].segment(s);
        let way = (b - a).normalize_or(DVec2::X);
        (a + (at_mm - self.arcs[ring][s]) * way, way, s)
    }

    /// The place that faces a position at about a bead's distance, and the points at both places.
    /// `walk` passes the neighbour from one call to the next, because along a bead it mostly stays the
    /// same.
    pub(super) fn facing(
        &self,
        ring: usize,
        at_mm: f64,
        side: Side,
        range: [f64; 2],
        walk: &mut Walk,
    ) -> Option<(Place, [DVec2; 2])> {
        let (p, way, segment) = self.point_near(ring, at_mm, walk.segment);
        let known = walk.facing.and_then(|before| self.still_facing(p, way, side, range, before));
        let place = known.or_else(|| self.facing_along(ring, p, way, segment, side, range));
        *walk = Walk { segment, facing: place.map(|other| (other.ring, other.segment)) };
        place.map(|other| (other, [p, p + other.distance_mm * side.normal(way)]))
    }

    /// The facing place, if it lies on or next to the segment that faced the previous position.
    fn still_facing(
        &self,
        p: DVec2,
        way: DVec2,
        side: Side,
        range: [f64; 2],
        (ring, before): (usize, usize),
    ) -> Option<Place> {
        let look = side.normal(way);
        let [least, most] = [range[0], CLOSE.value()].map(|beads| beads * self.spacing_mm);
        let n = self.lines[ring].n_segments();
        // The same segment first, then its two neighbours: a walk moves by at most one or two
        // segments at a time.
        [before, before + n - 1, before + 1].into_iter().find_map(|segment| {
            let segment = segment % n;
            let (a, b) = self.lines[ring].segment(segment);
            let distance_mm = beside(p, look, a, b).filter(|d| *d > least && *d < most)?;
            let at_mm = self.arcs[ring][segment] + a.distance(p + distance_mm * look);
            ((b - a).dot(way) < -AGAINST.value() * a.distance(b)).then_some(Place {
                ring,
                segment,
                at_mm,
                distance_mm,
            })
        })
    }

    fn facing_along(
        &self,
        ring: usize,
        p: DVec2,
        way: DVec2,
        segment: usize,
        side: Side,
        range: [f64; 2],
    ) -> Option<Place> {
        let look = side.normal(way);
        let skips = |r: usize, s: usize| r == ring && s == segment;
        let hit = self.neighbours.hit(p, look, range[1] * self.spacing_mm, skips)?;
        let other = hit.line?;
        let (a, b) = self.lines[other].segment(hit.segment);
        let against = (b - a).normalize_or(DVec2::X).dot(way) < -AGAINST.value();
        if !against || hit.distance_mm < range[0] * self.spacing_mm {
            return None;
        }
        let at_mm = self.arcs[other][hit.segment] + a.distance(p + hit.distance_mm * look);
        Some(Place { ring: other, segment: hit.segment, at_mm, distance_mm: hit.distance_mm })
    }

    /// The stretch around a position and the stretch around the facing place, if both are straight enough.
    /// `known` is a ring and segment already known to face the position.
    pub(super) fn stretches(
        &self,
        ring: usize,
        at_mm: f64,
        side: Side,
        range: [f64; 2],
        known: Option<(usize, usize)>,
    ) -> Option<Facing> {
        let half = 0.5 * self.spacing_mm;
        let (p, way, middle_segment) = self.point(ring, at_mm);
        let known = known.and_then(|facing| self.still_facing(p, way, side, range, facing));
        let middle = known.or_else(|| self.facing_along(ring, p, way, middle_segment, side, range))?;
        let look = side.normal(way);
        let mut ends = [(middle, DVec2::ZERO, DVec2::ZERO); 2];
        for (end, by) in ends.iter_mut().zip([-half, half]) {
            let (q, along, segment) = self.point_near(ring, self.wrapped(ring, at_mm + by), middle_segment);
            // With a sharper turn within half a bead the stretch is a bend, and the joint would cut
            // its corner.
            if along.dot(way) < STRAIGHT.value() {
                return None;
            }
            // All rays are square to the ring's direction at the middle, so that they are parallel. A strip
            // may end between two rays, so both ends are searched anew.
            let place = self.facing_along(ring, q, way, segment, side, range)?;
            *end = (place, q, q + place.distance_mm * look);
        }
        let length = self.length_mm(middle.ring);
        let ahead = |from: f64, to: f64| (to - from).rem_euclid(length);
        let [(before, a0, b1), (after, a1, b0)] = ends;
        if before.ring != middle.ring || after.ring != middle.ring {
            return None;
        }
        let (d0, d1) = (ahead(after.at_mm, middle.at_mm), ahead(middle.at_mm, before.at_mm));
        // Between two rays, the longest straight stretch is the one at the flattest angle. A longer one has a bend,
        // which a joint would cut off.
        if d0.max(d1) > half / AGAINST.value() {
            return None;
        }
        if middle.ring == ring {
            // On one ring the two stretches must not overlap.
            let to_facing = ahead(at_mm, middle.at_mm);
            if to_facing <= half + d0 || length - to_facing <= half + d1 {
                return None;
            }
        }
        // A hole without a ring around it may lie between the two beads. The ends themselves may
        // lie on the border, so a little is left out at either end.
        let free = |a: DVec2, b: DVec2| {
            let (a, b) = (a.lerp(b, LEFT_OUT), b.lerp(a, LEFT_OUT));
            self.infill_region.contains(a) && !self.infill_region.meets(a, b)
        };
        if !free(a0, b1) || !free(a1, b0) {
            return None;
        }
        let w = |x: f64| self.wrapped(ring, x);
        Some(Facing {
            one: [w(at_mm - half), w(at_mm), w(at_mm + half)],
            one_ring: ring,
            other: [after.at_mm, middle.at_mm, before.at_mm],
            other_ring: middle.ring,
            corners: [a0, a1, b0, b1],
            half_mm: half,
        })
    }

    /// Short stretches around a position and around a place of another ring that a ray at any angle
    /// hits, if the connections between their ends are free. They join rings that nowhere run side by
    /// side, as at the ends of a neck.
    pub(super) fn short_joints(&self, ring: usize, at_mm: f64, far: f64) -> Vec<Facing> {
        let (p, way, segment) = self.point(ring, at_mm);
        let mut out = Vec::new();
        for turn in [0.0, 0.5, -0.5, 1.0, -1.0].map(|rad| rad * SHORT_TURN.value()) {
            for side in [Side::Left, Side::Right] {
                let look = rotated(side.normal(way), direction(turn));
                let skips = |r: usize, s: usize| r == ring && s == segment;
                let hit = self.neighbours.hit(p, look, far * self.spacing_mm, skips);
                let Some((hit, other)) = hit.and_then(|h| Some((h, h.line?))) else { continue };
                if other == ring {
                    continue;
                }
                let start = self.lines[other].segment(hit.segment).0;
                let facing_mm = self.arcs[other][hit.segment] + start.distance(p + hit.distance_mm * look);
                for half in [0.4, 0.2, 0.08].map(|h| h * SHORT_HALF.value() * self.spacing_mm) {
                    if [ring, other].into_iter().any(|r| self.length_mm(r) < LEAST_RING * half) {
                        continue;
                    }
                    let three =
                        |ring: usize, at: f64| [at - half, at, at + half].map(|v| self.wrapped(ring, v));
                    let (one, facing) = (three(ring, at_mm), three(other, facing_mm));
                    let [a0, a1] = [one[0], one[2]].map(|v| self.point(ring, v).0);
                    let [b0, b1] = [facing[0], facing[2]].map(|v| self.point(other, v).0);
                    // Connections that cross would make a knot.
                    let apart = segment::meeting([a0, b1], [b0, a1]) == Meeting::Apart;
                    if apart && self.is_free(a0, b1) && self.is_free(b0, a1) {
                        out.push(Facing {
                            one,
                            one_ring: ring,
                            other: facing,
                            other_ring: other,
                            corners: [a0, a1, b0, b1],
                            half_mm: half,
                        });
                    }
                }
            }
        }
        out
    }

    /// Whether the straight connection between two points of rings meets no ring and stays inside the
    /// region.
    fn is_free(&self, a: DVec2, b: DVec2) -> bool {
        let (p, q) = (a.lerp(b, LEFT_OUT), b.lerp(a, LEFT_OUT));
        let way = (q - p).normalize_or_zero();
        self.infill_region.segment_inside(p, q)
            && self.neighbours.hit(p, way, p.distance(q), |_, _| false).is_none()
    }

    /// The rings that result when all joints in `swaps` are made.
    pub(super) fn exchanged(&self, swaps: &[Facing]) -> Vec<Vec<DVec2>> {
        // For each ring its cuts: start and end of the removed stretch, and a number `2 * joint +
        // side`.
        let mut cuts: Vec<Vec<(f64, f64, usize)>> = vec![Vec::new(); self.lines.len()];
        for (k, s) in swaps.iter().enumerate() {
            cuts[s.one_ring].push((s.one[0], s.one[2], 2 * k));
            cuts[s.other_ring].push((s.other[0], s.other[2], 2 * k + 1));
        }
        cuts.iter_mut().for_each(|c| c.sort_by(|a, b| a.0.total_cmp(&b.0)));
        // The piece of ring kept after cut `c` reaches from the cut's end to the start of the next cut.
        let mut kept: Vec<(usize, usize)> = vec![(0, 0); 2 * swaps.len()];
        for (ring, cuts) in cuts.iter().enumerate() {
            for (i, c) in cuts.iter().enumerate() {
                kept[c.2] = (ring, i);
            }
        }
        let corner = |cut: usize, end: usize| swaps[cut / 2].corners[2 * (cut % 2) + end];
        let mut out = Vec::new();
        for (ring, cuts) in cuts.iter().enumerate() {
            if cuts.is_empty() {
                out.push(self.lines[ring].points.clone());
            }
        }
        let mut used = vec![false; 2 * swaps.len()];
        for first in 0..used.len() {
            let mut ring = Vec::new();
            let mut cut = first;
            while !used[cut] {
                used[cut] = true;
                let (r, i) = kept[cut];
                let (_, from, _) = cuts[r][i];
                let (to, _, next) = cuts[r][(i + 1) % cuts[r].len()];
                ring.push(corner(cut, 1));
                self.between(r, from, to, &mut ring);
                ring.push(corner(next, 0));
                // From the start of a removed stretch the path crosses over to the end of its partner, and
                // then follows the partner's ring.
                cut = next ^ 1;
            }
            if !ring.is_empty() {
                out.push(ring);
            }
        }
        out
    }

    /// Adds the ring's points between two positions, in the direction of the ring.
    fn between(&self, ring: usize, from_mm: f64, to_mm: f64, out: &mut Vec<DVec2>) {
        let arc = &self.arcs[ring];
        let points = &self.lines[ring].points;
        let n = points.len();
        let first = arc.partition_point(|&a| a <= from_mm);
        let end = arc.partition_point(|&a| a < to_mm);
        // The piece passes the ring's first point.
        let wraps = to_mm <= from_mm;
        let range = if wraps { first..end + n } else { first..end };
        out.extend(range.map(|i| points[i % n]));
    }
}
