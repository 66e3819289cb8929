//! Gyroid infill: sections of the surface `sin x cos y + sin y cos z + sin z cos x = 0`.
//!
//! At a height `z` the section consists of waves along x or along y, depending on the phase of `z`. From
//! layer to layer one kind turns into the other, so no straight line of weakness runs through the part.
//! For a given `z` the equation is solved for the coordinate across the waves in closed form, with two
//! solutions, at 24 points a period.
//!
//! The density decides the period. The mean length of all waves per unit area, over all heights, is
//! integrated once numerically. The period is chosen so that this length times the bead's cross-section
//! gives the density. Source of the surface: `Schoen1970`. Lengths are in mm, phases in radians. Cost:
//! linear in the length of the waves.

use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

use grainpath_core::isolines::isolines;
use grainpath_core::math::{asin, atan2, cos, sin, sin_cos};
use grainpath_core::poly::{LineClipper, simplify_line};
use grainpath_core::{Bounds2, DVec2, Polygon, Region, Toolpath};

use super::{FillContext, Infill};
use crate::guide::graded_density::DensityMap;

/// Slices of `sin x cos y + sin y cos z + sin z cos x = 0`.
pub struct Gyroid;

/// Points of a wave in one period. Source: derived: on a sine of unit amplitude a chord over 2 pi /
/// 24 is off by (2 pi / 24)^2 / 8 = 0.0086 of the length unit, which is 8 um at a density of 20 %
/// and beads of 0.45 mm.
const POINTS: usize = 24;

impl Infill for Gyroid {
    fn fill(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
        let Some(bounds) = infill_region.bounds() else { return };
        // The length per area is proportional to 1 / unit. So the unit of the phase is the bead spacing
        // times the length per area at unit 1, over the density.
        let unit_mm = context.spacing_mm() * length_density() / context.density.fraction();
        let clipper = LineClipper::new(&Region::from(infill_region.clone()));
        let z = context.z_mid_mm / unit_mm;
        for wave in waves(bounds.grown(0.1), unit_mm, z) {
            for piece in clipper.clip(&wave) {
                let path = Toolpath::new(piece.points, context.bead_width_mm, context.role, false);
                // A piece shorter than its width would only be a dot.
                if path.length_mm() > context.bead_width_mm {
                    out.push(path);
                }
            }
        }
    }
}

/// Lays a gyroid whose period halves where the map's density passes from one level to the next. `levels`
/// are the densities of the levels, the shortest period first.
///
/// Between two levels the section is a mixture of both surfaces over a band of densities, so that waves
/// continue from one to the other. The caller sets the widths.
pub(super) fn graded(
    context: &FillContext<'_>,
    map: &DensityMap,
    infill_region: &Polygon,
    levels: &[f64],
    out: &mut Vec<Toolpath>,
) {
    let Some(bounds) = infill_region.bounds() else { return };
    let bounds = bounds.grown(1.0);
    let Some(&finest) = levels.first() else { return };
    let unit_mm = |density: f64| context.spacing_mm() * length_density() / density;
    let size = bounds.size();
    let cell_mm = (unit_mm(finest) * TAU / MIXED_POINTS).max((size.x * size.y / MOST_NODES).sqrt());
    let n = [size.x, size.y].map(|mm| (mm / cell_mm).ceil() as usize + 2);
    // Sines and cosines of each level at every column and row.
    let axis = |unit: f64, from: f64, n: usize| -> Vec<(f64, f64)> {
        (0..n).map(|i| sin_cos((from + cell_mm * i as f64) / unit)).collect()
    };
    let waves: Vec<_> = levels
        .iter()
        .map(|&density| {
            let unit = unit_mm(density);
            (axis(unit, bounds.min.x, n[0]), axis(unit, bounds.min.y, n[1]), sin_cos(context.z_mid_mm / unit))
        })
        .collect();
    let value = |at: usize| {
        let (i, j) = (at % n[0], at / n[0]);
        let p = bounds.min + cell_mm * DVec2::new(i as f64, j as f64);
        let density = map.at(p.extend(context.z_mid_mm));
        let section = |k: usize| {
            let (x, y, (sz, cz)) = &waves[k];
            let ((sx, cx), (sy, cy)) = (x[i], y[j]);
            sx * cy + sy * cz + sz * cx
        };
        // Each level has half the density of the one before. A density between two levels takes the finer one if it is
        // above their geometric mean, which is 0.707 of the finer level's density, and the coarser one if it is below.
        let finer = levels.iter().rposition(|&level| level >= density).unwrap_or(0);
        let coarser = (finer + 1).min(levels.len() - 1);
        let share = 0.5 + (std::f64::consts::FRAC_1_SQRT_2 - density / levels[finer]) / MIXED;
        let share = share.clamp(0.0, 1.0);
        ((1.0 - share) * section(finer) + share * section(coarser)) as f32
    };
    let values: Vec<f32> = (0..n[0] * n[1]).map(value).collect();
    let clipper = LineClipper::new(&Region::from(infill_region.clone()));
    for line in isolines(n, bounds.min, cell_mm, &values) {
        let mut points = line.points;
        if line.closed {
            points.extend(points.first().copied());
        }
        for piece in clipper.clip(&points) {
            let points = simplify_line(&piece.points, 0.02);
            let path = Toolpath::new(points, context.bead_width_mm, context.role, false);
            // Small rings that arise where two levels meet are left out.
            if path.length_mm() > 6.0 * context.bead_width_mm {
                out.push(path);
            }
        }
    }
}

/// Nodes in a period of the finest level. Source: derived: marching squares misplace a sine's zeros by a
/// share of (2 pi / 16)^2 / 8 of its amplitude, 2 %, which is 5 um there.
const MIXED_POINTS: f64 = 16.0;
/// Largest number of grid nodes for a section. Source: derived: as in `mask` of core.
const MOST_NODES: f64 = 1.5e6;
/// Band of densities over which two levels mix, as a share of the finer level. Source: derived: two levels
/// differ by half of the finer one, and a band of a third of that leaves both levels pure for most of their
/// range.
const MIXED: f64 = 0.16;

/// The curves of the section at phase `z` within the bounds. Each is a function of x, or of y if the waves
/// run along y.
fn waves(bounds: Bounds2, unit_mm: f64, z: f64) -> Vec<Vec<DVec2>> {
    let (sz, cz) = sin_cos(z);
    let upright = sz.abs() > cz.abs();
    let (lo, hi) = (bounds.min / unit_mm, bounds.max / unit_mm);
    let (along, across) = if upright { ([lo.y, hi.y], [lo.x, hi.x]) } else { ([lo.x, hi.x], [lo.y, hi.y]) };
    let step = TAU / POINTS as f64;
    let (first, last) = ((along[0] / step).floor() as i64, (along[1] / step).ceil() as i64);
    let mut out = Vec::new();
    // Each period across the waves holds two curves, and a curve deviates from its place by less than a period.
    let (low, high) = ((across[0] / TAU).floor() as i64 - 1, (across[1] / TAU).ceil() as i64 + 1);
    for (k, second) in (low..=high).flat_map(|k| [(k, false), (k, true)]) {
        let curve: Vec<DVec2> = (first..=last)
            .map(|i| {
                let u = i as f64 * step;
                let v = branch(u, sz, cz, upright, second) + TAU * k as f64;
                (if upright { DVec2::new(v, u) } else { DVec2::new(u, v) }) * unit_mm
            })
            .collect();
        // Every other wave is reversed, so that the travel from the end of one wave to the start of the
        // next is short.
        out.push(if k.rem_euclid(2) == 0 { curve } else { curve.into_iter().rev().collect() });
    }
    out
}

/// One of the two solutions of the section's equation: the coordinate across the waves for `u` along them.
fn branch(u: f64, sz: f64, cz: f64, upright: bool, second: bool) -> f64 {
    // a sin v + b cos v + c = 0
    let (a, b, c) = if upright { (cos(u), sz, sin(u) * cz) } else { (cz, sin(u), sz * cos(u)) };
    // Where a and b are both zero, every coordinate solves the equation; the lower bound only avoids a
    // division by zero.
    let r = (a * a + b * b).sqrt().max(1e-12);
    let angle = asin((-c / r).clamp(-1.0, 1.0));
    // The phase is continuous along the curve: it stays within half a turn of the value that cz or sz gives.
    let phase = if upright {
        // a = cos u changes sign along the curve, b = sz does not.
        PI / 2.0 * sz.signum() - atan2(a, b.abs()) * sz.signum()
    } else {
        let p = atan2(b, a.abs());
        if a < 0.0 { PI - p } else { p }
    };
    if second { PI - angle - phase } else { angle - phase }
}

/// Mean length of the curves per unit area over all heights, in units of the phase.
fn length_density() -> f64 {
    static DENSITY: OnceLock<f64> = OnceLock::new();
    *DENSITY.get_or_init(|| {
        // Number of heights in the midpoint rule. Measured: with 64 heights and 256 points a period the
        // length is 0.39089, with 512 and 1024 it is 0.39131, 0.1 % more.
        const N: usize = 64;
        let mut sum = 0.0;
        for k in 0..N {
            let (sz, cz) = sin_cos((k as f64 + 0.5) / N as f64 * TAU);
            let upright = sz.abs() > cz.abs();
            for second in [false, true] {
                let at = |i: usize| {
                    let u = i as f64 / 256.0 * TAU;
                    DVec2::new(u, branch(u, sz, cz, upright, second))
                };
                sum += (0..256).map(|i| at(i).distance(at(i + 1))).sum::<f64>();
            }
        }
        sum / N as f64 / (TAU * TAU)
    })
}
