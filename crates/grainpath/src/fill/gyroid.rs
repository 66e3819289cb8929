//! Gyroid infill: sections of the surface `sin x cos y + sin y cos z + sin z cos x = 0`.
//!
//! At a height `z` the section consists of waves that run along x or along y, whichever the phase
//! favours; from layer to layer they turn into each other, so no straight line of weakness runs
//! through the part. For a given `z` the equation is solved for the coordinate across in closed
//! form (two branches), 24 points a period.
//!
//! The density fixes the period: the mean length of all waves in a unit of area, over all heights,
//! is integrated once numerically. The period is then chosen so that length times bead area is the
//! density asked for. Source of the surface: `Schoen1970`. Lengths are in mm, phases in radians.
//! Cost: linear in the length of the waves.

use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

use grainpath_core::math::{asin, atan2, cos, sin, sin_cos};
use grainpath_core::poly::LineClipper;
use grainpath_core::{Bounds2, DVec2, Polygon, Region, Toolpath};

use super::{FillContext, Infill};

/// Slices of `sin x cos y + sin y cos z + sin z cos x = 0`.
pub struct Gyroid;

/// Points of a wave in one period. Source: derived: on a sine of unit amplitude a chord over 2 pi /
/// 24 is off by (2 pi / 24)^2 / 8 = 0.0086 of the length unit, which is 8 um at a density of 20 %
/// and beads of 0.45 mm.
const POINTS: usize = 24;

impl Infill for Gyroid {
    fn fill(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
        let Some(bounds) = infill_region.bounds() else { return };
        // Length per area falls as 1 / unit, so the unit of the phase is a bead's spacing times the
        // length density, over the density asked for.
        let unit_mm = context.spacing_mm() * length_density() / context.density.fraction();
        let clipper = LineClipper::new(&Region::from(infill_region.clone()));
        let z = context.z_mid_mm / unit_mm;
        for wave in waves(bounds.grown(0.1), unit_mm, z) {
            for piece in clipper.clip(&wave) {
                let path = Toolpath::new(piece.points, context.bead_width_mm, context.role, false);
                // A piece shorter than it is wide is a dot.
                if path.length_mm() > context.bead_width_mm {
                    out.push(path);
                }
            }
        }
    }
}

/// The curves of the section at phase `z` over the bounds: functions of x, or of y where the waves
/// run upright.
fn waves(bounds: Bounds2, unit_mm: f64, z: f64) -> Vec<Vec<DVec2>> {
    let (sz, cz) = sin_cos(z);
    let upright = sz.abs() > cz.abs();
    let (lo, hi) = (bounds.min / unit_mm, bounds.max / unit_mm);
    let (along, across) = if upright { ([lo.y, hi.y], [lo.x, hi.x]) } else { ([lo.x, hi.x], [lo.y, hi.y]) };
    let step = TAU / POINTS as f64;
    let (first, last) = ((along[0] / step).floor() as i64, (along[1] / step).ceil() as i64);
    let mut out = Vec::new();
    // Each period across holds two curves; a curve wanders by less than a period.
    let (low, high) = ((across[0] / TAU).floor() as i64 - 1, (across[1] / TAU).ceil() as i64 + 1);
    for (k, second) in (low..=high).flat_map(|k| [(k, false), (k, true)]) {
        let curve: Vec<DVec2> = (first..=last)
            .map(|i| {
                let u = i as f64 * step;
                let v = branch(u, sz, cz, upright, second) + TAU * k as f64;
                (if upright { DVec2::new(v, u) } else { DVec2::new(u, v) }) * unit_mm
            })
            .collect();
        // Every other wave runs backwards, so that the travel from the end of one to the start of
        // the next is short.
        out.push(if k.rem_euclid(2) == 0 { curve } else { curve.into_iter().rev().collect() });
    }
    out
}

/// One of the two solutions of the slice's equation for the coordinate across, given the one along.
fn branch(u: f64, sz: f64, cz: f64, upright: bool, second: bool) -> f64 {
    // a sin v + b cos v + c = 0
    let (a, b, c) = if upright { (cos(u), sz, sin(u) * cz) } else { (cz, sin(u), sz * cos(u)) };
    // Where a and b vanish together every coordinate solves the equation; the floor only keeps the
    // division finite.
    let r = (a * a + b * b).sqrt().max(1e-12);
    let angle = asin((-c / r).clamp(-1.0, 1.0));
    // The phase is kept continuous along the curve: it wanders within a half turn of where cz or sz puts it.
    let phase = if upright {
        // a = cos u changes sign along the curve, b = sz does not.
        PI / 2.0 * sz.signum() - atan2(a, b.abs()) * sz.signum()
    } else {
        let p = atan2(b, a.abs());
        if a < 0.0 { PI - p } else { p }
    };
    if second { PI - angle - phase } else { angle - phase }
}

/// Length of the curves in a unit of area, mean over all heights, in units of the phase.
fn length_density() -> f64 {
    static DENSITY: OnceLock<f64> = OnceLock::new();
    *DENSITY.get_or_init(|| {
        // Heights of the midpoint rule. Measured: with 64 heights and 256 points a period the
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
