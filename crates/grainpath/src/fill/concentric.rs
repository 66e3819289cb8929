//! Concentric infill: loops parallel to the border, from outside inwards.
//!
//! Each loop is an offset of the previous one by a step. At full density the step is the bead spacing;
//! below it the step is the bead spacing over the density. Offsets are mitred like walls. Loops follow
//! holes too, and the middle between them stays open where it is narrower than a bead. Every loop
//! starts anew; [`Continuous`](super::Continuous) joins loops into one path. Cost: one polygon offset a
//! loop.

use grainpath_core::poly::Join;
use grainpath_core::{Polygon, Region, Toolpath};

use super::{FillContext, Infill};

/// Loops at equal distances from the border inwards.
pub struct Concentric;

impl Infill for Concentric {
    fn fill(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
        loops(context, infill_region, 1, 0.0, out);
    }
}

/// Lays loops in groups of `beads` side by side. The first group lies half the distance of groups from the wall; `nearer` is the
/// share of that distance by which it lies nearer, up to a half, and from there on how much the next group does.
pub(super) fn loops(
    context: &FillContext<'_>,
    infill_region: &Polygon,
    beads: usize,
    nearer: f64,
    out: &mut Vec<Toolpath>,
) {
    let apart = context.spacing_mm();
    let step = beads as f64 * apart / context.density.fraction();
    let across = (beads - 1) as f64 * apart;
    let mut region = Region::from(infill_region.clone());
    // Below full density the first group lies half a gap away from the wall.
    let from_wall = if nearer > 0.5 { 1.5 - nearer } else { 0.5 - nearer };
    let mut inset = if context.density.is_dense() { 0.0 } else { (from_wall * step - 0.5 * across).max(0.0) };
    let mut laid = 0;
    loop {
        region = region.offset(-inset, Join::Miter(3.0));
        if region.is_empty() {
            return;
        }
        for contour in region.contours() {
            let path = Toolpath::new(contour.clone(), context.bead_width_mm, context.role, true);
            if path.length_mm() > 2.0 * context.bead_width_mm {
                out.push(path);
            }
        }
        laid += 1;
        inset = if laid % beads == 0 { step - across } else { apart };
    }
}
