//! Fills that follow a direction field.
//!
//! Dense fill is a *stripe pattern* (`Knoppel2015`): over the infill region a phase is found that makes one
//! turn for every bead across the field, and each bead runs where the phase completes a turn. So the
//! spacing is even over the whole region. With streamline seeding it would depend on the order in which
//! lines are drawn. The steps:
//!
//! 1. [`FieldMesh`](grainpath_core::field_mesh::FieldMesh) covers the region with right triangles
//!    about one bead wide;
//! 2. [`phase`](grainpath_core::phase) finds the phase; where the field diverges it has a singular point, at which a bead
//!    ends;
//! 3. [`levels`] traces the lines on which the phase completes a turn;
//! 4. [`line_ends`] lets lines begin and end where there is room for them;
//! 5. [`stripes`] moves the lines to the middle of their space, joins ends along the border and fills
//!    remaining gaps with single beads; [`refit`] takes steps 4 and 5 once more around lines that would have crossed others;
//! 6. [`widths`] measures the space of each bead between its neighbours, which decides the bead's width;
//! 7. [`voids`] finds short straight beads for corners that all these leave open.
//!
//! Where all beads are to have one width, they stay where they are ([`one_width`]). Where lines are to end before a
//! border that they meet across, [`band`] lays beads along it first, and so where a border divides dense infill.
//!
//! Down to a density of [`LEAST_STRIPES`], sparse fill takes the same steps with lines farther apart. Below
//! it, and for a field that asks for distances of its own, [`streamlines`] places evenly spaced streamlines
//! (`Jobard1997`). [`seed_lines`] is the published principal stress line method, kept for comparison.
//! Lengths are in mm, phases in radians; the sign of the axis has no meaning.

pub(crate) mod band;
pub(super) mod levels;
mod line_ends;
mod one_width;
mod own_frame;
mod refit;
pub(super) mod seed_lines;
pub(super) mod streamlines;
pub(super) mod stripes;
mod voids;
pub(super) mod widths;

pub use seed_lines::SeedLines;

use grainpath_core::math::direction;
use grainpath_core::{DVec2, DVec3, Density, DirectionField, Polygon, Toolpath};

use super::{FillContext, Infill};

/// Lines along the field, evenly spaced at any density.
pub struct Streamlines;

/// The same fill as [`Streamlines`], under the name of its dense variant.
pub struct Stripes;

impl Infill for Streamlines {
    fn fill(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
        along_field(context, infill_region, out);
    }
}

impl Infill for Stripes {
    fn fill(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
        along_field(context, infill_region, out);
    }
}

/// The least density that is filled with stripes; below it streamlines are laid. Source: derived. Below it
/// lines are more than two beads apart, so that streamlines, which end at half of their distance, do not
/// overlap. Streamlines lie closer to the field, because none has to follow its neighbours.
const LEAST_STRIPES: f64 = 0.5;

/// Whether lines of this density are streamlines, which go on from layer to layer.
pub(crate) fn is_streamlines(density: Density) -> bool {
    !density.is_dense() && density.fraction() < LEAST_STRIPES
}

/// Fills a region for both patterns, at any density from lines far apart to beads that touch.
fn along_field(context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
    let density = context.density;
    if density.is_dense() {
        stripes::dense(context, infill_region, out)
    } else if !is_streamlines(density) && !context.field_asks(infill_region) {
        stripes::spaced(context, infill_region, density.fraction(), out)
    } else {
        streamlines::sparse(context, infill_region, out)
    }
}

/// The field's axis at a point of the layer.
pub(super) fn axis_of(field: &dyn DirectionField, context: &FillContext<'_>, p: DVec2) -> DVec2 {
    direction(field.sample(DVec3::new(p.x, p.y, context.z_mid_mm)).axis_rad)
}

#[cfg(test)]
mod figures;
#[cfg(test)]
mod tests;
