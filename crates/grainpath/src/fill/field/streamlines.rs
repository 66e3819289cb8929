//! Evenly spaced streamlines: sparse fill along a field, and fill for fields that ask for distances of
//! their own.
//!
//! Method: evenly spaced streamlines (`Jobard1997`). A line starts at a point that is at least the
//! separation away from all others, and follows the field in both directions. It ends where its distance to
//! another line falls below a share of the separation. So lines end where the field converges and begin
//! where it diverges. All beads have one width: the nominal width, corrected until the volume matches the
//! density.
//!
//! Limits: lines end as soon as they are too close, so a converging field gets a little less than its
//! density. The [`SEPARATION`] is less than the nominal distance to make up for it on average. At a density of
//! [`super::LEAST_STRIPES`] or more [`super::stripes`] is used instead. Cost: linear in the length of all
//! lines. The first seeds lie on the lines of the highest layer below with the same directions: a line has to stand on one.
//! Where the field changes with the height, lines seeded in each layer on its own lay anywhere between those below: in a
//! bar of 80 x 30 x 20 mm, bent upwards, 50 to 57 % of their length lay on air. A line that starts on a bead of the layer
//! below ends where no bead lies below it: in a bend of the field, lines from neighbouring seeds part, so that the far arm of
//! a line would take the place of another, over air (an angle of 45 x 40 x 20 mm, turned by 37 degrees and graded by the
//! stress: 5.4 % of the length on air without that rule, 1.2 with it). New lines begin where there is room for one, and for
//! those nothing lies below.

use grainpath_core::poly::LineClipper;
use grainpath_core::{DVec2, Polygon, Region, Toolpath};

use super::axis_of;
use super::seed_lines::{LONGEST_SIDES, TOLERANCE_MM};
use super::stripes::fit_volume;
use crate::fill::{FillContext, LinesBelow};
use grainpath_core::streamlines::{LineSettings, Seeding, evenly_spaced};
use grainpath_core::tuned::Tuned;

/// A line ends where another line is nearer than this share of the wanted distance.
/// Measured: row `fill.field.streamlines.END_SHARE` of `cargo xtask bench constants`.
static END_SHARE: Tuned<f64> = Tuned::new("fill.field.streamlines.END_SHARE", 0.55);
/// The same where the field itself asks for distances. Source: derived. Where the wanted distance grows along the
/// lines, every other line ends at this share, and the rest are then twice as far apart: from 0.71 to 1.41 of the wanted
/// distance the mean density is 1.02 of the asked one. Measured: with 0.55 a distance that grows from 1 to 3 mm over 40 mm
/// got 1.21 times its length of lines, and 1.14 with this share and the separation below.
const END_SHARE_ASKED: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Lines that end beside another are left out where they are shorter than this multiple of the separation. Lines from border
/// to border are held by walls at both ends and stay from a bead's width on: without them a rib narrower than the separation
/// had no infill at all.
/// Measured: row `fill.field.streamlines.SHORTEST_SHARE` of `cargo xtask bench constants`.
static SHORTEST_SHARE: Tuned<f64> = Tuned::new("fill.field.streamlines.SHORTEST_SHARE", 1.5);
/// A line of the layer below goes on if no other line is nearer than this share of the wanted distance. Source: measured on
/// a bar of 80 x 30 x 20 mm, bent upwards, with lines that ended up to a step before they left the beads below. At a density of
/// 0.3, shares of 0.55, 0.7, 0.8 and 0.9 left 0.02, 0.36, 0.58 and 1.01 % of the length on air, of 168, 150, 142 and 133 m of
/// lines. With a density by stress it was 0.54, 0.66, 0.94 and 0.91 %, and the worst error over a cell of 5 mm 5.2, 5.7, 4.6
/// and 5.9 % of full. Lines that end where they leave the beads leave 0.16 and 0.70 % with a share of 0.7.
const SEED_SHARE: f64 = 0.7;
/// The least distance of two lines, as a share of the nominal one. Measured: row `fill.field.streamlines.SEPARATION` of
/// `cargo xtask bench constants`.
static SEPARATION: Tuned<f64> = Tuned::new("fill.field.streamlines.SEPARATION", 0.94);
/// Lines are traced in steps of this share of their separation, and of [`STEP_MM`] at most. Measured: row
/// `fill.field.streamlines.STEP_SHARE` of `cargo xtask bench constants`.
static STEP_SHARE: Tuned<f64> = Tuned::new("fill.field.streamlines.STEP_SHARE", 0.5);
/// The longest step in which lines are traced, mm. Measured: row `fill.field.streamlines.STEP_MM` of `cargo xtask bench
/// constants`.
static STEP_MM: Tuned<f64> = Tuned::new("fill.field.streamlines.STEP_MM", 2.0);
/// Points are left out that lie this near to the line without them, mm. Source: derived. A motor of 200 steps, divided
/// by 16, on a belt of 40 mm a turn moves by 0.0125 mm.
const SIMPLIFY_MM: f64 = 0.01;

/// Lays evenly spaced lines of one bead width along the field.
pub(super) fn sparse(context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
    let shares = if context.field_asks(infill_region) {
        Shares { end: END_SHARE_ASKED, separation: 1.0 }
    } else {
        Shares { end: END_SHARE.value(), separation: SEPARATION.value() }
    };
    lay(context, infill_region, &shares, out);
}

/// Lays lines at the distances of a graded density, whose widths are fitted afterwards. They end as late as those of an even
/// density: where a line ends early, that of the next layer hangs over air.
pub(crate) fn graded(context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
    let shares = Shares { end: END_SHARE.value(), separation: SEPARATION.value() };
    lay(context, infill_region, &shares, out);
}

/// Distances of lines as shares of what is wanted.
struct Shares {
    /// A line ends where another is nearer than this.
    end: f64,
    /// Lines are laid this far apart.
    separation: f64,
}

fn lay(context: &FillContext<'_>, infill_region: &Polygon, shares: &Shares, out: &mut Vec<Toolpath>) {
    let (Some(field), Some(bounds)) = (context.field, infill_region.bounds()) else { return };
    let inside = LineClipper::new(&Region::from(infill_region.clone()));
    let axis = |p: DVec2| inside.contains(p).then(|| axis_of(field, context, p));
    // Converging lines end and leave gaps, so the mean distance is a little larger than the
    // separation.
    let separation = shares.separation * context.spacing_mm() / context.density.fraction();
    // A field may ask for distances of its own. They are at least the bead spacing, so that beads do not overlap.
    let asked = |p: DVec2| field.spacing_mm(p.extend(context.z_mid_mm));
    let own = |p: DVec2| asked(p).map_or(separation, |mm| shares.separation * mm.max(context.spacing_mm()));
    let seeding = Seeding {
        separation_mm: &own,
        end_share: shares.end,
        shortest_mm: SHORTEST_SHARE.value() * separation,
        shortest_across_mm: context.bead_width_mm,
        seed_share: SEED_SHARE,
        whole: false,
        is_held: &|p| context.is_held(p),
    };
    let settings = LineSettings {
        tolerance_mm: TOLERANCE_MM,
        step_mm: (STEP_SHARE.value() * separation).min(STEP_MM.value()),
        longest_mm: LONGEST_SIDES * bounds.size().element_sum(),
    };
    let first = out.len();
    let here = |p: &&DVec2| p.clamp(bounds.min, bounds.max) == **p;
    let below = context.below.into_iter().flat_map(LinesBelow::places).filter(here);
    let seeds: Vec<DVec2> = below.copied().chain([bounds.centre()]).collect();
    for line in evenly_spaced(&seeds, bounds, &axis, &seeding, &settings) {
        let points = grainpath_core::poly::simplify_line(&line.points, SIMPLIFY_MM);
        out.push(Toolpath::new(points, context.bead_width_mm, context.role, line.closed));
    }
    // If the field asks for distances, these decide the density, and the width is not corrected.
    if asked(bounds.centre()).is_none() {
        fit_volume(&mut out[first..], context.wanted_mm3(infill_region), context);
    }
}
