//! Compares the density of the planned beads of graded infill with the required density.
//!
//! The sparse infill of the part is divided into cubic cells with a side of [`CELL_MM`]. In each cell the density of the
//! beads, which is their volume over the volume of the infill region, is compared with the mean required density. A
//! cell counts if at least half of it is sparse infill, because smaller pieces hold less than one line. Densities of a file
//! are required as the file gives them, within the range of the job: what the limit of their slope adds is an error.
//! Densities by stress are required after that limit, because stress falls off from peaks as steeply as it likes. Cost: linear in
//! the area and in the beads.

use grainpath_core::mask::{Mask, MaskGrid};
use grainpath_core::poly::LineClipper;
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::{Bounds2, DVec2, DVec3, LayerStack, Region, Role, Warning, WarningId};
use grainpath_job::choices::{Choice, DensityBy};
use serde::Serialize;

use crate::fill::density_windows::WINDOW_MM;
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
    /// The distance over which the density can fall from its greatest to its least value, mm.
    pub fall_mm: f64,
    /// The sparse infill region of each layer.
    pub areas: &'a [Region],
    /// Whether sparse infill of regions with a density of their own lies beside `areas`.
    pub beside_others: bool,
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
    /// What the limit of the slope adds to the mean density that the file or the stress gives.
    pub slope_added: f64,
    pub mean_error: f64,
    pub worst_error: f64,
    /// Middle of the cell with the worst error, part coordinates.
    pub worst_at_mm: [f64; 3],
    /// Number of cells that count.
    pub cells: usize,
    /// Whether the errors would be small enough if the limit of the slope were no part of them.
    #[serde(skip)]
    pub follows: bool,
    /// The distance over which the density can fall from its greatest to its least value, mm.
    #[serde(skip)]
    pub fall_mm: f64,
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
        // The volume of sparse infill, the density given and the one after the limit of its slope times that volume, and the
        // volume of the beads.
        let mut sums = vec![[0.0f64; 4]; n[0] * n[1] * n[2]];
        let cell_of = |p: DVec2, k: usize| {
            let q = ((p - bounds.min) / CELL_MM).max(DVec2::ZERO);
            (k * n[1] + (q.y as usize).min(n[1] - 1)) * n[0] + (q.x as usize).min(n[0] - 1)
        };
        // The area of sparse infill in each cell of the plan, and both densities times that area, mm2.
        let mut plan = vec![[0.0f64; 3]; n[0] * n[1]];
        // The layer whose plan that is.
        let mut of_plan: Option<usize> = None;
        for &i in &filled {
            let (layer, area) = (&all[i], &asked.areas[i]);
            let (h, z) = (layer.height_mm(), layer.z_top_mm() - 0.5 * layer.height_mm());
            let k = (((z - bottom) / high_mm) as usize).min(n[2] - 1);
            // Layers of a plate have the same area, and its density is the same at all heights.
            if !asked.map.is_upright() || of_plan.is_none_or(|of| asked.areas[of] != *area) {
                of_plan = Some(i);
                plan.fill([0.0; 3]);
                let Some(own) = area.bounds() else { continue };
                let grid = MaskGrid::over(own, SQUARE_MM);
                let mask = Mask::from_region(grid, area);
                let ([nx, ny], square_mm) = (grid.size(), grid.cell_mm());
                for (x, y) in
                    (0..ny).flat_map(|y| (0..nx).map(move |x| (x, y))).filter(|&(x, y)| mask.get(x, y))
                {
                    let p = grid.origin() + square_mm * DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                    let sum = &mut plan[cell_of(p, 0)];
                    let square_mm2 = square_mm * square_mm;
                    sum[0] += square_mm2;
                    sum[1] += square_mm2 * asked.map.given_at(p.extend(z));
                    sum[2] += square_mm2 * asked.map.at(p.extend(z));
                }
            }
            let of_layer = &mut sums[k * plan.len()..(k + 1) * plan.len()];
            of_layer.iter_mut().zip(&plan).for_each(|(sum, plan)| (0..3).for_each(|k| sum[k] += h * plan[k]));
            // Sparse infill outside `area` is skipped: it belongs to regions that have a density of their own. Its beads begin
            // half a strip beyond the border, so squares are too coarse to tell them apart.
            let inside = asked.beside_others.then(|| LineClipper::new(area));
            let paths = layers[i].islands.iter().flat_map(|island| &island.fills);
            for path in paths.filter(|p| p.role == Role::SparseFill) {
                for (a, b, width) in (0..path.n_segments()).map(|s| path.segment(s)) {
                    let pieces = (a.distance(b) / (0.5 * SQUARE_MM)).ceil().max(1.0);
                    let each = bead_spacing_mm(width, h) * h * a.distance(b) / pieces;
                    for s in 0..pieces as usize {
                        let p = a.lerp(b, (s as f64 + 0.5) / pieces);
                        if inside.as_ref().is_none_or(|inside| inside.contains(p)) {
                            sums[cell_of(p, k)][3] += each;
                        }
                    }
                }
            }
        }
        Self::of_cells(asked, &sums, bounds.min.extend(bottom), n, high_mm)
    }

    fn of_cells(
        asked: &AskedDensity<'_>,
        sums: &[[f64; 4]],
        low: DVec3,
        n: [usize; 3],
        high_mm: f64,
    ) -> Self {
        let half = 0.5 * CELL_MM * CELL_MM * high_mm;
        let required = match asked.by {
            DensityBy::File => 1,
            DensityBy::Stress => 2,
        };
        let cell = |(i, s): (usize, &[f64; 4])| {
            let at = DVec3::new((i % n[0]) as f64, (i / n[0] % n[1]) as f64, (i / (n[0] * n[1])) as f64);
            let low_mm = low + at * DVec3::new(CELL_MM, CELL_MM, high_mm);
            let of = |k: usize| s[k] / s[0];
            (s[0] >= half).then(|| (CellDensity { low_mm, asked: of(required), laid: of(3) }, of(2)))
        };
        let (each, limited): (Vec<CellDensity>, Vec<f64>) = sums.iter().enumerate().filter_map(cell).unzip();
        let error = |c: &CellDensity| (c.laid - c.asked).abs();
        let mean = |errors: f64| errors / each.len().max(1) as f64;
        let mean_error = mean(each.iter().map(error).sum());
        let worst = each.iter().max_by(|a, b| error(a).total_cmp(&error(b)));
        let off = || each.iter().zip(&limited).map(|(c, limited)| (c.laid - limited).abs());
        let follows = mean(off().sum()) <= WARNED[0] && off().fold(0.0, f64::max) <= WARNED[1];
        let all = sums.iter().fold([0.0; 4], |all, s| [0, 1, 2, 3].map(|k| all[k] + s[k]));
        let share = |v: f64| (v * 1e4).round() / 1e4;
        let middle = |c: &CellDensity| c.low_mm + 0.5 * DVec3::new(CELL_MM, CELL_MM, high_mm);
        Self {
            by: asked.by.name(),
            min: asked.range[0],
            max: asked.range[1],
            asked: share(all[required] / all[0].max(1e-9)),
            laid: share(all[3] / all[0].max(1e-9)),
            slope_added: share((all[2] - all[1]) / all[0].max(1e-9)),
            mean_error: share(mean_error),
            worst_error: share(worst.map_or(0.0, error)),
            worst_at_mm: worst
                .map_or([0.0; 3], |c| middle(c).to_array().map(|v| (v * 100.0).round() / 100.0)),
            cells: each.len(),
            follows,
            fall_mm: asked.fall_mm,
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
                    "by {}, {} to {}, mean {} (laid {}), of which the limit of the slope adds {}",
                    self.by,
                    percent(self.min),
                    percent(self.max),
                    percent(self.asked),
                    percent(self.laid),
                    percent(self.slope_added)
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
        let off = format!(
            "infill is off the density asked for by {:.1} % of full in the mean and by {:.1} % at worst, at ({x:.1}, {y:.1}, {z:.1}) mm",
            100.0 * self.mean_error,
            100.0 * self.worst_error
        );
        if !self.follows {
            return Some(Warning::new(WarningId::DensityOff, off));
        }
        let text = format!(
            "{off}: the densities of the file fall faster than the distance between lines may grow, and what lies around dense \
             places gets more material, {:.1} % of full in the mean",
            100.0 * self.slope_added
        );
        let remedy = format!(
            "smooth the densities so that they fall from {} to {} over {:.0} mm or more, or lower fill.density.max or raise \
             fill.density.min",
            self.max,
            self.min,
            self.fall_mm.ceil()
        );
        Some(Warning::new(WarningId::DensityOff, text).with_remedy(remedy))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::order::Island;
    use grainpath_core::{Layer, Toolpath};

    /// Densities from 0.1 to 0.5 by the stress, in these areas of the layers beside other areas.
    fn asked_by_stress<'a>(map: &'a DensityMap, areas: &'a [Region]) -> AskedDensity<'a> {
        let by = DensityBy::Stress;
        AskedDensity { map, range: [0.1, 0.5], by, fall_mm: 0.0, areas, beside_others: true }
    }

    #[test]
    fn cells_compare_what_is_laid_with_what_is_asked_for() {
        let section = || Region::rectangle(DVec2::ZERO, DVec2::new(20.0, 10.0));
        let layer = |i: usize| Layer::new(0.2 * (i + 1) as f64, 0.2, section()).expect("a layer");
        let stack = LayerStack::new((0..25).map(layer).collect()).expect("a stack");
        let map = DensityMap::new(DVec3::ZERO, DVec3::new(20.0, 10.0, 5.0), 1.0, true, |_| 0.25);
        let areas = vec![section(); 25];
        let asked = asked_by_stress(&map, &areas);
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

    #[test]
    fn beads_of_a_region_beside_the_graded_infill_do_not_count() {
        let section = || Region::rectangle(DVec2::ZERO, DVec2::new(10.0, 5.0));
        let layer = Layer::new(0.2, 0.2, section()).expect("a layer");
        let stack = LayerStack::new(vec![layer]).expect("a stack");
        let map = DensityMap::new(DVec3::ZERO, DVec3::new(10.0, 5.0, 0.2), 1.0, true, |_| 0.25);
        // Graded lines 1 mm apart up to a border that cuts a cell, and lines four times as dense beyond it.
        let border_mm = 8.1;
        let width = grainpath_core::units::bead_width_mm(0.25, 0.2);
        let line = |y: f64, from: f64, to: f64| {
            Toolpath::new(vec![DVec2::new(from, y), DVec2::new(to, y)], width, Role::SparseFill, false)
        };
        let mut fills: Vec<Toolpath> = (0..5).map(|k| line(f64::from(k) + 0.5, 0.0, border_mm)).collect();
        fills.extend((0..20).map(|k| line(0.25 * f64::from(k) + 0.125, border_mm + 0.05, 10.0)));
        let layers =
            [LayerPaths { islands: vec![Island { walls: Vec::new(), fills }], ..LayerPaths::default() }];
        let areas = [Region::rectangle(DVec2::ZERO, DVec2::new(border_mm, 5.0))];
        let asked = asked_by_stress(&map, &areas);
        let found = LaidDensity::measure(&asked, &stack, &layers);
        assert!(found.cells == 2 && found.worst_error < 0.02, "{found:?}");
    }

    #[test]
    fn what_the_limit_of_the_slope_adds_to_a_file_is_an_error_that_is_told_with_its_cause() {
        let section = || Region::rectangle(DVec2::ZERO, DVec2::new(20.0, 20.0));
        let stack =
            LayerStack::new(vec![Layer::new(0.2, 0.2, section()).expect("a layer")]).expect("a stack");
        // Squares of 5 mm at 0.9 and 0.1 by turns, with a mean of 0.5.
        let at = |p: DVec3| if ((p.x / 5.0).floor() + (p.y / 5.0).floor()) % 2.0 == 0.0 { 0.9 } else { 0.1 };
        let mut map = DensityMap::new(DVec3::ZERO, DVec3::new(20.0, 20.0, 0.2), 1.0, true, at);
        map.limit(0.4);
        // Beads of half a millimetre, 0.5 mm apart, that lay the limited densities to the dot.
        let bead = |k: usize| {
            let p = 0.5 * DVec2::new((k % 40) as f64 + 0.5, (k / 40) as f64 + 0.5);
            let width = grainpath_core::units::bead_width_mm(0.5 * map.at(p.extend(0.1)), 0.2);
            let ends = [p - DVec2::new(0.25, 0.0), p + DVec2::new(0.25, 0.0)];
            Toolpath::new(ends.to_vec(), width, Role::SparseFill, false)
        };
        let island = Island { walls: Vec::new(), fills: (0..1600).map(bead).collect() };
        let layers = [LayerPaths { islands: vec![island], ..LayerPaths::default() }];
        let areas = [section()];
        let measured = |by: DensityBy| {
            let asked = AskedDensity {
                map: &map,
                range: [0.1, 0.9],
                by,
                fall_mm: 7.1,
                areas: &areas,
                beside_others: false,
            };
            LaidDensity::measure(&asked, &stack, &layers)
        };
        let by_file = measured(DensityBy::File);
        assert!((by_file.asked - 0.5).abs() < 0.05 && by_file.slope_added > 0.1, "{by_file:?}");
        assert!((by_file.asked + by_file.slope_added - by_file.laid).abs() < 0.01, "{by_file:?}");
        assert!(by_file.mean_error > 0.1 && by_file.worst_error > 0.2, "{by_file:?}");
        let warning = by_file.warning().expect("far off");
        assert_eq!(warning.id, WarningId::DensityOff);
        assert!(warning.text.contains("fall faster"), "{}", warning.text);
        assert!(format!("{warning:?}").contains("over 8 mm or more"), "{warning:?}");
        // Stress may fall off steeply: there the limited densities are asked for.
        let by_stress = measured(DensityBy::Stress);
        assert!(
            by_stress.warning().is_none() && by_stress.slope_added == by_file.slope_added,
            "{by_stress:?}"
        );
    }
}
