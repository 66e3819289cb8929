//! Sparse lines that touch no other line: neither beside them in their layer, nor crossing above or below.
//!
//! Lines that run the same way in every layer and lie further apart than a bead is wide print as thin walls that only
//! the outline holds together. The published grain specimens forbid that: curves are inserted until neighbours touch,
//! so that no curve stands alone. A plan with such layers is printable, but it
//! bends and splits between its lines, so the run says so.
//!
//! Method: sparse fill of up to `CHECKED_LAYERS` layers, evenly spread, is sampled once per bead width. A sample
//! touches if another line of the same layer lies within a bead's width of it, or if a line of the layer above or below
//! passes there at an angle. Lengths are in mm. Cost: linear in the samples of those layers and their two neighbours.

use grainpath_core::buckets::PointGrid2;
use grainpath_core::polyline::resampled;
use grainpath_core::{Bounds2, DVec2, LayerPlan, Role, Warning, WarningId};

/// So many layers at most are looked at. Source: derived; lines of a layer differ little from those of the layers beside
/// it, and 12 layers of the largest plans take less than 1 % of the time of their fill.
const CHECKED_LAYERS: usize = 12;
/// Two beads touch up to this distance of their middles, in widths. Source: derived; dense fill lies at 0.9 of a width
/// apart, and 1.05 leaves room for the rounding of widths.
const TOUCHING: f64 = 1.05;
/// Points of one line are no neighbours of each other within this length along it, in widths. Source: derived; half a
/// circle around the tightest turn between touching lines is 1.6 widths long.
const OWN: f64 = 3.0;
/// Lines of neighbouring layers cross if the cosine between them is below this, at more than 20 degrees. Source: derived;
/// a line that turns slowly differs less than that from the same line a layer below.
const CROSSING_COS: f64 = 0.94;
/// A layer is told of where less than this share of its length touches. Measured: the sparse lines of the grain example
/// touch along 0.6 % of their length, and lines that cross touch along a fifth of it at a density of 0.1.
const LEAST_SHARE: f64 = 0.05;

/// A warning that names the first layer whose sparse lines touch nothing, and how many of the layers looked at are so.
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

/// Samples of a layer's sparse lines: place, direction, and the number of the line.
struct Samples {
    points: Vec<Vec<DVec2>>,
    /// The same points, each with its line and its index in it.
    near: PointGrid2<(u32, u32)>,
    width_mm: f64,
}

impl Samples {
    fn of_layer(layer: &LayerPlan) -> Option<Self> {
        let lines = || layer.paths.iter().map(|p| &p.path).filter(|p| p.role == Role::SparseFill);
        // One width for the layer: the widest, so that wide beads are not taken for separate ones.
        let widths = lines().flat_map(|p| (0..p.points.len()).map(|i| p.width_at(i)));
        let width_mm = widths.fold(0.0, f64::max);
        if width_mm <= 0.0 {
            return None;
        }
        let points = lines().map(|p| resampled(&p.points, p.closed, 0.5 * width_mm)).collect::<Vec<_>>();
        let bounds = Bounds2::around_points(points.iter().flatten().copied())?;
        let mut near = PointGrid2::new(bounds, TOUCHING * width_mm);
        for (line, points) in (0u32..).zip(&points) {
            (0u32..).zip(points).for_each(|(k, &p)| near.insert(p, (line, k)));
        }
        Some(Self { points, near, width_mm })
    }

    /// The direction of a line at one of its samples, without a sign.
    fn direction(&self, line: usize, at: usize) -> DVec2 {
        let points = &self.points[line];
        let (a, b) = (points[at.saturating_sub(1)], points[(at + 1).min(points.len() - 1)]);
        (b - a).normalize_or_zero()
    }

    /// Whether another line lies beside a sample, or the same one further along.
    fn touches(&self, line: usize, at: usize) -> bool {
        let own = (OWN / 0.5) as u32;
        let mut beside = self.near.within(self.points[line][at], TOUCHING * self.width_mm);
        beside.any(|(_, (other, k))| other as usize != line || k.abs_diff(at as u32) > own)
    }

    /// Whether a line passes a place at an angle to a direction.
    fn crosses(&self, place: DVec2, direction: DVec2) -> bool {
        let mut passing = self.near.within(place, 0.5 * self.width_mm);
        passing.any(|(_, (line, k))| {
            self.direction(line as usize, k as usize).dot(direction).abs() < CROSSING_COS
        })
    }
}

/// The share of a layer's sparse length that touches another line; `None` without such lines.
fn touching_share(layers: &[LayerPlan], k: usize) -> Option<f64> {
    let own = Samples::of_layer(&layers[k])?;
    let beside = [k.checked_sub(1), Some(k + 1)].into_iter().flatten();
    let neighbours: Vec<Samples> =
        beside.filter_map(|i| layers.get(i)).filter_map(Samples::of_layer).collect();
    let (mut all, mut touching) = (0_usize, 0_usize);
    for (line, points) in own.points.iter().enumerate() {
        for (at, &place) in points.iter().enumerate() {
            let direction = own.direction(line, at);
            all += 1;
            touching += usize::from(
                own.touches(line, at) || neighbours.iter().any(|other| other.crosses(place, direction)),
            );
        }
    }
    (all > 0).then(|| touching as f64 / all as f64)
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
