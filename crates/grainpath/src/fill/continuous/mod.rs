//! One path through a whole room, along the field where it can.
//!
//! The room is cut into strips two beads wide along the field ([`strips`]), these into cells ([`cells`]); a tree joins
//! cells that share an edge ([`tree`]). Around each cell runs a closed loop half a bead inside; where the tree passes
//! an edge the loops of both sides become one ([`rings`]). A loop around all the tree's cells is one path.

mod cells;
mod finish;
mod rings;
mod strips;
mod tree;

use grainpath_core::poly::{Join, perimeter_mm};
use grainpath_core::{DVec2, Polygon, Region, Toolpath};

use super::field::stripes::axis_of;
use super::{FillContext, Infill};
use cells::Taken;
use rings::Rings;
pub use tree::TreeKind;

/// One closed path, along the field wherever it can.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Continuous {
    /// How cells are joined.
    pub tree: TreeKind,
    /// Length of a cell, in its widths.
    pub aspect: f64,
    /// Whether beads widen and narrow to fill what room there is.
    pub variable: bool,
}

impl Continuous {
    /// Along the field, with beads of varying width.
    pub const DEFAULT: Self = Self { tree: TreeKind::Directed, aspect: 2.5, variable: true };
}

/// Rings shorter than this are dropped, in beads.
const SHORTEST: f64 = 6.0;

impl Infill for Continuous {
    fn fill(&self, context: &FillContext<'_>, room: &Polygon, out: &mut Vec<Toolpath>) {
        let spacing = context.spacing_mm() / context.density;
        let outlines = strips::outlines(context, room, spacing);
        let axis = |p: DVec2| match context.field {
            Some(field) => {
                let sample = field.sample(p.extend(context.z_mid_mm));
                (axis_of(field, context, p), sample.strength.max(0.02))
            }
            None => (DVec2::X, 1.0),
        };
        let outlines: Vec<Vec<DVec2>> = outlines.into_iter().filter(|o| o.len() > 2).collect();
        let rings = Rings::new(outlines, spacing);
        let mut taken = Taken::new(&rings, 0.25 * spacing);
        let cells = cells::cut(&rings, 2.0 * self.aspect * spacing, spacing, &mut taken);
        let exchanges = tree::join(&rings, &cells, self.tree, spacing, &axis, &mut taken);
        let mut joined = rings.exchanged(&exchanges);
        if joined.len() > 1 {
            let rings = Rings::new(joined, spacing);
            let exchanges = tree::join_rest(&rings, spacing);
            joined = rings.exchanged(&exchanges);
        }
        // The path first; what could not be joined to it and is more than a crumb after it.
        let length = |p: &Vec<DVec2>| perimeter_mm(p);
        joined.sort_by(|a, b| length(b).total_cmp(&length(a)));
        let kept =
            joined.iter().enumerate().filter(|(k, p)| *k == 0 || length(p) > SHORTEST * spacing).count();
        joined.truncate(kept);
        let border = Region::from(room.clone()).offset(context.border_mm, Join::Miter(3.0));
        out.extend(finish::lay(joined, room, &border, self.variable, context));
    }
}
