//! Warns of sparse lines that touch no other line, neither a neighbour in their layer nor a crossing line above or below.
//!
//! Lines that have the same direction in every layer and are more than a bead width apart are printed as separate thin
//! sheets, held together only by the outline of the part. In the published grain specimens this does not occur: curves are
//! inserted until neighbours touch. A plan with such layers can be printed, but the part bends and splits between the
//! lines, so the run gives a warning.
//!
//! Method: the sparse fill of up to `CHECKED_LAYERS` evenly distributed layers is sampled twice per bead width. A sample
//! touches if another line of the same layer lies within a bead width of it, or if a line of the layer above or below
//! crosses it at an angle. Lengths are in mm. Cost: linear in the samples of these layers and their two neighbours.

use grainpath_core::buckets::{Buckets, CellGrid};
use grainpath_core::polyline::resampled;
use grainpath_core::{Bounds2, DVec2, LayerPlan, Role, Warning, WarningId};

/// Largest number of cells along a side of the grid of samples. Source: derived; a cell takes 4 bytes, so all take 16 MB.
const MAX_CELLS_PER_SIDE: usize = 2000;
/// Largest number of examined layers. Source: derived; the lines of neighbouring layers differ little, and examining 12
/// layers of the largest plans takes less than 1 % of the time needed for their infill.
const CHECKED_LAYERS: usize = 12;
/// Largest distance between the centrelines of two beads that touch, in bead widths. Source: derived; lines of dense fill
/// are 0.9 widths apart, and 1.05 leaves room for the rounding of widths.
const TOUCHING: f64 = 1.05;
/// Two points of one line can touch only if they are farther apart along the line than this, in bead widths. Source:
/// derived; the tightest U-turn between two touching lines is 1.6 widths long.
const OWN: f64 = 3.0;
/// Lines of neighbouring layers cross if the cosine of their angle is below this value (more than 20 degrees). Source:
/// derived; a line whose direction turns slowly over the layers differs by less from the same line one layer below.
const CROSSING_COS: f64 = 0.94;
/// A layer is reported if less than this share of its sparse length touches. Measured: the sparse lines of the grain
/// example touch along 0.6 % of their length; crossing lines at a density of 0.1 touch along a fifth of their length.
const LEAST_SHARE: f64 = 0.05;

/// Returns a warning with the first examined layer whose sparse lines touch nothing, and the number of such layers.
#[must_use]
pub fn check(layers: &[LayerPlan]) -> Option<Warning> {
    let with_lines: Vec<usize> = (0..layers.len()).filter(|&k| has_sparse_lines(&layers[k])).collect();
    let every = with_lines.len().div_ceil(CHECKED_LAYERS).max(1);
    let checked: Vec<usize> = with_lines.iter().copied().step_by(every).collect();
    let shares: Vec<(usize, f64)> =
        checked.iter().filter_map(|&k| Some((k, touching_share(layers, k)?))).collect();
    let separate = shares.iter().filter(|(_, share)| *share < LEAST_SHARE);
    let n = separate.clone().count();
    let &(first, share) = separate.clone().next()?;
    let text = format!(
        "fill lines touch no other line in {n} of {} layers examined ({:.1} % of their length does); only the walls hold \
         them",
        shares.len(),
        100.0 * share
    );
    Some(Warning::new(WarningId::FillLinesSeparate, text).in_layer(first, layers[first].z_top_mm))
}

fn has_sparse_lines(layer: &LayerPlan) -> bool {
    layer.paths.iter().any(|p| p.path.role == Role::SparseFill)
}

/// Samples of a layer's sparse lines, one line after the other.
struct Samples {
    /// Each sample with the number of its line.
    all: Vec<(DVec2, u32)>,
    /// The samples sorted into cells whose side is the largest distance of a touch.
    near: Buckets,
    width_mm: f64,
}

impl Samples {
    fn of_layer(layer: &LayerPlan) -> Option<Self> {
        let lines = || layer.paths.iter().map(|p| &p.path).filter(|p| p.role == Role::SparseFill);
        // The layer is examined with its greatest width, so that wide beads are not taken for separate ones.
        let widths = lines().flat_map(|p| (0..p.points.len()).map(|i| p.width_at(i)));
        let width_mm = widths.fold(0.0, f64::max);
        if width_mm <= 0.0 {
            return None;
        }
        let mut all = Vec::new();
        for (line, path) in (0u32..).zip(lines()) {
            all.extend(resampled(&path.points, path.closed, 0.5 * width_mm).into_iter().map(|p| (p, line)));
        }
        let bounds = Bounds2::around_points(all.iter().map(|sample| sample.0))?;
        let cells = CellGrid::covering(bounds, TOUCHING * width_mm, MAX_CELLS_PER_SIDE);
        let near = Buckets::new(cells, all.len(), |i, add| add(cells.index(cells.cell_of(all[i].0))));
        Some(Self { all, near, width_mm })
    }

    /// The direction of a line at one of its samples; the sign is arbitrary.
    fn direction(&self, sample: usize) -> DVec2 {
        let (place, line) = self.all[sample];
        let beside =
            |i: usize| self.all.get(i).filter(|other| other.1 == line).map_or(place, |other| other.0);
        (beside(sample + 1) - beside(sample.wrapping_sub(1))).normalize_or_zero()
    }

    /// The samples within `distance_mm` of `place`.
    fn within(&self, place: DVec2, distance_mm: f64) -> impl Iterator<Item = usize> {
        let cells = &self.near.cells;
        let found = cells.block(cells.cell_of(place - distance_mm), cells.cell_of(place + distance_mm));
        found
            .flat_map(move |cell| self.near.members(cells.index(cell)))
            .map(|&sample| sample as usize)
            .filter(move |&sample| self.all[sample].0.distance_squared(place) < distance_mm * distance_mm)
    }

    /// Whether a sample touches another line, or a distant part of its own line.
    fn touches(&self, sample: usize) -> bool {
        let own = (OWN / 0.5) as usize;
        let (place, line) = self.all[sample];
        let mut beside = self.within(place, TOUCHING * self.width_mm);
        beside.any(|other| self.all[other].1 != line || other.abs_diff(sample) > own)
    }

    /// Whether a line passes through `place` at more than 20 degrees to `direction`.
    fn crosses(&self, place: DVec2, direction: DVec2) -> bool {
        let mut passing = self.within(place, 0.5 * self.width_mm);
        passing.any(|other| self.direction(other).dot(direction).abs() < CROSSING_COS)
    }
}

/// The share of a layer's sparse length that touches another line; `None` without such lines.
fn touching_share(layers: &[LayerPlan], k: usize) -> Option<f64> {
    let own = Samples::of_layer(&layers[k])?;
    let beside = [k.checked_sub(1), Some(k + 1)].into_iter().flatten();
    let neighbours: Vec<Samples> =
        beside.filter_map(|i| layers.get(i)).filter_map(Samples::of_layer).collect();
    let touching = (0..own.all.len()).filter(|&sample| {
        let crossed = |other: &Samples| other.crosses(own.all[sample].0, own.direction(sample));
        own.touches(sample) || neighbours.iter().any(crossed)
    });
    (!own.all.is_empty()).then(|| touching.count() as f64 / own.all.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::{PlannedPath, Toolpath, Travel};

    /// Layers of parallel lines 30 mm long over 30 mm, turned by these angles in turn.
    fn layers(spacing_mm: f64, angles_deg: &[f64]) -> Vec<LayerPlan> {
        let n = (15.0 / spacing_mm) as i32;
        let layer = |k: usize| {
            let turn = DVec2::from_angle(angles_deg[k % angles_deg.len()].to_radians());
            let line = |i: i32| {
                let y = f64::from(i) * spacing_mm;
                let points = [DVec2::new(-15.0, y), DVec2::new(15.0, y)].map(|p| turn.rotate(p)).to_vec();
                let path = Toolpath::new(points, 0.45, Role::SparseFill, false);
                PlannedPath { travel: Travel::default(), path }
            };
            LayerPlan { z_top_mm: 0.2 * (k + 1) as f64, height_mm: 0.2, paths: (-n..=n).map(line).collect() }
        };
        (0..30).map(layer).collect()
    }

    #[test]
    fn parallel_lines_apart_in_every_layer_are_told_of() {
        for angle_deg in [0.0, 37.0, 90.0] {
            let warning = check(&layers(0.81, &[angle_deg])).expect("the lines touch nothing");
            assert_eq!(warning.id, WarningId::FillLinesSeparate);
            assert_eq!(warning.place.and_then(|p| p.layer), Some(1));
        }
    }

    #[test]
    fn lines_that_touch_or_cross_are_not() {
        assert_eq!(check(&layers(0.44, &[20.0])), None, "neighbours touch");
        for spacing_mm in [0.81, 2.0, 4.0] {
            assert_eq!(check(&layers(spacing_mm, &[45.0, -45.0])), None, "crossed every {spacing_mm} mm");
        }
        assert_eq!(check(&[]), None);
    }
}
