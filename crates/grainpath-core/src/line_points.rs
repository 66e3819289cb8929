//! Points of lines in square buckets.
//!
//! Fills ask here whether a new point of a line comes too near to others. Coordinates and radii are
//! in mm. Cost: the points in the buckets within the radius.

use crate::{Bounds2, DVec2};

/// Points of lines in square buckets, searchable by place.
pub struct LinePoints {
    bounds: Bounds2,
    cell_mm: f64,
    nx: usize,
    ny: usize,
    cells: Vec<Vec<(DVec2, u32, i32)>>,
}

impl LinePoints {
    /// Empty, for points within `bounds`; cells are `cell_mm` wide, or wider where there would be too many.
    pub fn new(bounds: Bounds2, cell_mm: f64) -> Self {
        // At most a few million cells, whatever the bounds.
        let cell_mm = cell_mm.max(bounds.size().max_element() / 2000.0);
        // One empty cell around the bounds, so that points just outside do not crowd the border's
        // cells.
        let count = |mm: f64| (mm / cell_mm) as usize + 3;
        let (nx, ny) = (count(bounds.size().x), count(bounds.size().y));
        Self { bounds, cell_mm, nx, ny, cells: vec![Vec::new(); nx * ny] }
    }

    /// The points of these lines.
    pub fn of_lines(lines: &[Vec<DVec2>], cell_mm: f64) -> Self {
        let bounds = Bounds2::of(lines.iter().flatten().copied());
        let mut near = Self::new(bounds.unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO }), cell_mm);
        for (id, line) in lines.iter().enumerate() {
            line.iter().enumerate().for_each(|(k, &p)| near.insert(p, id as u32, k as i32));
        }
        near
    }

    /// The bounds that the buckets cover.
    pub fn bounds(&self) -> Bounds2 {
        self.bounds
    }

    fn cell(&self, p: DVec2) -> (usize, usize) {
        let at = (p - self.bounds.min) / self.cell_mm + 1.0;
        let clamp = |v: f64, n: usize| v.clamp(0.0, n as f64 - 1.0) as usize;
        (clamp(at.x, self.nx), clamp(at.y, self.ny))
    }

    /// Adds point `index` of a line.
    pub fn insert(&mut self, p: DVec2, line: u32, index: i32) {
        let (i, j) = self.cell(p);
        self.cells[j * self.nx + i].push((p, line, index));
    }

    /// Calls `see` with every point nearer than `r_mm`.
    pub fn each(&self, p: DVec2, r_mm: f64, mut see: impl FnMut(DVec2, u32, i32)) {
        let (i, j) = self.cell(p);
        let reach = (r_mm / self.cell_mm).ceil() as usize;
        for y in j.saturating_sub(reach)..=(j + reach).min(self.ny - 1) {
            let row = y * self.nx;
            let columns = row + i.saturating_sub(reach)..=row + (i + reach).min(self.nx - 1);
            for &(q, line, index) in self.cells[columns].iter().flatten() {
                if q.distance_squared(p) < r_mm * r_mm {
                    see(q, line, index);
                }
            }
        }
    }

    /// Removes the point that was added last to the cell of `p`, if it belongs to this line.
    pub fn remove(&mut self, p: DVec2, line: u32) {
        let (i, j) = self.cell(p);
        let cell = &mut self.cells[j * self.nx + i];
        if cell.last().is_some_and(|(_, l, _)| *l == line) {
            cell.pop();
        }
    }

    /// Whether no point that `matters` lies within `r_mm`; `matters` gets the line and the index of
    /// a point.
    pub fn open(&self, p: DVec2, r_mm: f64, matters: impl Fn(u32, i32) -> bool) -> bool {
        let (i, j) = self.cell(p);
        let reach = (r_mm / self.cell_mm).ceil() as usize;
        (j.saturating_sub(reach)..=(j + reach).min(self.ny - 1)).all(|y| {
            let row = y * self.nx;
            let columns = row + i.saturating_sub(reach)..row + (i + reach).min(self.nx - 1) + 1;
            self.cells[columns]
                .iter()
                .flatten()
                // The distance is tested first: `matters` is a closure and costs more.
                .all(|&(q, line, index)| q.distance_squared(p) >= r_mm * r_mm || !matters(line, index))
        })
    }
}
