//! Warns of sparse lines whose ends hang over air, or that lie on nothing at all.
//!
//! Where density or directions change with the height, a line may begin where no bead lies below. A nozzle that pushes
//! such an end drags it along. Lines that cross those below hang freely between the crossings as well, but are held at
//! both ends; only ends are counted here.
//!
//! Method: an open line of sparse infill is followed from either end, in steps of a fifth of its width, up to the first
//! place with a bead of the layer below within `HELD`. Lengths are in mm. Cost: a search for each step up to that
//! place, linear in the beads. Limits: a bead below counts whether it is held itself or not.

use std::ops::AddAssign;

use grainpath_core::polyline::resampled;
use grainpath_core::segments::Segments;
use grainpath_core::{DVec2, LayerPlan, Role, Warning, WarningId};
use rayon::prelude::*;

use crate::fill::HELD;

/// Distance of the places that are looked at, in bead widths. Source: derived; an end is then found a tenth of a width too
/// long on average.
const STEP: f64 = 0.2;
/// Shorter ends are not counted, mm. Source: chosen; about two beads, as long as a line that meets a wall at a flat angle
/// lies beside the bead below.
const SHORT_MM: f64 = 1.0;
/// Warned of from this share of the length of sparse lines on. Measured: on a bar of 80 x 30 x 20 mm bent upwards, graded by
/// stress, it is 0.9 % of the lines along the stress and 0.3 % of hexagons; of crossing lines and gyroids it is less.
const LEAST_SHARE: f64 = 0.002;

/// What hangs over air, of one layer or of all.
#[derive(Debug, Default, Clone, Copy)]
struct Hanging {
    n_ends: usize,
    n_whole: usize,
    ends_mm: f64,
    all_mm: f64,
    /// Length, layer and place of the longest.
    longest: Option<(f64, usize, DVec2)>,
}

impl AddAssign for Hanging {
    fn add_assign(&mut self, other: Self) {
        self.n_ends += other.n_ends;
        self.n_whole += other.n_whole;
        self.ends_mm += other.ends_mm;
        self.all_mm += other.all_mm;
        if other.longest.is_some_and(|o| self.longest.is_none_or(|own| o.0 > own.0)) {
            self.longest = other.longest;
        }
    }
}

/// A warning with the share of the length that hangs, the number of ends and the longest of them.
#[must_use]
pub fn check(layers: &[LayerPlan]) -> Option<Warning> {
    let each: Vec<Hanging> = (1..layers.len()).into_par_iter().map(|k| of_layer(layers, k)).collect();
    let mut all = Hanging::default();
    each.into_iter().for_each(|one| all += one);
    let (longest_mm, k, at) = all.longest?;
    let share = all.ends_mm / all.all_mm.max(f64::MIN_POSITIVE);
    let text = format!(
        "{:.1} % of the length of sparse infill hangs over air: {} ends of lines, the longest {longest_mm:.1} mm, and {} \
         lines with nothing below",
        100.0 * share,
        all.n_ends,
        all.n_whole
    );
    let warning = Warning::new(WarningId::FillOverAir, text).in_layer(k, layers[k].z_top_mm);
    (share >= LEAST_SHARE).then(|| warning.at_mm(at.x, at.y))
}

fn of_layer(layers: &[LayerPlan], k: usize) -> Hanging {
    let mut out = Hanging::default();
    let lines = || layers[k].paths.iter().map(|p| &p.path).filter(|p| p.role == Role::SparseFill);
    let widest_mm = lines().map(|p| p.width_at(0)).fold(0.0, f64::max);
    if widest_mm <= 0.0 {
        return out;
    }
    let below = layers[k - 1].paths.iter().map(|p| &p.path);
    let below = Segments::of_paths(below, 4.0 * widest_mm);
    for line in lines() {
        let length_mm = line.length_mm();
        out.all_mm += length_mm;
        let width_mm = line.width_at(0);
        let places = resampled(&line.points, line.closed, STEP * width_mm);
        let held = |p: &DVec2| below.within(*p, HELD * width_mm).next().is_some();
        let mut add = |n_ends, n_whole, ends_mm, at| {
            if ends_mm > SHORT_MM {
                out += Hanging { n_ends, n_whole, ends_mm, all_mm: 0.0, longest: Some((ends_mm, k, at)) };
            }
        };
        let Some(first) = places.iter().position(held) else {
            add(0, 1, length_mm, line.points[0]);
            continue;
        };
        // A ring has no end.
        if !line.closed {
            let step_mm = length_mm / (places.len() - 1).max(1) as f64;
            let last = places.iter().rev().position(held).unwrap_or(first);
            add(1, 0, step_mm * first as f64, line.start());
            add(1, 0, step_mm * last as f64, line.end());
        }
    }
    out
}
