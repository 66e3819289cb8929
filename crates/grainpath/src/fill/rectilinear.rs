//! Straight lines: sparse in one or several directions, and dense.

use std::f64::consts::PI;

use grainpath_core::math::{direction, rotated};
use grainpath_core::units::bead_width_mm;
use grainpath_core::{Polygon, Toolpath};

use super::hatch::{Hatch, Joints, Lines};
use super::{FillContext, Infill};

/// Parallel lines at the distance the density asks for.
pub struct Rectilinear;

/// Lines in two (grid) or three (triangles) directions, each with its share of the density.
pub struct Crossed {
    /// How many directions.
    pub directions: usize,
}

/// Lines that fill the room: the first and the last at its border, evenly spaced between, the width following the
/// spacing so that the volume is the room's.
pub struct Solid;

impl Infill for Rectilinear {
    fn fill(&self, context: &FillContext<'_>, room: &Polygon, out: &mut Vec<Toolpath>) {
        if context.density >= 0.999 {
            return Solid.fill(context, room, out);
        }
        sparse(context, room, context.angle_rad, context.spacing_mm() / context.density, out);
    }
}

impl Infill for Crossed {
    fn fill(&self, context: &FillContext<'_>, room: &Polygon, out: &mut Vec<Toolpath>) {
        if context.density >= 0.999 {
            return Solid.fill(context, room, out);
        }
        let n = self.directions as f64;
        for k in 0..self.directions {
            let angle = context.angle_rad + PI * k as f64 / n;
            sparse(context, room, angle, n * context.spacing_mm() / context.density, out);
        }
    }
}

/// Lines whose place depends only on the part, not on the room.
fn sparse(context: &FillContext<'_>, room: &Polygon, angle_rad: f64, step_mm: f64, out: &mut Vec<Toolpath>) {
    let centre = context.part.centre();
    let back = direction(-angle_rad);
    let first_mm = rotated(centre, back).y;
    let hatch = Hatch::new(room, Lines { angle_rad, first_mm, step_mm });
    let joints = Joints { longest_mm: 1.8 * step_mm, bulge_mm: 0.5 * step_mm };
    let width = context.bead_width_mm;
    out.extend(
        hatch.paths(&joints).into_iter().map(|points| Toolpath::new(points, width, context.role, false)),
    );
}

impl Infill for Solid {
    fn fill(&self, context: &FillContext<'_>, room: &Polygon, out: &mut Vec<Toolpath>) {
        let s = context.spacing_mm();
        let back = direction(-context.angle_rad);
        let rows = || room.outer.iter().map(|&p| rotated(p, back).y);
        let (low, high) =
            rows().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), y| (lo.min(y), hi.max(y)));
        if low >= high {
            return;
        }
        // The beads' strips reach half a spacing beyond the room on both sides; they share that height evenly.
        let n = ((high - low + s) / s + 0.02).floor().max(1.0);
        let step_mm = (high - low + s) / n;
        let hair = 1e-3 * s;
        let first = low + 0.5 * (step_mm - s);
        let lines = if n < 2.0 {
            Lines { angle_rad: context.angle_rad, first_mm: 0.5 * (low + high), step_mm: 2.0 * (high - low) }
        } else {
            // A line exactly on the border would be counted by one side of it only.
            let first_mm = first.max(low + hair);
            Lines {
                angle_rad: context.angle_rad,
                first_mm,
                step_mm: (step_mm * (n - 1.0) - 2.0 * hair) / (n - 1.0),
            }
        };
        let joints = Joints { longest_mm: 4.0 * step_mm, bulge_mm: 0.5 * step_mm };
        let paths = Hatch::new(room, lines).paths(&joints);
        // What is laid is what there is room for: where joints and line ends lie on each other the beads get a little
        // thinner. They are wider than their spacing, so nothing opens between them.
        let length: f64 = paths.iter().flat_map(|p| p.windows(2)).map(|w| w[0].distance(w[1])).sum();
        let area = room.area_mm2() + context.border_mm * (room.perimeter_mm() + 4.0 * context.border_mm);
        let strip_mm = (area / length.max(1e-9)).clamp(0.9 * step_mm, 1.05 * step_mm);
        let width = bead_width_mm(strip_mm, context.height_mm);
        out.extend(paths.into_iter().map(|points| Toolpath::new(points, width, context.role, false)));
    }
}
