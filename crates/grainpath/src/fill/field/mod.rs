//! Fills that follow a direction field.
//!
//! Dense fill is a *stripe pattern* (`Knoppel2015`): a phase is found over the infill region that
//! turns once for every bead across the field, and each bead runs where the phase completes a turn.
//! Even spacing is then a property of the whole region and not of the order in which lines are
//! drawn, which is what streamline seeding lacks. The steps:
//!
//! 1. [`FieldMesh`](grainpath_core::field_mesh::FieldMesh) covers the region with right triangles
//!    about one bead wide;
//! 2. [`phase`] finds the phase; where the field diverges, a bead has to end, and the phase misses
//!    a turn there;
//! 3. [`levels`] traces the lines on which the phase completes a turn;
//! 4. [`stripes`] moves the lines to the middle of the space they have, takes crowded ones out,
//!    joins ends along the
//!    border and puts single beads into what is left open;
//! 5. [`widths`] measures the space of each bead between its neighbours, which becomes its width.
//!
//! Sparse fill ([`streamlines`]) places evenly spaced streamlines (`Jobard1997`); [`seed_lines`] is
//! the published principal stress line method, kept for comparison. Lengths are in mm, phases in
//! radians; the sign of the axis carries no meaning.

mod levels;
pub(super) mod phase;
mod seed_lines;
mod streamlines;
pub(super) mod stripes;
pub(super) mod widths;

pub use seed_lines::SeedLines;

use grainpath_core::math::direction;
use grainpath_core::{DVec2, DVec3, DirectionField, Polygon, Toolpath};

use super::{FillContext, Infill};

/// Lines along the field: evenly spaced streamlines, and stripes where the fill is dense.
pub struct Streamlines;

/// Dense stripes along the field, and streamlines where the fill is sparse.
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

/// Both patterns differ in their names alone until streamlines reach full density by themselves.
fn along_field(context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
    if context.density.is_dense() {
        stripes::dense(context, infill_region, out)
    } else {
        streamlines::sparse(context, infill_region, out)
    }
}

/// The field's axis at a point of the layer.
pub fn axis_of(field: &dyn DirectionField, context: &FillContext<'_>, p: DVec2) -> DVec2 {
    direction(field.sample(DVec3::new(p.x, p.y, context.z_mid_mm)).axis_rad)
}

#[cfg(test)]
mod figures;
#[cfg(test)]
mod tests;
