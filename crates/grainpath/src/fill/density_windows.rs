//! Windows of an infill region, in which the density that is asked for is held against the one that is laid.
//!
//! A sparse fill has a density only over an area as wide as several lines. A window is a square with a side of [`WINDOW_MM`];
//! windows lie all over the region. What one asks for is the sum of the density map over its cells, in mm2 of this layer, read
//! from a table of sums ([`Sums`]). Cost: linear in the cells of the region for the tables, constant for a window.

use grainpath_core::mask::{Mask, MaskGrid};
use grainpath_core::poly::Join;
use grainpath_core::{DVec2, Polygon, Region};

use super::FillContext;
use crate::guide::graded_density::DensityMap;

/// Side of the window in which volume is fitted, mm; also that of the cells over which densities are measured
/// ([`laid_density`](crate::measure::laid_density)). Source: chosen; a requirement of the project.
pub(crate) const WINDOW_MM: f64 = 5.0;

/// Table from which the sum over any rectangle of a grid is read.
pub(super) struct Sums(Vec<f64>);

impl Sums {
    pub(super) fn new([nx, ny]: [usize; 2], values: &[f64]) -> Self {
        let mut sums = vec![0.0; (nx + 1) * (ny + 1)];
        for j in 0..ny {
            let mut row = 0.0;
            for i in 0..nx {
                row += values[j * nx + i];
                sums[(j + 1) * (nx + 1) + i + 1] = sums[j * (nx + 1) + i + 1] + row;
            }
        }
        Self(sums)
    }

    /// The places of the table from which the sum over a square is read that reaches `half` cells to each side of `p`,
    /// which is given in cells, in a grid of this size.
    pub(super) fn around([nx, ny]: [usize; 2], p: DVec2, half: f64) -> [u32; 4] {
        let cut = |v: f64, n: usize| v.round().clamp(0.0, n as f64) as usize;
        let [x0, x1] = [p.x - half, p.x + half].map(|v| cut(v, nx));
        let [y0, y1] = [p.y - half, p.y + half].map(|v| cut(v, ny));
        [(x1, y1), (x0, y1), (x1, y0), (x0, y0)].map(|(x, y)| (y * (nx + 1) + x) as u32)
    }

    /// The sum over a square.
    pub(super) fn of(&self, around: [u32; 4]) -> f64 {
        let [a, b, c, d] = around.map(|place| self.0[place as usize]);
        a - b - c + d
    }
}

/// The volume that the windows of an infill region ask for in one layer.
pub(super) struct Windows<'a> {
    map: &'a DensityMap,
    z_mid_mm: f64,
    pub(super) grid: MaskGrid,
    /// The cells of the area that beads fill.
    mask: Mask,
    /// Half the side of a window, in cells.
    half: f64,
    /// The volume that windows ask for, as the area it would take in this layer, mm2.
    pub(super) asked: Sums,
}

impl<'a> Windows<'a> {
    pub(super) fn of(
        context: &FillContext<'_>,
        map: &'a DensityMap,
        infill_region: &Polygon,
    ) -> Option<Self> {
        let area = Region::from(infill_region.clone()).offset(context.border_mm, Join::Miter(2.0));
        let grid = MaskGrid::over(area.bounds()?, 0.5);
        let mask = Mask::from_region(grid, &area);
        let half = 0.5 * WINDOW_MM / grid.cell_mm();
        let mut windows = Self { map, z_mid_mm: context.z_mid_mm, grid, mask, half, asked: Sums(Vec::new()) };
        windows.asked = windows.sums(|k| {
            if windows.is_in_area(k) {
                windows.density(windows.middle_mm(k)) * windows.cell_mm2()
            } else {
                0.0
            }
        });
        Some(windows)
    }

    pub(super) fn n_cells(&self) -> usize {
        let [nx, ny] = self.grid.size();
        nx * ny
    }

    pub(super) fn cell_mm2(&self) -> f64 {
        self.grid.cell_mm() * self.grid.cell_mm()
    }

    /// Column and row of a cell.
    pub(super) fn at(&self, k: usize) -> [usize; 2] {
        [k % self.grid.size()[0], k / self.grid.size()[0]]
    }

    pub(super) fn is_in_area(&self, k: usize) -> bool {
        let [i, j] = self.at(k);
        self.mask.get(i, j)
    }

    /// The middle of a cell, mm.
    pub(super) fn middle_mm(&self, k: usize) -> DVec2 {
        let [i, j] = self.at(k);
        self.grid.origin() + self.grid.cell_mm() * DVec2::new(i as f64 + 0.5, j as f64 + 0.5)
    }

    /// The cell of a point.
    pub(super) fn cell_of(&self, p: DVec2) -> usize {
        let [nx, ny] = self.grid.size();
        let q = ((p - self.grid.origin()) / self.grid.cell_mm()).max(DVec2::ZERO);
        (q.y as usize).min(ny - 1) * nx + (q.x as usize).min(nx - 1)
    }

    /// The density asked for at a point.
    pub(super) fn density(&self, p: DVec2) -> f64 {
        self.map.at(p.extend(self.z_mid_mm))
    }

    /// The window around a point.
    pub(super) fn around(&self, p: DVec2) -> [u32; 4] {
        Sums::around(self.grid.size(), (p - self.grid.origin()) / self.grid.cell_mm(), self.half)
    }

    /// The cells of the window around the middle of a cell.
    pub(super) fn cells_in(&self, k: usize) -> impl Iterator<Item = usize> + use<> {
        let ([nx, ny], [i, j], half) = (self.grid.size(), self.at(k), self.half as usize);
        let rows = j.saturating_sub(half)..(j + half + 1).min(ny);
        let columns = i.saturating_sub(half)..(i + half + 1).min(nx);
        rows.flat_map(move |j| columns.clone().map(move |i| j * nx + i))
    }

    /// Sums over windows of a value of each cell.
    pub(super) fn sums(&self, of: impl Fn(usize) -> f64) -> Sums {
        Sums::new(self.grid.size(), &(0..self.n_cells()).map(of).collect::<Vec<f64>>())
    }
}

/// A segment in equal pieces that are at most `piece_mm` long: the length of a piece, mm, and the middles of all.
pub(super) fn pieces(a: DVec2, b: DVec2, piece_mm: f64) -> (f64, impl ExactSizeIterator<Item = DVec2>) {
    let n = (a.distance(b) / piece_mm).ceil().max(1.0);
    (a.distance(b) / n, (0..n as usize).map(move |i| a.lerp(b, (i as f64 + 0.5) / n)))
}
