//! Things sorted into the cells of a grid, for asking what lies near a place or a line.

use glam::DVec2;

use crate::Bounds2;

/// Square cells over a box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cells {
    /// Lower left corner of the first cell.
    pub origin: DVec2,
    /// Side of a cell, mm.
    pub cell_mm: f64,
    /// Cells in x.
    pub nx: usize,
    /// Cells in y.
    pub ny: usize,
}

impl Cells {
    /// Cells that cover `bounds`, at most `most` in either direction: larger ones where it would be more.
    pub fn over(bounds: Bounds2, cell_mm: f64, most: usize) -> Self {
        let size = bounds.size();
        let cell_mm = cell_mm.max(size.max_element() / most as f64);
        let count = |mm: f64| (mm / cell_mm) as usize + 1;
        Self { origin: bounds.min, cell_mm, nx: count(size.x), ny: count(size.y) }
    }

    /// Column and row of the cell at `p`; of the nearest one outside.
    pub fn at(&self, p: DVec2) -> [usize; 2] {
        let q = (p - self.origin) / self.cell_mm;
        [(q.x.max(0.0) as usize).min(self.nx - 1), (q.y.max(0.0) as usize).min(self.ny - 1)]
    }

    /// Number of the cell in a column and a row.
    pub fn index(&self, [column, row]: [usize; 2]) -> usize {
        row * self.nx + column
    }

    /// The cells around one, up to `n` columns and rows away.
    pub fn around(&self, [column, row]: [usize; 2], n: usize) -> impl Iterator<Item = [usize; 2]> + use<> {
        self.block(
            [column.saturating_sub(n), row.saturating_sub(n)],
            [(column + n).min(self.nx - 1), (row + n).min(self.ny - 1)],
        )
    }

    /// The cells from one to another, rows from below.
    pub fn block(&self, low: [usize; 2], high: [usize; 2]) -> impl Iterator<Item = [usize; 2]> + use<> {
        (low[1]..=high[1]).flat_map(move |row| (low[0]..=high[0]).map(move |column| [column, row]))
    }

    /// The numbers of the cells a segment passes, a hair generously; what lies outside the grid is left out.
    pub fn passed(&self, a: DVec2, b: DVec2, mut each: impl FnMut(usize)) {
        let cell = |p: DVec2| (p - self.origin) / self.cell_mm;
        let (a, b) = (cell(a), cell(b));
        let (low, high) = if a.y <= b.y { (a, b) } else { (b, a) };
        const HAIR: f64 = 1e-6;
        // Rounded down, within the grid and one cell around it.
        let down = |v: f64, n: usize| (v.clamp(-1.0, n as f64) + 1.0) as i64 - 1;
        let row_of = |y: f64| down(y, self.ny);
        let column = |x: f64| down(x, self.nx);
        let (first, last) = (row_of(low.y - HAIR).max(0), row_of(high.y + HAIR).min(self.ny as i64 - 1));
        let (left, right) = (column(a.x.min(b.x) - HAIR), column(a.x.max(b.x) + HAIR));
        if first == last || left == right {
            let (left, right) = (left.max(0), right.min(self.nx as i64 - 1));
            for row in first..=last {
                (left..=right).for_each(|c| each(row as usize * self.nx + c as usize));
            }
            return;
        }
        let slope = if high.y > low.y { (high.x - low.x) / (high.y - low.y) } else { 0.0 };
        for row in first..=last {
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
}

/// Numbered things in cells; one may be in several.
#[derive(Debug, Clone)]
pub struct Buckets {
    /// Where the cells are.
    pub cells: Cells,
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl Buckets {
    /// Sorts `n` things: `places` tells the numbers of a thing's cells. In a cell they keep their order.
    pub fn new(cells: Cells, n: usize, places: impl Fn(usize, &mut dyn FnMut(usize))) -> Self {
        let mut starts = vec![0u32; cells.nx * cells.ny + 1];
        // Cells of all things one after the other, and where those of each end.
        let (mut all, mut ends) = (Vec::with_capacity(2 * n), Vec::with_capacity(n));
        for i in 0..n {
            places(i, &mut |cell| {
                starts[cell] += 1;
                all.push(cell as u32);
            });
            ends.push(all.len());
        }
        let mut total = 0;
        for count in &mut starts {
            total += std::mem::replace(count, total);
        }
        let mut next = starts.clone();
        let mut members = vec![0; total as usize];
        let mut first = 0;
        for (i, end) in ends.into_iter().enumerate() {
            for &cell in &all[first..end] {
                members[next[cell as usize] as usize] = i as u32;
                next[cell as usize] += 1;
            }
            first = end;
        }
        Self { cells, starts, members }
    }

    /// What is in a cell.
    pub fn of(&self, cell: usize) -> &[u32] {
        self.of_run(cell, cell)
    }

    /// What is in the cells numbered from `first` to `last`, cell after cell.
    pub fn of_run(&self, first: usize, last: usize) -> &[u32] {
        &self.members[self.starts[first] as usize..self.starts[last + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_found_along_their_way_and_nowhere_far() {
        let bounds = Bounds2 { min: DVec2::splat(-3.0), max: DVec2::new(17.0, 9.0) };
        let cells = Cells::over(bounds, 1.0, 1000);
        let segments: Vec<[DVec2; 2]> = (0..50)
            .map(|k| {
                let turn = crate::math::direction(f64::from(k));
                let a = DVec2::new(7.0, 3.0) + f64::from(k) * 0.1 * turn;
                [a, a + 4.0 * DVec2::new(turn.y, turn.x)]
            })
            .collect();
        let buckets = Buckets::new(cells, segments.len(), |i, add| {
            cells.passed(segments[i][0], segments[i][1], add);
        });
        for (i, [a, b]) in segments.iter().enumerate() {
            for step in 0..=40 {
                let p = a.lerp(*b, f64::from(step) / 40.0);
                if p.cmpge(bounds.min).all() && p.cmple(bounds.max).all() {
                    assert!(buckets.of(cells.index(cells.at(p))).contains(&(i as u32)), "{i} at {p}");
                }
            }
        }
        for at in cells.block([0, 0], [cells.nx - 1, cells.ny - 1]) {
            let centre = cells.origin + DVec2::new(at[0] as f64 + 0.5, at[1] as f64 + 0.5);
            for &i in buckets.of(cells.index(at)) {
                let [a, b] = segments[i as usize];
                let t = ((centre - a).dot(b - a) / a.distance_squared(b)).clamp(0.0, 1.0);
                assert!(centre.distance(a.lerp(b, t)) < 0.71, "{i} in {at:?}");
            }
        }
        assert_eq!(cells.around([0, 0], 1).count(), 4);
        assert_eq!(cells.at(DVec2::splat(1e9)), [cells.nx - 1, cells.ny - 1]);
    }
}
