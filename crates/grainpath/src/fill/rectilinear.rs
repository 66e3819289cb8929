//! Straight lines: sparse infill in one or several directions, and solid infill.
//!
//! Sparse lines lie on a raster of the whole part, so that islands and layers line up. Their distance is
//! the bead spacing over the density; with `n` directions it is `n` times that. Solid lines are placed for
//! each region ([`spaced`]), and their width follows the spacing, so that the volume laid equals the volume
//! of the region. Ends of neighbouring lines are joined along the border if the joint is short
//! ([`Joints`]), so a raster becomes a few zigzag paths. Wedges that solid lines leave open beside a border at a small angle
//! get single beads of varying width, and so do places without room for two solid lines beside each other.
//!
//! Units: mm, radians from +X. Cost: linear in the lines and in the edges of the region, except for sorting
//! the ends of each line.

use std::f64::consts::PI;

use grainpath_core::math::{direction, rotated};
use grainpath_core::polyline::length_mm;
use grainpath_core::units::{bead_spacing_mm, bead_width_mm};
use grainpath_core::{BeadWidth, Density, Polygon, Region, Role, Toolpath};
use grainpath_job::choices::BeadWidths;

use super::field::stripes::simplified;
use super::hatch::{Group, Hatch, Joints, Lines, Wedge};
use super::{FillContext, Infill, spaced};
use crate::wall::{MITER, shrinks_smoothly, single_beads};

/// How far acute corners of dense lines reach into the notches beside them, in steps. Measured: `docs/quality.md`; gap and
/// overlap of a star of five tips were 0.46, 0.44, 0.42 and 0.40 %, and 0.33, 0.31, 0.29 and 0.28 % with 0.4, 0.5, 0.6 and
/// 0.8 (0.62 and 0.49 % without), but the overlap of the small regions of `pinion` passes what it has without from 0.6 on.
const PAST: f64 = 0.5;

/// Width of the narrowest strips of dense lines, in steps. Source: derived. A bead of 0.45 mm in a layer of 0.2 mm covers
/// 1.1 times its strip in plan, so narrower ones would part from their neighbours.
const NARROWEST: f64 = 0.9;
/// Where beads are as narrow as they may be, corners reach into notches until this share of the area is laid. Measured: gap
/// and overlap of `tray_bottom`, whose lines are 1.3 mm long, were 0.68 and 0.66 %, 0.57 and 1.00 %, and 0.47 and 1.38 % with
/// 1.00, 1.01 and 1.02; without a limit 0.09 and 4.2 %.
const MOST_LAID: f64 = 1.02;

/// Width in steps up to which a place gets a single bead along its middle. Source: derived, as `MAX_SQUEEZE` of walls: two strips
/// may each be narrower by 15 %. Measured: of a ring with a round section of 2.4 mm, whose infill is up to 0.8 mm wide, 1.16,
/// 0.95, 0.51 and 0.32 % stay open with 0, 1.3, 1.5 and 1.7, at an overlap of 1.37, 0.75, 0.10 and -0.29 %; of `bone_lattice`
/// 1.11, 1.13, 1.11 and 1.09 %, of `pinion` 0.45, 0.45, 0.48 and 0.48 %.
const NARROW: f64 = 1.7;
/// Length of the shortest place that gets a bead of its own, in steps. Source: derived. Lines across a shorter one have two
/// turns at most.
const SHORTEST: f64 = 2.0;

/// Parallel lines at the distance the density asks for.
pub struct Rectilinear;

/// Lines in two (grid) or three (triangles) directions, each with its share of the density.
pub struct Crossed {
    /// Number of directions.
    pub directions: usize,
}

/// Lines that fill an infill region. The outermost lines lie along its borders where these are parallel to
/// the lines, and the others evenly between them. The bead width follows the spacing, so that the volume
/// laid equals the volume of the region.
pub struct Solid;

impl Infill for Rectilinear {
    fn fill(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
        match context.density {
            Density::Dense => Solid.fill(context, infill_region, out),
            Density::Sparse(fraction) => {
                sparse(context, infill_region, context.angle_rad, context.spacing_mm() / fraction, 1, out);
            }
        }
    }
}

impl Infill for Crossed {
    fn fill(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
        if context.density.is_dense() {
            return Solid.fill(context, infill_region, out);
        }
        crossed(context, infill_region, self.directions, 1, out);
    }
}

/// Lays sparse lines in this number of directions, each line with this number of beads side by side.
pub(super) fn crossed(
    context: &FillContext<'_>,
    infill_region: &Polygon,
    directions: usize,
    beads: usize,
    out: &mut Vec<Toolpath>,
) {
    let n = directions as f64;
    let step_mm = beads as f64 * n * context.spacing_mm() / context.density.fraction();
    for k in 0..directions {
        let angle = context.angle_rad + PI * k as f64 / n;
        sparse(context, infill_region, angle, step_mm, beads, out);
    }
}

/// Lays lines whose position depends only on the part, not on the region.
pub(super) fn sparse(
    context: &FillContext<'_>,
    infill_region: &Polygon,
    angle_rad: f64,
    step_mm: f64,
    beads: usize,
    out: &mut Vec<Toolpath>,
) {
    let centre = context.part.centre();
    let back = direction(-angle_rad);
    // A row passes through the middle of the part in every layer, so the rows of a direction lie on
    // each other.
    let first_mm = rotated(centre, back).y;
    let apart_mm = context.spacing_mm();
    let lines = Lines { angle_rad, first_mm, step_mm };
    let hatch = Hatch::in_groups(infill_region, lines, &Group { rows: beads, apart_mm });
    // Along a border square to the lines a joint of two rows is one step long; 1.8 steps allow borders down
    // to 34 degrees from the lines. A longer joint would lay a second bead along the wall for nothing. A
    // joint that returns to its own row may bulge half way to the next row, which in a group lies one bead
    // away.
    let bulge_mm = 0.5 * if beads > 1 { apart_mm } else { step_mm };
    let joints = Joints { longest_mm: 1.8 * step_mm, bulge_mm, past_mm: 0.0 };
    let width = context.bead_width_mm;
    out.extend(
        hatch.paths(&joints).into_iter().map(|points| Toolpath::new(points, width, context.role, false)),
    );
}

impl Infill for Solid {
    fn fill(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
        let Some(wide) = without_narrow_places(context, infill_region, out) else {
            return lines_of(context, infill_region, out);
        };
        wide.polygons.iter().for_each(|polygon| lines_of(context, polygon, out));
    }
}

/// Lays a single bead of varying width along the middle of places that have no room for two strips beside each other, and
/// returns the rest of the region; `None` where there is no such place. Short lines across a narrow place leave notches at
/// both of its sides.
fn without_narrow_places(
    context: &FillContext<'_>,
    infill_region: &Polygon,
    out: &mut Vec<Toolpath>,
) -> Option<Region> {
    if !context.fills_wedges || context.is_one_width() {
        return None;
    }
    let (spacing_mm, border_mm) = (context.spacing_mm(), context.border_mm);
    let inset_mm = 0.5 * NARROW * spacing_mm - border_mm;
    let region = Region::from(infill_region.clone());
    let core = region.offset(-inset_mm, MITER);
    if shrinks_smoothly(infill_region, &core, inset_mm) {
        return None;
    }
    let wide = core.offset(inset_mm, MITER);
    // A narrow place has two sides. Most regions have none, and this tells so before anything is cut.
    let perimeter_mm = |region: &Region| region.polygons.iter().map(Polygon::perimeter_mm).sum::<f64>();
    if perimeter_mm(&region) - perimeter_mm(&wide) < 2.0 * SHORTEST * spacing_mm {
        return None;
    }
    let mut narrow = region.offset(border_mm, MITER).difference(&wide.offset(border_mm, MITER));
    narrow.polygons.retain(|place| place.area_mm2() > SHORTEST * spacing_mm * spacing_mm);
    if narrow.is_empty() {
        return None;
    }
    single_beads(
        &narrow,
        context.bead_width_mm,
        context.min_bead_width_mm,
        context.height_mm,
        Role::GapFill,
        out,
    );
    Some(region.difference(&narrow.offset(border_mm, MITER)))
}

/// Parallel lines over a whole region, and single beads in the wedges beside them.
fn lines_of(context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
    let Some((lines, step_mm)) = spaced::lines(infill_region, context.angle_rad, context.spacing_mm()) else {
        return;
    };
    let hatch = Hatch::new(infill_region, lines);
    let laid = |past: f64| {
        let past_mm = past * step_mm;
        let joints = Joints { longest_mm: 4.0 * step_mm, bulge_mm: 0.5 * step_mm, past_mm };
        let (paths, joined) = hatch.joined_paths(&joints);
        let length: f64 = paths.iter().map(|path| length_mm(path, false)).sum();
        (paths, joined, length)
    };
    // Lines of bridges and of fibre stay straight to their ends.
    let past = if context.fills_wedges && !context.is_one_width() { PAST } else { 0.0 };
    let (mut paths, joined, mut length) = laid(past);
    let least_mm = bead_spacing_mm(context.min_bead_width_mm, context.height_mm);
    let single = |wedge: Wedge| {
        let widths: Vec<f64> =
            wedge.widths_mm.iter().map(|mm| bead_width_mm(*mm, context.height_mm)).collect();
        let (points, widths) = simplified(&wedge.points, &widths, false);
        let path = Toolpath::new(points, context.bead_width_mm, context.role, false);
        Toolpath { width: BeadWidth::PerVertex(widths), ..path }
    };
    let wedges: Vec<Toolpath> = match context.widths {
        BeadWidths::Variable if context.fills_wedges => {
            let all = hatch.wedges(&joined, step_mm, context.border_mm, least_mm);
            all.into_iter().map(single).collect()
        }
        BeadWidths::Variable | BeadWidths::Constant => Vec::new(),
    };
    // The volume laid equals the volume of the region. Joints and line ends overlap their neighbours,
    // so beads become a little narrower. No gap opens between them, because beads are wider than their
    // spacing.
    // Source: derived: a rectangle grown by b on all sides gains its perimeter times b and four
    // corners of b x b.
    let area = infill_region.area_mm2()
        + context.border_mm * (infill_region.perimeter_mm() + 4.0 * context.border_mm)
        - wedges.iter().map(|p| p.volume_mm3(context.height_mm)).sum::<f64>() / context.height_mm;
    // Beads that are narrower than their distance leave gaps, so that they cannot make up for all of a longer way.
    let longest = MOST_LAID * area / (NARROWEST * step_mm);
    if length > longest {
        let (_, _, least) = laid(0.0);
        let past = past * ((longest - least) / (length - least).max(1e-9)).clamp(0.0, 1.0);
        (paths, _, length) = laid(past);
    }
    let strip_mm = (area / length.max(1e-9)).clamp(NARROWEST * step_mm, 1.05 * step_mm);
    let width = bead_width_mm(strip_mm, context.height_mm);
    out.extend(paths.into_iter().map(|points| Toolpath::new(points, width, context.role, false)));
    out.extend(wedges);
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::tests::context;
    use super::*;

    /// A ring whose infill is 1.3 strips wide, and tapers to that from 2.5 strips: 20 mm across, turned.
    #[test]
    fn places_without_room_for_two_strips_get_one_bead() {
        let context = context(1.0, 0.8, 0.1);
        let s = context.spacing_mm();
        let circle = |radius: f64, off: f64| -> Vec<_> {
            (0..240).map(|k| radius * direction(TAU * f64::from(k) / 240.0) + off * direction(0.6)).collect()
        };
        for (strips, off, is_one) in [(1.3, 0.0, true), (1.9, 0.6 * s, false), (2.5, 0.0, false)] {
            // The region of the centrelines is half a strip smaller on either side.
            let mut inner = circle(10.0 - 0.5 * (strips - 1.0) * s, off);
            inner.reverse();
            let ring = Polygon { outer: circle(10.0 + 0.5 * (strips - 1.0) * s, 0.0), holes: vec![inner] };
            let mut paths = Vec::new();
            Solid.fill(&context, &ring, &mut paths);
            let singles = paths.iter().filter(|p| p.role == Role::GapFill).count();
            assert_eq!(singles > 0, is_one || off > 0.0, "{strips}: {singles}");
            assert!(!is_one || (paths.len() == 1 && paths[0].closed), "{strips}: {} paths", paths.len());
            let laid: f64 = paths.iter().map(|p| p.volume_mm3(context.height_mm)).sum();
            let asked = ring.area_mm2() + context.border_mm * ring.perimeter_mm();
            let share = laid / (asked * context.height_mm);
            assert!((share - 1.0).abs() < 0.02, "{strips}: {share} of the volume");
        }
    }
}
