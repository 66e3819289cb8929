//! Clips open lines by a region, and finds where a straight line crosses the region's border.
//!
//! Method: the edges of the region are sorted into the buckets of a grid with about one edge in each. A
//! segment is tested against the edges in the buckets that it passes. An edge is crossed if its ends lie on
//! different sides of the segment and the segment's ends lie on different sides of the edge. The side is
//! computed exactly (`shewchuk1997`). Ties are decided as if every line were moved to the left by an
//! infinitesimal length, and up by one that is infinitesimal beside the first (the symbolic perturbation of
//! `edelsbrunner1990`). The move is the same for all lines and all edges, so crossings alternate between
//! entering and leaving even where a vertex of the line lies on a vertex of the border. Clipping needs a
//! single point test, at the beginning of a line, which decides ties by the same move.
//!
//! Lengths are in mm. A crossing is given as a share of the segment, 0 to 1. A point of a clipped piece is
//! given as vertex index plus share of the segment after it. Cost: building is about linear in the vertices.
//! A segment costs the buckets that it passes, with the edges in them. A point test costs the row of buckets
//! to the left of the point. The grid has at most about 2000 buckets a side.
//!
//! Degenerate cases: an empty region has no crossings and clips every line to nothing. A line through a
//! vertex crosses the border as often as the moved line does. A piece that runs exactly along an edge is
//! inside where the region lies to the left of the edge, or above a horizontal one. Pieces of a single
//! point are left out. The position of a crossing between nearly parallel segments is as inexact as their
//! angle is small; that it exists is exact.

use glam::DVec2;

use super::{Bounds2, Region};
use crate::buckets::{Buckets, CellGrid};
use crate::math::cross;
use crate::segment::turn;

/// A piece of a clipped polyline.
#[derive(Debug, Clone, PartialEq)]
pub struct ClippedLine {
    /// The piece, in the direction of the line it was cut from.
    pub points: Vec<DVec2>,
    /// For each point its position on the line: vertex index plus fraction of the following
    /// segment.
    pub at: Vec<f64>,
}

/// A point where a straight line crosses a region's border.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Share of the line's length.
    pub t: f64,
    /// Number of the contour, as [`Region::contours`] counts them.
    pub contour: usize,
    /// Number of the edge in the contour: from vertex `edge` to the next one.
    pub edge: usize,
}

/// Clips many lines by one region. Every line keeps its identity, direction and order; lines may cross.
///
/// Edges are kept in a grid of about one cell an edge, so a line meets only edges near it.
#[derive(Debug, Clone)]
pub struct LineClipper {
    edges: Vec<Edge>,
    bounds: Bounds2,
    buckets: Buckets,
}

#[derive(Debug, Clone, Copy)]
struct Edge {
    a: DVec2,
    b: DVec2,
    contour: u32,
    index: u32,
}

impl Edge {
    /// Whether the edge lies to one side of the box between two corners.
    fn is_apart_from(&self, least: DVec2, most: DVec2) -> bool {
        (self.a.max(self.b).cmplt(least) | self.a.min(self.b).cmpgt(most)).any()
    }
}

impl LineClipper {
    /// Prepares the region; about linear in its vertices.
    pub fn new(region: &Region) -> Self {
        let mut edges = Vec::with_capacity(region.n_vertices());
        for (c, contour) in region.contours().enumerate() {
            let all = super::edges(contour).enumerate();
            edges.extend(all.map(|(i, (a, b))| Edge { a, b, contour: c as u32, index: i as u32 }));
        }
        let bounds = region.bounds().unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
        let size = bounds.size().max(DVec2::splat(1e-6));
        // With about one edge a cell, neither empty cells nor crowded ones cost much time.
        let cell_mm = (size.x * size.y / edges.len().max(1) as f64).sqrt();
        let cells = CellGrid::covering(Bounds2 { min: bounds.min, max: bounds.min + size }, cell_mm, 2000);
        let buckets = Buckets::of_segments(cells, edges.len(), |i| [edges[i].a, edges[i].b]);
        Self { edges, bounds, buckets }
    }

    /// The box around the region; `None` for an empty one.
    pub fn bounds(&self) -> Option<Bounds2> {
        (!self.edges.is_empty()).then_some(self.bounds)
    }

    /// All crossings of the segment with the border, in order along it. Where the segment touches the
    /// border in a point, they are those of a segment moved to the left by an infinitesimal length, and up
    /// by an even smaller one.
    pub fn crossings(&self, a: DVec2, b: DVec2) -> Vec<Crossing> {
        let mut near: Vec<u32> = Vec::new();
        let (least, most) = (a.min(b), a.max(b));
        // Most edges of the buckets lie apart from a short segment, whichever way ties are decided.
        self.buckets.cells.for_each_passed(a, b, |cell| {
            let members = self.buckets.members(cell).iter().copied();
            near.extend(members.filter(|i| !self.edges[*i as usize].is_apart_from(least, most)));
        });
        if near.is_empty() {
            return Vec::new();
        }
        // An edge is listed in every bucket that it passes through, so duplicates are removed: each crossing counts once.
        near.sort_unstable();
        near.dedup();
        let mut out: Vec<Crossing> = near
            .into_iter()
            .filter_map(|i| {
                let e = &self.edges[i as usize];
                let t = crossing(a, b, e.a, e.b)?;
                Some(Crossing { t, contour: e.contour as usize, edge: e.index as usize })
            })
            .collect();
        // Of crossings at the same place the edge of lower number comes first, because the sort is
        // stable.
        out.sort_by(|x, y| x.t.total_cmp(&y.t));
        out
    }

    /// Whether a line that spans few buckets has no edge near it, so that none can cross it.
    fn is_apart_from(&self, line: &[DVec2]) -> bool {
        let (first, rest) = (line[0], &line[1..]);
        let (least, most) = rest.iter().fold((first, first), |(a, b), p| (a.min(*p), b.max(*p)));
        let cells = &self.buckets.cells;
        let ([left, bottom], [right, top]) = (cells.cell_of(least), cells.cell_of(most));
        if (right - left + 1) * (top - bottom + 1) > STRETCH {
            return false;
        }
        cells.block([left, bottom], [right, top]).all(|at| {
            let members = self.buckets.members(cells.index(at)).iter();
            members.copied().all(|i| self.edges[i as usize].is_apart_from(least, most))
        })
    }

    /// Whether the segment crosses the border anywhere, as [`Self::crossings`] counts.
    pub fn meets(&self, a: DVec2, b: DVec2) -> bool {
        let mut met = false;
        self.buckets.cells.for_each_passed(a, b, |cell| {
            let crossed = |&i: &u32| {
                let e = &self.edges[i as usize];
                crossing(a, b, e.a, e.b).is_some()
            };
            met = met || self.buckets.members(cell).iter().any(crossed);
        });
        met
    }

    /// Whether `p` is inside the region: the number of edges left of it is odd. On the border it is the
    /// answer for a point moved as [`Self::crossings`] moves a segment.
    pub fn contains(&self, p: DVec2) -> bool {
        if self.edges.is_empty() || !self.bounds.meets(Bounds2 { min: p, max: p }) {
            return false;
        }
        let cells = &self.buckets.cells;
        let [column, row] = cells.cell_of(p);
        // Only buckets of the row to the left can hold edges that a ray to the left crosses.
        let mut near =
            self.buckets.members_of_run(cells.index([0, row]), cells.index([column, row])).to_vec();
        near.sort_unstable();
        near.dedup();
        let near = near.into_iter().map(|i| (self.edges[i as usize].a, self.edges[i as usize].b));
        super::crossings_left_are_odd(near, p)
    }

    /// Whether the straight line from `a` to `b` meets no border and lies inside.
    pub fn segment_inside(&self, a: DVec2, b: DVec2) -> bool {
        self.contains(a) && self.contains(b) && !self.meets(a, b)
    }

    /// The pieces of `line` inside the region, in order. A piece that runs exactly along an edge is
    /// inside where the region lies to the left of the edge, or above a horizontal one.
    pub fn clip(&self, line: &[DVec2]) -> Vec<ClippedLine> {
        let mut out: Vec<ClippedLine> = Vec::new();
        let Some(&first) = line.first() else { return out };
        let inside = self.contains(first);
        let begin = |p: DVec2, at: f64| ClippedLine { points: vec![p], at: vec![at] };
        let mut current = inside.then(|| begin(first, 0.0));
        for from in (0..line.len() - 1).step_by(STRETCH) {
            let stretch = &line[from..line.len().min(from + STRETCH + 1)];
            if self.is_apart_from(stretch) {
                if let Some(piece) = &mut current {
                    piece.points.extend_from_slice(&stretch[1..]);
                    piece.at.extend((from + 1..from + stretch.len()).map(|i| i as f64));
                }
                continue;
            }
            for (i, w) in (from..).zip(stretch.windows(2)) {
                for crossing in self.crossings(w[0], w[1]) {
                    let (p, at) = (w[0].lerp(w[1], crossing.t), i as f64 + crossing.t);
                    if let Some(mut piece) = current.take() {
                        piece.points.push(p);
                        piece.at.push(at);
                        out.push(piece);
                    } else {
                        current = Some(begin(p, at));
                    }
                }
                if let Some(piece) = &mut current {
                    piece.points.push(w[1]);
                    piece.at.push((i + 1) as f64);
                }
            }
        }
        // A line that ends exactly on the border leaves a piece of a single point.
        out.extend(current.filter(|p| p.points.len() > 1));
        out.retain(|p| p.points.len() > 2 || p.points[0] != p.points[1]);
        out
    }
}

/// Segments of a line are looked at one by one where so many together come near the border. Source: chosen. A line of beads then has
/// one test every 4 mm, and looks at a hundredth of a plate's width near its border.
const STRETCH: usize = 16;

/// The position at which `a`-`b` crosses the edge `p`-`q`, as a share of `a`-`b`. Sides are exact.
fn crossing(a: DVec2, b: DVec2, p: DVec2, q: DVec2) -> Option<f64> {
    // Where a point lies exactly on a line, the side follows from the move of `a` and `b` to the left and,
    // infinitesimally less, up. A line that points up is then left of where it was, and one that points to
    // the right above it, so what lay on it lies to its right.
    let moved_to_its_left = |d: DVec2| d.y > 0.0 || (d.y == 0.0 && d.x > 0.0);
    let left = |side: f64, tie: bool| if side == 0.0 { tie } else { side > 0.0 };
    let tie = !moved_to_its_left(b - a);
    if left(turn(a, b, p), tie) == left(turn(a, b, q), tie) {
        return None;
    }
    let tie = moved_to_its_left(q - p);
    if left(turn(p, q, a), tie) == left(turn(p, q, b), tie) {
        return None;
    }
    // The segments are known to cross, so a zero here is a rounding error; the middle is as good as
    // any other point.
    let d = cross(b - a, q - p);
    Some(if d == 0.0 { 0.5 } else { (cross(p - a, q - p) / d).clamp(0.0, 1.0) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::failure_svg::FailurePicture;
    use proptest::prelude::*;

    fn ring() -> Region {
        let outer = Region::rectangle(DVec2::ZERO, DVec2::splat(10.0));
        outer.difference(&Region::rectangle(DVec2::splat(4.0), DVec2::splat(6.0)))
    }

    #[test]
    fn a_line_through_a_ring_is_two_pieces() {
        let clipper = LineClipper::new(&ring());
        let pieces = clipper.clip(&[DVec2::new(-5.0, 5.0), DVec2::new(15.0, 5.0)]);
        let lengths: Vec<f64> = pieces.iter().map(|p| p.points[0].distance(p.points[1])).collect();
        assert_eq!(lengths.len(), 2);
        assert!(lengths.iter().all(|l| (l - 4.0).abs() < 1e-9), "{lengths:?}");
        assert!((pieces[0].at[0] - 0.25).abs() < 1e-12);
        assert!(clipper.segment_inside(DVec2::new(1.0, 1.0), DVec2::new(9.0, 1.0)));
        assert!(!clipper.segment_inside(DVec2::new(1.0, 5.0), DVec2::new(9.0, 5.0)));
        assert!(LineClipper::new(&Region::default()).clip(&[DVec2::ZERO, DVec2::X]).is_empty());
    }

    #[test]
    fn a_line_from_border_to_border_is_whole() {
        // Ends exactly on the border, where `contains` and crossings need not agree.
        let (low, high) = (DVec2::splat(0.2271), DVec2::new(44.7729, 22.2729));
        let clipper = LineClipper::new(&Region::rectangle(low, high));
        for k in 0..200 {
            let share = f64::from(k) / 200.0 + 0.0021;
            let p = low + share * (high - low);
            let up = [DVec2::new(p.x, low.y), DVec2::new(p.x, 11.0), DVec2::new(p.x, high.y)];
            let across = [DVec2::new(low.x, p.y), DVec2::new(20.0, p.y), DVec2::new(high.x, p.y)];
            for mut line in [up, across] {
                for _ in 0..2 {
                    let pieces = clipper.clip(&line);
                    let length: f64 =
                        pieces.iter().flat_map(|p| p.points.windows(2)).map(|w| w[0].distance(w[1])).sum();
                    assert!((length - line[0].distance(line[2])).abs() < 1e-9, "{line:?}: {length}");
                    line.reverse();
                }
            }
        }
    }

    #[test]
    fn long_lines_of_short_segments_are_clipped_as_each_segment_is() {
        let clipper = LineClipper::new(&ring());
        let point =
            |k: i32| DVec2::splat(5.0) + 0.012 * f64::from(k) * crate::math::direction(0.02 * f64::from(k));
        let line: Vec<DVec2> = (0..600).map(point).collect();
        let length = |pieces: Vec<ClippedLine>| -> f64 {
            pieces.iter().flat_map(|p| p.points.windows(2)).map(|w| w[0].distance(w[1])).sum()
        };
        let pieces = clipper.clip(&line);
        for piece in &pieces {
            assert!(piece.at.windows(2).all(|w| w[0] < w[1] && w[1] - w[0] <= 1.0));
        }
        assert!(pieces.len() > 2, "the line leaves the ring and comes back: {}", pieces.len());
        let one_by_one: f64 = line.windows(2).map(|w| length(clipper.clip(w))).sum();
        let found = length(pieces);
        assert!((found - one_by_one).abs() < 1e-9, "{found} mm, one by one {one_by_one} mm");
    }

    proptest! {
        // Vertices on a lattice of five by five meet vertices and edges of the border in most cases.
        #[test]
        fn a_line_that_touches_the_border_stays_inside(
            square in (0i32..5, 0i32..5, 0i32..5, 0i32..5, 0i32..5, 0i32..5),
            line in proptest::collection::vec((0i32..5, 0i32..5), 2..7),
        ) {
            let lattice = |x: i32, y: i32| DVec2::new(f64::from(x), f64::from(y));
            let (ax, ay, bx, by, cx, cy) = square;
            let outer = vec![lattice(ax, ay), lattice(bx, by), lattice(cx, cy)];
            let triangle = Region::from(crate::Polygon { outer, holes: vec![] });
            let line: Vec<DVec2> = line.into_iter().map(|(x, y)| lattice(x, y)).collect();
            let clipper = LineClipper::new(&triangle);
            // The line moved as the module says, by lengths that matter on no lattice of this size.
            let moved: Vec<DVec2> = line.iter().map(|&p| p + DVec2::new(-1e-5, 1e-10)).collect();
            let counts = |line: &[DVec2]| -> Vec<usize> {
                line.windows(2).map(|w| clipper.crossings(w[0], w[1]).len()).collect()
            };
            prop_assert_eq!(counts(&line), counts(&moved));
            prop_assert_eq!(clipper.contains(line[0]), clipper.contains(moved[0]));
            let length = |pieces: Vec<ClippedLine>| -> f64 {
                pieces.iter().flat_map(|p| p.points.windows(2)).map(|w| w[0].distance(w[1])).sum()
            };
            let (found, expected) = (length(clipper.clip(&line)), length(clipper.clip(&moved)));
            let mut picture = FailurePicture::new("clip at ties");
            picture.region("region", &triangle);
            picture.line("line", &line);
            prop_assert!(picture.holds((found - expected).abs() < 1e-3), "{found} mm, moved {expected} mm");
        }

        #[test]
        fn pieces_cover_exactly_what_is_inside(
            radii in proptest::collection::vec(2.0f64..10.0, 5..60),
            line in proptest::collection::vec((-11.0f64..11.0, -11.0f64..11.0), 2..12),
        ) {
            let n = radii.len() as f64;
            let point = |(i, r): (usize, &f64)| crate::math::direction(i as f64 / n * std::f64::consts::TAU) * *r;
            let star = Region::from(crate::Polygon { outer: radii.iter().enumerate().map(point).collect(), holes: vec![] });
            let clipper = LineClipper::new(&star);
            let line: Vec<DVec2> = line.into_iter().map(DVec2::from).collect();
            let pieces = clipper.clip(&line);
            for step in 0..200 {
                let at = (line.len() - 1) as f64 * (f64::from(step) + 0.5) / 200.0;
                let i = at as usize;
                let p = line[i].lerp(line[i + 1], at - i as f64);
                let covered = pieces.iter().any(|c| c.at[0] <= at && at <= c.at[c.at.len() - 1]);
                // A sample within rounding of the border may fall on either side.
                let near = super::super::edges(&star.polygons[0].outer)
                    .any(|(a, b)| (p.distance(a) + p.distance(b) - a.distance(b)).abs() < 1e-9);
                let mut picture = FailurePicture::new("clip");
                picture.region("region", &star);
                picture.line("line", &line);
                pieces.iter().for_each(|piece| picture.line("piece", &piece.points));
                picture.point("offender", p);
                prop_assert!(picture.holds(covered == star.contains(p) || near), "{p} at {at}");
                prop_assert!(picture.holds(clipper.contains(p) == star.contains(p) || near));
            }
        }
    }
}
