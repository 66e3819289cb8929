//! Spatial indices: they find the points near a position and the grid cells that a segment passes.
//!
//! - [`CellGrid`]: square cells over a box; it finds the cell of a point, the cells that a segment passes,
//!   and the cells in a ring around a cell.
//! - [`Buckets`]: numbered items sorted once into the cells of a grid; compact and fast to read.
//! - [`PointGrid2`] and [`PointGrid3`]: points in the plane and in space that can be added and removed.
//!
//! Lengths are mm. Answers never depend on the size of the cells or on the order in which points
//! were added: of equally near points, the one with the lowest value is taken. Building takes linear
//! time. The time of a query is proportional to the points in the cells that it visits; if a cell is about
//! as large as the query radius, these are a small multiple of the points found. Points outside the box
//! belong to the nearest cell at its border: they are always found, but more slowly.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::{DVec2, DVec3};

use crate::Bounds2;
use crate::math::cross;

/// Square cells over a box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellGrid {
    /// Lower left corner of the first cell.
    pub origin: DVec2,
    /// Side of a cell, mm.
    pub cell_mm: f64,
    /// Cells in x.
    pub nx: usize,
    /// Cells in y.
    pub ny: usize,
}

impl CellGrid {
    /// A grid of cells that covers `bounds`. The cells are larger than `cell_mm` if there would otherwise
    /// be more than `max_per_side` in x or y.
    pub fn covering(bounds: Bounds2, cell_mm: f64, max_per_side: usize) -> Self {
        let size = bounds.size();
        // A box of size zero gets one cell; the smallest positive size keeps the division finite.
        let cell_mm = cell_mm.max(size.max_element() / max_per_side as f64).max(f64::MIN_POSITIVE);
        let count = |mm: f64| (mm / cell_mm) as usize + 1;
        Self { origin: bounds.min, cell_mm, nx: count(size.x), ny: count(size.y) }
    }

    /// Column and row of the cell that contains `p`; outside the grid, those of the nearest cell.
    #[inline]
    pub fn cell_of(&self, p: DVec2) -> [usize; 2] {
        let q = ((p - self.origin) / self.cell_mm).max(DVec2::ZERO);
        // No grid has 2^31 columns or rows. A 32 bit integer takes one instruction.
        [(q.x as i32 as usize).min(self.nx - 1), (q.y as i32 as usize).min(self.ny - 1)]
    }

    /// Index of the cell in this column and row; cells are numbered row by row.
    #[inline]
    pub fn index(&self, [column, row]: [usize; 2]) -> usize {
        row * self.nx + column
    }

    /// The cells at most `n` columns and `n` rows away from a cell, including the cell itself.
    #[inline]
    pub fn neighbourhood(
        &self,
        [column, row]: [usize; 2],
        n: usize,
    ) -> impl Iterator<Item = [usize; 2]> + use<> {
        self.block(
            [column.saturating_sub(n), row.saturating_sub(n)],
            [(column + n).min(self.nx - 1), (row + n).min(self.ny - 1)],
        )
    }

    /// The cells of the block between two corner cells, row by row from below.
    #[inline]
    pub fn block(&self, low: [usize; 2], high: [usize; 2]) -> impl Iterator<Item = [usize; 2]> + use<> {
        (low[1]..=high[1]).flat_map(move |row| (low[0]..=high[0]).map(move |column| [column, row]))
    }

    /// The cells in a square ring around a cell, `ring` columns or rows away. Those outside the grid are left out.
    pub fn ring(&self, [column, row]: [usize; 2], ring: usize) -> impl Iterator<Item = [usize; 2]> + use<> {
        let (nx, ring) = (self.nx, ring as i64);
        let (column, row) = (column as i64, row as i64);
        let rows = (row - ring).max(0)..=(row + ring).min(self.ny as i64 - 1);
        // The first and the last row belong to the ring as a whole; of each row between, only its two ends do.
        rows.flat_map(move |y| {
            let (left, right) = (column - ring, column + ring);
            let whole = y == row - ring || y == row + ring;
            let within = |x: i64| (0..nx as i64).contains(&x);
            let run = if whole { left.max(0)..right.min(nx as i64 - 1) + 1 } else { 0..0 };
            let ends = [left, right].map(|x| (!whole && within(x)).then_some(x));
            ends.into_iter().flatten().chain(run).map(move |x| [x as usize, y as usize])
        })
    }

    /// The least possible distance between a point in a cell and a point in the ring `ring` around that cell, mm.
    pub fn ring_distance_mm(&self, ring: usize) -> f64 {
        // A point may lie at the border of its cell, so its distance to the first ring can be
        // zero.
        ring.saturating_sub(1) as f64 * self.cell_mm
    }

    /// A number of rings that covers all cells, whichever cell the rings surround.
    pub fn n_rings(&self) -> usize {
        self.nx.max(self.ny)
    }

    /// Calls `each` with the index of every cell that a segment passes, or misses by less than about a
    /// millionth of a cell. The part of the segment outside the grid is left out.
    pub fn for_each_passed(&self, a: DVec2, b: DVec2, mut each: impl FnMut(usize)) {
        let cell = |p: DVec2| (p - self.origin) / self.cell_mm;
        let (a, b) = (cell(a), cell(b));
        // Margin in cells around the segment. Source: derived: cell coordinates below 1e4 are
        // rounded to about 1e-12, so a margin of 1e-6 never misses a cell that is passed and hardly
        // ever adds one.
        const HAIR: f64 = 1e-6;
        // A short segment inside the grid, the usual case, passes one cell, or two beside each other.
        let least = a.min(b) - HAIR;
        let most = a.max(b) + HAIR;
        let is_inside =
            least.x >= 0.0 && least.y >= 0.0 && most.x < self.nx as f64 && most.y < self.ny as f64;
        if is_inside {
            // No grid has 2^31 columns or rows.
            let (left, right) = (least.x as i32 as usize, most.x as i32 as usize);
            let (bottom, top) = (least.y as i32 as usize, most.y as i32 as usize);
            let n_cells = (right - left + 1) * (top - bottom + 1);
            let first = bottom * self.nx + left;
            if n_cells == 1 {
                return each(first);
            }
            if left == right || bottom == top {
                let step = if left == right { self.nx } else { 1 };
                return (0..n_cells).for_each(|k| each(first + k * step));
            }
            if n_cells == 4 {
                // Besides the cells of both ends, the segment passes the cell on its side of the corner in the middle of the four.
                let d = b - a;
                let side =
                    cross(d, DVec2::new(right as f64, top as f64) - a) * if d.y < 0.0 { -1.0 } else { 1.0 };
                let hair = HAIR * (d.x.abs() + d.y.abs());
                // Whether the segment passes to the right and to the left of the corner.
                let (right_of, left_of) = (side >= -hair, side <= hair);
                let rises = (d.x > 0.0) == (d.y > 0.0);
                let upper = first + self.nx;
                for (cell, is_passed) in [
                    (first, rises || left_of),
                    (first + 1, !rises || right_of),
                    (upper, !rises || left_of),
                    (upper + 1, rises || right_of),
                ] {
                    if is_passed {
                        each(cell);
                    }
                }
                return;
            }
        }
        let (low, high) = if a.y <= b.y { (a, b) } else { (b, a) };
        // Rounds down; the result lies in the grid or one cell outside it.
        let down = |v: f64, n: usize| (v.clamp(-1.0, n as f64) + 1.0) as i64 - 1;
        let row_of = |y: f64| down(y, self.ny);
        let column = |x: f64| down(x, self.nx);
        let (first, last) = (row_of(least.y).max(0), row_of(most.y).min(self.ny as i64 - 1));
        let slope = if high.y > low.y { (high.x - low.x) / (high.y - low.y) } else { 0.0 };
        for row in first..=last {
            // The clamp prevents extrapolation beyond the ends of the segment, which could be steep.
            let x_at = |y: f64| low.x + (y.clamp(low.y, high.y) - low.y) * slope;
            let (x0, x1) = if high.y > low.y {
                (x_at(row as f64 - HAIR), x_at(row as f64 + 1.0 + HAIR))
            } else {
                (low.x, high.x)
            };
            let c0 = column(x0.min(x1) - HAIR).max(0);
            let c1 = column(x0.max(x1) + HAIR).min(self.nx as i64 - 1);
            for c in c0..=c1 {
                each(row as usize * self.nx + c as usize);
            }
        }
    }

    /// Calls `each` with the index of the cells that the ray from `p` along the unit vector `way` passes, the nearest first, as
    /// far as `each` returned last, mm, at first `far_mm`. A ray that passes a corner of cells visits one of those beside it. The
    /// part of the ray outside the grid is left out.
    ///
    /// A search for the first of many segments ends with the cell that holds it:
    /// ```
    /// use grainpath_core::{Bounds2, DVec2, buckets::CellGrid};
    ///
    /// let cells = CellGrid::covering(Bounds2 { min: DVec2::ZERO, max: DVec2::new(9.0, 1.0) }, 2.0, 1000);
    /// let mut passed = Vec::new();
    /// cells.for_each_along(DVec2::new(7.0, 0.5), -DVec2::X, 9.0, |cell| {
    ///     passed.push(cell);
    ///     if cell == 2 { 2.5 } else { 9.0 }
    /// });
    /// assert_eq!(passed, [3, 2], "from the fourth cell to the third, where a segment at 2.5 mm is met");
    /// ```
    pub fn for_each_along(&self, p: DVec2, way: DVec2, far_mm: f64, mut each: impl FnMut(usize) -> f64) {
        let at = (p - self.origin) / self.cell_mm;
        let size = DVec2::new(self.nx as f64, self.ny as f64);
        if !(at.cmpge(DVec2::ZERO).all() && at.cmplt(size).all()) {
            // A ray from outside enters the grid somewhere along its border, which the walk below does not look for.
            self.for_each_passed(p, p + far_mm * way, |cell| {
                each(cell);
            });
            return;
        }
        /// How far beyond the nearest find cells are still visited, as a share of a cell. Source: derived: as the margin of
        /// `for_each_passed`, far above the rounding of either distance.
        const HAIR: f64 = 1e-6;
        let (mut column, mut row) = (at.x as i32 as usize, at.y as i32 as usize);
        // Distance to the next side of the cell and between sides, mm.
        let sides = |at: f64, index: usize, way: f64| {
            let ahead = if way > 0.0 { (index + 1) as f64 - at } else { at - index as f64 };
            let apart_mm = self.cell_mm / way.abs();
            (if way == 0.0 { f64::INFINITY } else { ahead * apart_mm }, apart_mm)
        };
        let (mut x_mm, x_apart_mm) = sides(at.x, column, way.x);
        let (mut y_mm, y_apart_mm) = sides(at.y, row, way.y);
        // The ray leaves a cell by whichever of its two sides ahead is nearer, so no cell is visited twice.
        loop {
            let until_mm = each(row * self.nx + column) + HAIR * self.cell_mm;
            if x_mm.min(y_mm) > until_mm {
                return;
            }
            // Beyond the first column or row the index wraps around and is no less than their number.
            if x_mm < y_mm {
                column = if way.x > 0.0 { column + 1 } else { column.wrapping_sub(1) };
                x_mm += x_apart_mm;
            } else {
                row = if way.y > 0.0 { row + 1 } else { row.wrapping_sub(1) };
                y_mm += y_apart_mm;
            }
            if column >= self.nx || row >= self.ny {
                return;
            }
        }
    }
}

/// Numbered items sorted into cells; an item may be in several cells.
///
/// ```
/// use grainpath_core::{Bounds2, DVec2, buckets::{Buckets, CellGrid}};
///
/// let segments = [[DVec2::ZERO, DVec2::new(4.0, 0.0)], [DVec2::new(0.0, 3.0), DVec2::new(4.0, 3.0)]];
/// let bounds = Bounds2::around_points(segments.iter().flatten().copied()).unwrap();
/// let grid = CellGrid::covering(bounds, 1.0, 1000);
/// let buckets = Buckets::of_segments(grid, 2, |i| segments[i]);
/// let cell = grid.index(grid.cell_of(DVec2::new(2.5, 0.2)));
/// assert_eq!(buckets.members(cell), [0], "only the lower segment is near");
/// ```
#[derive(Debug, Clone)]
pub struct Buckets {
    /// Position and size of the cells.
    pub cells: CellGrid,
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl Buckets {
    /// Sorts `n` items into cells. `places` gets an item's number and calls its second argument with the
    /// index of each cell that contains the item. In a cell, items keep their order.
    pub fn new(cells: CellGrid, n: usize, places: impl Fn(usize, &mut dyn FnMut(usize))) -> Self {
        let mut counted = Counted::new(&cells, n);
        for i in 0..n {
            places(i, &mut |cell| counted.add(cell));
            counted.end_item();
        }
        counted.sorted(cells)
    }

    /// Sorts `n` segments into the cells that they pass. In a cell, segments keep their order.
    pub fn of_segments(cells: CellGrid, n: usize, segment: impl Fn(usize) -> [DVec2; 2]) -> Self {
        let mut counted = Counted::new(&cells, n);
        for i in 0..n {
            let [a, b] = segment(i);
            cells.for_each_passed(a, b, |cell| counted.add(cell));
            counted.end_item();
        }
        counted.sorted(cells)
    }

    /// The items in a cell.
    #[inline]
    pub fn members(&self, cell: usize) -> &[u32] {
        self.members_of_run(cell, cell)
    }

    /// The index range of a cell's items in the list of the items of all cells, which is [`Self::members_of_run`] from the
    /// first cell to the last.
    #[inline]
    pub fn range(&self, cell: usize) -> Range<usize> {
        self.starts[cell] as usize..self.starts[cell + 1] as usize
    }

    /// Pairs of items that share a cell and for which `meet` is true, the lower number first, in ascending order. `meet` gets the
    /// lower number first, and a pair that shares several cells once for each.
    pub fn pairs(&self, meet: impl Fn(usize, usize) -> bool) -> Vec<[usize; 2]> {
        let mut out = Vec::new();
        for cell in 0..self.cells.nx * self.cells.ny {
            let members = self.members(cell);
            for (k, j) in members.iter().map(|&j| j as usize).enumerate() {
                let before = members[..k].iter().map(|&i| i as usize);
                out.extend(before.filter(|&i| meet(i, j)).map(|i| [i, j]));
            }
        }
        out.sort_unstable();
        out.dedup();
        out
    }

    /// The items in the cells with the indices `first` to `last`, cell after cell.
    #[inline]
    pub fn members_of_run(&self, first: usize, last: usize) -> &[u32] {
        &self.members[self.starts[first] as usize..self.starts[last + 1] as usize]
    }
}

/// Items with their cells, counted: the first half of a counting sort.
struct Counted {
    /// How many items each cell holds.
    counts: Vec<u32>,
    /// The cells of all items one after the other, so that the places of an item are asked for only once.
    all: Vec<u32>,
    /// The end of each item's cells in `all`.
    ends: Vec<u32>,
}

impl Counted {
    fn new(cells: &CellGrid, n: usize) -> Self {
        let counts = vec![0; cells.nx * cells.ny + 1];
        // A segment of a line, a little shorter than a cell, passes about two cells.
        Self { counts, all: Vec::with_capacity(5 * n / 2), ends: Vec::with_capacity(n) }
    }

    #[inline]
    fn add(&mut self, cell: usize) {
        self.counts[cell] += 1;
        self.all.push(cell as u32);
    }

    #[inline]
    fn end_item(&mut self) {
        self.ends.push(self.all.len() as u32);
    }

    /// Counts become the ends of cells, then each item is written before the one written last to its cells: the last item first.
    fn sorted(self, cells: CellGrid) -> Buckets {
        let mut starts = self.counts;
        let mut total = 0;
        for count in &mut starts {
            total += *count;
            *count = total;
        }
        let mut members = vec![0; total as usize];
        for i in (0..self.ends.len()).rev() {
            let first = if i > 0 { self.ends[i - 1] as usize } else { 0 };
            for &cell in &self.all[first..self.ends[i] as usize] {
                let at = &mut starts[cell as usize];
                *at -= 1;
                members[*at as usize] = i as u32;
            }
        }
        Buckets { cells, starts, members }
    }
}

/// Largest number of cells along a side of a grid of points. Source: derived: an empty cell takes
/// 24 bytes, so 2000 x 2000 take 96 MB.
const MAX_CELLS_PER_SIDE: usize = 2000;

/// Points in the plane, each with a value. They can be added, removed and searched by position.
///
/// ```
/// use grainpath_core::{Bounds2, DVec2, buckets::PointGrid2};
///
/// let bounds = Bounds2 { min: DVec2::ZERO, max: DVec2::splat(10.0) };
/// let mut grid = PointGrid2::new(bounds, 1.0);
/// grid.insert(DVec2::new(1.0, 1.0), "a");
/// grid.insert(DVec2::new(9.0, 1.0), "b");
/// assert_eq!(grid.nearest(DVec2::new(6.0, 0.0), |_| true).map(|n| n.1), Some("b"));
/// assert_eq!(grid.within(DVec2::new(1.5, 1.0), 1.0).count(), 1);
/// assert!(grid.remove(DVec2::new(9.0, 1.0), |value| value == "b"));
/// assert_eq!(grid.nearest(DVec2::new(6.0, 0.0), |_| true).map(|n| n.1), Some("a"));
/// ```
#[derive(Debug, Clone)]
pub struct PointGrid2<T> {
    cells: CellGrid,
    points: Vec<Vec<(DVec2, T)>>,
}

impl<T: Copy + Ord> PointGrid2<T> {
    /// An empty grid over `bounds`; it is fastest for query radii of about `cell_mm`.
    pub fn new(bounds: Bounds2, cell_mm: f64) -> Self {
        let cells = CellGrid::covering(bounds, cell_mm.max(1e-6), MAX_CELLS_PER_SIDE);
        Self { cells, points: vec![Vec::new(); cells.nx * cells.ny] }
    }

    fn cell(&self, p: DVec2) -> usize {
        self.cells.index(self.cells.cell_of(p))
    }

    /// Adds a point.
    pub fn insert(&mut self, p: DVec2, value: T) {
        let cell = self.cell(p);
        self.points[cell].push((p, value));
    }

    /// The grid of cells.
    pub fn cells(&self) -> &CellGrid {
        &self.cells
    }

    /// Removes a point at exactly this position whose value is accepted; of several, the one added last. Returns false if
    /// there is none.
    pub fn remove(&mut self, p: DVec2, accept: impl Fn(T) -> bool) -> bool {
        let cell = self.cell(p);
        // The search starts at the back, since most points are removed soon after they were added.
        let found = self.points[cell].iter().rposition(|&(q, v)| q == p && accept(v));
        if let Some(i) = found {
            self.points[cell].remove(i);
        }
        found.is_some()
    }

    /// The points nearer to `p` than `radius_mm`, in no particular order.
    pub fn within(&self, p: DVec2, radius_mm: f64) -> impl Iterator<Item = (DVec2, T)> + '_ {
        let (low, high) = (self.cells.cell_of(p - radius_mm), self.cells.cell_of(p + radius_mm));
        let row = move |y: usize| self.cells.index([low[0], y])..=self.cells.index([high[0], y]);
        (low[1]..=high[1])
            .flat_map(move |y| self.points[row(y)].iter().flatten())
            .filter(move |(q, _)| q.distance_squared(p) < radius_mm * radius_mm)
            .copied()
    }

    /// The points in the ring of cells `ring` columns or rows away from the cell of `p`, in the order of the cells.
    pub fn ring(&self, p: DVec2, ring: usize) -> impl Iterator<Item = (DVec2, T)> + '_ {
        let cells = self.cells.ring(self.cells.cell_of(p), ring);
        cells.flat_map(|cell| &self.points[self.cells.index(cell)]).copied()
    }

    /// The nearest point whose value is accepted; of equally near points, the one with the lowest value.
    pub fn nearest(&self, p: DVec2, accept: impl Fn(T) -> bool) -> Option<(DVec2, T)> {
        let mut best: Option<(f64, DVec2, T)> = None;
        for ring in 0..self.cells.n_rings() {
            // The test is `>` and not `>=`: a farther ring may hold a point at the same distance with
            // a lower value.
            let reach = self.cells.ring_distance_mm(ring);
            if best.is_some_and(|b| reach * reach > b.0) {
                break;
            }
            for (q, value) in self.ring(p, ring) {
                let d = q.distance_squared(p);
                let nearer = best.is_none_or(|b| d < b.0 || (d == b.0 && value < b.2));
                if nearer && accept(value) {
                    best = Some((d, q, value));
                }
            }
        }
        best.map(|(_, q, value)| (q, value))
    }
}

/// Points in space, each with a value. They can be added, removed and searched by position. No
/// bounds are needed: only cells with points take memory.
///
/// ```
/// use grainpath_core::{DVec3, buckets::PointGrid3};
///
/// let mut grid = PointGrid3::new(2.0);
/// grid.insert(DVec3::ZERO, 7);
/// grid.insert(DVec3::new(0.0, 0.0, 3.0), 8);
/// assert_eq!(grid.nearest_within(DVec3::new(0.0, 0.0, 2.0), 5.0), Some(8));
/// assert_eq!(grid.within(DVec3::ZERO, 2.5).count(), 1);
/// ```
#[derive(Debug, Clone)]
pub struct PointGrid3<T> {
    cell_mm: f64,
    cells: BTreeMap<[i64; 3], Vec<(DVec3, T)>>,
}

impl<T: Copy + Ord> PointGrid3<T> {
    /// An empty grid; it is fastest for query radii of about `cell_mm`.
    pub fn new(cell_mm: f64) -> Self {
        Self { cell_mm, cells: BTreeMap::new() }
    }

    fn key(&self, p: DVec3) -> [i64; 3] {
        (p / self.cell_mm).floor().to_array().map(|c| c as i64)
    }

    /// Adds a point.
    pub fn insert(&mut self, p: DVec3, value: T) {
        self.cells.entry(self.key(p)).or_default().push((p, value));
    }

    /// Removes the point with this position and value; returns false if there is none.
    pub fn remove(&mut self, p: DVec3, value: T) -> bool {
        let Some(cell) = self.cells.get_mut(&self.key(p)) else { return false };
        let found = cell.iter().rposition(|&(q, v)| q == p && v == value);
        if let Some(i) = found {
            cell.remove(i);
        }
        found.is_some()
    }

    /// The points at most `radius_mm` away from `p`, with their distances, in no particular order.
    pub fn within(&self, p: DVec3, radius_mm: f64) -> impl Iterator<Item = (f64, T)> + '_ {
        let ([x0, y0, z0], [x1, y1, z1]) = (self.key(p - radius_mm), self.key(p + radius_mm));
        (x0..=x1)
            .flat_map(move |x| (y0..=y1).map(move |y| (x, y)))
            // In the order of the map z varies fastest, so the cells with the same x and y are one range.
            .flat_map(move |(x, y)| self.cells.range([x, y, z0]..=[x, y, z1]))
            .flat_map(|(_, points)| points)
            .map(move |&(q, value)| (q.distance(p), value))
            .filter(move |&(d, _)| d <= radius_mm)
    }

    /// The value of the nearest point within the radius; of equally near points, the lowest value.
    pub fn nearest_within(&self, p: DVec3, radius_mm: f64) -> Option<T> {
        self.within(p, radius_mm).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|n| n.1)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Both kinds of grid answer as a search through all points does, whatever the size of the
        /// cells, after some points were removed, and for points outside the bounds.
        #[test]
        fn grids_answer_as_a_search_through_all_points(
            points in prop::collection::vec(prop::array::uniform3(-8i32..8), 1..60),
            cell in 0.3f64..5.0,
            at in prop::array::uniform3(-10.0f64..10.0),
            radius in 0.5f64..6.0,
        ) {
            let bounds = Bounds2 { min: DVec2::splat(-5.0), max: DVec2::splat(5.0) };
            let (mut flat, mut space) = (PointGrid2::new(bounds, cell), PointGrid3::new(cell));
            let points: Vec<DVec3> = points.iter().map(|p| DVec3::from(p.map(f64::from))).collect();
            for (i, p) in points.iter().enumerate() {
                flat.insert(p.truncate(), i);
                space.insert(*p, i);
            }
            for (i, p) in points.iter().enumerate().step_by(3) {
                prop_assert!(flat.remove(p.truncate(), |v| v == i) && space.remove(*p, i));
                prop_assert!(!flat.remove(p.truncate(), |v| v == i) && !space.remove(*p, i));
            }
            let left = || points.iter().enumerate().filter(|(i, _)| i % 3 != 0);
            let at = DVec3::from(at);
            let wanted = left().map(|(i, p)| (p.truncate().distance_squared(at.truncate()), i));
            let wanted = wanted.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|n| n.1);
            prop_assert_eq!(flat.nearest(at.truncate(), |_| true).map(|n| n.1), wanted);
            let near: Vec<(f64, usize)> =
                left().map(|(i, p)| (p.distance(at), i)).filter(|n| n.0 <= radius).collect();
            let mut found: Vec<usize> = space.within(at, radius).map(|n| n.1).collect();
            found.sort_unstable();
            prop_assert_eq!(&found, &near.iter().map(|n| n.1).collect::<Vec<_>>());
            let nearest = near.iter().min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|n| n.1);
            prop_assert_eq!(space.nearest_within(at, radius), nearest);
            let mut found: Vec<usize> = flat.within(at.truncate(), radius).map(|n| n.1).collect();
            found.sort_unstable();
            let near = left().filter(|(_, p)| p.truncate().distance(at.truncate()) < radius).map(|n| n.0);
            prop_assert_eq!(found, near.collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_ray_visits_the_cells_along_its_way_up_to_what_it_finds() {
        let bounds = Bounds2 { min: DVec2::splat(-3.0), max: DVec2::new(17.0, 9.0) };
        let cells = CellGrid::covering(bounds, 0.9, 1000);
        let ways = (0..40).map(|k| crate::math::direction(0.3 * f64::from(k)));
        for (k, way) in ways.chain([DVec2::X, -DVec2::Y]).enumerate() {
            let p = DVec2::new(2.0 + 0.2 * k as f64, 3.1);
            for until_mm in [0.0, 2.5, 40.0] {
                let mut visited = Vec::new();
                cells.for_each_along(p, way, 40.0, |cell| {
                    visited.push(cell);
                    until_mm
                });
                let mut passed = Vec::new();
                cells.for_each_passed(p, p + until_mm * way, |cell| passed.push(cell));
                assert!(
                    visited.iter().all(|cell| passed.contains(cell)),
                    "{p} {way}: {visited:?} {passed:?}"
                );
                let mut along: Vec<usize> = (0..=4000)
                    .map(|step| p + f64::from(step) * 1e-2 * way)
                    .take_while(|q| q.distance(p) < until_mm + 1e-9)
                    .filter(|q| q.cmpge(bounds.min).all() && q.cmple(bounds.max).all())
                    .map(|q| cells.index(cells.cell_of(q)))
                    .collect();
                along.dedup();
                // Samples may miss a cell whose corner the ray cuts, so the visited ones may be more.
                let mut rest = visited.iter();
                assert!(along.iter().all(|cell| rest.any(|v| v == cell)), "{p} {way}: {visited:?} {along:?}");
            }
        }
        // From outside, the cells that the segment passes are visited.
        let mut visited = Vec::new();
        cells.for_each_along(DVec2::new(-5.0, 0.0), DVec2::X, 4.0, |cell| {
            visited.push(cell);
            4.0
        });
        assert_eq!(visited.len(), 3, "3 mm of the grid: {visited:?}");
    }

    #[test]
    fn a_short_segment_is_in_the_cells_that_it_passes_alone() {
        let bounds = Bounds2 { min: DVec2::ZERO, max: DVec2::splat(9.0) };
        let cells = CellGrid::covering(bounds, 1.0, 1000);
        for k in 0..2000 {
            let a = DVec2::splat(4.0) + f64::from(k % 7) * 0.17 * crate::math::direction(f64::from(k % 31));
            let b = a + f64::from(1 + k % 9) * 0.15 * crate::math::direction(0.37 * f64::from(k));
            let mut found = Vec::new();
            cells.for_each_passed(a, b, |cell| found.push(cell));
            let at = |i: u32| cells.index(cells.cell_of(a.lerp(b, f64::from(i) / 1e4)));
            let mut passed: Vec<usize> = (0..=10_000).map(at).collect();
            passed.sort_unstable();
            passed.dedup();
            found.sort_unstable();
            // A cell that is cut at a corner alone may hold no sample.
            let extra = found.iter().filter(|cell| passed.binary_search(cell).is_err()).count();
            assert!(passed.iter().all(|cell| found.contains(cell)), "{a} to {b}: {found:?}, {passed:?}");
            let is_at_corner = (0..=10_000).any(|i| {
                let p = a.lerp(b, f64::from(i) / 1e4);
                (p - p.round()).abs().max_element() < 2e-3 || (p - p.round()).abs().min_element() < 2e-6
            });
            assert!(extra == 0 || is_at_corner, "{a} to {b}: {found:?}, {passed:?}");
        }
    }

    #[test]
    fn segments_are_found_along_their_way_and_nowhere_far() {
        let bounds = Bounds2 { min: DVec2::splat(-3.0), max: DVec2::new(17.0, 9.0) };
        let cells = CellGrid::covering(bounds, 1.0, 1000);
        let segments: Vec<[DVec2; 2]> = (0..50)
            .map(|k| {
                let turn = crate::math::direction(f64::from(k));
                let a = DVec2::new(7.0, 3.0) + f64::from(k) * 0.1 * turn;
                [a, a + 4.0 * DVec2::new(turn.y, turn.x)]
            })
            .collect();
        let buckets = Buckets::of_segments(cells, segments.len(), |i| segments[i]);
        for (i, [a, b]) in segments.iter().enumerate() {
            for step in 0..=40 {
                let p = a.lerp(*b, f64::from(step) / 40.0);
                if p.cmpge(bounds.min).all() && p.cmple(bounds.max).all() {
                    assert!(
                        buckets.members(cells.index(cells.cell_of(p))).contains(&(i as u32)),
                        "{i} at {p}"
                    );
                }
            }
        }
        for at in cells.block([0, 0], [cells.nx - 1, cells.ny - 1]) {
            let centre = cells.origin + DVec2::new(at[0] as f64 + 0.5, at[1] as f64 + 0.5);
            for &i in buckets.members(cells.index(at)) {
                let [a, b] = segments[i as usize];
                let t = ((centre - a).dot(b - a) / a.distance_squared(b)).clamp(0.0, 1.0);
                assert!(centre.distance(a.lerp(b, t)) < 0.71, "{i} in {at:?}");
            }
        }
        assert_eq!(cells.neighbourhood([0, 0], 1).count(), 4);
        assert_eq!(cells.cell_of(DVec2::splat(1e9)), [cells.nx - 1, cells.ny - 1]);
    }
}
