//! Warns of sparse lines that touch no other line, neither a neighbour in their layer nor a crossing line above or below.
//!
//! Lines that have the same direction in every layer and are more than a bead width apart are printed as separate thin
//! sheets, held together only by the outline of the part. In the published grain specimens this does not occur: curves are
//! inserted until neighbours touch. A plan with such layers can be printed, but the part bends and splits between the
//! lines, so the run gives a warning.
//!
//! Method: in up to `CHECKED_LAYERS` evenly distributed layers, up to `SAMPLES` points of the sparse fill are tested. A
//! point touches if another line of the same layer lies within a bead width of it, or if a line of the layer above or
//! below crosses it at an angle. The share of touching points is that of the length to within about 0.7 %. A layer is
//! done as soon as enough of its points touch; the layers beside it are searched only if its own lines are not enough.
//! Lengths are in mm. Cost: linear in the pieces of these layers and their two neighbours.

use grainpath_core::segments::Segments;
use grainpath_core::{DVec2, LayerPlan, Role, Warning, WarningId};

/// Side of the cells that pieces are sorted into, in bead widths. Source: derived; sorting takes a step for each cell that a
/// line passes and a test one for each line that passes a cell. At the usual densities some lines pass a cell of this size.
const CELL: f64 = 16.0;
/// Largest number of points of a layer that are tested. Source: derived; the standard deviation of a share of 5 % found with
/// 1000 points is 0.7 %.
const SAMPLES: usize = 1000;
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
        checked.iter().filter_map(|&k| Some((k, low_touching_share(layers, k)?))).collect();
    let &(first, share) = shares.first()?;
    let text = format!(
        "fill lines touch no other line in {} of {} layers examined ({:.1} % of their length does); only the walls hold \
         them",
        shares.len(),
        checked.len(),
        100.0 * share
    );
    Some(Warning::new(WarningId::FillLinesSeparate, text).in_layer(first, layers[first].z_top_mm))
}

fn has_sparse_lines(layer: &LayerPlan) -> bool {
    layer.paths.iter().any(|p| p.path.role == Role::SparseFill)
}

/// The straight pieces of a layer's sparse lines, one line after the other.
struct Lines {
    pieces: Segments,
    /// For each piece the number of its line, and the distance of its beginning from the start of the layer's first line,
    /// measured along all lines one after the other.
    of_pieces: Vec<(u32, f64)>,
    width_mm: f64,
    length_mm: f64,
}

impl Lines {
    fn of_layer(layer: &LayerPlan) -> Option<Self> {
        let (mut pieces, mut of_pieces, mut width_mm, mut length_mm) = (Vec::new(), Vec::new(), 0.0f64, 0.0);
        let sparse = layer.paths.iter().map(|p| &p.path).filter(|p| p.role == Role::SparseFill);
        for (line, path) in (0u32..).zip(sparse) {
            for i in 0..path.n_segments() {
                let (a, b, width) = path.segment(i);
                // The layer is examined with its greatest width, so that wide beads are not taken for separate ones.
                width_mm = width_mm.max(width);
                pieces.push([a, b]);
                of_pieces.push((line, length_mm));
                length_mm += a.distance(b);
            }
        }
        if width_mm <= 0.0 || length_mm <= 0.0 {
            return None;
        }
        Some(Self { pieces: Segments::new(pieces, CELL * width_mm), of_pieces, width_mm, length_mm })
    }

    fn direction(&self, piece: usize) -> DVec2 {
        let [a, b] = self.pieces.ends(piece);
        (b - a).normalize_or_zero()
    }

    /// Points spread evenly over the length of all lines, each with the number of its piece.
    fn samples(&self) -> Vec<(DVec2, usize)> {
        /// Multiples of the golden ratio, less their whole parts, are spread evenly and have no period, so that they
        /// cannot fall in step with lines that cross at even distances. Source: Weyl's equidistribution.
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let n = ((self.length_mm / (0.5 * self.width_mm)).ceil() as usize).clamp(1, SAMPLES);
        let point = |k: usize| {
            let along = self.length_mm * (k as f64 * GOLDEN).fract();
            // The first piece begins at 0, so one at least begins at or before every place.
            let piece = self.of_pieces.partition_point(|&(_, from_mm)| from_mm <= along) - 1;
            (self.pieces.ends(piece)[0] + (along - self.of_pieces[piece].1) * self.direction(piece), piece)
        };
        (1..=n).map(point).collect()
    }

    /// Whether a point of a piece touches another line, or a distant part of its own line.
    fn touches(&self, place: DVec2, piece: usize) -> bool {
        let (line, from_mm) = self.of_pieces[piece];
        // Points of the same line lie on it one after the other, so a turn beside the point is told by its distance along.
        let along_mm = from_mm + self.pieces.ends(piece)[0].distance(place);
        self.pieces.within(place, TOUCHING * self.width_mm).any(|(other, share)| {
            let [a, b] = self.pieces.ends(other);
            let (other_line, other_from_mm) = self.of_pieces[other];
            let apart_mm = (other_from_mm + share * a.distance(b) - along_mm).abs();
            other_line != line || apart_mm > OWN * self.width_mm
        })
    }

    /// Whether a line passes through `place` at more than 20 degrees to `direction`.
    fn crosses(&self, place: DVec2, direction: DVec2) -> bool {
        let mut passing = self.pieces.within(place, 0.5 * self.width_mm);
        passing.any(|(other, _)| self.direction(other).dot(direction).abs() < CROSSING_COS)
    }
}

/// The share of a layer's sparse length that touches another line, if it is below `LEAST_SHARE`.
fn low_touching_share(layers: &[LayerPlan], k: usize) -> Option<f64> {
    let own = Lines::of_layer(&layers[k])?;
    let samples = own.samples();
    let enough = LEAST_SHARE * samples.len() as f64;
    let mut n_touching = 0u32;
    let mut alone = Vec::new();
    for &(place, piece) in &samples {
        if own.touches(place, piece) {
            n_touching += 1;
            if f64::from(n_touching) >= enough {
                return None;
            }
        } else {
            alone.push((place, own.direction(piece)));
        }
    }
    // A crossing counts above and below: either neighbour holds the line.
    let beside = [k.checked_sub(1), Some(k + 1)].into_iter().flatten();
    let neighbours: Vec<Lines> = beside.filter_map(|i| layers.get(i)).filter_map(Lines::of_layer).collect();
    for (place, direction) in alone {
        if neighbours.iter().any(|other| other.crosses(place, direction)) {
            n_touching += 1;
            if f64::from(n_touching) >= enough {
                return None;
            }
        }
    }
    Some(f64::from(n_touching) / samples.len() as f64)
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
