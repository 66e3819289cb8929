//! Measures the space of a bead between its neighbours, which decides its width.
//!
//! Beads and the border of the area to be filled are stored as segments in square buckets. From a point of
//! a bead one ray goes to the left and one to the right, square to the bead. The distance to a neighbouring
//! bead is shared with it; the distance to the border belongs to the bead alone:
//!
//! ```text
//!    ------------------------- neighbour
//!         ^  d1                        reach to the left: d1 / 2
//!    -----o------------------- bead
//!         v  d2                        reach to the right: d2
//!    ######################### border
//! ```
//!
//! Where a bead ends on a border ahead, its neighbour has ended earlier. The space beside the bead then
//! belongs to the joint of the two, so the bead keeps the reach it had before. The sum of both reaches is
//! the width of the bead's strip;
//! [`bead_width_mm`](grainpath_core::units::bead_width_mm) turns it into the width that is printed.
//! The space is exact for parallel beads. For beads that converge at an angle it is too large by a factor
//! of one over the cosine of half the angle. Cost: a ray passes the buckets up to what it meets, whatever the size of
//! the region. Most rays need no bucket: along a line, the ray of a vertex meets the line that the one before it met.

use std::collections::HashSet;
use std::ops::Range;

use grainpath_core::buckets::{Buckets, CellGrid};
use grainpath_core::math::{cos, cross};
use grainpath_core::poly::edges;
use grainpath_core::polyline;
use grainpath_core::segment::{self, Meeting};
use grainpath_core::tuned::Tuned;
use grainpath_core::{Bounds2, DVec2, Region};

/// Distance between the points of a line, in spacings. Measured: row `fill.field.widths.STEP_BEADS` of `cargo xtask
/// bench constants`.
pub(super) static STEP_BEADS: Tuned<f64> = Tuned::new("fill.field.widths.STEP_BEADS", 0.55);
/// Nothing farther away than this is a neighbour of a bead, in spacings. Measured: row `fill.field.widths.FAR_BEADS` of
/// `cargo xtask bench constants`.
pub(super) static FAR_BEADS: Tuned<f64> = Tuned::new("fill.field.widths.FAR_BEADS", 1.8);
/// Side of the cells that segments are sorted into, in spacings. Measured: it changes speed alone; a layer along waves takes 0.29 to
/// 0.30 s of processor time with 0.55, 0.7 and 0.9, one along the lines of two charges 0.51, 0.49 and 0.52 s.
pub(super) const CELL_BEADS: f64 = 0.7;
/// This many segments before and behind a point are no neighbours of it. Source: derived. Three steps of [`STEP_BEADS`]
/// are 1.65 spacings; a line that returns beside itself within them turns more tightly than two beads that touch.
pub(super) const OWN_SEGMENTS: usize = 3;

/// Where another line ends beside a line, the line gets a point this far before and one this far behind the place, in
/// spacings. Source: measured on the field lines of two charges and on a spiral (`cargo xtask bench jobs fields`, open ends):
/// with 0.1 and 0.2, 0.94 and 0.91, and 0.90 and 0.82 % stay open, 0.99 and 1.01, and 0.56 and 0.69 % are laid twice, and beads
/// lie 2.54 and 2.61, and 3.28 and 3.41 degrees off.
const BESIDE_END: f64 = 0.1;

/// The centreline of a bead being laid, with points at about equal steps, but for those of [`with_steps`].
#[derive(Debug, Clone)]
pub(crate) struct Line {
    pub points: Vec<DVec2>,
    pub closed: bool,
}

impl Line {
    /// Number of straight segments.
    pub(crate) fn n_segments(&self) -> usize {
        if self.closed { self.points.len() } else { self.points.len().saturating_sub(1) }
    }

    /// Both ends of segment `i`.
    pub(crate) fn segment(&self, i: usize) -> (DVec2, DVec2) {
        (self.points[i], self.points[(i + 1) % self.points.len()])
    }

    /// Unit vector along the line at vertex `i`.
    pub(crate) fn tangent(&self, i: usize) -> DVec2 {
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

    /// The line with a point `apart_mm` before and one behind each of these places, given by a segment and a point on it, and
    /// the indices of these points. Inner points within twice that distance of a place make room for them.
    fn with_points_around(&self, places: &[(usize, DVec2)], apart_mm: f64) -> (Self, Vec<usize>) {
        // The distance of each point along the line, and the length of the whole line.
        let mut along_mm = vec![0.0];
        for (a, b) in (0..self.n_segments()).map(|s| self.segment(s)) {
            along_mm.push(along_mm[along_mm.len() - 1] + a.distance(b));
        }
        let length_mm = along_mm[self.n_segments()];
        let mut at: Vec<f64> =
            places.iter().map(|&(s, p)| along_mm[s] + self.points[s].distance(p)).collect();
        at.sort_by(f64::total_cmp);
        let is_near = |mm: f64| {
            let next = at.partition_point(|a| *a < mm);
            at[next.saturating_sub(1)..].iter().take(2).any(|a| (a - mm).abs() < 2.0 * apart_mm)
        };
        let last = self.points.len() - 1;
        let stays = |v: &usize| (!self.closed && (*v == 0 || *v == last)) || !is_near(along_mm[*v]);
        // Distance along the line, point, and whether it is new.
        let old = (0..=last).filter(stays).map(|v| (along_mm[v], self.points[v], false));
        let mut all: Vec<(f64, DVec2, bool)> = old.collect();
        for mm in at.iter().flat_map(|a| [a - apart_mm, a + apart_mm]) {
            // So near to an end of the line nothing changes before it.
            if mm > 0.5 * apart_mm && mm < length_mm - 0.5 * apart_mm {
                let s = along_mm.partition_point(|a| *a <= mm).clamp(1, self.n_segments()) - 1;
                let (a, b) = self.segment(s);
                let share = (mm - along_mm[s]) / (along_mm[s + 1] - along_mm[s]);
                all.push((mm, a.lerp(b, share), true));
            }
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Two lines may end at one place, on both sides of this one.
        all.dedup_by(|next, at| next.2 && at.2 && next.0 - at.0 < 0.5 * apart_mm);
        let new = (0..all.len()).filter(|&v| all[v].2).collect();
        (Self { points: all.into_iter().map(|p| p.1).collect(), closed: self.closed }, new)
    }
}

/// Points at which lines were cut. Such an end is no end of a bead, so it stays where it is, and coordinates can be compared exactly.
#[derive(Default)]
pub(super) struct Cuts(HashSet<[u64; 2]>);

impl Cuts {
    /// Adds a point.
    pub(super) fn insert(&mut self, p: DVec2) {
        self.0.insert(bits_of(p));
    }

    /// Whether a line was cut at this point.
    pub(super) fn contains(&self, p: DVec2) -> bool {
        self.0.contains(&bits_of(p))
    }
}

/// The bits of both coordinates, which tell points apart that do not move.
pub(super) fn bits_of(p: DVec2) -> [u64; 2] {
    p.to_array().map(f64::to_bits)
}

/// The stretches of a line that deviate from the field's axis by `farthest_rad` at most; stretches shorter
/// than `shortest_mm` are left out. `cosine` is that of the angle between the axis at a point and a unit vector.
pub(super) fn stretches_along(
    line: Line,
    cosine: &dyn Fn(DVec2, DVec2) -> f64,
    farthest_rad: f64,
    shortest_mm: f64,
) -> Vec<Line> {
    let least = cos(farthest_rad);
    let follows = |(a, b): (DVec2, DVec2)| {
        (b - a).try_normalize().is_none_or(|along| cosine(0.5 * (a + b), along) >= least)
    };
    let n = line.n_segments();
    let good: Vec<bool> = (0..n).map(|s| follows(line.segment(s))).collect();
    let Some(bad) = good.iter().position(|good| !good) else { return vec![line] };
    // A ring is opened where it first deviates from the field.
    let first = if line.closed { bad } else { 0 };
    let mut out = Vec::new();
    let mut stretch: Vec<DVec2> = Vec::new();
    for s in (first..n).chain(0..first) {
        if !good[s] {
            out.push(std::mem::take(&mut stretch));
            continue;
        }
        let (a, b) = line.segment(s);
        if stretch.is_empty() {
            stretch.push(a);
        }
        stretch.push(b);
    }
    out.push(stretch);
    out.retain(|points| polyline::length_mm(points, false) > shortest_mm);
    out.into_iter().map(|points| Line { points, closed: false }).collect()
}

/// The space of a bead at a point: its reach to the left and to the right, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reach {
    pub left_mm: f64,
    pub right_mm: f64,
}

/// The first segment that a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hit {
    pub distance_mm: f64,
    /// `None` for the border.
    pub line: Option<usize>,
    pub segment: usize,
    /// Unit vector along the segment.
    pub along: DVec2,
}

#[derive(Clone, Copy)]
struct BeadSegment {
    a: DVec2,
    b: DVec2,
    /// Number of the line, [`BORDER`] or [`GONE`], and of the segment.
    line: u32,
    segment: u32,
}

const BORDER: u32 = u32::MAX;
/// Stands for the line of a piece that is gone ([`Neighbours::keep`]).
const GONE: u32 = u32::MAX - 1;

impl BeadSegment {
    /// How far away the ray from `p` along the unit vector `way` meets the segment, mm, if it does so within `far_mm`.
    #[inline]
    fn met_by(&self, p: DVec2, way: DVec2, far_mm: f64) -> Option<f64> {
        let (d, to) = (self.b - self.a, self.a - p);
        // The ray misses most segments, so the division is done only when both parameters are known
        // to be in range. All four comparisons are made without a branch: a processor foresees none of them.
        let det = cross(way, d);
        let (size, sign) = (det.abs(), det.signum());
        let (t, u) = (sign * cross(to, d), sign * cross(to, way));
        // The tolerance at the ends of a segment keeps a ray from slipping through the
        // vertex between two segments.
        let hit = (u >= -1e-9 * size) & (u <= (1.0 + 1e-9) * size) & (t > 0.0) & (t <= far_mm * size);
        hit.then(|| t / size)
    }
}

fn pieces_of(l: usize, line: &Line) -> impl Iterator<Item = BeadSegment> + '_ {
    (0..line.n_segments()).map(move |s| {
        let (a, b) = line.segment(s);
        BeadSegment { a, b, line: l as u32, segment: s as u32 }
    })
}

/// The beads of an infill region and its border, searchable for the neighbours of a bead.
pub(crate) struct Neighbours {
    pieces: Vec<BeadSegment>,
    buckets: Buckets,
}

impl Neighbours {
    /// Indexes all `lines` and the border of the region they fill. Cells are `cell_mm` wide.
    pub(crate) fn new(lines: &[Line], border: &Region, cell_mm: f64) -> Self {
        Self::beside(lines, &[], border, cell_mm)
    }

    /// As [`Self::new`], with `others` beside the lines, whose numbers follow those of the lines.
    pub(super) fn beside(lines: &[Line], others: &[Line], border: &Region, cell_mm: f64) -> Self {
        let all = || lines.iter().chain(others);
        let n_edges: usize = border.contours().map(|c| c.len()).sum();
        let mut pieces = Vec::with_capacity(all().map(Line::n_segments).sum::<usize>() + n_edges);
        all().enumerate().for_each(|(l, line)| pieces.extend(pieces_of(l, line)));
        for contour in border.contours() {
            pieces.extend(edges(contour).map(|(a, b)| BeadSegment { a, b, line: BORDER, segment: 0 }));
        }
        Self::from_pieces(pieces, cell_mm)
    }

    /// Keeps these segments of the `n_lines` lines: for each line that remains, in their order, the number of the line of which it
    /// was a part, and its segments there.
    pub(super) fn keep(&mut self, n_lines: usize, kept: &[(usize, Range<usize>)]) {
        let mut rest = kept.iter().enumerate().peekable();
        for piece in self.pieces.iter_mut().filter(|piece| piece.line != BORDER) {
            let (line, segment) = (piece.line as usize, piece.segment as usize);
            if line >= n_lines {
                // Lines beside those that are kept follow them.
                piece.line = (line - n_lines + kept.len()) as u32;
                continue;
            }
            // Pieces come in the order of lines and segments, as what is kept of them does.
            while rest.next_if(|(_, (l, s))| (*l, s.end) <= (line, segment)).is_some() {}
            match rest.peek() {
                Some((k, (l, s))) if *l == line && s.start <= segment => {
                    (piece.line, piece.segment) = (*k as u32, (segment - s.start) as u32);
                }
                _ => piece.line = GONE,
            }
        }
    }

    /// Whether a piece is gone.
    pub(super) fn is_gone(&self, piece: u32) -> bool {
        self.pieces[piece as usize].line == GONE
    }

    /// Indexes only those segments of `lines` that lie within about `reach_mm` of the lines for which
    /// `chosen` is true.
    pub(crate) fn around(
        lines: &[Line],
        chosen: impl Fn(usize) -> bool,
        reach_mm: f64,
        cell_mm: f64,
    ) -> Self {
        let points = lines.iter().flat_map(|l| l.points.iter().copied());
        let bounds = Bounds2::around_points(points).unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
        // Coarse cells of the size of the reach are enough: a segment counts as near if it passes one of
        // the nine cells around a chosen bead.
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
        Self::from_pieces(pieces, cell_mm)
    }

    /// Indexes those segments of `lines`, and of `others` beside them, that lie within `reach_mm` of a place. Numbers are those of
    /// [`Self::beside`].
    fn around_places(
        lines: &[Line],
        others: &[Line],
        places: impl Iterator<Item = DVec2>,
        reach_mm: f64,
        cell_mm: f64,
    ) -> Self {
        let all = || lines.iter().chain(others);
        let points = all().flat_map(|l| l.points.iter().copied());
        let bounds = Bounds2::around_points(points).unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
        let longest = all().flat_map(|line| (0..line.n_segments()).map(|s| line.segment(s)));
        let longest_mm = longest.map(|(a, b)| a.distance_squared(b)).fold(0.0, f64::max).sqrt();
        // What lies within the reach is part of a segment with an end at most half of its length farther away.
        let near = Near::new(bounds, places, reach_mm + 0.5 * longest_mm);
        let mut pieces = Vec::new();
        for (l, line) in all().enumerate() {
            pieces.extend(pieces_of(l, line).filter(|p| near.contains(p.a) || near.contains(p.b)));
        }
        Self::from_pieces(pieces, cell_mm)
    }

    /// Copies the segments that lie within two cells of `places`, with the positions that `lines`
    /// have now. Their cells are found from the old positions, so lines may have moved by less than a
    /// cell.
    pub(crate) fn near(&self, lines: &[Line], places: &[DVec2]) -> Self {
        let cells = &self.buckets.cells;
        let mut is_near = vec![false; self.pieces.len()];
        for &p in places {
            for at in cells.neighbourhood(cells.cell_of(p), 2) {
                self.buckets.members(cells.index(at)).iter().for_each(|&m| is_near[m as usize] = true);
            }
        }
        let moved = |p: &BeadSegment| {
            // The border has not moved. Bead segments are read again, because the lines have moved since
            // the cells were filled.
            if p.line == BORDER {
                return *p;
            }
            let (a, b) = lines[p.line as usize].segment(p.segment as usize);
            BeadSegment { a, b, ..*p }
        };
        let near = self.pieces.iter().zip(is_near).filter(|p| p.1);
        Self::from_pieces(near.map(|p| moved(p.0)).collect(), cells.cell_mm)
    }

    fn from_pieces(pieces: Vec<BeadSegment>, cell_mm: f64) -> Self {
        let ends = pieces.iter().flat_map(|p| [p.a, p.b]);
        let bounds = Bounds2::around_points(ends).unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
        let cells = CellGrid::covering(bounds, cell_mm, 4000);
        let buckets = Buckets::of_segments(cells, pieces.len(), |i| [pieces[i].a, pieces[i].b]);
        Self { pieces, buckets }
    }

    /// The first segment that the ray from `p` along the unit vector `way` meets within `far_mm`.
    /// Segments for which `skips` is true are left out.
    pub(crate) fn hit(
        &self,
        p: DVec2,
        way: DVec2,
        far_mm: f64,
        skips: impl Fn(usize, usize) -> bool,
    ) -> Option<Hit> {
        self.first(p, way, far_mm, skips).map(|(distance_mm, m)| {
            let piece = &self.pieces[m as usize];
            Hit {
                distance_mm,
                line: (piece.line != BORDER).then_some(piece.line as usize),
                segment: piece.segment as usize,
                along: (piece.b - piece.a).normalize_or_zero(),
            }
        })
    }

    /// Distance and index of the segment that [`Self::hit`] returns.
    fn first(
        &self,
        p: DVec2,
        way: DVec2,
        far_mm: f64,
        skips: impl Fn(usize, usize) -> bool,
    ) -> Option<(f64, u32)> {
        let (mut best, mut nearest_mm) = (None, far_mm);
        self.buckets.cells.for_each_along(p, way, far_mm, |cell| {
            for &m in self.buckets.members(cell) {
                let piece = &self.pieces[m as usize];
                let Some(mm) = piece.met_by(p, way, nearest_mm) else { continue };
                let counts = match piece.line {
                    BORDER => true,
                    GONE => false,
                    line => !skips(line as usize, piece.segment as usize),
                };
                if counts && (best.is_none() || mm < nearest_mm) {
                    (best, nearest_mm) = (Some(m), mm);
                }
            }
            nearest_mm
        });
        best.map(|m| (nearest_mm, m))
    }

    /// Whether a bead crosses the straight line from `a` to `b`. Segments that end at one of the `own`
    /// points are skipped.
    pub(crate) fn between(&self, a: DVec2, b: DVec2, own: [DVec2; 2]) -> bool {
        let mut blocked = false;
        self.buckets.cells.for_each_passed(a, b, |cell| {
            for &m in self.buckets.members(cell) {
                let piece = &self.pieces[m as usize];
                let ends = [piece.a, piece.b];
                if piece.line >= GONE || own.iter().any(|p| ends.contains(p)) {
                    continue;
                }
                // Touching counts as crossing: a joint through the end of another bead would be
                // laid on top of it.
                blocked |= segment::meeting([a, b], ends) != Meeting::Apart;
            }
        });
        blocked
    }

    /// Pairs of segments that cross or touch and are not neighbours on a line, each given as line and segment.
    pub(crate) fn crossings(&self) -> Vec<[(usize, usize); 2]> {
        let cross = |i: usize, j: usize| {
            let (p, q) = (&self.pieces[i], &self.pieces[j]);
            // A segment and its successor share a point on purpose.
            let follows = p.line == q.line && (p.a == q.b || p.b == q.a);
            let is_border = p.line == BORDER || q.line == BORDER;
            !is_border && !follows && segment::meeting([p.a, p.b], [q.a, q.b]) != Meeting::Apart
        };
        let place = |i: usize| (self.pieces[i].line as usize, self.pieces[i].segment as usize);
        // Pieces are in the order of lines and segments, and so are the pairs.
        self.buckets.pairs(cross).into_iter().map(|pair| pair.map(place)).collect()
    }

    /// What lies to the left and to the right of every vertex of the lines, within `far_mm`, line by line. Where nothing ends or turns
    /// back between the rays of two vertices that follow each other, the second ray meets the line that the first one met, so that only
    /// the pieces beside the one met there are tried.
    pub(super) fn sides(&self, lines: &[Line], far_mm: f64) -> Vec<Vec<[Side; 2]>> {
        let ends = LineEnds::new(self);
        let of_line = |(number, line): (usize, &Line)| {
            // The piece of another line that the ray of the vertex before met on each side, and where.
            let mut before: [Option<(u32, DVec2)>; 2] = [None; 2];
            let at = |(vertex, &p): (usize, &DVec2)| {
                let along = line.tangent(vertex);
                let skips = |other: usize, segment: usize| other == number && is_own(line, vertex, segment);
                let cell = self.buckets.cells.index(self.buckets.cells.cell_of(p));
                let (is_near_border, near) = (ends.is_near_border[cell], ends.around.members(cell));
                let mut sides = [Side::Open; 2];
                for (k, way) in [along.perp(), -along.perp()].into_iter().enumerate() {
                    let beside = before[k].filter(|_| !is_near_border).and_then(|(m, met)| {
                        let (mm, m) = self.first_beside(p, way, along, m)?;
                        // Between both rays lies a narrow area. A line can come into it only by ending or turning back there, since
                        // lines do not cross.
                        let corners = || [line.points[vertex - 1], met, p, p + mm * way];
                        (near.is_empty() || ends.are_outside(near, corners())).then_some((mm, m))
                    });
                    let found = beside.or_else(|| self.first(p, way, far_mm, skips));
                    // Borders have corners, and a line that meets itself goes round: there rays look around themselves.
                    before[k] = found.map(|(mm, m)| (m, p + mm * way)).filter(|(m, _)| {
                        let met = self.pieces[*m as usize].line;
                        met != BORDER && met as usize != number
                    });
                    sides[k] = self.side(along, found);
                }
                sides
            };
            line.points.iter().enumerate().map(at).collect()
        };
        lines.iter().enumerate().map(of_line).collect()
    }

    /// Distance and index of a piece of a line or a piece beside it that the ray to one side of a line that runs `along` meets within
    /// [`BESIDE_CELLS`].
    fn first_beside(&self, p: DVec2, way: DVec2, along: DVec2, m: u32) -> Option<(f64, u32)> {
        let &BeadSegment { a, b, line, .. } = self.pieces.get(m as usize)?;
        let far_mm = BESIDE_CELLS as f64 * self.buckets.cells.cell_mm;
        // Lines have points at equal steps, so the next ray mostly meets the next piece.
        let (next, last) = (m + 1, m.wrapping_sub(1));
        let order = if along.dot(b - a) > 0.0 { [next, m, last] } else { [last, m, next] };
        order.into_iter().find_map(|m| {
            let piece = self.pieces.get(m as usize).filter(|piece| piece.line == line)?;
            piece.met_by(p, way, far_mm).map(|mm| (mm, m))
        })
    }

    /// What a ray across a line met.
    fn side(&self, along: DVec2, found: Option<(f64, u32)>) -> Side {
        let Some((mm, m)) = found else { return Side::Open };
        let piece = &self.pieces[m as usize];
        if piece.line != BORDER {
            return Side::Line { distance_mm: mm, piece: m };
        }
        let sine = cross(along, (piece.b - piece.a).normalize_or_zero()).abs();
        if sine > AHEAD_SINE { Side::Ahead(mm) } else { Side::Border(mm) }
    }
}

/// Adds points to lines just before and just behind the places where another line ends beside them and goes on no
/// farther: there their space changes at once. `others` lie beside the lines. At `cuts` lines do not end. Returns the lines, and for
/// each the indices of these points.
pub(super) fn with_steps(
    lines: Vec<Line>,
    others: &[Line],
    cuts: &Cuts,
    border: &Region,
    spacing_mm: f64,
) -> (Vec<Line>, Vec<Vec<usize>>) {
    let cell_mm = CELL_BEADS * spacing_mm;
    let edge = Neighbours::new(&[], border, cell_mm);
    // For each end inside the region its line, its vertex and the direction in which the line would go on.
    let mut ends: Vec<(usize, usize, DVec2)> = Vec::new();
    for (l, line) in lines.iter().enumerate().filter(|(_, line)| !line.closed && line.points.len() > 1) {
        let last = line.points.len() - 1;
        for (end, before) in [(0, 1), (last, last - 1)] {
            let p = line.points[end];
            let onward = (p - line.points[before]).normalize_or_zero();
            // Where the border lies ahead, the lines beside this one end on it too.
            if !cuts.contains(p) && edge.hit(p, onward, spacing_mm, |_, _| false).is_none() {
                ends.push((l, end, onward));
            }
        }
    }
    let at = |&(l, end, _): &(usize, usize, DVec2)| lines[l].points[end];
    let neighbours = Neighbours::around_places(&lines, others, ends.iter().map(at), spacing_mm, cell_mm);
    let mut places: Vec<Vec<(usize, DVec2)>> = vec![Vec::new(); lines.len()];
    for (l, end, onward) in ends {
        let p = lines[l].points[end];
        let own = |other: usize, s: usize| other == l && s.abs_diff(end) <= OWN_SEGMENTS;
        for way in [onward.perp(), -onward.perp()] {
            if let Some(Hit { line: Some(other), segment, .. }) = neighbours.hit(p, way, spacing_mm, own)
                && let Some(line) = lines.get(other)
            {
                let (a, b) = line.segment(segment);
                places[other].push((segment, segment::closest_point(p, a, b)));
            }
        }
    }
    let with_points = |(line, places): (Line, Vec<(usize, DVec2)>)| {
        if places.is_empty() {
            (line, Vec::new())
        } else {
            line.with_points_around(&places, BESIDE_END * spacing_mm)
        }
    };
    lines.into_iter().zip(places).map(with_points).unzip()
}

/// The surroundings of places.
pub(super) struct Near {
    cells: CellGrid,
    is_near: Vec<bool>,
}

impl Near {
    /// The surroundings up to about `reach_mm` around the places.
    pub(super) fn new(bounds: Bounds2, places: impl Iterator<Item = DVec2>, reach_mm: f64) -> Self {
        let cells = CellGrid::covering(bounds, reach_mm, 4000);
        let mut is_near = vec![false; cells.nx * cells.ny];
        for p in places {
            cells.neighbourhood(cells.cell_of(p), 1).for_each(|at| is_near[cells.index(at)] = true);
        }
        Self { cells, is_near }
    }

    fn contains(&self, p: DVec2) -> bool {
        self.is_near[self.cells.index(self.cells.cell_of(p))]
    }

    /// The first and the last point of each run of points of a line that lie here, of those longer than `shortest_mm`.
    pub(super) fn runs(&self, line: &Line, shortest_mm: f64) -> Vec<[usize; 2]> {
        let near: Vec<bool> = line.points.iter().map(|&p| self.contains(p)).collect();
        let mut runs = Vec::new();
        let mut from = 0;
        for run in near.chunk_by(|a, b| a == b) {
            let last = from + run.len() - 1;
            if run[0] && polyline::length_mm(&line.points[from..=last], false) > shortest_mm {
                runs.push([from, last]);
            }
            from = last + 1;
        }
        runs
    }

    /// Whether a point of the line lies here.
    pub(super) fn passed_by(&self, line: &Line) -> bool {
        line.points.iter().any(|&p| self.contains(p))
    }
}

/// Whether a segment lies so near along its line to one of the vertices that it is no neighbour of it.
pub(super) fn is_own(line: &Line, vertex: usize, segment: usize) -> bool {
    // The last segments of a closed line touch its first vertex, so near the seam the whole line is skipped.
    let n = line.n_segments();
    let at_seam = line.closed && (vertex < OWN_SEGMENTS || vertex + OWN_SEGMENTS > n);
    let near = if at_seam { n } else { OWN_SEGMENTS };
    segment.abs_diff(vertex) <= near
}

/// Where lines begin, end or turn sharply, and where borders pass.
struct LineEnds {
    /// For each cell, whether a border passes within [`AROUND_CELLS`] of it.
    is_near_border: Vec<bool>,
    /// The ends and the sharp turns of lines.
    points: Vec<DVec2>,
    /// For each cell, those of them that lie within [`AROUND_CELLS`] of it.
    around: Buckets,
}

impl LineEnds {
    fn new(neighbours: &Neighbours) -> Self {
        let cells = neighbours.buckets.cells;
        let mut is_near_border = vec![false; cells.nx * cells.ny];
        let mut points = Vec::new();
        let goes_straight_on = |first: &BeadSegment, second: &BeadSegment| {
            let (a, b) = (first.b - first.a, second.b - second.a);
            let dot = a.dot(b);
            let least = SHARP_COS * SHARP_COS * a.length_squared() * b.length_squared();
            first.line == second.line && dot > 0.0 && dot * dot >= least
        };
        // Pieces come line by line. The seam of a closed line counts as an end.
        let mut before: Option<&BeadSegment> = None;
        for piece in &neighbours.pieces {
            if piece.line == BORDER {
                cells.for_each_passed(piece.a, piece.b, |cell| {
                    let at = [cell % cells.nx, cell / cells.nx];
                    let around = cells.neighbourhood(at, AROUND_CELLS);
                    around.for_each(|at| is_near_border[cells.index(at)] = true);
                });
            } else if !before.is_some_and(|before| goes_straight_on(before, piece)) {
                points.extend(before.map(|before| before.b).into_iter().chain([piece.a]));
            }
            before = Some(piece);
        }
        // Without a border the last piece has no other behind it.
        points.extend(before.map(|before| before.b));
        let around = Buckets::new(cells, points.len(), |i, put| {
            let around = cells.neighbourhood(cells.cell_of(points[i]), AROUND_CELLS);
            around.for_each(|at| put(cells.index(at)));
        });
        Self { is_near_border, points, around }
    }

    /// Whether none of these ends and sharp turns lies in the box around the corners.
    fn are_outside(&self, near: &[u32], [a, b, c, d]: [DVec2; 4]) -> bool {
        let (least, most) = (a.min(b).min(c.min(d)), a.max(b).max(c.max(d)));
        let is_outside = |p: DVec2| (p.cmplt(least) | p.cmpgt(most)).any();
        near.iter().all(|&i| is_outside(self.points[i as usize]))
    }
}

/// A ray meets the line that the ray before it met within so many cells. Source: derived; two cells of [`CELL_BEADS`] reach beyond
/// the line beside a line.
const BESIDE_CELLS: usize = 2;
/// What ends or turns back between two rays is looked for within so many cells of the second one's vertex. Source: derived. The first
/// ray lies a step of [`STEP_BEADS`] before it, which is less than a cell.
const AROUND_CELLS: usize = BESIDE_CELLS + 1;
/// A line turns sharply where the cosine of its turn at a vertex is smaller. Source: derived. 0.95 is 18 degrees. A line that goes back
/// within the length of a step turns by far more at one of its vertices.
const SHARP_COS: f64 = 0.95;

/// A border counts as ahead if it meets a line at more than 30 degrees. Source: derived. At such an angle the next line
/// has ended less than two spacings before this one.
const AHEAD_SINE: f64 = 0.5;

/// What lies beside a line at one of its points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Side {
    /// Another line or a far part of the same one.
    Line { distance_mm: f64, piece: u32 },
    /// A border that runs with the line: its distance, mm.
    Border(f64),
    /// A border that the line ends on: its distance, mm.
    Ahead(f64),
    /// Nothing near.
    Open,
}

/// The space of a line with these sides at each of its vertices: on each side the distance to the border, or half of the
/// distance to the next bead.
///
/// Where a line ends on a border ahead, the next line has ended earlier, and the space beside this line
/// belongs to their joint. There the line keeps the reach of the nearest vertex that has a neighbour.
/// `free_mm` is used if a side has no such vertex, and where nothing is near.
pub(super) fn settled(sides: &[[Side; 2]], closed: bool, free_mm: f64) -> Vec<Reach> {
    let [left, right] = [0, 1].map(|side| settled_side(sides, side, closed, free_mm));
    left.into_iter().zip(right).map(|(left_mm, right_mm)| Reach { left_mm, right_mm }).collect()
}

/// The reaches on one side of a line, mm.
fn settled_side(sides: &[[Side; 2]], side: usize, closed: bool, free_mm: f64) -> Vec<f64> {
    let n = sides.len();
    // Vertices are counted on round a closed line, so that each has n of them before and n behind it.
    let n_before = if closed { n } else { 0 };
    let end = n + 2 * n_before;
    // The reach of a vertex that has a neighbour.
    let known = |v: usize| match sides[v % n][side] {
        Side::Line { distance_mm, .. } => Some((v, 0.5 * distance_mm)),
        Side::Border(mm) => Some((v, mm)),
        Side::Ahead(_) | Side::Open => None,
    };
    let mut before = (0..n_before).rev().find_map(known);
    let mut after: Option<(usize, f64)> = None;
    let mut looked_up_to = 0;
    let reach = |v: usize| {
        if let Some(found) = known(v) {
            before = Some(found);
            return found.1;
        }
        let Side::Ahead(mm) = sides[v % n][side] else { return free_mm };
        if looked_up_to <= v {
            after = (v + 1..end).find_map(known);
            looked_up_to = after.map_or(end, |(at, _)| at);
        }
        let nearest_mm = match (before, after) {
            (Some(before), Some(after)) if v - before.0 <= after.0 - v => before.1,
            (_, Some(found)) | (Some(found), None) => found.1,
            (None, None) => free_mm,
        };
        mm.min(nearest_mm)
    };
    (n_before..n_before + n).map(reach).collect()
}

/// Widths of the strips of a line at its vertices, mm, from its sides, for lines that lie about `spacing_mm` apart.
pub(super) fn strips(sides: &[[Side; 2]], closed: bool, spacing_mm: f64) -> Vec<f64> {
    let reaches = settled(sides, closed, 0.5 * spacing_mm);
    let mut widths: Vec<f64> = reaches.into_iter().map(|r| r.left_mm + r.right_mm).collect();
    let n = widths.len();
    if !closed && n > 3 {
        // At the end of a line the ray runs along the border, not across to the neighbour. So the
        // end takes the strip of the next point.
        (widths[0], widths[n - 1]) = (widths[1], widths[n - 2]);
    }
    smooth(&mut widths, closed, 1);
    widths
}

/// Smooths values along a line, `times` over. The ends of open lines do not change.
pub(crate) fn smooth<T>(values: &mut [T], closed: bool, times: usize)
where
    T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let n = values.len();
    if n < 3 {
        return;
    }
    for _ in 0..times {
        let old = values.to_vec();
        let mean = |before: T, at: T, after: T| (before + after) * 0.25 + at * 0.5;
        for (value, old) in values[1..].iter_mut().zip(old.windows(3)) {
            *value = mean(old[0], old[1], old[2]);
        }
        if closed {
            values[0] = mean(old[n - 1], old[0], old[1]);
            values[n - 1] = mean(old[n - 2], old[n - 1], old[0]);
        }
    }
}
