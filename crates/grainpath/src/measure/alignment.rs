//! Warns of plans whose infill deviates far from its guide, and of stress that beads of a single
//! direction cannot carry.
//!
//! The angle between each segment of infill and the direction of the guide is weighted by the length
//! of the segment and by the guide's weight there, as in the report. At most `MAX_LAYERS` layers are
//! examined, evenly distributed over the height, so the cost does not grow with the height. The
//! worst layer is divided into cells, each a fifth of the layer's infill wide. The warning names a
//! place in the cell with the largest sum of weighted angles. Degenerate cases: no guide, no infill
//! and a guide without weight give no warning.

use grainpath_core::{Bounds2, DVec2, Diagnostics, LayerPlan, Warning, WarningId};
use grainpath_job::choices::{Choice, DensityBy, Pattern};

use crate::measure::Planned;
use crate::measure::report::direction_error;

/// A larger mean angle between infill and guide gives a warning, degrees. Source: chosen; a requirement of the project.
const MAX_MEAN_DEG: f64 = 15.0;
/// A warning is given if more than this share of the weighted infill lies in pure shear. Source:
/// derived: more than half.
const MAX_UNDECIDED_SHARE: f64 = 0.5;
/// Largest number of examined layers. Source: derived: with 32 layers, the gap between two of them
/// is about a thirtieth of the height.
const MAX_LAYERS: usize = 32;
/// Cells along each side of the part. Source: derived: a place known to a fifth of the part is
/// precise enough to be found in a picture.
const CELLS: usize = 5;

/// Sums over the infill of one layer.
struct LayerSums {
    weight: f64,
    weighted_deg: f64,
    undecided: f64,
    stress_weight: f64,
    /// For each cell, the sum of the weighted angles, and the sum of the segments' midpoints, each multiplied
    /// by its weighted angle.
    cells: [(f64, DVec2); CELLS * CELLS],
}

/// Adds a warning if the infill deviates far from its guide, and one if tension and compression of
/// equal amount cross in most of it. Where the density follows the stress and the pattern follows no field, the guide is there
/// for the density alone: the infill then has no directions to keep, and nothing is warned of.
pub(crate) fn warn_if_far(
    planned: &Planned,
    pattern: Pattern,
    density_by: Option<DensityBy>,
    diagnostics: &Diagnostics,
) {
    if density_by == Some(DensityBy::Stress) && !pattern.follows_field() {
        return;
    }
    let layers = &planned.plan.layers;
    let picked: Vec<usize> = if layers.len() <= MAX_LAYERS {
        (0..layers.len()).collect()
    } else {
        (0..MAX_LAYERS).map(|k| k * (layers.len() - 1) / (MAX_LAYERS - 1)).collect()
    };
    let sums: Vec<(usize, LayerSums)> =
        picked.into_iter().filter_map(|i| Some((i, sums(planned, &layers[i])?))).collect();
    let total = |f: &dyn Fn(&LayerSums) -> f64| sums.iter().map(|(_, s)| f(s)).sum::<f64>();
    let weight = total(&|s| s.weight);
    let mean_deg = total(&|s| s.weighted_deg) / weight.max(f64::MIN_POSITIVE);
    let worst = sums.iter().max_by(|a, b| a.1.weighted_deg.total_cmp(&b.1.weighted_deg).then(b.0.cmp(&a.0)));
    if let Some((i, layer)) = worst.filter(|_| weight > 0.0 && mean_deg >= MAX_MEAN_DEG) {
        let layer_deg = layer.weighted_deg / layer.weight.max(f64::MIN_POSITIVE);
        let cell = layer.cells.iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let place = cell.map_or(DVec2::ZERO, |(sum, places)| *places / sum.max(f64::MIN_POSITIVE));
        let text = format!(
            "the infill lies {mean_deg:.1} degrees from the directions of its guide in the mean, and {layer_deg:.1} degrees in \
             this layer; {:?} {}",
            pattern.name(),
            if pattern.follows_field() {
                "cannot follow them closely here"
            } else {
                "does not follow a guide"
            }
        );
        let remedy = match pattern {
            Pattern::Stripes => {
                "raise guide.smoothing_mm where the directions turn within a few beads, or lay fill.pattern = \"continuous\""
            }
            Pattern::Rectilinear
            | Pattern::Grid
            | Pattern::Triangles
            | Pattern::Gyroid
            | Pattern::Concentric
            | Pattern::Honeycomb
            | Pattern::Aligned
            | Pattern::Streamlines
            | Pattern::SeedLines
            | Pattern::Continuous => {
                "try fill.pattern = \"stripes\"; `grainpath render --color direction` shows where the infill is off"
            }
        };
        let z_mm = layers[*i].z_top_mm;
        let warning = Warning::new(WarningId::GuideFar, text).with_remedy(remedy);
        diagnostics.push(warning.in_layer(*i, z_mm).at_mm(place.x, place.y));
    }
    let undecided = total(&|s| s.undecided) / total(&|s| s.stress_weight).max(f64::MIN_POSITIVE);
    if undecided > MAX_UNDECIDED_SHARE {
        let text = format!(
            "in {:.0} % of the infill, weighted by stress, tension and compression of about equal amount cross (pure shear); \
             beads of one layer follow one of them",
            100.0 * undecided
        );
        diagnostics.warn(WarningId::GuideTwoDirections, text);
    }
}

/// The sums over the infill of one layer; `None` if the plan has no guide.
fn sums(planned: &Planned, layer: &LayerPlan) -> Option<LayerSums> {
    let off = direction_error(planned)?;
    let z_mid_mm = layer.z_top_mm - 0.5 * layer.height_mm;
    let beads = || layer.paths.iter().map(|p| &p.path).filter(|p| p.role.is_fill());
    let bounds = Bounds2::around_points(beads().flat_map(|p| p.points.iter().copied()));
    let bounds = bounds.unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ONE });
    let size = bounds.size().max(DVec2::splat(1e-9));
    let mut sums = LayerSums {
        weight: 0.0,
        weighted_deg: 0.0,
        undecided: 0.0,
        stress_weight: 0.0,
        cells: [(0.0, DVec2::ZERO); CELLS * CELLS],
    };
    for path in beads() {
        for i in 0..path.n_segments() {
            let (a, b, _) = path.segment(i);
            let Some((deg, weight)) = off(z_mid_mm, [a, b]) else { continue };
            let (middle, weight) = (0.5 * (a + b), weight * a.distance(b));
            sums.weight += weight;
            sums.weighted_deg += weight * deg;
            let at = ((middle - bounds.min) / size * CELLS as f64).min(DVec2::splat(CELLS as f64 - 1.0));
            let cell = &mut sums.cells[at.y as usize * CELLS + at.x as usize];
            cell.0 += weight * deg;
            cell.1 += weight * deg * middle;
            if let Some(crossed) =
                planned.guide.as_ref().and_then(|g| g.is_pure_shear(middle.extend(z_mid_mm)))
            {
                sums.stress_weight += weight;
                sums.undecided += if crossed { weight } else { 0.0 };
            }
        }
    }
    Some(sums)
}
