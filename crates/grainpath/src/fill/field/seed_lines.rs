//! Dense fill of one bead width from seed lines and their offsets: the principal stress line method.
//!
//! Method: the S2 paper in docs/references.bib (`PrincipalStressLines`). Some streamlines of the field are
//! chosen as seed lines; they never come nearer to each other than a bead. Seed lines divide the infill
//! region, and their offsets, one bead apart, fill the areas between them.
//!
//! ```text
//!    seed 2  ___________________
//!            - - - - - - - - - -     offset of seed 2
//!            - - - - - - - - - -     offset of seed 1, a bead apart
//!    seed 1  ___________________
//! ```
//!
//! In the paper each area is filled with offsets of the seed at its lower left. So the fill changes if the
//! part is turned on the plate, and where seeds diverge the offsets deviate from the field by as much. This
//! project changes three things:
//!
//! 1. the first seed passes through the middle of the widest place ([`widest_place`]), and all steps are taken in a frame
//!    that turns with the part ([`own_frame`](super::own_frame));
//! 2. offsets grow from all seeds at once, one bead in each round, and an offset ends where it deviates
//!    from the field by more than [`FARTHEST_RAD`];
//! 3. areas that are still open get seeds and offsets again, and finally streamlines one bead apart
//!    (`Jobard1997`), so that every field is filled, even with point defects.
//!
//! All beads have one width, so wedges narrower than a bead stay open where the field diverges;
//! [`Stripes`](super::Stripes) leaves none. Lengths are in mm. Cost: each bead takes one polygon offset and
//! one difference from the free area, so the cost grows with the number of beads times their vertices.
//! Degenerate cases: if the field has no axis anywhere in the region, nothing is laid; a region narrower
//! than a bead has no area for centrelines and does not reach this code.

use grainpath_core::poly::{Join, LineClipper, centroid, simplify_contour, simplify_line};
use grainpath_core::polyline;
use grainpath_core::streamlines::{FOUND_SHARE, LineSettings, Seeding, TracedLine, evenly_spaced};
use grainpath_core::tuned::Tuned;
use grainpath_core::{DVec2, Polygon, Region, Role, Toolpath};

use super::axis_of;
use super::own_frame::{OwnFrame, foremost};
use super::refit::Beside;
use super::stripes::{BEYOND, LEAST_SINE, WideBead, ended, ended_before_crossings, push_inside};
use super::widths::{CELL_BEADS, Line, Neighbours, stretches_along};
use crate::fill::{FillContext, Infill};

/// Fill with seed lines and their offsets.
pub struct SeedLines;

/// Distance between the seed lines that the planner places, in beads.
/// Measured: row `fill.field.seed_lines.SEED_SPACING` of `cargo xtask bench constants`.
static SEED_SPACING: Tuned<f64> = Tuned::new("fill.field.seed_lines.SEED_SPACING", 8.0);
/// Pieces shorter than this are dropped, in beads.
/// Measured: row `fill.field.seed_lines.SHORTEST` of `cargo xtask bench constants`.
static SHORTEST: Tuned<f64> = Tuned::new("fill.field.seed_lines.SHORTEST", 2.0);
/// Distance between the points of an offset, in beads. Source: chosen; an offset follows its seed, and bends by less than a
/// hundredth of a bead between two points on a circle of eight beads.
const POINTS: f64 = 0.75;
/// An offset ends where it deviates from the field by more than this. Source: chosen; a plan with a larger
/// mean deviation gets the warning `guide-far`.
const FARTHEST_RAD: f64 = 15.0 * std::f64::consts::PI / 180.0;
/// How often distant seeds are laid into the area that is still open. Source: chosen. After two rounds the
/// open places on a radial disk are narrower than the distance of two seeds.
const SEED_ROUNDS: usize = 2;
/// Before a line is offset, its ends on the border are extended by this length, in beads. Source: derived.
/// An offset by one bead then reaches the border if the line meets it at 27 degrees or more.
const DRAWN_OUT: f64 = 2.0;
/// Share of the spacing that a laid line keeps free of centrelines on either side. Where the offsets of two
/// seeds meet, a last bead is laid if there is space for twice this share.
/// Measured: row `fill.field.seed_lines.KEPT_FREE` of `cargo xtask bench constants`.
static KEPT_FREE: Tuned<f64> = Tuned::new("fill.field.seed_lines.KEPT_FREE", 0.8);
/// Accuracy of lines, mm. Source: derived. A hundredth of a usual bead.
pub(crate) const TOLERANCE_MM: f64 = 0.005;
/// No line is longer than this multiple of the sum of both sides of its region, since a line could circle for ever.
/// Source: derived. A spiral whose turns lie a bead apart in a region of 40 x 40 beads is as long; a line along a field
/// that does not turn round is shorter than both sides.
pub(crate) const LONGEST_SIDES: f64 = 20.0;
/// Streamlines that fill what is open start this far inside of it, in beads. Source: derived. That is 0.008 mm at a
/// bead of 0.4 mm, eighty times the grid that regions are rounded to.
const INWARDS: f64 = 0.02;
/// The widest place of a region is found to this share of a bead. Measured: row `fill.field.seed_lines.WIDEST_PLACE` of
/// `cargo xtask bench constants`.
static WIDEST_PLACE: Tuned<f64> = Tuned::new("fill.field.seed_lines.WIDEST_PLACE", 0.1);

/// Places are alike whose sizes, or distances from the middle, differ by less than this share. Source: chosen. What is left of
/// places that are equally wide differs by a tenth, as widths are found to [`WIDEST_PLACE`].
const ALIKE: f64 = 0.2;

impl Infill for SeedLines {
    fn fill(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
        let Some(field) = context.field else { return };
        let step = context.spacing_mm() / context.density.fraction();
        let infill_region = Region::from(infill_region.clone());
        // All steps are taken in a frame that turns with the part. Seeds, and which line is laid first, depend on the axes.
        let frame = OwnFrame::of(&infill_region, &|p| axis_of(field, context, p));
        let infill_region = frame.seen_region(&infill_region);
        let axis = |p: DVec2| frame.seen_axis(axis_of(field, context, frame.back(p)));
        let mut free =
            FreeArea { infill_region: &infill_region, free: infill_region.clone(), step, axis: &axis };
        let (mut seeds, mut offsets) = (Vec::new(), Vec::new());
        // The first seeds run from border to border and divide the region as in the paper. Later ones may
        // end inside it: they lie where offsets have left the field, which is where the field itself begins
        // to diverge.
        let mut more = free.seeds(true);
        for round in 0..=SEED_ROUNDS {
            offsets.extend(free.grown_from(&more));
            seeds.append(&mut more);
            more = if round < SEED_ROUNDS { free.seeds(false) } else { free.streamlines() };
        }
        offsets.extend(free.grown_from(&more));
        seeds.append(&mut more);
        let border = infill_region.offset(context.border_mm, Join::Miter(2.0));
        let bead = |l: &Line| {
            let points = simplify_line(&l.points, TOLERANCE_MM);
            WideBead { widths: vec![context.bead_width_mm; points.len()], points, closed: l.closed }
        };
        // A line may turn into itself at a point defect.
        let n_seeds = seeds.len();
        seeds.append(&mut offsets);
        let widths = seeds.iter().map(|l| vec![context.bead_width_mm; l.points.len()]).collect();
        let spacing_mm = context.spacing_mm();
        let mut seeds = ended_before_crossings(seeds, widths, &Beside::default(), &border, spacing_mm).lines;
        let mut offsets = seeds.split_off(n_seeds);
        for lines in [&mut seeds, &mut offsets] {
            lines.retain(|line| line.points.len() > 1);
        }
        // Seed lines are joined first, then the offsets between them. No joint may cross a line that was
        // laid before.
        let mut others: Vec<Line> = seeds.iter().chain(&offsets).cloned().collect();
        for (rank, lines) in [(0, &seeds), (1, &offsets)] {
            let neighbours = Neighbours::new(&others, &border, CELL_BEADS * context.spacing_mm());
            let paths = ended(
                lines.iter().map(bead).collect(),
                &infill_region,
                &neighbours,
                &border,
                context,
                LEAST_SINE,
            );
            others.extend(paths.iter().map(|b| Line { points: b.points.clone(), closed: b.closed }));
            // Skins and bridges keep their role: the speed and the fan depend on it.
            let role = match context.role {
                Role::SolidFill | Role::SparseFill if rank == 0 => Role::SeedLine,
                role => role,
            };
            out.extend(paths.into_iter().map(|bead| {
                let points = bead.points.into_iter().map(|p| frame.back(p)).collect();
                let path = Toolpath::new(points, context.bead_width_mm, role, bead.closed);
                Toolpath { rank, ..path }
            }));
        }
    }
}

/// The area that is still open while lines are laid.
struct FreeArea<'a> {
    /// The area in which centrelines may lie at all.
    infill_region: &'a Region,
    /// The area for further centrelines: at least [`KEPT_FREE`] of the spacing from every line laid so far.
    free: Region,
    /// Distance between neighbouring lines, mm.
    step: f64,
    /// The field's axis at a point.
    axis: &'a dyn Fn(DVec2) -> DVec2,
}

impl FreeArea<'_> {
    /// Distant streamlines, the first one through the middle of the widest place. With `whole` only
    /// streamlines from border to border are laid.
    fn seeds(&mut self, whole: bool) -> Vec<Line> {
        let spacing = SEED_SPACING.value();
        // A seed line continues until it is one bead away from another one.
        let lines = self.traced(&[widest_place(&self.free, self.step)], spacing, 1.0 / spacing, whole);
        lines.iter().for_each(|line| self.take(line));
        lines
    }

    /// Streamlines one bead apart in the whole area that is still open.
    fn streamlines(&mut self) -> Vec<Line> {
        // They start along the borders of the open area, where each lies beside a line already laid.
        let inwards = INWARDS * self.step;
        let starts: Vec<DVec2> = self
            .free
            .offset(-inwards, Join::Miter(2.0))
            .contours()
            .flat_map(|c| polyline::resampled(c, true, self.step))
            .collect();
        let lines = self.traced(&starts, 1.0, KEPT_FREE.value(), false);
        lines.iter().for_each(|line| self.take(line));
        lines
    }

    /// Streamlines of the free area, `beads` apart.
    fn traced(&self, starts: &[DVec2], beads: f64, end_share: f64, whole: bool) -> Vec<Line> {
        let Some(bounds) = self.free.bounds() else { return Vec::new() };
        let inside = LineClipper::new(&self.free);
        let axis = |p: DVec2| inside.contains(p).then(|| (self.axis)(p));
        let seeding = Seeding {
            separation_mm: &|_| beads * self.step,
            end_share,
            shortest_mm: SHORTEST.value() * self.step,
            shortest_across_mm: SHORTEST.value() * self.step,
            seed_share: FOUND_SHARE,
            whole,
            is_held: &|_| true,
        };
        let settings = LineSettings {
            tolerance_mm: TOLERANCE_MM,
            step_mm: self.step,
            // A line could circle for ever.
            longest_mm: LONGEST_SIDES * bounds.size().element_sum(),
        };
        let line = |l: TracedLine| Line { points: l.points, closed: l.closed };
        evenly_spaced(starts, bounds, &axis, &seeding, &settings).into_iter().map(line).collect()
    }

    /// Offsets of lines, one bead farther in each round, until no more offset fits.
    fn grown_from(&mut self, lines: &[Line]) -> Vec<Line> {
        let mut out = Vec::new();
        let mut front = lines.to_vec();
        while !front.is_empty() {
            let mut next = Vec::new();
            // Lines are offset one by one in the order of the seeds. So lines that grow towards each other
            // meet in the middle, and the result does not depend on the number of threads.
            for line in &front {
                let offsets = self.offsets(line);
                // The next line of the round has to keep clear of these offsets.
                offsets.iter().for_each(|line| self.take(line));
                next.extend(offsets);
            }
            out.extend(next.iter().cloned());
            front = next;
        }
        out
    }

    /// The offset of a line by one bead to both sides, where its place is free and it follows the field.
    fn offsets(&self, line: &Line) -> Vec<Line> {
        let around = Region::around_line(&self.drawn_out(line), line.closed, self.step);
        let clipper = LineClipper::new(&self.free);
        // The place of the previous line is taken, so offsets only grow away from the seed. Round caps at
        // the ends of a line run across the field and are cut off below.
        let mut pieces = Vec::new();
        let shortest_mm = SHORTEST.value() * self.step;
        for contour in around.contours() {
            push_inside(&clipper, contour.clone(), true, shortest_mm, POINTS * self.step, &mut pieces);
        }
        let along = |piece| {
            stretches_along(piece, &|p, along| (self.axis)(p).dot(along).abs(), FARTHEST_RAD, shortest_mm)
        };
        pieces.into_iter().flat_map(along).collect()
    }

    /// The points of a line, extended straight on where it ends on the border of the infill region.
    fn drawn_out(&self, line: &Line) -> Vec<DVec2> {
        if line.closed {
            return simplify_contour(&line.points, TOLERANCE_MM);
        }
        let mut points = simplify_line(&line.points, TOLERANCE_MM);
        if points.len() < 2 {
            return points;
        }
        for _ in 0..2 {
            let n = points.len();
            let along = (points[n - 1] - points[n - 2]).normalize_or(DVec2::ZERO);
            // A short distance, but longer than the rounding of clipping and tracing.
            if !self.infill_region.contains(points[n - 1] + BEYOND * self.step * along) {
                points.push(points[n - 1] + DRAWN_OUT * self.step * along);
            }
            points.reverse();
        }
        points
    }

    /// Removes the surroundings of a line from the area for further centrelines.
    fn take(&mut self, line: &Line) {
        // The line is extended as for the offset; otherwise a sliver would stay free where it meets the
        // border aslant.
        let points = self.drawn_out(line);
        let taken = Region::around_line(&points, line.closed, KEPT_FREE.value() * self.step);
        self.free = self.free.difference(&taken);
    }
}

/// The middle of the widest place of a region, which is the last part to remain when the region is shrunk.
/// The amount of shrinking is found to [`WIDEST_PLACE`]. If the region is turned, the place turns with it.
fn widest_place(region: &Region, step: f64) -> DVec2 {
    let Some(bounds) = region.bounds() else { return DVec2::ZERO };
    let (mut low, mut high) = (0.0, 0.5 * bounds.size().min_element());
    let mut left = region.clone();
    while high - low > WIDEST_PLACE.value() * step {
        let middle = 0.5 * (low + high);
        let shrunk = region.offset(-middle, Join::Round);
        if shrunk.is_empty() {
            high = middle;
        } else {
            (low, left) = (middle, shrunk);
        }
    }
    // Of equally wide places, as the corners of a square, the most forward one is taken. Their order is by chance.
    let most_mm2 = left.polygons.iter().map(Polygon::area_mm2).fold(0.0, f64::max);
    let alike = left.polygons.iter().filter(|p| p.area_mm2() >= (1.0 - ALIKE) * most_mm2);
    foremost(alike.map(middle_of)).unwrap_or_else(|| bounds.centre())
}

/// The centroid of a polygon, or the place in it that is nearest to the centroid.
fn middle_of(polygon: &Polygon) -> DVec2 {
    // A bar shrinks to a thin strip along its middle, whose centroid is the middle of the bar. A ring
    // shrinks to a thin ring, whose centroid lies outside of it.
    let middle = centroid(&polygon.outer);
    if polygon.contains(middle) {
        return middle;
    }
    let least_mm = polygon.outer.iter().map(|p| p.distance(middle)).fold(f64::INFINITY, f64::min);
    let alike = |p: &DVec2| p.distance(middle) <= (1.0 + ALIKE) * least_mm;
    foremost(polygon.outer.iter().copied().filter(alike)).unwrap_or(middle)
}
