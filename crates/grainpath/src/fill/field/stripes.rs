//! Dense fill along a field: evenly spaced beads whose width follows their spacing.
//!
//! Lines from the phase ([`phase`](grainpath_core::phase)) are turned into beads in four steps:
//!
//! 1. lines are clipped to the area for centrelines, and pieces too short to be worth a start are left out;
//! 2. lines are extended and move to the middle of their space. Then they begin and end where there is room for them
//!    ([`line_ends`](super::line_ends)), and every bead moves to the middle of its space, which its width then fills. Where
//!    another line ends beside it, its space changes at once, and so does its width ([`with_steps`]);
//! 3. ends that lie close together on the border are joined, so that the beads become few long paths; dense beads of varying
//!    width are joined by the narrowest bead along the border, which lies twice over less of their ends;
//! 4. each gap that stays open and is wide enough gets a single bead of varying width along its medial axis
//!    ([`single_beads`]), a wider one rings along its border first ([`rings_in`]), and a void that is as long as it is wide a
//!    short straight bead ([`voids`](super::voids)).
//!
//! Beads of one width stay where they are in step 2 ([`one_width`]).
//!
//! Names: `infill_region` is the area for centrelines. `border` is that area enlarged by half a bead, up to
//! the edge where the strips of the surrounding beads begin. `spacing` is the distance between lines, mm.
//!
//! Below full density the lines lie farther apart. Each bead then fills a share of the strip between its
//! neighbours, and all widths are fitted to the volume that the density asks for.
//!
//! Where the field runs along the border, a phase is prescribed that puts the outermost bead half a bead
//! from the border, so that it touches the walls. Method: stripe patterns (`Knoppel2015`); ends are joined
//! as in hatching. Cost: linear in the length of all beads, plus the phase. Degenerate cases: strips that are
//! too narrow for lines along the field get none, only the beads of step 4 ([`thin_places`]); where the field
//! meets the border at a right angle, beads end there and are joined by short turns, which deviate from the field.
//!
//! Tests on spirals, disks, rings and point defects check that nothing crosses, and that gap and overlap
//! stay within stated bounds.
//!
#![doc = include_str!("figures/stripes.svg")]

use std::ops::Range;

use grainpath_core::buckets::{Buckets, CellGrid, PointGrid2};
use grainpath_core::field_mesh::FieldMesh;
use grainpath_core::mask::{Mask, MaskGrid};
use grainpath_core::poly::{FillRule, Join, LineClipper, edges};
use grainpath_core::polyline::{self, resampled};
use grainpath_core::segment::{self, Meeting};
use grainpath_core::tuned::Tuned;
use grainpath_core::units::{bead_spacing_mm, bead_width_mm};
use grainpath_core::{BeadWidth, Bounds2, Contour, DVec2, DirectionField, Polygon, Region, Toolpath};

use super::levels::trace;
use super::line_ends::{ACROSS_SINE, LEAST_EXTENSION, Place, Room, extended_along_guide, fitted, trimmed};
use super::one_width;
use super::refit::{Beside, fitted_around};
use super::voids::short_beads;
use super::widths::{
    CELL_BEADS, FAR_BEADS, Line, Neighbours, Reach, STEP_BEADS, settled, smooth, with_steps,
};
use super::{axis_of, band};
use crate::fill::FillContext;
use crate::order::NearestEnds;
use crate::wall::{single_beads, widest_single_mm};
use grainpath_core::math::cross;
use grainpath_core::phase::{Diffusion, PhaseInput, drift, solve, turns};
use grainpath_job::choices::BeadWidths;

/// The narrowest bead, as a share of the nominal one. Source: `Kuipers2020` measures that a nozzle of 0.4
/// mm lays widths within a factor of about 2 of the nominal width. The range from 0.6 to 1.6 stays within that
/// factor and leaves a margin.
pub(crate) const NARROWEST: f64 = 0.6;
/// The widest bead, as a share of the nominal one. Source: `Kuipers2020`, as for the narrowest. Few beads reach it.
pub(crate) const WIDEST: f64 = 1.6;
/// Pieces of a line shorter than this are dropped, in spacings. Their start and end cost more than they fill.
/// Measured: row `fill.field.stripes.SHORTEST` of `cargo xtask bench constants`.
static SHORTEST: Tuned<f64> = Tuned::new("fill.field.stripes.SHORTEST", 2.0);
/// Two ends are joined if they lie at most this far apart, in spacings of dense infill.
/// Measured: row `fill.field.stripes.LONGEST_JOINT` of `cargo xtask bench constants`.
static LONGEST_JOINT: Tuned<f64> = Tuned::new("fill.field.stripes.LONGEST_JOINT", 2.0);
/// The space of a bead on a side where no other bead and no border is near, in spacings. Source: derived; half of the
/// widest bead.
const FREE: f64 = 0.5 * WIDEST;
/// The end of a line goes on into narrowing space down to this share of the strip of the narrowest bead. Source: derived. What
/// stays open in the tip beyond shrinks with the square of the share, and the bead overlaps its neighbours by the square of
/// what it lacks: with 0.7 half of the tip is closed for an overlap of a tenth of it.
const TIP_ROOM: f64 = 0.7;
/// Side of the grid cells with which gaps are searched, in spacings of dense infill. Source: derived. The strip
/// of the narrowest bead is about 0.55 spacings wide. A gap of that width contains the centre of a cell of
/// 0.33 wherever it lies, because the diagonal of the cell is 0.47.
const GAP_CELL: f64 = 0.33;
/// Side of the grid squares on which the phase is found, in spacings. Measured: row `fill.field.stripes.MESH` of `cargo
/// xtask bench constants`.
static MESH: Tuned<f64> = Tuned::new("fill.field.stripes.MESH", 1.0);
/// Rounds of diffusion of the phase at the narrowest width; the wider ones have twice as many.
/// Measured: row `fill.field.stripes.DIFFUSION_ROUNDS` of `cargo xtask bench constants`.
static DIFFUSION_ROUNDS: Tuned<usize> = Tuned::new("fill.field.stripes.DIFFUSION_ROUNDS", 2);
/// Factor on all widths of the diffusion.
/// Measured: row `fill.field.stripes.DIFFUSION_SCALE` of `cargo xtask bench constants`.
static DIFFUSION_SCALE: Tuned<f64> = Tuned::new("fill.field.stripes.DIFFUSION_SCALE", 1.0);
/// So many of the first steps of the diffusion are taken on squares twice as large. Source: measured over ten fields at five sizes of
/// squares: with none and half of the rounds, and with two, 0.461 and 0.449 % stay open, 0.476 and 0.473 % are laid twice, and beads lie
/// 2.527 and 2.529 degrees off. The phase of the plate of `cargo xtask bench paths` takes 35 and 17 ms.
const N_COARSE: usize = 2;
/// Each round is solved to this residual, as a share of the right side.
/// Measured: row `fill.field.stripes.PHASE_TOLERANCE` of `cargo xtask bench constants`.
static PHASE_TOLERANCE: Tuned<f64> = Tuned::new("fill.field.stripes.PHASE_TOLERANCE", 0.03);
/// The drift of the spacing is solved to this residual, as a share of the right side.
/// Measured: row `fill.field.stripes.DRIFT_TOLERANCE` of `cargo xtask bench constants`.
static DRIFT_TOLERANCE: Tuned<f64> = Tuned::new("fill.field.stripes.DRIFT_TOLERANCE", 0.01);
/// How often level lines are smoothed. Measured: row `fill.field.stripes.LEVEL_SMOOTHING` of `cargo xtask bench
/// constants`.
static LEVEL_SMOOTHING: Tuned<usize> = Tuned::new("fill.field.stripes.LEVEL_SMOOTHING", 3);
/// How often the shifts of a bead are smoothed. Measured: row `fill.field.stripes.SHIFT_SMOOTHING` of `cargo xtask
/// bench constants`.
static SHIFT_SMOOTHING: Tuned<usize> = Tuned::new("fill.field.stripes.SHIFT_SMOOTHING", 4);
/// When a line is moved to the middle of its space, the difference between the space on its left and on its right counts
/// at most this much, in spacings. Measured: row `fill.field.stripes.MOST_MOVE` of `cargo xtask bench constants`.
static MOST_MOVE: Tuned<f64> = Tuned::new("fill.field.stripes.MOST_MOVE", 0.4);
/// So much per length a line moves farther or less far sidewise when it takes the middle of its space; 0.25 is 14 degrees.
/// Source: measured as `BESIDE_END` of [`widths`](super::widths), with points at 0.2 spacings: with 0.15, 0.25 and 0.36 and
/// without a bound 1.02, 0.91, 0.89 and 0.88 % of the two charges stay open, beads lie 2.51, 2.61, 2.66 and 2.75 degrees off, and
/// those of the spiral 3.22, 3.41, 3.64 and 4.31, where lines jump to the border as soon as another ends before it.
const STEEPEST: f64 = 0.25;
/// A phase is prescribed up to this distance from the border, in spacings. Measured: row
/// `fill.field.stripes.NEAR_BORDER` of `cargo xtask bench constants`.
static NEAR_BORDER: Tuned<f64> = Tuned::new("fill.field.stripes.NEAR_BORDER", 1.2);
/// Side of the cells in which the nearest border is searched, in spacings. Source: derived. The search finds every
/// border within one side of a cell, so the side has to be at least [`NEAR_BORDER`]. A larger one changes only the
/// speed.
pub(crate) const BORDER_CELL: f64 = 1.6;
/// A phase is prescribed where the cosine of the angle between field and border is larger than this. 0.92 is 23
/// degrees. Measured: row `fill.field.stripes.PARALLEL_COS` of `cargo xtask bench constants`.
static PARALLEL_COS: Tuned<f64> = Tuned::new("fill.field.stripes.PARALLEL_COS", 0.92);
/// The weight of the prescribed phase rises from 0 at [`PARALLEL_COS`] to its full value where the cosine is larger by
/// this. With 0.92 and 0.08 it is full only where field and border are parallel. Measured: row
/// `fill.field.stripes.PARALLEL_RISE` of `cargo xtask bench constants`.
static PARALLEL_RISE: Tuned<f64> = Tuned::new("fill.field.stripes.PARALLEL_RISE", 0.08);
/// Full weight of the phase prescribed at the border; the field has a weight of 1. Measured: row
/// `fill.field.stripes.BORDER_WEIGHT` of `cargo xtask bench constants`.
static BORDER_WEIGHT: Tuned<f64> = Tuned::new("fill.field.stripes.BORDER_WEIGHT", 0.5);
/// A bead ends at the border if a place this far beyond its end is outside, in spacings. Source: derived. At a spacing
/// of 0.4 mm that is 0.02 mm, four times the accuracy to which lines are traced, and a twentieth of a bead.
pub(super) const BEYOND: f64 = 0.05;
/// Cosine of the angle between a piece of a line and the axes of all nodes around it up to which the axis on the piece itself is
/// not asked for. Source: derived. 0.97 is 14 degrees, half of the angle at which lines are cut; a field that leaves the axes
/// around it by as much within a square turns faster than a bead can.
const CLEARLY_ALONG: f64 = 0.97;
/// The border ahead of a bead's end is searched up to this multiple of half a bead, the distance of the end from the
/// border. Source: derived. A bead that meets the border at the sine [`LEAST_SINE`] has six times as far to go as one that
/// meets it at a right angle.
const REACH: f64 = 6.0;
/// An open bead of one width is extended to a border that it meets at an angle with at least this sine. 0.17 is 10 degrees.
/// Source: derived; at smaller angles the way to the border is longer than [`REACH`].
pub(super) const LEAST_SINE: f64 = 0.17;
/// The end of an open bead is flat. If its middle lay on a border that it meets at an angle, a corner would lie beyond.
/// It ends before that by this share of the length, along the bead, of that corner's way. Source: measured on a straight
/// field at 45 degrees (`cargo xtask bench jobs fields`): with 0, 0.125 and 0.25, 0.62, 0.92 and 1.24 % stay open and
/// 0.53, 0.29 and 0.13 % lie outside.
const RETREAT: f64 = 0.125;
/// How often widths are fitted to a volume. Source: derived. Widths at a bound cannot change, and the next round
/// distributes what they lack over the others. With a tenth of the beads at a bound, a thousandth of the error is left
/// after three rounds.
const FIT_ROUNDS: usize = 3;
/// The strip of a bead reaches beyond its two ends by this share of half its width. Source: derived; the strip then holds about
/// what a round end does.
const STRIP_LONGER: f64 = 0.5;
/// In a bend by an angle a the strips of both segments reach beyond it by the share tan(a / 2), at which their outer corners
/// meet, and by this at most. Source: derived; it closes a right angle. With the share 0.5 at every bend the corners of short
/// segments hid voids beside curved beads: in the flow past a hole, one of 2.0 squares of a bead got no bead.
const BEND_LONGER: f64 = 1.0;
/// A bead narrows to its joint over this share of the width that it loses. Source: measured on the radial disk (`cargo xtask bench
/// jobs fields`): with 0.15, 0.28, 0.4 and 0.5, 0.47, 0.56, 0.69 and 0.86 % stay open, 0.57, 0.90, 1.17 and 1.32 % are laid twice and
/// 0.81, 0.42, 0.14 and 0.04 % lie beyond the border. With 0.15 two charges, which have most, have 1.47 % laid twice, with 0.28 1.63 %.
const NARROWING: f64 = 0.15;
/// The smallest cells with which gaps are searched, as a share of those for the narrowest bead of `stripes`. Source: chosen.
/// Beads narrower than a quarter of that, 0.07 mm, are not laid well, and a mask of 250 x 250 mm takes 7 MB.
const FINEST_CELL: f64 = 0.25;
/// A loop in which a line crosses itself is cut off up to this length, in spacings. Source: derived. A round loop of five beads in
/// length is 1.6 across, so its bead covers all of it but a spot of 0.6. Cutting it off leaves at most two square beads unfilled. A
/// longer loop surrounds an area that needs it.
pub(crate) const SMALL_LOOP: f64 = 5.0;
/// Points nearer than this are one place, mm. Source: G-code has coordinates of three digits, and points as far apart as the
/// diagonal of a square of 0.001 mm, 0.0014 mm, can have the same ones.
const ROUNDED_MM: f64 = 1.5e-3;
/// Corners of rings in a gap, and of thin places, stay sharp. Source: as for walls, whose tips are cut off likewise.
const MITER: Join = Join::Miter(2.0);
/// Strips of up to this many beads are filled by rings and single beads where beads have one width. Source: derived. With `n`
/// beads up to one over `n + 1` of a strip stays open beside them, a quarter at three.
const ONE_WIDTH_STRIP: f64 = 3.0;
/// The window around an open cell reaches this many cells beyond it. Source: measured over ten fields at five sizes of squares: with
/// 2, 3 and 4, 0.453 % stay open with joined ends and 0.575 % with open ones; of one width 2.648 % with 2 and 2.645 % with 4. Dense
/// fill of the plate of `cargo xtask bench paths` takes 4.4 % fewer instructions with 2 than with 4.
const AROUND_GAP: usize = 2;

/// A bead shorter than it is wide is laid in a gap where it fills at least this many squares as wide as a strip. Source: chosen;
/// a void as large as half of one is what such a bead costs a start for. With 0.25 crumbs of a section get beads too, which reach
/// a quarter of a bead out of them.
const LEAST_VOID: f64 = 0.5;

/// Above this density single beads fill the gaps that remain. Source: derived. At 0.8 the free space
/// between two lines is a quarter of a bead, which is too narrow for the narrowest bead.
const CLOSED_FROM: f64 = 0.8;

/// Lays evenly spaced beads along the field over the whole infill region. They end where the field forces them to.
pub(crate) fn dense(context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
    spaced(context, infill_region, 1.0, out);
}

/// As [`dense`], with lines farther apart, so that beads fill `share` (0 to 1) of the region. Each bead fills
/// this share of the strip between its neighbours.
pub(crate) fn spaced(
    context: &FillContext<'_>,
    infill_region: &Polygon,
    share: f64,
    out: &mut Vec<Toolpath>,
) {
    let Some(field) = context.field else { return };
    let spacing = context.spacing_mm() / share;
    let infill_region = Region::from(infill_region.clone());
    let n_border = if share < 1.0 { 0 } else { context.shift.border_beads(spacing, 1) };
    if n_border > 0 {
        let axis = |p: DVec2| axis_of(field, context, p);
        let crossed = |edge| band::is_crossed(&axis, edge);
        let rest = band::laid(&infill_region, &crossed, n_border, spacing, context, out);
        let context = FillContext { shift: context.shift.without_border(), ..*context };
        rest.polygons.iter().for_each(|p| spaced(&context, p, share, out));
        return;
    }
    let border = infill_region.offset(context.border_mm, Join::Miter(2.0));
    // The mesh has to resolve the field, not single beads. The growth of the phase along an edge follows
    // from the field, so an edge may cross one or two levels.
    let cell_mm = MESH.value() * context.shift.grid_factor() * spacing;
    // The rows lie along the part, wherever it lies: a phase on another grid lays other lines.
    let Some(mesh) = FieldMesh::along(&border, cell_mm, field.rows()) else { return };
    let (levels, axes) = {
        let input = phase_input(&mesh, field, context, &border, spacing);
        let turns = turns(&mesh, &input);
        let phase = solve(&mesh, &input, &turns, &diffusion(context.widths));
        (trace(&mesh, &turns, &phase), input.axes)
    };
    // Beads that are narrowed come nearer to the border.
    let narrowest_mm = bead_spacing_mm(NARROWEST * context.bead_width_mm, context.height_mm) / share;
    let near_border = match context.widths {
        BeadWidths::Variable => {
            infill_region.offset((context.border_mm - 0.5 * narrowest_mm).max(0.0), Join::Miter(2.0))
        }
        BeadWidths::Constant => infill_region.clone(),
    };
    let singles = share > CLOSED_FROM && !context.is_one_width();
    let thin = if singles { thin_places(&border, context) } else { Region::default() };
    let near_border =
        LineClipper::new(&if thin.is_empty() { near_border } else { near_border.difference(&thin) });
    let (shortest_mm, step_mm) = (SHORTEST.value() * spacing, STEP_BEADS.value() * spacing);
    let mut lines = Vec::new();
    // Level lines have the zigzag of the triangulation. Resampling and a few rounds of smoothing remove
    // it.
    for level in levels {
        let mut points = resampled(&level.points, level.closed, step_mm);
        smooth(&mut points, level.closed, LEVEL_SMOOTHING.value());
        push_inside(&near_border, points, level.closed, shortest_mm, step_mm, &mut lines);
    }
    let axis = |p: DVec2| axis_of(field, context, p);
    // Nearly all pieces of lines run along the axes of all nodes around them, which are known.
    let cosine = |p: DVec2, along: DVec2| {
        let (nodes, shares) = mesh.around(p);
        let around = nodes.iter().zip(shares).filter(|(_, share)| *share > 0.0);
        let least = around.fold(1.0, |least: f64, (k, _)| least.min(axes[*k as usize].dot(along).abs()));
        if least >= CLEARLY_ALONG { least } else { axis(p).dot(along).abs() }
    };
    let edge = Neighbours::new(&[], &border, CELL_BEADS * spacing);
    let beside = Beside::default();
    let place = Place {
        border: &border,
        beside: &beside,
        edge: &edge,
        border_mm: context.border_mm,
        area: &near_border,
        axis: &axis,
        cosine: &cosine,
        spacing_mm: spacing,
        shortest_mm,
        longest_joint_mm: LONGEST_JOINT.value() * spacing,
    };
    let (nominal, h) = (context.bead_width_mm, context.height_mm);
    let mut apart = match context.widths {
        BeadWidths::Variable => {
            // A line begins where the lines beside it would otherwise have to be wider than the widest bead.
            let least = context.shift.room_factor() * narrowest_mm / spacing;
            let room = Room { least, tip: TIP_ROOM * least, begins: 0.5 * WIDEST, middle: true, rests: 0.0 };
            // Lines go on before they are moved, so that those beside them do not take their room. Further lines begin afterwards: where
            // they begin before as well, as much stays open over ten fields, beads lie 2.55 instead of 2.53 degrees off, and the fill
            // takes a tenth longer.
            let mut lines = extended_along_guide(lines, &place, room);
            centre(&mut lines, &border, spacing);
            // Moving lines may push points of them out of their area.
            let mut inside = Vec::with_capacity(lines.len());
            for line in lines {
                push_inside(&near_border, line.points, line.closed, shortest_mm, step_mm, &mut inside);
            }
            let lines = fitted(inside, &place, room);
            let lines = trimmed(lines, &place);
            let mut apart = filling_their_space(lines, &beside, &border, spacing);
            if !apart.freed.is_empty() {
                // Where lines were ended before others, the lines beside them have more room.
                let room = Room { rests: LEAST_EXTENSION, ..room };
                let again = |moving: Vec<Line>, beside: &Beside| {
                    let place = place.beside(beside);
                    let moving = trimmed(fitted(moving, &place, room), &place);
                    let apart = filling_their_space(moving, beside, &border, spacing);
                    (apart.lines, apart.widths)
                };
                (apart.lines, apart.widths) =
                    fitted_around(&apart.freed, (apart.lines, apart.widths), spacing, shortest_mm, again);
            }
            for width in apart.widths.iter_mut().flatten() {
                *width = bead_width_mm(share * *width, h).clamp(NARROWEST * nominal, WIDEST * nominal);
            }
            apart
        }
        BeadWidths::Constant => {
            let lines = fitted(lines, &place, one_width::ROOM);
            let widths = lines.iter().map(|l| vec![nominal; l.points.len()]).collect();
            ended_before_crossings(lines, widths, &beside, &border, spacing).without_points()
        }
    };
    let anew = || Neighbours::new(&apart.lines, &border, CELL_BEADS * spacing);
    let neighbours = apart.neighbours.take().unwrap_or_else(anew);
    let centrelines = Centrelines { lines: apart.lines, neighbours, widths: apart.widths };
    lay(centrelines, &infill_region, &border, context, share, out);
}

/// The strips in an area that beads along the field would leave open in part. Beads of any width do so where one single bead
/// fills the whole area: those across are shorter than is worth a start. Beads of one width leave a share of a bead open
/// beside them, which is a tenth or more of a strip of up to [`ONE_WIDTH_STRIP`] beads.
fn thin_places(border: &Region, context: &FillContext<'_>) -> Region {
    let half_mm = 0.5
        * match context.widths {
            BeadWidths::Variable => widest_single_mm(context.bead_width_mm, context.height_mm),
            BeadWidths::Constant => ONE_WIDTH_STRIP * context.spacing_mm(),
        };
    let core = border.offset(-half_mm, MITER);
    // Beads of any width taper into the thin ends of wider areas.
    if context.widths == BeadWidths::Variable && !core.is_empty() {
        return Region::default();
    }
    let mut thin = border.difference(&core.offset(half_mm, MITER));
    // The tips of corners that offsets round off are no strips.
    thin.polygons.retain(|p| p.area_mm2() > context.spacing_mm() * context.spacing_mm());
    thin
}

/// Lines that cross no others.
pub(super) struct Apart {
    pub lines: Vec<Line>,
    /// Widths at the points of the lines, mm.
    pub widths: Vec<Vec<f64>>,
    /// The points of lines that were ended before others that they would have crossed.
    pub freed: Vec<DVec2>,
    /// All lines, those beside them and the border, searchable, if no line was ended.
    pub neighbours: Option<Neighbours>,
}

impl Apart {
    /// Without the lines of which a single point is left.
    fn without_points(self) -> Self {
        let whole = self.lines.into_iter().zip(self.widths).filter(|(line, _)| line.points.len() > 1);
        let (lines, widths) = whole.unzip();
        Self { lines, widths, ..self }
    }
}

/// Moves every line to the middle of the space between the middles of the gaps on both sides. The widths are those of
/// that space.
///
/// All lines are moved at once, so the spaces share the region without gaps and overlaps whatever the distances between
/// the lines were. Only the smoothing, the bound [`STEEPEST`] and beads at the bounds of their width leave some of it open.
pub(super) fn filling_their_space(lines: Vec<Line>, beside: &Beside, border: &Region, spacing: f64) -> Apart {
    let (lines, steps) = with_steps(lines, &beside.lines, &beside.cuts, border, spacing);
    let neighbours = Neighbours::beside(&lines, &beside.lines, border, CELL_BEADS * spacing);
    let sides = neighbours.sides(&lines, FAR_BEADS.value() * spacing);
    let moved = |l: usize| {
        let line = &lines[l];
        let reaches = settled(&sides[l], line.closed, FREE * spacing);
        let mut shifts: Vec<f64> = reaches.iter().map(|r| to_middle(*r, spacing)).collect();
        let mut widths: Vec<f64> = reaches.iter().map(|r| r.left_mm + r.right_mm).collect();
        for values in [&mut shifts, &mut widths] {
            let n = values.len();
            if !line.closed && n > 3 {
                // At the end of a line the ray runs along the border, not across to the neighbour. So the end takes
                // the value of the next point.
                (values[0], values[n - 1]) = (values[1], values[n - 2]);
            }
            // Smoothed over the end of a line, beads would narrow before it and leave a wedge open.
            let stepped: Vec<f64> = steps[l].iter().map(|&v| values[v]).collect();
            smooth(values, line.closed, 1);
            steps[l].iter().zip(stepped).for_each(|(&v, value)| values[v] = value);
        }
        limit_slope(&mut shifts, line, STEEPEST);
        let to = |(v, &p): (usize, &DVec2)| {
            if beside.cuts.contains(p) { p } else { p + shifts[v] * line.tangent(v).perp() }
        };
        let points = line.points.iter().enumerate().map(to).collect();
        (Line { points, closed: line.closed }, widths)
    };
    let (lines, widths): (Vec<Line>, Vec<Vec<f64>>) = (0..lines.len()).map(moved).unzip();
    ended_before_crossings(lines, widths, beside, border, spacing).without_points()
}

/// Keeps the values at a line's points from changing by more than `most` times the length between them: the mean of the
/// least values above and of the greatest values below that do not.
fn limit_slope(values: &mut [f64], line: &Line, most: f64) {
    let n = values.len();
    let rounds = if line.closed { 2 * n } else { n };
    let (mut low, mut high) = (values.to_vec(), values.to_vec());
    for backwards in [false, true] {
        for k in 1..rounds {
            let [from, to] = [k - 1, k].map(|k| if backwards { n - 1 - k % n } else { k % n });
            let most = most * line.points[from].distance(line.points[to]);
            high[to] = high[to].min(high[from] + most);
            low[to] = low[to].max(low[from] - most);
        }
    }
    values.iter_mut().zip(low.iter().zip(high)).for_each(|(v, (low, high))| *v = 0.5 * (low + high));
}

/// Ends lines before others that they cross. Beside a singular point of the field, neighbours run in different directions,
/// so that lines that were extended or moved may cross there. Of two such lines that one ends which is nearer to its end; one of
/// the lines `beside`, which stay as they are, never does. Little is left of a line that is all crossings: it may have a single point.
pub(super) fn ended_before_crossings(
    mut lines: Vec<Line>,
    mut widths: Vec<Vec<f64>>,
    beside: &Beside,
    border: &Region,
    spacing: f64,
) -> Apart {
    let n_lines = lines.len();
    let neighbours = Neighbours::beside(&lines, &beside.lines, border, CELL_BEADS * spacing);
    let mut crossings = neighbours.crossings();
    let segment =
        |(l, s): (usize, usize)| lines.get(l).unwrap_or_else(|| &beside.lines[l - n_lines]).segment(s);
    // Both parts of a line that was cut touch there.
    let touch_at_a_cut = |[p, q]: [(usize, usize); 2]| {
        let ([a, b], [c, d]) = (<[DVec2; 2]>::from(segment(p)), <[DVec2; 2]>::from(segment(q)));
        [a, b].into_iter().any(|end| (end == c || end == d) && beside.cuts.contains(end))
    };
    crossings.retain(|pair| pair.iter().any(|(l, _)| *l < n_lines) && !touch_at_a_cut(*pair));
    if crossings.is_empty() {
        return Apart { lines, widths, freed: Vec::new(), neighbours: Some(neighbours) };
    }
    let mut freed = Vec::new();
    while !crossings.is_empty() {
        // The vertices that each line keeps.
        let mut kept: Vec<Option<Range<usize>>> = vec![None; lines.len()];
        for pair in &crossings {
            if pair.iter().any(|(l, _)| kept.get(*l).is_some_and(Option::is_some)) {
                continue;
            }
            // The numbers of segments between the crossing and both ends. A ring has no end, so it is opened only if it
            // crosses another ring or itself, and likewise a line that goes on beyond a cut.
            let from_ends = |(l, s): (usize, usize)| {
                let (line, last) = (&lines[l], lines[l].points.len() - 1);
                let goes_on = |end: usize| line.closed || beside.cuts.contains(line.points[end]);
                let from = |end: usize, n: usize| if goes_on(end) { usize::MAX } else { n };
                [from(0, s), from(last, line.n_segments() - 1 - s)]
            };
            // Lines come before those beside in each pair.
            let nearest = |at| from_ends(at).into_iter().min();
            let is_first = pair[1].0 >= n_lines || nearest(pair[0]) <= nearest(pair[1]);
            let (l, s) = if is_first { pair[0] } else { pair[1] };
            let n = lines[l].points.len();
            let [from_start, from_end] = from_ends((l, s));
            let at_start = if from_start == from_end { s < n / 2 } else { from_start < from_end };
            // One segment more goes, so that the bead ends beside the other and not on it.
            kept[l] = Some(if at_start { (s + 2).min(n)..n } else { 0..s.saturating_sub(1) });
        }
        for (l, kept) in kept.iter().enumerate() {
            if let Some(kept) = kept {
                freed.extend_from_slice(&lines[l].points[..kept.start]);
                freed.extend_from_slice(&lines[l].points[kept.end..]);
                lines[l].points = lines[l].points[kept.clone()].to_vec();
                lines[l].closed = false;
                widths[l] = widths[l][kept.clone()].to_vec();
            }
        }
        // What is left of shorter lines crosses where it did before.
        let left = |(l, s): (usize, usize)| match kept.get(l).and_then(Option::as_ref) {
            Some(kept) => (kept.contains(&s) && kept.contains(&(s + 1))).then(|| (l, s - kept.start)),
            None => Some((l, s)),
        };
        crossings = crossings.iter().filter_map(|pair| Some([left(pair[0])?, left(pair[1])?])).collect();
    }
    Apart { lines, widths, freed, neighbours: None }
}

/// How far to the left the middle of a space lies, mm. The bound keeps lines from changing places.
fn to_middle(r: Reach, spacing_mm: f64) -> f64 {
    let most_mm = MOST_MOVE.value() * spacing_mm;
    // Between two lines a reach is half of their distance, so the middle of the space lies half of the difference away.
    0.5 * (r.left_mm - r.right_mm).clamp(-most_mm, most_mm)
}

/// How the phase of lines for beads of these widths is diffused. Wide steps settle the pattern of the whole region, narrow ones
/// its details.
pub(super) fn diffusion(widths: BeadWidths) -> Diffusion<3> {
    match widths {
        BeadWidths::Variable => Diffusion {
            // A round on larger squares takes a quarter of the time.
            steps: [(30.0, 2), (12.5, 2), (4.0, 1)]
                .map(|(width, rounds)| (width * DIFFUSION_SCALE.value(), rounds * DIFFUSION_ROUNDS.value())),
            n_coarse: N_COARSE,
            tolerance: PHASE_TOLERANCE.value(),
        },
        BeadWidths::Constant => one_width::DIFFUSION,
    }
}

/// The input from which the phase is found, for lines `spacing` apart, mm.
pub(super) fn phase_input(
    mesh: &FieldMesh,
    field: &dyn DirectionField,
    context: &FillContext<'_>,
    border: &Region,
    spacing: f64,
) -> PhaseInput {
    let axes: Vec<DVec2> = mesh.nodes.iter().map(|&p| axis_of(field, context, p)).collect();
    let frequency = match context.widths {
        BeadWidths::Variable => {
            drift(mesh, &axes, DRIFT_TOLERANCE.value()).into_iter().map(|f| f / spacing).collect()
        }
        BeadWidths::Constant => vec![1.0 / spacing; axes.len()],
    };
    let near = NearBorder::new(border, BORDER_CELL * spacing);
    let wanted =
        mesh.nodes.iter().zip(&axes).map(|(&p, axis)| near.wanted(p, *axis, spacing, -0.5)).collect();
    let strength = vec![1.0; mesh.nodes.len()];
    PhaseInput { axes, frequency, strength, wanted }
}

/// The phase that is prescribed near the border. Where the field runs along the border, the outermost bead
/// should run along it too, half a bead away.
pub(crate) struct NearBorder {
    edges: Vec<(DVec2, DVec2)>,
    buckets: Buckets,
    /// For each cell, whether an edge passes it or one beside it.
    is_near: Vec<bool>,
}

impl NearBorder {
    /// Prepares a search for the border within `cell_mm` of a place.
    pub(crate) fn new(border: &Region, cell_mm: f64) -> Self {
        let edges: Vec<(DVec2, DVec2)> = border.contours().flat_map(|c| edges(c)).collect();
        let bounds = border.bounds().unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
        let cells = CellGrid::covering(bounds, cell_mm, 2000);
        let buckets = Buckets::of_segments(cells, edges.len(), |k| [edges[k].0, edges[k].1]);
        let mut is_near = vec![false; cells.nx * cells.ny];
        for at in cells.block([0, 0], [cells.nx - 1, cells.ny - 1]) {
            if !buckets.members(cells.index(at)).is_empty() {
                cells.neighbourhood(at, 1).for_each(|at| is_near[cells.index(at)] = true);
            }
        }
        Self { edges, buckets, is_near }
    }

    /// The phase prescribed at `p`, rad, and its weight. On the border the phase is `at_border` turns, and it
    /// grows by one turn per spacing inwards. Its sign depends on which of its two directions the axis is given in.
    pub(crate) fn wanted(&self, p: DVec2, axis: DVec2, spacing_mm: f64, at_border: f64) -> (f64, f64) {
        let cells = &self.buckets.cells;
        let cell = cells.cell_of(p);
        if !self.is_near[cells.index(cell)] {
            return (0.0, 0.0);
        }
        let mut best = (f64::INFINITY, u32::MAX);
        for &k in cells.neighbourhood(cell, 1).flat_map(|at| self.buckets.members(cells.index(at))) {
            let (a, b) = self.edges[k as usize];
            let distance = segment::distance_squared_mm2(p, a, b).sqrt();
            // Two edges may be at the same distance, for instance at a corner. Then the one with the lower
            // number counts, so that the order in the buckets has no effect.
            if distance < best.0 || (distance == best.0 && k < best.1) {
                best = (distance, k);
            }
        }
        let (distance, nearest) = best;
        if distance > NEAR_BORDER.value() * spacing_mm {
            return (0.0, 0.0);
        }
        let (a, b) = self.edges[nearest as usize];
        let d = b - a;
        // Outlines run counter-clockwise and holes clockwise: the inside is always on the left.
        let along = d.normalize_or(DVec2::X);
        let inwards = DVec2::new(-along.y, along.x);
        let depth = if inwards.dot(p - a) < 0.0 { -distance } else { distance };
        let parallel = along.dot(axis).abs();
        // The weight is full where field and border are parallel. At larger angles beads end on the border,
        // and all phases on it are equally good.
        let weight = ((parallel - PARALLEL_COS.value()) / PARALLEL_RISE.value()).clamp(0.0, 1.0);
        let normal = DVec2::new(-axis.y, axis.x);
        let sign = if normal.dot(inwards) < 0.0 { -1.0 } else { 1.0 };
        (sign * std::f64::consts::TAU * (depth / spacing_mm + at_border), BORDER_WEIGHT.value() * weight)
    }
}

/// Adds the pieces of a line that lie inside and are longer than `shortest_mm`, with points about `step_mm` apart. A ring
/// that lies inside as a whole stays closed; it needs five points.
pub(super) fn push_inside(
    clipper: &LineClipper,
    points: Vec<DVec2>,
    closed: bool,
    shortest_mm: f64,
    step_mm: f64,
    out: &mut Vec<Line>,
) {
    let mut line = points;
    if closed {
        line.extend(line.first().copied());
    }
    let mut pieces = clipper.clip(&line);
    // The clipper does not change the points of a line that lies inside as a whole, so coordinates are
    // compared exactly.
    let whole = pieces.len() == 1
        && pieces[0].points.len() == line.len()
        && pieces[0].points[0] == line[0]
        && pieces[0].points[line.len() - 1] == line[line.len() - 1];
    if closed && whole {
        line.pop();
        if line.len() > 4 {
            out.push(Line { points: line, closed: true });
        }
        return;
    }
    if closed && pieces.len() > 1 {
        // If the point where the ring begins lies inside, the first and the last piece are one.
        let joins = pieces[0].points.first() == Some(&line[0])
            && pieces[pieces.len() - 1].points.last() == Some(&line[0]);
        if joins && let Some(mut last) = pieces.pop() {
            last.points.pop();
            last.points.append(&mut pieces[0].points);
            pieces[0].points = last.points;
        }
    }
    for piece in pieces {
        let length: f64 = piece.points.windows(2).map(|w| w[0].distance(w[1])).sum();
        if length > shortest_mm {
            let points = resampled(&piece.points, false, step_mm);
            out.push(Line { points, closed: false });
        }
    }
}

/// Moves every line to the middle of its space.
fn centre(lines: &mut [Line], border: &Region, spacing_mm: f64) {
    let neighbours = Neighbours::new(lines, border, CELL_BEADS * spacing_mm);
    let sides = neighbours.sides(lines, FAR_BEADS.value() * spacing_mm);
    let moved: Vec<Vec<DVec2>> = lines
        .iter()
        .enumerate()
        .map(|(l, line)| {
            let reaches = settled(&sides[l], line.closed, FREE * spacing_mm);
            let mut shifts: Vec<f64> = reaches.into_iter().map(|r| to_middle(r, spacing_mm)).collect();
            // Neighbouring points measure to different segments of the next bead. Without smoothing, the
            // shifts would be printed as ripples.
            smooth(&mut shifts, line.closed, SHIFT_SMOOTHING.value());
            let to = |(v, &p): (usize, &DVec2)| {
                let t = line.tangent(v);
                p + shifts[v] * DVec2::new(-t.y, t.x)
            };
            let mut points: Vec<DVec2> = line.points.iter().enumerate().map(to).collect();
            smooth(&mut points, line.closed, 1);
            points
        })
        .collect();
    lines.iter_mut().zip(moved).for_each(|(line, points)| line.points = points);
}

/// The lines that beads run on.
struct Centrelines {
    lines: Vec<Line>,
    neighbours: Neighbours,
    /// Widths of the beads at the lines' points, mm.
    widths: Vec<Vec<f64>>,
}

/// Turns lines into beads, joins ends that lie close together, and fills gaps with single beads.
fn lay(
    centrelines: Centrelines,
    infill_region: &Region,
    border: &Region,
    context: &FillContext<'_>,
    share: f64,
    out: &mut Vec<Toolpath>,
) {
    let (nominal, h) = (context.bead_width_mm, context.height_mm);
    let Centrelines { lines, neighbours, widths } = centrelines;
    let mut beads = Vec::with_capacity(lines.len());
    for (line, widths) in lines.iter().zip(widths) {
        let (points, widths) = simplified(&line.points, &widths, line.closed);
        beads.push(WideBead { points, widths, closed: line.closed });
    }
    let first = out.len();
    // Beads that may be narrowed were led on beside a border that they meet at a small angle.
    let least_sine = match context.widths {
        BeadWidths::Variable => ACROSS_SINE.value(),
        BeadWidths::Constant => LEAST_SINE,
    };
    let beads = ended(beads, infill_region, &neighbours, border, context, least_sine);
    out.extend(beads.into_iter().map(|bead| Toolpath {
        width: BeadWidth::PerVertex(bead.widths),
        ..Toolpath::new(bead.points, nominal, context.role, bead.closed)
    }));
    let n_lines = out.len();
    if share > CLOSED_FROM {
        let narrowest_mm = NARROWEST * context.bead_width_mm;
        let singles = between_beads(border, &out[first..], narrowest_mm, context);
        out.extend(singles);
    }
    if share < 1.0 {
        let singles_mm3: f64 = out[n_lines..].iter().map(|p| p.volume_mm3(h)).sum();
        let wanted_mm3 = share * border.area_mm2() * h - singles_mm3;
        fit_volume(&mut out[first..n_lines], wanted_mm3, context);
    }
}

/// Widens or narrows all beads by one factor until they have this volume, within the printable widths.
pub(crate) fn fit_volume(beads: &mut [Toolpath], wanted_mm3: f64, context: &FillContext<'_>) {
    let (nominal, h) = (context.bead_width_mm, context.height_mm);
    let scaled = |w: f64, factor: f64| {
        bead_width_mm(factor * bead_spacing_mm(w, h), h).clamp(NARROWEST * nominal, WIDEST * nominal)
    };
    // Widths at a bound cannot change further, so the next round distributes what is missing over the others.
    for _ in 0..FIT_ROUNDS {
        let laid_mm3: f64 = beads.iter().map(|p| p.volume_mm3(h)).sum();
        if laid_mm3 <= 0.0 || wanted_mm3 <= 0.0 {
            return;
        }
        let factor = wanted_mm3 / laid_mm3;
        for bead in &mut *beads {
            match &mut bead.width {
                BeadWidth::Constant(w) => *w = scaled(*w, factor),
                BeadWidth::PerVertex(widths) => widths.iter_mut().for_each(|w| *w = scaled(*w, factor)),
            }
        }
    }
}

/// Beads in the gaps that `beads` leave open in an area. Gaps get single beads, at least as wide as the narrowest, whose width
/// varies along the gap; gaps too wide for one get rings along their border first ([`rings_in`]).
///
/// Where the job asks for beads of one width, gaps get the same, since what is left is narrower than such a bead. Only where
/// no bead may be narrower, as of fibre, all have the one width; a gap then gets a bead from the width on at which it closes
/// more than it lays twice.
fn between_beads(
    area: &Region,
    beads: &[Toolpath],
    narrowest_mm: f64,
    context: &FillContext<'_>,
) -> Vec<Toolpath> {
    let (nominal, h) = (context.bead_width_mm, context.height_mm);
    let one_width = context.is_one_width();
    let narrowest_mm = match context.widths {
        BeadWidths::Variable => narrowest_mm,
        BeadWidths::Constant if one_width => one_width::LEAST_GAP * nominal,
        BeadWidths::Constant => narrowest_mm.min(context.min_bead_width_mm),
    };
    // Narrower gaps need smaller cells.
    let share = (narrowest_mm / (NARROWEST * nominal)).clamp(FINEST_CELL, 1.0);
    let cell_mm = GAP_CELL * context.spacing_mm() * share;
    let strips = beads.iter().flat_map(|b| strips_of(b, h, 0.0));
    // What lies open beside flat ends is found once: beads with longer ends, and single beads, close parts of it.
    let open = Open::beside(area, strips.collect(), cell_mm);
    // For single beads, lines reach beyond their ends by about what round ends hold.
    let mut left = open.without(beads.iter().flat_map(|b| end_strips_of(b, h, STRIP_LONGER)).collect());
    let mut singles = Vec::new();
    if !one_width {
        rings_in(&mut left, narrowest_mm, context, &mut singles);
    }
    single_beads(&left, nominal, narrowest_mm, h, context.role, &mut singles);
    if one_width {
        singles.iter_mut().for_each(|single| single.width = BeadWidth::Constant(nominal));
    }
    // Where branches of a gap meet, their beads may cross; of two such beads the later one is dropped.
    let (mut laid, mut kept): (Vec<[DVec2; 2]>, _) = (Vec::new(), Vec::new());
    let least_mm2 = LEAST_VOID * context.spacing_mm() * context.spacing_mm();
    let is_worth_a_start = |p: &Toolpath| p.length_mm() > nominal || p.volume_mm3(h) > least_mm2 * h;
    for single in singles.into_iter().filter(is_worth_a_start) {
        let segments: Vec<[DVec2; 2]> =
            (0..single.n_segments()).map(|i| [single.segment(i).0, single.segment(i).1]).collect();
        if !segments.iter().any(|s| laid.iter().any(|l| segment::meeting(*s, *l) == Meeting::Cross)) {
            laid.extend(segments);
            kept.push(single);
        }
    }
    // A crumb of a section that gets no other bead gets none here: one as wide as the area reaches out of the crumb.
    if context.widths == BeadWidths::Variable && !(beads.is_empty() && kept.is_empty()) {
        // Ends are flat here: what a round end closes of a corner it takes from elsewhere, for it has the volume of a flat one.
        let open = open.without(kept.iter().flat_map(|b| strips_of(b, h, 0.0)).collect());
        kept.extend(short_beads(&open, narrowest_mm, WIDEST * nominal, context));
    }
    kept
}

/// Lays rings of whole beads along the border of gaps, where a gap has room for both sides of a ring and a single bead between
/// them, and takes their strips from the gaps. A strip in which every line along the field would be shorter than
/// [`SHORTEST`] is such a gap as a whole.
fn rings_in(gaps: &mut Region, narrowest_mm: f64, context: &FillContext<'_>, out: &mut Vec<Toolpath>) {
    let strip_mm = context.spacing_mm();
    // The single bead of a narrower gap leaves a fraction of a bead open at most.
    let least_mm = 2.0 * strip_mm + bead_spacing_mm(narrowest_mm, context.height_mm);
    loop {
        let wide = gaps.offset(-0.5 * least_mm, MITER).offset(0.5 * least_mm, MITER).intersection(gaps);
        if wide.is_empty() {
            return;
        }
        for contour in wide.offset(-0.5 * strip_mm, MITER).contours() {
            out.push(Toolpath::new(contour.clone(), context.bead_width_mm, context.role, true));
        }
        *gaps = gaps.difference(&wide).union(&wide.offset(-strip_mm, MITER));
    }
}

/// What strips leave open of an area, where it is wider than about one and a half cells.
///
/// It is found on a raster. Only around open cells are the strips subtracted exactly, because a union of all strips would cost more
/// than the rest of the fill together.
struct Open {
    grid: MaskGrid,
    /// The open cells.
    cells: Mask,
    /// The open part around those of them that are more than one cell wide.
    region: Region,
}

impl Open {
    fn beside(area: &Region, strips: Vec<[DVec2; 4]>, cell_mm: f64) -> Self {
        let bounds = area.bounds().unwrap_or(Bounds2 { min: DVec2::ZERO, max: DVec2::ZERO });
        let grid = MaskGrid::exactly(bounds, cell_mm);
        Self { grid, cells: Mask::from_region(grid, area), region: area.clone() }.narrowed_by(&strips)
    }

    /// The part that further strips leave open.
    fn without(&self, strips: Vec<[DVec2; 4]>) -> Region {
        self.narrowed_by(&strips).region
    }

    fn narrowed_by(&self, strips: &[[DVec2; 4]]) -> Self {
        let mut filled = Mask::empty(self.grid);
        strips.iter().for_each(|s| filled.add_convex(s));
        let cells = self.cells.clone().and_not(&filled);
        // A gap worth a bead is more than one cell long. Single cells lie between strips that nearly touch.
        let wide = cells.without_lone();
        if wide.is_empty() {
            return Self { cells, region: Region::default(), ..*self };
        }
        // The window extends some cells beyond the open cells, so that the narrow ends of a gap are cut out as well.
        let near = wide.grown(AROUND_GAP);
        let window = Region::from_contours(&near.contours(), FillRule::NonZero).intersection(&self.region);
        let there: Vec<Contour> =
            strips.iter().filter(|s| near.meets_convex(s)).map(|s| s.to_vec()).collect();
        let region = window.difference_by_parts(&there);
        Self { cells, region, ..*self }
    }
}

/// The area that the strips of beads fill.
#[cfg(test)]
pub(crate) fn covered(beads: &[Toolpath], height_mm: f64) -> Region {
    let strips: Vec<Contour> =
        beads.iter().flat_map(|b| strips_of(b, height_mm, STRIP_LONGER)).map(|s| s.to_vec()).collect();
    Region::from_contours(&strips, FillRule::NonZero)
}

/// The strip of every segment of a bead: four corners, counter-clockwise. It reaches beyond both ends of the bead by the share
/// `ends_longer` of half its width.
pub(super) fn strips_of(
    bead: &Toolpath,
    height_mm: f64,
    ends_longer: f64,
) -> impl Iterator<Item = [DVec2; 4]> + '_ {
    (0..bead.n_segments()).map(move |i| strip(bead, i, height_mm, ends_longer))
}

/// The first and the last of [`strips_of`] an open bead.
fn end_strips_of(bead: &Toolpath, height_mm: f64, ends_longer: f64) -> impl Iterator<Item = [DVec2; 4]> + '_ {
    let n = bead.n_segments();
    let ends = (0..n).filter(move |i| !bead.closed && (*i == 0 || i + 1 == n));
    ends.map(move |i| strip(bead, i, height_mm, ends_longer))
}

/// The strip of segment `i` of a bead.
fn strip(bead: &Toolpath, i: usize, height_mm: f64, ends_longer: f64) -> [DVec2; 4] {
    let n = bead.n_segments();
    let half = |v: usize| 0.5 * bead_spacing_mm(bead.width_at(v), height_mm);
    let along = |i: usize| {
        let (a, b, _) = bead.segment(i % n);
        (b - a).normalize_or(DVec2::X)
    };
    // How much longer than a segment its strip is at vertex `v`, so that a bend leaves no wedge open, mm.
    let longer = |v: usize| {
        if !bead.closed && !(1..n).contains(&v) {
            return ends_longer * half(v);
        }
        // The tangent of half the angle between both segments, from the sine and the cosine of the whole.
        let (before, after) = (along(v + n - 1), along(v));
        let tangent = cross(before, after).abs() / (1.0 + before.dot(after)).max(f64::MIN_POSITIVE);
        half(v) * tangent.min(BEND_LONGER)
    };
    let (a, b, _) = bead.segment(i);
    let along = along(i);
    let across = DVec2::new(-along.y, along.x);
    let (a, b) = (a - longer(i) * along, b + longer(i + 1) * along);
    let (p, q) = (across * half(i), across * half(i + 1));
    [a - p, b - q, b + q, a + p]
}

/// A bead with its widths.
pub(super) struct WideBead {
    pub points: Vec<DVec2>,
    /// Width at each point, mm.
    pub widths: Vec<f64>,
    pub closed: bool,
}

impl WideBead {
    /// Where the bead would end after losing `by_mm` along its line, at its start if `first` and else at its end: the
    /// number of vertices that stay, the new end and the width there, mm. At least half of the bead stays. A bead that loses
    /// less than nothing goes on straight.
    fn shortened_end(&self, first: bool, by_mm: f64) -> (usize, DVec2, f64) {
        let n = self.points.len();
        let vertex = |i: usize| if first { n - 1 - i } else { i };
        if by_mm < 0.0 {
            let (end, along, width_mm) = self.heading(first);
            return (n, end - by_mm * along, width_mm);
        }
        let mut left_mm = by_mm.min(0.5 * polyline::length_mm(&self.points, false));
        let mut kept = n - 1;
        loop {
            let (p, q) = (vertex(kept - 1), vertex(kept));
            let length_mm = self.points[p].distance(self.points[q]);
            if left_mm < length_mm || kept == 1 {
                let t = if length_mm > 0.0 { 1.0 - left_mm / length_mm } else { 1.0 };
                let width_mm = self.widths[p] + t * (self.widths[q] - self.widths[p]);
                return (kept, self.points[p].lerp(self.points[q], t), width_mm);
            }
            left_mm -= length_mm;
            kept -= 1;
        }
    }

    /// The end at its start if `first` and else that at its end, the direction in which the bead would go on there, and its
    /// width, mm.
    fn heading(&self, first: bool) -> (DVec2, DVec2, f64) {
        let n = self.points.len();
        let [end, before] = if first { [0, 1] } else { [n - 1, n.saturating_sub(2)] };
        let along = (self.points[end] - self.points[before]).normalize_or_zero();
        (self.points[end], along, self.widths[end])
    }

    /// Shortens the bead by `by_mm` at its end. A vertex in the place of the new end goes.
    fn shorten(&mut self, by_mm: f64) {
        let (mut kept, end, width_mm) = self.shortened_end(false, by_mm);
        if kept > 1 && self.points[kept - 1].distance(end) <= ROUNDED_MM {
            kept -= 1;
        }
        self.points.truncate(kept);
        self.widths.truncate(kept);
        self.points.push(end);
        self.widths.push(width_mm);
    }

    /// Narrows the bead at its end to `width_mm`.
    pub(super) fn narrow_end(&mut self, width_mm: f64) {
        let loses_mm = self.widths[self.widths.len() - 1] - width_mm;
        let last = self.points.len() - 1;
        if NARROWING * loses_mm > ROUNDED_MM {
            let end = self.points[last];
            self.shorten(NARROWING * loses_mm);
            self.points.push(end);
            self.widths.push(width_mm);
        } else if loses_mm > 0.0 {
            self.widths[last] = width_mm;
        }
    }

    /// The bead without loops of up to [`SMALL_LOOP`] spacings in which it crosses itself. `None` if what a loop leaves of it is
    /// shorter than a spacing. Two ends that meet in a joint may have crossed there, and a line may curl beside a defect.
    fn without_small_loops(mut self, spacing_mm: f64) -> Option<Self> {
        let n_points = self.points.len();
        polyline::cut_small_loops(&mut self.points, &mut self.widths, self.closed, SMALL_LOOP * spacing_mm);
        let is_whole = self.points.len() == n_points;
        (is_whole || polyline::length_mm(&self.points, self.closed) > spacing_mm).then_some(self)
    }

    fn reversed(mut self) -> Self {
        self.points.reverse();
        self.widths.reverse();
        self
    }
}

/// Gives beads the kind of ends that the job asks for: joined or open. Ends that stay open are extended to a border that they
/// meet at an angle with at least the sine `least_sine`, unless another bead or a joint lies in between. Where joined ends are
/// asked for, the others of fibre stay for turns that fibre can make, and those of sparse lines for the density.
pub(super) fn ended(
    beads: Vec<WideBead>,
    infill_region: &Region,
    neighbours: &Neighbours,
    border: &Region,
    context: &FillContext<'_>,
    least_sine: f64,
) -> Vec<WideBead> {
    let are_open = context.has_open_ends();
    let (beads, joints) =
        if are_open { (beads, Vec::new()) } else { joined(beads, neighbours, border, context) };
    let spacing_mm = context.spacing_mm();
    let mut beads: Vec<_> = beads.into_iter().filter_map(|b| b.without_small_loops(spacing_mm)).collect();
    let Some(bounds) = border.bounds() else { return beads };
    if !are_open && (context.is_one_width() || !context.density.is_dense()) {
        return beads;
    }
    let inside = LineClipper::new(infill_region);
    let edge = LineClipper::new(border);
    let contours: Vec<&Contour> = border.contours().collect();
    // Joints and extensions are found by their first points.
    let reach_mm = REACH * context.border_mm;
    let far_mm = reach_mm + reach_mm.max(LONGEST_JOINT.value() * context.spacing_mm());
    let mut laid = joints;
    let mut starts = PointGrid2::new(bounds, far_mm);
    laid.iter().enumerate().for_each(|(k, joint)| starts.insert(joint[0], k));
    for bead in beads.iter_mut().filter(|b| !b.closed && b.points.len() > 1) {
        for first in [true, false] {
            let found = at_border(bead, first, [&inside, &edge], &contours, context, least_sine);
            let Some((p, width)) = found else { continue };
            let end = bead.points[if first { 0 } else { bead.points.len() - 1 }];
            let meets = |(_, k): (DVec2, usize)| segment::meeting(laid[k], [end, p]) != Meeting::Apart;
            if neighbours.between(end, p, [end, end]) || starts.within(end, far_mm).any(meets) {
                continue;
            }
            starts.insert(end, laid.len());
            laid.push([end, p]);
            let at = if first { 0 } else { bead.points.len() };
            bead.points.insert(at, p);
            bead.widths.insert(at, width);
        }
    }
    beads
}

/// The point to which an open bead is extended so that it reaches the border, and its width there, mm. `None`
/// if the bead ends inside, or meets the border at an angle with a sine below `least_sine`.
fn at_border(
    bead: &WideBead,
    first: bool,
    [inside, edge]: [&LineClipper; 2],
    contours: &[&Contour],
    context: &FillContext<'_>,
    least_sine: f64,
) -> Option<(DVec2, f64)> {
    let (end, along, width) = bead.heading(first);
    // The bead ends inside if it could go on. The step is short, but longer than the rounding of clipping and
    // tracing.
    if inside.contains(end + BEYOND * context.spacing_mm() * along) {
        return None;
    }
    let (ahead_mm, d) = border_ahead(end, along, edge, contours, context)?;
    let sine = cross(along, d).abs();
    let short_mm = RETREAT * bead_spacing_mm(width, context.height_mm) * along.dot(d).abs() / sine.max(1e-9);
    let onward_mm = ahead_mm - short_mm;
    (sine >= least_sine && onward_mm > 1e-3).then(|| (end + onward_mm * along, width))
}

/// How far ahead of a bead's end the border lies, mm, and the direction of the border there; `None` where it is out of reach.
fn border_ahead(
    end: DVec2,
    along: DVec2,
    edge: &LineClipper,
    contours: &[&Contour],
    context: &FillContext<'_>,
) -> Option<(f64, DVec2)> {
    let reach_mm = REACH * context.border_mm;
    let hit = *edge.crossings(end, end + reach_mm * along).first()?;
    let contour = contours.get(hit.contour)?;
    let d = (contour[(hit.edge + 1) % contour.len()] - contour[hit.edge]).try_normalize()?;
    Some((hit.t * reach_mm, d))
}

/// Joins open beads end to end along the border. Each end is joined to the nearest free end, if it is close
/// enough and the joint stays inside the region. Returns the joints too.
///
/// Dense beads of varying width end where the narrowest bead along the border has room, and are joined by such a bead. A joint as
/// wide as the beads lay twice over a quarter of a square of each end, which on a disk of 11 mm was 1.3 % of its area.
fn joined(
    beads: Vec<WideBead>,
    neighbours: &Neighbours,
    border: &Region,
    context: &FillContext<'_>,
) -> (Vec<WideBead>, Vec<[DVec2; 2]>) {
    let spacing_mm = context.spacing_mm();
    let retreat_mm = (0.5 * spacing_mm - context.border_mm).max(0.0);
    let are_narrow = context.widths == BeadWidths::Variable && context.density.is_dense();
    let joint_mm = if are_narrow { NARROWEST * context.bead_width_mm } else { f64::INFINITY };
    let inside = LineClipper::new(border);
    let contours: Vec<&Contour> = border.contours().collect();
    let half_mm = 0.5 * bead_spacing_mm(NARROWEST * context.bead_width_mm, context.height_mm);
    let retreat_of = |bead: &WideBead, first: bool| {
        if !are_narrow {
            return retreat_mm;
        }
        let (end, along, _) = bead.heading(first);
        let ahead = border_ahead(end, along, &inside, &contours, context);
        // A bead that runs beside the border has no border ahead that its joint could lie along.
        let across = ahead.map(|(mm, d)| (mm, cross(along, d).abs())).filter(|a| a.1 >= ACROSS_SINE.value());
        across.map_or(0.0, |(mm, sine)| (half_mm / sine - mm).clamp(-0.5 * spacing_mm, 0.5 * spacing_mm))
    };
    // Pieces of two joints that meet begin within the length of both.
    let near_mm = 2.0 * (LONGEST_JOINT.value() + 1.0) * spacing_mm;
    let mut joints: Vec<[DVec2; 2]> = Vec::new();
    let ends: Vec<[DVec2; 2]> = beads.iter().map(|b| [b.points[0], b.points[b.points.len() - 1]]).collect();
    let mut index = NearestEnds::new(&ends);
    for (i, _) in beads.iter().enumerate().filter(|(_, bead)| bead.closed) {
        index.take(i);
    }
    let mut beads: Vec<Option<WideBead>> = beads.into_iter().map(Some).collect();
    let mut out = Vec::new();
    // Beads are tried in the order of the level lines. That order depends only on the mesh, so the joints of a
    // region are the same for any number of threads.
    for first in 0..beads.len() {
        let Some(mut bead) = beads[first].take_if(|_| !index.is_taken(first)) else { continue };
        index.take(first);
        // The bead is continued at its end first, then at its start.
        for _ in 0..2 {
            loop {
                let at = bead.points[bead.points.len() - 1];
                let Some((next, second)) = index.nearest(at) else { break };
                let to = ends[next][usize::from(second)];
                let Some(other) = beads[next].as_ref() else { break };
                let [own_mm, other_mm] = [retreat_of(&bead, false), retreat_of(other, !second)];
                let joint = [bead.shortened_end(false, own_mm).1, other.shortened_end(!second, other_mm).1];
                // Where ends go on to a joint, their way is a part of it.
                let way = [[at, joint[0]], joint, [joint[1], to]];
                // The straight line between the ends and the joint half a bead inside are both tested,
                // because another bead may cross either of them.
                if at.distance(to) > LONGEST_JOINT.value() * spacing_mm
                    || !inside.segment_inside(at, to)
                    || !inside.segment_inside(joint[0], joint[1])
                    || neighbours.between(at, to, [at, to])
                    || way.iter().any(|[a, b]| a != b && neighbours.between(*a, *b, [at, to]))
                    || joints.iter().any(|j| {
                        j[0].distance(at) < near_mm
                            && way.iter().any(|w| segment::meeting(*j, *w) == Meeting::Cross)
                    })
                {
                    break;
                }
                joints.extend(way);
                index.take(next);
                let Some(other) = beads[next].take() else { break };
                let mut other = if second { other } else { other.reversed() };
                // The joint lies half of its width from the border, as a bead along it would.
                bead.shorten(own_mm);
                other.shorten(other_mm);
                bead.narrow_end(joint_mm);
                other.narrow_end(joint_mm);
                let other = other.reversed();
                bead.points.extend(other.points);
                bead.widths.extend(other.widths);
            }
            bead = bead.reversed();
        }
        out.push(bead);
    }
    out.extend(beads.into_iter().flatten());
    (out, joints)
}

/// A vertex is dropped if it lies within this distance of the line without it, mm. Source: derived. A motor
/// of 200 steps a turn, each divided by 16, on a belt that runs 40 mm a turn moves in steps of 0.0125 mm. The
/// limit is less than half of a step, which a printer cannot show.
pub(crate) const SIMPLIFY_MM: f64 = 0.005;
/// How much the width at a dropped vertex may differ from the width interpolated between its neighbours, mm. Source: measured on
/// ten fields with open ends: with 0.01 mm slits of that width between beads made up a tenth of the gap (radial disk 1.13
/// and 1.02 %); G-code has 6 to 10 % more bytes. With 0.002 mm for vertices too the gap is 0.99 %, for 40 % more bytes.
const SIMPLIFY_WIDTH_MM: f64 = 0.004;

/// Drops vertices that change neither the line nor its width noticeably.
pub(crate) fn simplified(points: &[DVec2], widths: &[f64], closed: bool) -> (Vec<DVec2>, Vec<f64>) {
    polyline::simplified_with(points, widths, closed, SIMPLIFY_MM, SIMPLIFY_WIDTH_MM)
}
