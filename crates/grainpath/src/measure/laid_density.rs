//! Compares the density of the planned beads of graded infill with the required density.
//!
//! The sparse infill of the part is divided into cubic cells with a side of [`CELL_MM`]. In each cell the density of the
//! beads, which is their volume over the volume of the infill region, is compared with the mean required density. A
//! cell counts if at least half of it is sparse infill, because smaller pieces hold less than one line. Cost: linear in
//! the area and in the beads.

use grainpath_core::mask::{Mask, MaskGrid};
use grainpath_core::poly::Join;
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::{Bounds2, DVec2, DVec3, LayerStack, Region, Role, Warning, WarningId};
use grainpath_job::choices::{Choice, DensityBy};
use serde::Serialize;

use crate::fill::graded_infill::WINDOW_MM;
use crate::guide::graded_density::DensityMap;
use crate::order::LayerPaths;

/// Side of a cell, mm. Source: the window in which graded infill fits its volume.
pub const CELL_MM: f64 = WINDOW_MM;
/// Largest mean error, and largest error of a single cell, for which no warning is given. Source: chosen; a requirement of the project.
const WARNED: [f64; 2] = [0.03, 0.1];
/// Side of the grid squares over which volumes are summed, mm. Source: derived: a tenth of a cell. Each square that a
/// border cuts causes an error of at most a hundredth of the cell's area.
const SQUARE_MM: f64 = 0.5;

/// The required density, and the regions to which it applies.
pub struct AskedDensity<'a> {
    /// The required density at every point.
    pub map: &'a DensityMap,
    /// The least and the greatest required density.
    pub range: [f64; 2],
    /// The quantity that the densities follow.
    pub by: DensityBy,
    /// The sparse infill region of each layer.
    pub areas: &'a [Region],
}

/// The density of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellDensity {
    /// Its lowest corner, mm.
    pub low_mm: DVec3,
    /// The required density.
    pub asked: f64,
    /// The density of the beads.
    pub laid: f64,
}

/// Density of the beads over all cells. Errors are differences of density, where 1 is solid.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct LaidDensity {
    pub by: &'static str,
    pub min: f64,
    pub max: f64,
    /// Mean required density over all sparse infill.
    pub asked: f64,
    /// Mean density of the beads over all sparse infill.
    pub laid: f64,
    pub mean_error: f64,
    pub worst_error: f64,
    /// Middle of the cell with the worst error, part coordinates.
    pub worst_at_mm: [f64; 3],
    /// Number of cells that count.
    pub cells: usize,
    /// Every cell that counts.
    #[serde(skip)]
    pub each: Vec<CellDensity>,
}

impl LaidDensity {
    /// Measures the paths of all layers before they are put in printing order.
    pub fn measure(asked: &AskedDensity<'_>, stack: &LayerStack, layers: &[LayerPaths]) -> Self {
        let all = stack.layers();
        let bounds = asked.areas.iter().filter_map(|a| a.bounds()).reduce(|a, b| a.union(b));
        let bounds = bounds.unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
        let filled: Vec<usize> = (0..all.len()).filter(|&i| !asked.areas[i].is_empty()).collect();
        let bottom = filled.first().map_or(0.0, |&i| all[i].z_top_mm() - all[i].height_mm());
        let tall = filled.last().map_or(0.0, |&i| all[i].z_top_mm()) - bottom;
        // If the infill is less high than a cell, the cells are as high as the infill.
        let high_mm = if tall > CELL_MM { CELL_MM } else { tall.max(1e-6) };
        let count = |mm: f64, cell: f64| (mm / cell - 1e-6).ceil().max(1.0) as usize;
        let size = bounds.size();
        let n = [count(size.x, CELL_MM), count(size.y, CELL_MM), count(tall, high_mm)];
        let mut sums = vec![[0.0f64; 3]; n[0] * n[1] * n[2]];
        let cell_of = |p: DVec2, k: usize| {
            let q = ((p - bounds.min) / CELL_MM).max(DVec2::ZERO);
            (k * n[1] + (q.y as usize).min(n[1] - 1)) * n[0] + (q.x as usize).min(n[0] - 1)
        };
        for &i in &filled {
            let (layer, area) = (&all[i], &asked.areas[i]);
            let (h, z) = (layer.height_mm(), layer.z_top_mm() - 0.5 * layer.height_mm());
            let k = (((z - bottom) / high_mm) as usize).min(n[2] - 1);
            let Some(own) = area.bounds() else { continue };
            let grid = MaskGrid::over(own, SQUARE_MM);
            let mask = Mask::from_region(grid, area);
            let ([nx, ny], square_mm) = (grid.size(), grid.cell_mm());
            for (x, y) in (0..ny).flat_map(|y| (0..nx).map(move |x| (x, y))).filter(|&(x, y)| mask.get(x, y))
            {
                let p = grid.origin() + square_mm * DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                let sum = &mut sums[cell_of(p, k)];
                let volume = square_mm * square_mm * h;
                sum[0] += volume;
                sum[1] += volume * asked.map.at(p.extend(z));
            }
            // Sparse infill outside `area` is skipped: it belongs to regions that have a density of their own.
            let near = Mask::from_region(grid, &area.offset(SQUARE_MM, Join::Miter(2.0)));
            let paths = layers[i].islands.iter().flat_map(|island| &island.fills);
            for path in paths.filter(|p| p.role == Role::SparseFill) {
                for (a, b, width) in (0..path.n_segments()).map(|s| path.segment(s)) {
                    let pieces = (a.distance(b) / (0.5 * SQUARE_MM)).ceil().max(1.0);
                    let each = bead_spacing_mm(width, h) * h * a.distance(b) / pieces;
                    for s in 0..pieces as usize {
                        let p = a.lerp(b, (s as f64 + 0.5) / pieces);
                        if near.contains(p) {
                            sums[cell_of(p, k)][2] += each;
                        }
                    }
                }
            }
        }
        Self::of_cells(asked, &sums, bounds.min.extend(bottom), n, high_mm)
    }

    fn of_cells(
        asked: &AskedDensity<'_>,
        sums: &[[f64; 3]],
        low: DVec3,
        n: [usize; 3],
        high_mm: f64,
    ) -> Self {
        let half = 0.5 * CELL_MM * CELL_MM * high_mm;
        let cell = |(i, s): (usize, &[f64; 3])| {
            let at = DVec3::new((i % n[0]) as f64, (i / n[0] % n[1]) as f64, (i / (n[0] * n[1])) as f64);
            let low_mm = low + at * DVec3::new(CELL_MM, CELL_MM, high_mm);
            (s[0] >= half).then(|| CellDensity { low_mm, asked: s[1] / s[0], laid: s[2] / s[0] })
        };
        let each: Vec<CellDensity> = sums.iter().enumerate().filter_map(cell).collect();
        let error = |c: &CellDensity| (c.laid - c.asked).abs();
        let mean_error = each.iter().map(error).sum::<f64>() / each.len().max(1) as f64;
        let worst = each.iter().max_by(|a, b| error(a).total_cmp(&error(b)));
        let all = sums.iter().fold([0.0; 3], |all, s| [all[0] + s[0], all[1] + s[1], all[2] + s[2]]);
        let share = |v: f64| (v * 1e4).round() / 1e4;
        let middle = |c: &CellDensity| c.low_mm + 0.5 * DVec3::new(CELL_MM, CELL_MM, high_mm);
        Self {
            by: asked.by.name(),
            min: asked.range[0],
            max: asked.range[1],
            asked: share(all[1] / all[0].max(1e-9)),
            laid: share(all[2] / all[0].max(1e-9)),
            mean_error: share(mean_error),
            worst_error: share(worst.map_or(0.0, error)),
            worst_at_mm: worst
                .map_or([0.0; 3], |c| middle(c).to_array().map(|v| (v * 100.0).round() / 100.0)),
            cells: each.len(),
            each,
        }
    }

    /// Names and values for the terminal and the report page.
    pub fn rows(&self) -> Vec<(String, String)> {
        let percent = |v: f64| format!("{:.1} %", 100.0 * v);
        let [x, y, z] = self.worst_at_mm;
        vec![
            (
                "graded density".into(),
                format!(
                    "by {}, {} to {}, mean {} (laid {})",
                    self.by,
                    percent(self.min),
                    percent(self.max),
                    percent(self.asked),
                    percent(self.laid)
                ),
            ),
            (
                "density error".into(),
                format!(
                    "mean {}, worst {} of full at ({x:.1}, {y:.1}, {z:.1}) mm, over {} cells of {CELL_MM} mm",
                    percent(self.mean_error),
                    percent(self.worst_error),
                    self.cells
                ),
            ),
        ]
    }

    /// A warning if the required density is not met.
    pub fn warning(&self) -> Option<Warning> {
        if self.mean_error <= WARNED[0] && self.worst_error <= WARNED[1] {
            return None;
        }
        let [x, y, z] = self.worst_at_mm;
        let text = format!(
            "infill is off the density asked for by {:.1} % of full in the mean and by {:.1} % at worst, at ({x:.1}, {y:.1}, {z:.1}) mm",
            100.0 * self.mean_error,
            100.0 * self.worst_error
        );
        Some(Warning::new(WarningId::DensityOff, text))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::order::Island;
    use grainpath_core::{Layer, Toolpath};

    #[test]
    fn cells_compare_what_is_laid_with_what_is_asked_for() {
        let section = || Region::rectangle(DVec2::ZERO, DVec2::new(20.0, 10.0));
        let layer = |i: usize| Layer::new(0.2 * (i + 1) as f64, 0.2, section()).expect("a layer");
        let stack = LayerStack::new((0..25).map(layer).collect()).expect("a stack");
        let map = DensityMap::new(DVec3::ZERO, DVec3::new(20.0, 10.0, 5.0), 1.0, true, |_| 0.25);
        let areas = vec![section(); 25];
        let asked = AskedDensity { map: &map, range: [0.1, 0.5], by: DensityBy::Stress, areas: &areas };
        // Lines 1 mm apart with a strip of 0.25 mm on the left half, none on the right.
        let width = grainpath_core::units::bead_width_mm(0.25, 0.2);
        let line = |k: usize| {
            let x = k as f64 + 0.5;
            Toolpath::new(vec![DVec2::new(x, 0.0), DVec2::new(x, 10.0)], width, Role::SparseFill, false)
        };
        let fills: Vec<Toolpath> = (0..10).map(line).collect();
        let island = Island { walls: Vec::new(), fills };
        let layers: Vec<LayerPaths> =
            (0..25).map(|_| LayerPaths { islands: vec![island.clone()], ..LayerPaths::default() }).collect();
        let found = LaidDensity::measure(&asked, &stack, &layers);
        assert_eq!(found.cells, 8);
        assert!((found.mean_error - 0.125).abs() < 0.002, "{found:?}");
        assert!((found.worst_error - 0.25).abs() < 0.002 && found.worst_at_mm[0] > 10.0, "{found:?}");
        assert!((found.laid - 0.125).abs() < 0.002);
        assert_eq!(found.warning().map(|w| w.id), Some(WarningId::DensityOff));
    }
}
