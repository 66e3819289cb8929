//! Square cells over a plate, in which its beads and its strength are counted.

use grainpath_core::DVec2;

/// The neighbours of a cell, by how far they lie along x and y; those that share a side come first.
pub(super) const AROUND: [(isize, isize); 8] =
    [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, -1), (-1, 1), (1, 1)];

/// Square cells over a rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellGrid {
    /// Lowest corner, mm.
    pub low: DVec2,
    /// Side of a cell, mm.
    pub cell_mm: f64,
    /// Cells along x.
    pub nx: usize,
    /// Cells along y.
    pub ny: usize,
}

impl CellGrid {
    /// The neighbours of a cell and the directions to them; those that share a side come first.
    pub(super) fn around(&self, cell: usize) -> impl Iterator<Item = (DVec2, usize)> {
        let (nx, ny) = (self.nx, self.ny);
        let [i, j] = self.place(cell);
        AROUND.into_iter().filter_map(move |(di, dj)| {
            let (a, b) = (i.checked_add_signed(di)?, j.checked_add_signed(dj)?);
            (a < nx && b < ny).then_some((DVec2::new(di as f64, dj as f64), b * nx + a))
        })
    }

    /// Which cell this is along x and along y.
    pub(super) fn place(&self, cell: usize) -> [usize; 2] {
        [cell % self.nx, cell / self.nx]
    }

    /// The middle of a cell, mm.
    pub fn centre(&self, cell: usize) -> DVec2 {
        let [i, j] = self.place(cell);
        self.low + self.cell_mm * DVec2::new(i as f64 + 0.5, j as f64 + 0.5)
    }
}
