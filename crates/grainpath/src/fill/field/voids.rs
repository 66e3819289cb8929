//! Short straight beads in the voids that lines and single beads leave open.
//!
//! Where lines meet the border at a slant, where they part before a hole, and in corners of the region, voids are triangles.
//! The chords of a triangle's medial axis are short at its tips and longer than any bead at its widest place, so a single bead
//! along it is too short to be worth a start. A straight bead along another direction still fills most of it
//! ([`straight_strip`]):
//!
//! ```text
//!    -----------------------------  border
//!     \ void |/       /
//!      \    /  bead  /
//!       \  /        /
//! ```
//!
//! Lengths are in mm. Cost: that of [`straight_strip`] for each void.

use grainpath_core::poly::{Join, centroid, straight_strip};
use grainpath_core::units::{bead_spacing_mm, bead_width_mm};
use grainpath_core::{BeadWidth, DVec2, Region, Toolpath};

use super::axis_of;
use crate::fill::FillContext;

/// Corners of voids stay sharp where slits are taken off. Source: as for rings in gaps ([`stripes`](super::stripes)).
const MITER: Join = Join::Miter(2.0);
/// Slits narrower than this tie voids together and get no bead, in spacings. Source: derived; less than a fifth of the strip of the
/// narrowest bead, which would lie twice over four fifths of itself.
const SLIT: f64 = 0.1;
/// A void gets a short straight bead from this size on, in squares as wide as a strip. Source: measured
/// on ten fields (`cargo xtask bench jobs fields`). It is half a square, less what the outside measure of a plan finds more; with
/// 0.4 no void is smaller, two charges get 8 such beads instead of 6, and a straight field 3 instead of 1.
const SHORT_VOID: f64 = 0.48;
/// A short straight bead closes at least this much more of a void than it lays outside of it, in squares as wide as a strip.
/// Source: measured on ten fields; with 0.2, a void of 0.56 squares stays open on the spiral, where 0.35 do with 0.1.
const LEAST_GAIN: f64 = 0.1;

/// Short straight beads in what stays open beside ends of lines and where single beads along a medial axis are too short.
///
/// Beads are from `narrowest_mm` to `widest_mm` wide, and no narrower than the job allows.
pub(super) fn short_beads(
    open: &Region,
    narrowest_mm: f64,
    widest_mm: f64,
    context: &FillContext<'_>,
) -> Vec<Toolpath> {
    let (nominal, h) = (context.bead_width_mm, context.height_mm);
    let strips_mm = [narrowest_mm.max(context.min_bead_width_mm), widest_mm].map(|mm| bead_spacing_mm(mm, h));
    if strips_mm[0] > strips_mm[1] {
        return Vec::new();
    }
    let square_mm2 = context.spacing_mm() * context.spacing_mm();
    let half_slit_mm = 0.5 * SLIT * context.spacing_mm();
    let mut out = Vec::new();
    for void in &open.polygons {
        let mut open_mm2 = void.area_mm2();
        if open_mm2 < SHORT_VOID * square_mm2 {
            continue;
        }
        // The largest piece comes first: what it closes may leave the rest too small for a bead.
        let mut pieces =
            Region::from(void.clone()).offset(-half_slit_mm, MITER).offset(half_slit_mm, MITER).polygons;
        pieces.sort_by(|a, b| b.area_mm2().total_cmp(&a.area_mm2()));
        for piece in pieces {
            if open_mm2 < SHORT_VOID * square_mm2 {
                break;
            }
            let axis =
                context.field.map_or(DVec2::ZERO, |field| axis_of(field, context, centroid(&piece.outer)));
            let bead = straight_strip(&piece, axis, strips_mm);
            let Some(bead) = bead.filter(|b| b.gain_mm2 > LEAST_GAIN * square_mm2) else { continue };
            open_mm2 -= bead.gain_mm2;
            let widths = bead.widths_mm.map(|mm| bead_width_mm(mm, h)).to_vec();
            out.push(Toolpath {
                width: BeadWidth::PerVertex(widths),
                ..Toolpath::new(bead.ends.to_vec(), nominal, context.role, false)
            });
        }
    }
    out
}
