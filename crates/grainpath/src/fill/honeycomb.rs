//! Honeycomb infill: regular hexagons, the same in every layer.
//!
//! Each path is a wave of flats and ramps; neighbouring waves lie mirrored, so that their flats lie
//! side by side as one wall two beads thick and their ramps bound the hexagons. Printed as waves
//! the pattern has no stops and no crossing:
//!
//! ```text
//!     __      __            __      __
//!    /  \__  /  \__   ...   flats two by two beside each other
//!    \__/  \_\__/  \_
//! ```
//!
//! The side of a hexagon follows from the density, counting the double walls once each. Cost:
//! linear in the waves.

use grainpath_core::math::{direction, rotated};
use grainpath_core::poly::LineClipper;
use grainpath_core::{Bounds2, DVec2, Polygon, Region, Toolpath};

use super::{FillContext, Infill};

/// Regular hexagons, the same in every layer.
pub struct Honeycomb;

impl Infill for Honeycomb {
    fn fill(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
        // Cells smaller than a bead cannot be told from solid infill.
        if !waves(context, infill_region, 1, out) {
            super::Rectilinear.fill(context, infill_region, out);
        }
    }
}

/// The middles of waves that are this number of beads wide. False, and no wave, where the sides of the
/// hexagons would be shorter than a wave is wide.
pub(super) fn waves(
    context: &FillContext<'_>,
    infill_region: &Polygon,
    beads: usize,
    out: &mut Vec<Toolpath>,
) -> bool {
    let s = beads as f64 * context.spacing_mm();
    // A wave is 4 sides long over a width of 3 sides. Waves are one rise and one spacing apart.
    let side = (4.0 / (3.0 * context.density.fraction()) - 1.0) * s * 2.0 / 3f64.sqrt();
    if side < s {
        return false;
    }
    let rise = side * 0.5 * 3f64.sqrt();
    let pitch = rise + s;
    let axis = direction(context.angle_rad);
    let back = DVec2::new(axis.x, -axis.y);
    // The raster is anchored at the part's centre, so that the hexagons of all layers lie on
    // each other.
    let centre = rotated(context.part.centre(), back);
    let local = Bounds2::around_points(infill_region.outer.iter().map(|&p| rotated(p, back) - centre));
    let Some(bounds) = local else { return true };
    let clipper = LineClipper::new(&Region::from(infill_region.clone()));
    let (low, high) = ((bounds.min.y / pitch).floor() as i64 - 1, (bounds.max.y / pitch).ceil() as i64 + 1);
    let (first, last) =
        ((bounds.min.x / (3.0 * side)).floor() as i64 - 1, (bounds.max.x / (3.0 * side)).ceil() as i64);
    for k in low..=high {
        let y = k as f64 * pitch;
        // Odd waves are mirrored, so that flats meet flats.
        let (up, down) = if k.rem_euclid(2) == 0 { (0.0, rise) } else { (rise, 0.0) };
        let mut wave = Vec::new();
        for period in first..=last {
            let x = period as f64 * 3.0 * side;
            for (dx, dy) in [(0.0, up), (side, up), (1.5 * side, down), (2.5 * side, down)] {
                wave.push(rotated(DVec2::new(x + dx, y + dy) + centre, axis));
            }
        }
        // Every other wave runs backwards: the next one then starts where this one ends.
        if k.rem_euclid(2) == 1 {
            wave.reverse();
        }
        for piece in clipper.clip(&wave) {
            out.push(Toolpath::new(piece.points, context.bead_width_mm, context.role, false));
        }
    }
    true
}
