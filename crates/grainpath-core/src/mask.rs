//! Masks represent regions as bits on a square grid, one bit per cell. They combine the regions of many
//! layers at a cost of a few instructions per 64 cells. Borders that determine the width of a bead are
//! taken from the polygons instead.
//!
//! Rows are ordered upwards in y. A word holds 64 cells of a row; its lowest bit is the leftmost cell. Cost:
//! set operations and growth are linear in the words, filling is linear in the length of the border.

use crate::poly::{edges, signed_area_mm2, simplify_contour};
use crate::{Bounds2, Contour, DVec2, Polygon, Region};

/// Position and size of the cells. Two masks can be combined only if they have the same grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaskGrid {
    origin: DVec2,
    cell_mm: f64,
    nx: usize,
    ny: usize,
    words: usize,
}

impl MaskGrid {
    /// A grid over `bounds` with an empty margin of 8 cells all round. Cells are `cell_mm` wide, or
    /// wider if their number would otherwise exceed about 600,000.
    pub fn over(bounds: Bounds2, cell_mm: f64) -> Self {
        let size = bounds.size();
        let coarsest = (size.x * size.y / 6e5).sqrt().max(size.max_element() / 60_000.0);
        Self::exactly(bounds, cell_mm.max(coarsest))
    }

    /// As [`MaskGrid::over`], but with cells of exactly this width. A mask takes an eighth of a byte for each cell.
    pub fn exactly(bounds: Bounds2, cell_mm: f64) -> Self {
        let size = bounds.size();
        let margin = 8.0 * cell_mm;
        let origin = bounds.min - margin;
        let count = |mm: f64| ((mm + 2.0 * margin) / cell_mm).ceil() as usize;
        let (nx, ny) = (count(size.x), count(size.y));
        Self { origin, cell_mm, nx, ny, words: nx.div_ceil(64) }
    }

    /// Width of a cell, mm.
    pub fn cell_mm(&self) -> f64 {
        self.cell_mm
    }

    /// Number of cells in x and in y.
    pub fn size(&self) -> [usize; 2] {
        [self.nx, self.ny]
    }

    /// The lower left corner of the first cell.
    pub fn origin(&self) -> DVec2 {
        self.origin
    }

    /// Calls `each` for every row in which a convex shape, grown by `slack` cells, covers cell centres. The
    /// arguments are the row and its first and last covered column.
    fn convex_rows<const N: usize>(
        &self,
        corners: &[DVec2; N],
        slack: f64,
        mut each: impl FnMut(usize, usize, usize),
    ) {
        // Coordinates are in cells, with cell centres at whole numbers.
        let places = corners.map(|p| (p - self.origin) / self.cell_mm - 0.5);
        let Some(Bounds2 { min: low, max: high }) = Bounds2::around_points(places.iter().copied()) else {
            return;
        };
        let is_counter_clockwise = signed_area_mm2(&places) > 0.0;
        // A convex shape lies beside the lines through all of its edges, and a grown one beside these lines moved outwards. So it
        // covers a single stretch of cells in each row, from the rightmost of the lines on its left to the leftmost of those on its
        // right. Each line has a point, the columns it gains from row to row, and its side.
        let lines: [(DVec2, f64, bool); N] = std::array::from_fn(|k| {
            let (a, b) = (places[k], places[(k + 1) % N]);
            let is_left = (b.y < a.y) == is_counter_clockwise;
            let outwards = DVec2::new(if is_left { -slack } else { slack }, 0.0);
            // An edge along the row bounds it no closer than the corners do.
            if a.y == b.y {
                return (outwards + if is_left { low } else { high }, 0.0, is_left);
            }
            let slope = (b.x - a.x) / (b.y - a.y);
            (if a.y < b.y { a } else { b } + outwards * (1.0 + slope.abs()), slope, is_left)
        });
        let (low, high) = (low - slack, high + slack);
        let last_column = self.nx as f64 - 1.0;
        for row in low.y.ceil().max(0.0) as usize..=high.y.floor().clamp(-1.0, self.ny as f64 - 1.0) as usize
        {
            let (mut from, mut to) = (low.x.max(0.0), high.x.min(last_column));
            for (p, slope, is_left) in lines {
                let x = p.x + (row as f64 - p.y) * slope;
                if is_left && x > from {
                    from = x;
                } else if !is_left && x < to {
                    to = x;
                }
            }
            if from <= to {
                let (first, last) = (from as usize, to as usize);
                // The first cell whose centre is not left of the stretch.
                let first = first + usize::from((first as f64) < from);
                if first <= last {
                    each(row, first, last);
                }
            }
        }
    }

    /// Calls `each` with every row that an edge crosses and the column of the first cell right of the crossing.
    fn for_each_row(&self, a: DVec2, b: DVec2, mut each: impl FnMut(usize, usize)) {
        // Coordinates are in cells, with cell centres at whole numbers.
        let (a, b) = ((a - self.origin) / self.cell_mm - 0.5, (b - self.origin) / self.cell_mm - 0.5);
        let (lo, hi) = if a.y < b.y { (a, b) } else { (b, a) };
        // The edge is half-open in y, so that a vertex on a row of centres counts for only one of its two edges.
        let (first, end) = (lo.y.ceil().max(0.0) as usize, hi.y.ceil().clamp(0.0, self.ny as f64) as usize);
        let slope = (hi.x - lo.x) / (hi.y - lo.y);
        for row in first..end {
            let x = lo.x + (row as f64 - lo.y) * slope;
            let column = x.ceil().max(0.0) as usize;
            if column < self.nx {
                each(row, column);
            }
        }
    }

    /// The bits of a word that belong to the cells `from` to `to` of a row.
    fn stretch(word: usize, from: usize, to: usize) -> u64 {
        let first = if word == from / 64 { from % 64 } else { 0 };
        let last = if word == to / 64 { to % 64 } else { 63 };
        (u64::MAX << first) & (u64::MAX >> (63 - last))
    }

    /// The part of the grid that covers `bounds` and is whole words wide, with its first word and its first row.
    fn window(&self, bounds: Bounds2) -> (Self, usize, usize) {
        let (lo, hi) = ((bounds.min - self.origin) / self.cell_mm, (bounds.max - self.origin) / self.cell_mm);
        let word = (lo.x.max(0.0) as usize / 64).min(self.words - 1);
        let row = (lo.y.max(0.0) as usize).min(self.ny - 1);
        let words = (hi.x.max(0.0) as usize / 64 + 1).clamp(word + 1, self.words) - word;
        let ny = (hi.y.max(0.0) as usize + 1).clamp(row + 1, self.ny) - row;
        let origin = self.origin + DVec2::new(64.0 * word as f64, row as f64) * self.cell_mm;
        (Self { origin, nx: words * 64, ny, words, cell_mm: self.cell_mm }, word, row)
    }
}

/// Whether a mask covers none, a part or all of a polygon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coverage {
    /// At most two cells of the polygon are covered.
    None,
    /// Some cells are covered, others are not.
    Part,
    /// All cells are covered, except two at most.
    All,
}

/// A set of cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    grid: MaskGrid,
    bits: Vec<u64>,
}

impl Mask {
    /// A mask without cells.
    pub fn empty(grid: MaskGrid) -> Self {
        Self { grid, bits: vec![0; grid.words * grid.ny] }
    }

    /// The cells whose centres lie in the region.
    pub fn from_region(grid: MaskGrid, region: &Region) -> Self {
        Self::of_contours(grid, region.contours())
    }

    /// The cells whose centres lie inside closed lines by the even-odd rule.
    pub fn of_contours<'a>(grid: MaskGrid, contours: impl IntoIterator<Item = &'a Contour>) -> Self {
        let mut mask = Self::empty(grid);
        // Even-odd filling without sorting: each edge flips one bit in each row that it crosses, and a running
        // parity turns the flips into stretches of cells.
        for (a, b) in contours.into_iter().flat_map(|c| edges(c)) {
            mask.toggle_right_of(a, b);
        }
        // Each set bit now marks a cell at which the inside begins or ends; the running parity fills the row.
        for row in mask.bits.chunks_mut(grid.words) {
            let mut carry = 0u64;
            for word in row {
                let mut w = *word;
                // Prefix parity of a word in six steps: after the step with shift s each bit holds
                // the parity of 2 s bits.
                for shift in [1, 2, 4, 8, 16, 32] {
                    w ^= w << shift;
                }
                w ^= carry;
                *word = w;
                carry = if w >> 63 == 1 { u64::MAX } else { 0 };
            }
        }
        mask
    }

    /// The cells whose centres lie inside closed lines by the non-zero winding rule. The cost grows with the rows that the
    /// edges cross and does not depend on the number of crossings between lines.
    pub fn wound<'a>(grid: MaskGrid, contours: impl IntoIterator<Item = &'a Contour>) -> Self {
        // The change of the winding number at each cell, from left to right.
        let mut turns = vec![0i32; grid.nx * grid.ny];
        for (a, b) in contours.into_iter().flat_map(|c| edges(c)) {
            let turn = if a.y < b.y { 1 } else { -1 };
            grid.for_each_row(a, b, |row, column| turns[row * grid.nx + column] += turn);
        }
        let mut mask = Self::empty(grid);
        for (row, turns) in turns.chunks(grid.nx).enumerate() {
            let mut winding = 0;
            for (column, turn) in turns.iter().enumerate() {
                winding += turn;
                mask.bits[row * grid.words + column / 64] |= u64::from(winding != 0) << (column % 64);
            }
        }
        mask
    }

    /// As [`Mask::from_region`], plus the cells that a border passes through, so that thin parts between cell
    /// centres are not lost.
    pub fn touched(grid: MaskGrid, region: &Region) -> Self {
        let mut mask = Self::from_region(grid, region);
        for (a, b) in region.contours().flat_map(|c| edges(c)) {
            // Samples are half a cell apart, so a cell is missed only if the border crosses it over less than
            // half a cell's width.
            let n = (a.distance(b) / (0.5 * grid.cell_mm)).ceil().max(1.0);
            for i in 0..n as usize {
                let c = (a.lerp(b, i as f64 / n) - grid.origin) / grid.cell_mm;
                if c.x >= 0.0 && c.y >= 0.0 && (c.x as usize) < grid.nx && (c.y as usize) < grid.ny {
                    mask.bits[c.y as usize * grid.words + c.x as usize / 64] |= 1 << (c.x as usize % 64);
                }
            }
        }
        mask
    }

    /// Adds the cells whose centres lie in a convex shape.
    pub fn add_convex<const N: usize>(&mut self, corners: &[DVec2; N]) {
        let (grid, bits) = (self.grid, &mut self.bits);
        grid.convex_rows(corners, 0.0, |row, from, to| {
            for word in from / 64..=to / 64 {
                bits[row * grid.words + word] |= MaskGrid::stretch(word, from, to);
            }
        });
    }

    /// Whether any set cell has its centre in a convex shape or at most about one cell away from it.
    pub fn meets_convex<const N: usize>(&self, corners: &[DVec2; N]) -> bool {
        let slack = 1.0;
        let meets = |row: usize, from: usize, to: usize| {
            (from / 64..=to / 64)
                .any(|word| self.bits[row * self.grid.words + word] & MaskGrid::stretch(word, from, to) != 0)
        };
        // Nothing is set in the box of most shapes, and boxes are faster.
        let Some(Bounds2 { min, max }) = Bounds2::around_points(corners.iter().copied()) else {
            return false;
        };
        let MaskGrid { nx, ny, .. } = self.grid;
        let cell = |p: DVec2| (p - self.grid.origin) / self.grid.cell_mm - 0.5;
        let (low, high) = ((cell(min) - slack).max(DVec2::ZERO), cell(max) + slack);
        let last = high.min(DVec2::new(nx as f64, ny as f64) - 1.0);
        if !low.cmple(last).all() {
            return false;
        }
        let [left, right] = [low.x, last.x].map(|x| x as usize);
        if !(low.y as usize..=last.y as usize).any(|row| meets(row, left, right)) {
            return false;
        }
        let mut any = false;
        self.grid.convex_rows(corners, slack, |row, from, to| any |= meets(row, from, to));
        any
    }

    /// Flips, in every row that the edge crosses, the bit of the first cell right of the crossing.
    fn toggle_right_of(&mut self, a: DVec2, b: DVec2) {
        let words = self.grid.words;
        self.grid
            .for_each_row(a, b, |row, column| self.bits[row * words + column / 64] ^= 1 << (column % 64));
    }

    /// Whether no cell is set.
    pub fn is_empty(&self) -> bool {
        self.bits.iter().all(|&w| w == 0)
    }

    /// Number of cells set.
    pub fn count(&self) -> usize {
        self.bits.iter().map(|w| w.count_ones() as usize).sum()
    }

    /// Area of the cells set, mm2.
    pub fn area_mm2(&self) -> f64 {
        self.count() as f64 * self.grid.cell_mm * self.grid.cell_mm
    }

    /// Whether the mask covers none, a part or all of a polygon, with a tolerance of two cells. Cost: linear in
    /// the cells of the polygon's bounding box.
    pub fn coverage(&self, polygon: &Polygon) -> Coverage {
        let Some(bounds) = polygon.bounds() else { return Coverage::None };
        let (window, word, row) = self.grid.window(bounds);
        let cells = Self::of_contours(window, polygon.contours());
        let (mut all, mut hit) = (0, 0);
        for (y, line) in cells.bits.chunks(window.words).enumerate() {
            let start = (row + y) * self.grid.words + word;
            for (c, m) in line.iter().zip(&self.bits[start..]) {
                all += c.count_ones();
                hit += (c & m).count_ones();
            }
        }
        if hit <= 2 {
            Coverage::None
        } else if all - hit <= 2 {
            Coverage::All
        } else {
            Coverage::Part
        }
    }

    /// Whether the cell that holds `p` is set; false outside the grid.
    pub fn contains(&self, p: DVec2) -> bool {
        let c = (p - self.grid.origin) / self.grid.cell_mm;
        c.x >= 0.0 && c.y >= 0.0 && self.get(c.x as usize, c.y as usize)
    }

    /// Whether cell (x, y) is set; false outside the grid.
    pub fn get(&self, x: usize, y: usize) -> bool {
        x < self.grid.nx && y < self.grid.ny && self.bits[y * self.grid.words + x / 64] >> (x % 64) & 1 == 1
    }

    fn zip(mut self, other: &Self, f: impl Fn(u64, u64) -> u64) -> Self {
        debug_assert_eq!(self.grid, other.grid);
        for (a, &b) in self.bits.iter_mut().zip(&other.bits) {
            *a = f(*a, b);
        }
        self
    }

    /// The cells in both masks.
    pub fn and(self, other: &Self) -> Self {
        self.zip(other, |a, b| a & b)
    }

    /// The cells in either mask.
    pub fn or(self, other: &Self) -> Self {
        self.zip(other, |a, b| a | b)
    }

    /// The cells in this mask that are not in the other.
    pub fn and_not(self, other: &Self) -> Self {
        self.zip(other, |a, b| a & !b)
    }

    /// Writes the cells left and right of set cells to `out`, and the cells themselves if `own` is
    /// true.
    fn sideways(&self, own: bool, out: &mut Self) {
        let words = self.grid.words;
        let beside = |[left, word, right]: [u64; 3]| {
            word << 1 | left >> 63 | word >> 1 | right << 63 | if own { word } else { 0 }
        };
        for (out, row) in out.bits.chunks_mut(words).zip(self.bits.chunks(words)) {
            if let [first, .., last] = row {
                for (out, w) in out[1..].iter_mut().zip(row.array_windows()) {
                    *out = beside(*w);
                }
                out[0] = beside([0, *first, row[1]]);
                out[words - 1] = beside([row[words - 2], *last, 0]);
            } else {
                out[0] = beside([0, row[0], 0]);
            }
        }
    }

    /// Adds the cells above and below those of `source`.
    fn add_above_and_below(&mut self, source: &Self) {
        let words = self.grid.words;
        for (bits, below) in self.bits[words..].iter_mut().zip(&source.bits) {
            *bits |= below;
        }
        for (bits, above) in self.bits.iter_mut().zip(&source.bits[words..]) {
            *bits |= above;
        }
    }

    /// The mask without single cells: those that share no side with another set cell.
    pub fn without_lone(&self) -> Self {
        let mut neighbours = Self::empty(self.grid);
        self.sideways(false, &mut neighbours);
        neighbours.add_above_and_below(self);
        neighbours.and(self)
    }

    /// The mask grown by `n` cells on all sides. Growth adds the four neighbours and all eight neighbours in turn,
    /// so a single cell becomes an octagon.
    pub fn grown(&self, n: usize) -> Self {
        self.clone().into_grown(n)
    }

    fn into_grown(self, n: usize) -> Self {
        if self.is_empty() {
            return self;
        }
        let mut grown = self;
        let mut sideways = Self::empty(grown.grid);
        // Four and eight neighbours in turn approximate a disc by an octagon; either alone would
        // grow a diamond or a square.
        for i in 0..n {
            grown.sideways(true, &mut sideways);
            if i % 2 == 1 {
                grown.bits.copy_from_slice(&sideways.bits);
                grown.add_above_and_below(&sideways);
            } else {
                sideways.add_above_and_below(&grown);
                std::mem::swap(&mut grown, &mut sideways);
            }
        }
        grown
    }

    /// The mask shrunk by `n` cells on all sides.
    pub fn shrunk(&self, n: usize) -> Self {
        // Shrinking a mask is the same as growing its complement.
        self.clone().inverted().into_grown(n).inverted()
    }

    fn inverted(mut self) -> Self {
        self.bits.iter_mut().for_each(|w| *w = !*w);
        self
    }

    /// The mask without parts that are thinner than about `2 n` cells.
    pub fn opened(&self, n: usize) -> Self {
        self.shrunk(n).into_grown(n)
    }

    /// The borders as closed lines, counter-clockwise around cells and clockwise around holes. The staircase
    /// is smoothed within a cell's width. Cells that touch only at a corner belong to separate lines.
    pub fn contours(&self) -> Vec<Contour> {
        let mut seen = Self::empty(self.grid);
        let mut out = Vec::new();
        for y in 0..self.grid.ny {
            for i in 0..self.grid.words {
                // Bits beyond the last column are no cells, and a walk around them would not come back.
                let here = self.bits[y * self.grid.words + i] & MaskGrid::stretch(i, 0, self.grid.nx - 1);
                let below = if y > 0 { self.bits[(y - 1) * self.grid.words + i] } else { 0 };
                // A contour is found at the lower edges of cells with none below. Lower edges that were
                // walked already are marked in `seen`.
                let mut starts = here & !below & !seen.bits[y * self.grid.words + i];
                while starts != 0 {
                    let x = i * 64 + starts.trailing_zeros() as usize;
                    let line = self.trace(x, y, &mut seen);
                    let smooth = simplify_contour(&line, 0.7 * self.grid.cell_mm);
                    if !smooth.is_empty() {
                        out.push(smooth);
                    }
                    // The walk may have passed other starts in the same word, so they are computed again.
                    starts = here & !below & !seen.bits[y * self.grid.words + i];
                }
            }
        }
        out
    }

    /// Walks along the border with the cells on the left, from the lower edge of cell (x, y), and marks the
    /// lower edges that it passes in `seen`.
    fn trace(&self, x: usize, y: usize, seen: &mut Self) -> Contour {
        let set = |x: i64, y: i64| x >= 0 && y >= 0 && self.get(x as usize, y as usize);
        let start = (x as i64, y as i64);
        let (mut at, mut d) = (start, (1i64, 0i64));
        let mut line = Vec::new();
        loop {
            if d == (1, 0) {
                let (cx, cy) = (at.0 as usize, at.1 as usize);
                seen.bits[cy * self.grid.words + cx / 64] |= 1 << (cx % 64);
            }
            at = (at.0 + d.0, at.1 + d.1);
            // `cell` tests the cells ahead, to the left and to the right of the direction of travel.
            let cell = |side: (i64, i64)| {
                let corner = (2 * at.0 + d.0 + side.0, 2 * at.1 + d.1 + side.1);
                set((corner.0 - 1).div_euclid(2), (corner.1 - 1).div_euclid(2))
            };
            let left = (-d.1, d.0);
            // Left is tested first: where two cells touch only at a corner, the walk turns left, so that they
            // get separate contours.
            let turned = if !cell(left) {
                left
            } else if cell((d.1, -d.0)) {
                (d.1, -d.0)
            } else {
                d
            };
            if turned != d {
                line.push(self.grid.origin + DVec2::new(at.0 as f64, at.1 as f64) * self.grid.cell_mm);
                d = turned;
            }
            if at == start && d == (1, 0) {
                return line;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> MaskGrid {
        MaskGrid::over(Bounds2 { min: DVec2::ZERO, max: DVec2::splat(30.0) }, 0.2)
    }

    fn square(lo: f64, hi: f64) -> Region {
        Region::rectangle(DVec2::splat(lo), DVec2::splat(hi))
    }

    /// Where even-odd counting leaves the overlap of two squares out, winding keeps it; a hole wound the other way stays.
    /// Growth fills the whole last word of a row, also where the grid ends within it.
    #[test]
    fn a_mask_that_is_filled_up_to_its_sides_has_a_border() {
        for wide in [3.0, 10.0, 20.0] {
            let bounds = Bounds2 { min: DVec2::ZERO, max: DVec2::new(wide, 4.0) };
            let grid = MaskGrid::over(bounds, 0.1);
            let all = Mask::empty(grid).inverted().grown(3);
            let [nx, ny] = grid.size();
            let [border] = &all.contours()[..] else { panic!("one border") };
            let area = signed_area_mm2(border);
            assert!((area - 0.01 * (nx * ny) as f64).abs() < 1e-6, "{wide}: {area} mm2");
        }
    }

    #[test]
    fn winding_keeps_overlaps_and_holes() {
        let (a, b) = (square(5.0, 15.0), square(10.0, 20.0));
        let mut hole = square(6.0, 8.0).polygons[0].outer.clone();
        hole.reverse();
        let contours = [a.polygons[0].outer.clone(), b.polygons[0].outer.clone(), hole];
        let area = Mask::wound(grid(), &contours).area_mm2();
        assert!((area - (175.0 - 4.0)).abs() < 1.0, "{area}");
        assert!((Mask::of_contours(grid(), &contours).area_mm2() - (150.0 - 4.0)).abs() < 1.0);
    }

    #[test]
    fn area_of_a_ring_and_back() {
        let ring = square(5.0, 25.0).difference(&square(10.0, 20.0));
        let mask = Mask::from_region(grid(), &ring);
        assert!((mask.area_mm2() - 300.0).abs() < 1.0, "{}", mask.area_mm2());
        let lines = mask.contours();
        assert_eq!(lines.len(), 2);
        let area: f64 = lines.iter().map(|c| signed_area_mm2(c)).sum();
        assert!((area - mask.area_mm2()).abs() < 1e-6);
        assert!(mask.contains(DVec2::splat(7.0)) && !mask.contains(DVec2::splat(15.0)));
    }

    #[test]
    fn growing_and_opening() {
        let mask = Mask::from_region(grid(), &square(10.0, 20.0));
        let grown = mask.grown(5).area_mm2();
        assert!(grown > 142.0 && grown < 144.1, "{grown}");
        assert_eq!(mask.grown(5).shrunk(5), mask);
        let sliver =
            Mask::from_region(grid(), &Region::rectangle(DVec2::new(0.0, 5.0), DVec2::new(30.0, 5.5)));
        assert!(!sliver.is_empty() && sliver.opened(2).is_empty());
        // One cell, and two side by side across a word.
        let cells = |x: usize, n: usize| {
            let low = grid().origin() + 0.2 * DVec2::new(x as f64, 30.0);
            Region::rectangle(low, low + 0.2 * DVec2::new(n as f64, 1.0))
        };
        let both = Mask::from_region(grid(), &cells(20, 1).union(&cells(63, 2)));
        assert_eq!((both.count(), both.without_lone()), (3, Mask::from_region(grid(), &cells(63, 2))));
    }

    #[test]
    fn convex_shapes_cover_the_cells_that_their_regions_do() {
        let g = grid();
        let mut all = Mask::empty(g);
        for k in 0..40 {
            let turn = f64::from(k);
            let (c, along) = (DVec2::new(10.0 + 0.2 * turn, 15.0), crate::math::direction(turn));
            let (length, half) = (0.2 + 0.2 * turn, 0.17);
            let across = half * DVec2::new(-along.y, along.x);
            let corners = [c - across, c + length * along - across, c + length * along + across, c + across];
            let mut one = Mask::empty(g);
            one.add_convex(&corners);
            let region: Region = Polygon { outer: corners.to_vec(), holes: Vec::new() }.into();
            assert_eq!(one, Mask::from_region(g, &region), "{k}");
            assert!(one.is_empty() || one.meets_convex(&corners));
            let aside = corners.map(|p| p + 20.0 * across);
            assert!(!one.meets_convex(&aside), "{k}");
            all = all.or(&one);
        }
        assert!(all.count() > 500);
    }

    /// A shape grown by a number of cells covers the centres around which a square of that size meets it, whichever way round its
    /// corners come, and with edges along the grid.
    #[test]
    fn grown_convex_shapes_cover_the_cells_around_which_a_square_meets_them() {
        let g = MaskGrid::exactly(Bounds2 { min: DVec2::ZERO, max: DVec2::splat(4.0) }, 0.2);
        let [nx, ny] = g.size();
        for k in 0..30 {
            let turn_rad = f64::from(k) * if k < 4 { std::f64::consts::FRAC_PI_2 } else { 0.21 };
            let along = crate::math::direction(turn_rad);
            let (c, across) = (DVec2::new(1.937, 2.073), along.perp());
            let mut corners =
                [c - 0.31 * across, c + 0.93 * along - 0.17 * across, c + 0.93 * along + 0.23 * across];
            let shape = Region::from(Polygon { outer: corners.to_vec(), holes: Vec::new() });
            for slack in [0.0, 1.0, 2.5] {
                corners.reverse();
                let mut covered = Mask::empty(g);
                let set = |row: usize, from: usize, to: usize| {
                    for x in from..=to {
                        covered.bits[row * g.words + x / 64] |= 1 << (x % 64);
                    }
                };
                g.convex_rows(&corners, slack, set);
                for (x, y) in (0..nx).flat_map(|x| (0..ny).map(move |y| (x, y))) {
                    let centre = g.origin() + 0.2 * (DVec2::new(x as f64, y as f64) + 0.5);
                    let half = 0.2 * slack;
                    let square = Region::rectangle(centre - half, centre + half);
                    let meets = shape.contains(centre) || !square.intersection(&shape).is_empty();
                    assert_eq!(covered.get(x, y), meets, "{k}, {slack}, {centre}");
                }
            }
        }
    }

    #[test]
    fn cells_that_touch_at_corners_stay_apart() {
        let g = MaskGrid::over(Bounds2 { min: DVec2::ZERO, max: DVec2::splat(4.0) }, 1.0);
        let two = square(0.0, 1.0).union(&square(1.0, 2.0));
        assert_eq!(Mask::from_region(g, &two).contours().len(), 2);
    }
}
