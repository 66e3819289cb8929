//! The space of a bead between its neighbours, which decides its width.
//!
//! Beads and the border of the area they fill are kept as segments in square buckets. From a point
//! of a bead a ray goes to the left and to the right, at right angles to it. A neighbouring bead
//! shares the distance, the border gives all of it:
//!
//! ```text
//!    ------------------------- neighbour
//!         ^  d1                        reach to the left: d1 / 2
//!    -----o------------------- bead
//!         v  d2                        reach to the right: d2
//!    ######################### border
//! ```
//!
//! The sum of both reaches is the width of the bead's strip;
//! [`bead_width_mm`](grainpath_core::units::bead_width_mm) turns it into the width that is printed.
//! Exact for parallel beads; where beads converge at an angle the ray overestimates the space by
//! the cosine of half of it. Cost: a ray passes a few buckets, whatever the size of the region.

use grainpath_core::buckets::{Buckets, CellGrid};
use grainpath_core::math::cross;
use grainpath_core::poly::edges;
use grainpath_core::segment::{self, Meeting};
use grainpath_core::{Bounds2, DVec2, Region};

/// A bead being laid: its centreline at about equal steps.
#[derive(Debug, Clone)]
pub struct Line {
    pub points: Vec<DVec2>,
    pub closed: bool,
}

impl Line {
    /// Number of straight segments.
    pub fn n_segments(&self) -> usize {
        if self.closed { self.points.len() } else { self.points.len().saturating_sub(1) }
    }

    /// Both ends of segment `i`.
    pub fn segment(&self, i: usize) -> (DVec2, DVec2) {
        (self.points[i], self.points[(i + 1) % self.points.len()])
    }

    /// Unit vector along the line at vertex `i`.
    pub fn tangent(&self, i: usize) -> DVec2 {
        let n = self.points.len();
        let before = if i > 0 {
            i - 1
        } else if self.closed {
            n - 1
        } else {
            0
        };
        let after = if i + 1 < n {
            i + 1
        } else if self.closed {
            0
        } else {
            n - 1
        };
        (self.points[after] - self.points[before]).normalize_or(DVec2::X)
    }
}

/// The space of a bead at a point: its reach to the left and to the right, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    pub left_mm: f64,
    pub right_mm: f64,
}

/// The first segment that a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    pub distance_mm: f64,
    /// `None` for the border.
    pub line: Option<usize>,
    pub segment: usize,
}

#[derive(Clone, Copy)]
struct BeadSegment {
    a: DVec2,
    b: DVec2,
    /// Line and segment; `u32::MAX` for the border.
    line: u32,
    segment: u32,
}

const BORDER: u32 = u32::MAX;

fn pieces_of(l: usize, line: &Line) -> impl Iterator<Item = BeadSegment> + '_ {
    (0..line.n_segments()).map(move |s| {
        let (a, b) = line.segment(s);
        BeadSegment { a, b, line: l as u32, segment: s as u32 }
    })
}

/// The beads of an infill region and its border, searchable for the neighbours of a bead.
pub struct Neighbours {
    pieces: Vec<BeadSegment>,
    buckets: Buckets,
}

impl Neighbours {
    /// From all `lines` and the border of the region they fill; cells are `cell_mm` wide.
    pub fn new(lines: &[Line], border: &Region, cell_mm: f64) -> Self {
        let mut pieces = Vec::with_capacity(lines.iter().map(Line::n_segments).sum());
        lines.iter().enumerate().for_each(|(l, line)| pieces.extend(pieces_of(l, line)));
        for contour in border.contours() {
            pieces.extend(edges(contour).map(|(a, b)| BeadSegment { a, b, line: BORDER, segment: 0 }));
        }
        Self::of(pieces, cell_mm)
    }

    /// Only those segments of `lines` that lie within about `reach_mm` of the beads that `chosen`
    /// names.
    pub fn around(lines: &[Line], chosen: impl Fn(usize) -> bool, reach_mm: f64, cell_mm: f64) -> Self {
        let points = lines.iter().flat_map(|l| l.points.iter().copied());
        let bounds = Bounds2::of(points).unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
        // Coarse cells of the size of the reach: a segment counts as near if it passes one of the
        // nine cells around a chosen bead.
        let cells = CellGrid::covering(bounds, reach_mm, 4000);
        let mut is_near = vec![false; cells.nx * cells.ny];
        for (l, line) in lines.iter().enumerate().filter(|l| chosen(l.0)) {
            for p in pieces_of(l, line) {
                cells.for_each_passed(p.a, p.b, |cell| {
                    let at = [cell % cells.nx, cell / cells.nx];
                    cells.neighbourhood(at, 1).for_each(|at| is_near[cells.index(at)] = true);
                });
            }
        }
        let mut pieces = Vec::new();
        for (l, line) in lines.iter().enumerate() {
            pieces.extend(pieces_of(l, line).filter(|p| {
                let mut near = false;
                cells.for_each_passed(p.a, p.b, |cell| near |= is_near[cell]);
                near
            }));
        }
        Self::of(pieces, cell_mm)
    }

    /// A copy with those segments that lie within two cells of `places`, at the positions that
    /// `lines` have now. The cells are those of the old positions, so lines may have moved by less
    /// than a cell.
    pub fn near(&self, lines: &[Line], places: &[DVec2]) -> Self {
        let cells = &self.buckets.cells;
        let mut is_near = vec![false; self.pieces.len()];
        for &p in places {
            for at in cells.neighbourhood(cells.cell_of(p), 2) {
                self.buckets.members(cells.index(at)).iter().for_each(|&m| is_near[m as usize] = true);
            }
        }
        let moved = |p: &BeadSegment| {
            // The border stays; bead segments are read anew, because the lines were moved after the
            // cells were filled.
            if p.line == BORDER {
                return *p;
            }
            let (a, b) = lines[p.line as usize].segment(p.segment as usize);
            BeadSegment { a, b, ..*p }
        };
        let near = self.pieces.iter().zip(is_near).filter(|p| p.1);
        Self::of(near.map(|p| moved(p.0)).collect(), cells.cell_mm)
    }

    fn of(pieces: Vec<BeadSegment>, cell_mm: f64) -> Self {
        let ends = pieces.iter().flat_map(|p| [p.a, p.b]);
        let bounds = Bounds2::of(ends).unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
        let cells = CellGrid::covering(bounds, cell_mm, 4000);
        let buckets =
            Buckets::new(cells, pieces.len(), |i, add| cells.for_each_passed(pieces[i].a, pieces[i].b, add));
        Self { pieces, buckets }
    }

    /// Distance from `p` along the unit vector `way` to the next bead or border within `far_mm`,
    /// and whether it is the border.
    ///
    /// `own` is line, segment and count: segments of that line within that count of that segment
    /// are skipped, because a bead is no neighbour to itself nearby.
    pub fn ray(&self, p: DVec2, way: DVec2, far_mm: f64, own: (usize, usize, usize)) -> Option<(f64, bool)> {
        let skips = |line: usize, segment: usize| line == own.0 && segment.abs_diff(own.1) <= own.2;
        self.hit(p, way, far_mm, skips).map(|h| (h.distance_mm, h.line.is_none()))
    }

    /// The first segment that the ray from `p` along the unit vector `way` meets within `far_mm`.
    /// Segments for which `skips` is true are left out.
    pub fn hit(
        &self,
        p: DVec2,
        way: DVec2,
        far_mm: f64,
        skips: impl Fn(usize, usize) -> bool,
    ) -> Option<Hit> {
        let end = p + far_mm * way;
        let mut best: Option<(f64, u32)> = None;
        self.buckets.cells.for_each_passed(p, end, |cell| {
            for &m in self.buckets.members(cell) {
                let piece = &self.pieces[m as usize];
                let d = piece.b - piece.a;
                let to = piece.a - p;
                // Most segments are missed by the ray, so the division waits until both parameters
                // are known to be in range.
                let det = cross(way, d);
                let (size, sign) = (det.abs(), det.signum());
                let (t, u) = (sign * cross(to, d), sign * cross(to, way));
                let nearest = best.map_or(far_mm, |b| b.0);
                // The tolerance at the ends of a segment keeps a ray from slipping through the
                // vertex between two segments.
                let hit = u >= -1e-9 * size && u <= (1.0 + 1e-9) * size && t > 0.0 && t <= nearest * size;
                if hit && (piece.line == BORDER || !skips(piece.line as usize, piece.segment as usize)) {
                    let t = t / size;
                    if best.is_none_or(|b| t < b.0) {
                        best = Some((t, m));
                    }
                }
            }
        });
        best.map(|(distance_mm, m)| {
            let piece = &self.pieces[m as usize];
            Hit {
                distance_mm,
                line: (piece.line != BORDER).then_some(piece.line as usize),
                segment: piece.segment as usize,
            }
        })
    }

    /// Whether a bead crosses the straight way from `a` to `b`; segments that end at one of the
    /// `own` points are skipped.
    pub fn between(&self, a: DVec2, b: DVec2, own: [DVec2; 2]) -> bool {
        let mut blocked = false;
        self.buckets.cells.for_each_passed(a, b, |cell| {
            for &m in self.buckets.members(cell) {
                let piece = &self.pieces[m as usize];
                let ends = [piece.a, piece.b];
                if piece.line == BORDER || own.iter().any(|p| ends.contains(p)) {
                    continue;
                }
                // Touching counts as crossing: a joint through the end of another bead would be
                // laid on top of it.
                blocked |= segment::meeting([a, b], ends) != Meeting::Apart;
            }
        });
        blocked
    }

    /// Pairs of segments, as line and segment, that cross or touch without following each other on a line.
    pub fn crossings(&self) -> Vec<[(usize, usize); 2]> {
        let mut out = Vec::new();
        let cells = &self.buckets.cells;
        // Segments of the same cell seen before.
        let mut met: Vec<BeadSegment> = Vec::new();
        for cell in 0..cells.nx * cells.ny {
            met.clear();
            for &i in self.buckets.members(cell) {
                let p = self.pieces[i as usize];
                if p.line == BORDER {
                    continue;
                }
                for q in &met {
                    // A segment and its successor share a point on purpose.
                    let follows = p.line == q.line && (p.a == q.b || p.b == q.a);
                    if !follows && segment::meeting([p.a, p.b], [q.a, q.b]) != Meeting::Apart {
                        out.push([q, &p].map(|s| (s.line as usize, s.segment as usize)));
                    }
                }
                met.push(p);
            }
        }
        // A pair that shares several cells is found in each of them.
        out.sort_unstable();
        out.dedup();
        out
    }

    /// The space of a bead at a vertex: all of the distance to the border, half of the distance to
    /// the next bead. `free_mm` stands in where neither is met within `far_mm`.
    pub fn reach(&self, lines: &[Line], line: usize, vertex: usize, far_mm: f64, free_mm: f64) -> Reach {
        let l = &lines[line];
        let t = l.tangent(vertex);
        let left = DVec2::new(-t.y, t.x);
        // The last segments of a closed line touch its first vertex, so near the seam the whole
        // line is skipped.
        let n = l.n_segments();
        let near = if l.closed && (vertex < 3 || vertex + 3 > n) { n } else { 3 };
        let ray = |way: DVec2, far_mm: f64| self.ray(l.points[vertex], way, far_mm, (line, vertex, near));
        // Most neighbours are much nearer than `far_mm`, and a short ray passes few cells. The long
        // ray is tried only where the short one finds no segment.
        let side = |way: DVec2| match ray(way, 0.7 * far_mm).or_else(|| ray(way, far_mm)) {
            Some((d, true)) => d,
            Some((d, false)) => 0.5 * d,
            None => free_mm,
        };
        Reach { left_mm: side(left), right_mm: side(-left) }
    }
}

/// Values smoothed along a line, `times` over; ends of open lines stay.
pub fn smooth<T>(values: &mut [T], closed: bool, times: usize)
where
    T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let n = values.len();
    if n < 3 {
        return;
    }
    for _ in 0..times {
        let old = values.to_vec();
        let range = if closed { 0..n } else { 1..n - 1 };
        for i in range {
            values[i] = (old[(i + n - 1) % n] + old[(i + 1) % n]) * 0.25 + old[i] * 0.5;
        }
    }
}
