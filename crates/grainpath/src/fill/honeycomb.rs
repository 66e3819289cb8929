//! Honeycomb infill: regular hexagons, the same in every layer.
//!
//! Each path is a wave of flats and ramps. Neighbouring waves are mirrored, so that their flats lie side by
//! side as a wall two beads thick and their ramps bound the hexagons. Printed as waves, the pattern has no
//! crossings and no stops within a wave:
//!
//! ```text
//!     __      __            __      __
//!    /  \__  /  \__   ...   flats two by two beside each other
//!    \__/  \_\__/  \_
//! ```
//!
//! The side of a hexagon follows from the density; of a double wall each bead counts once. Cost: linear in
//! the waves.

use grainpath_core::math::{direction, rotated};
use grainpath_core::poly::LineClipper;
use grainpath_core::{Bounds2, DVec2, Polygon, Region, Toolpath};

use super::{FillContext, Infill};

/// Regular hexagons, the same in every layer.
pub struct Honeycomb;

impl Infill for Honeycomb {
    fn fill(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
        // Cells smaller than a bead would be the same as solid infill, so lines are laid.
        if !waves(context, infill_region, 1, out) {
            super::Rectilinear.fill(context, infill_region, out);
        }
    }
}

/// Lays the centrelines of waves that are this number of beads wide. Returns false, and lays nothing, if
/// the sides of the hexagons would be shorter than the width of a wave.
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
        // Every other wave is reversed, so that it starts near the end of the wave before.
        if k.rem_euclid(2) == 1 {
            wave.reverse();
        }
        for piece in clipper.clip(&wave) {
            out.push(Toolpath::new(piece.points, context.bead_width_mm, context.role, false));
        }
    }
    true
}
