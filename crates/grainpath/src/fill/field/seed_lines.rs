//! Dense fill of one bead width from seed lines and their offsets: the principal stress line method.
//!
//! Method: the S2 paper in docs/references.bib (`PrincipalStressLines`). Some streamlines of the
//! field are chosen, the seed lines, that come nowhere nearer to each other than a bead. They part
//! the infill region, and what lies between is filled with their offsets, one bead apart.
//!
//! ```text
//!    seed 2  ___________________
//!            - - - - - - - - - -     offset of seed 2
//!            - - - - - - - - - -     offset of seed 1, a bead apart
//!    seed 1  ___________________
//! ```
//!
//! The paper offsets the seed at the lower left of each part until the part is full, so a part that
//! is turned on the plate is filled in another way, and where seeds diverge the offsets leave the
//! field by as much as the seeds do. Three things are ours:
//!
//! 1. the first seed passes through the middle of the widest place, which turns with the part
//!    ([`widest_place`]);
//! 2. offsets grow from all seeds at once, a bead each round, and an offset ends where it leaves the
//!    field by more than [`FARTHEST_RAD`];
//! 3. what is then still open gets seeds and offsets again, and at last streamlines one bead apart
//!    (`Jobard1997`), so that every field is filled, point defects included.
//!
//! All beads have one width, so wherever the field diverges wedges narrower than a bead stay open;
//! [`Stripes`](super::Stripes) has none. Lengths are in mm. Cost: each bead takes one polygon offset
//! and one difference from the free area, so it grows with the number of beads times their vertices.
//! Degenerate cases: a field without an axis anywhere in the region lays nothing; a region narrower
//! than a bead has no area for centrelines and is never passed here.

use grainpath_core::poly::{Join, LineClipper, centroid, simplify_contour, simplify_line};
use grainpath_core::polyline;
use grainpath_core::streamlines::{LineSettings, Seeding, TracedLine, evenly_spaced};
use grainpath_core::tuned::Tuned;
use grainpath_core::{DVec2, Polygon, Region, Role, Toolpath};

use super::axis_of;
use super::stripes::{WideBead, ended, push_inside};
use super::widths::{Line, Neighbours, stretches_along};
use crate::fill::{FillContext, Infill};

/// Seed lines and offsets.
pub struct SeedLines;

/// Distance between seed lines where the planner places them, in beads.
/// Measured: row `fill.field.seed_lines.SEED_SPACING` of `cargo xtask bench constants`.
static SEED_SPACING: Tuned<f64> = Tuned::new("fill.field.seed_lines.SEED_SPACING", 8.0);
/// Pieces shorter than this are dropped, in beads.
/// Measured: row `fill.field.seed_lines.SHORTEST` of `cargo xtask bench constants`.
static SHORTEST: Tuned<f64> = Tuned::new("fill.field.seed_lines.SHORTEST", 2.0);
/// An offset ends where it leaves the field by more than this. Source: chosen; plans whose mean
/// angle is larger are warned of (`guide-far`).
const FARTHEST_RAD: f64 = 15.0 * std::f64::consts::PI / 180.0;
/// How often seeds far apart are laid into what is still open. Source: chosen. What two rounds leave
/// open on a radial disk is narrower than two seeds far apart.
const SEED_ROUNDS: usize = 2;
/// How far ends on the border are drawn out before a line is offset, in beads. Source: derived. An
/// offset by one bead reaches a border that the line meets at 27 degrees or more.
const DRAWN_OUT: f64 = 2.0;
/// Share of the spacing that a laid line keeps free of centrelines on either side: where lines of two
/// seeds meet, a last bead is laid if there is room for twice this.
/// Measured: row `fill.field.seed_lines.KEPT_FREE` of `cargo xtask bench constants`.
static KEPT_FREE: Tuned<f64> = Tuned::new("fill.field.seed_lines.KEPT_FREE", 0.8);
/// Accuracy of lines, mm. Source: derived. A hundredth of a usual bead.
const TOLERANCE_MM: f64 = 0.005;

impl Infill for SeedLines {
    fn fill(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
        let Some(field) = context.field else { return };
        let step = context.spacing_mm() / context.density.fraction();
        let infill_region = Region::from(infill_region.clone());
        let axis = |p: DVec2| axis_of(field, context, p);
        let mut free =
            FreeArea { infill_region: &infill_region, free: infill_region.clone(), step, axis: &axis };
        let (mut seeds, mut offsets) = (Vec::new(), Vec::new());
        // Seeds from border to border part the region as in the paper. Later ones may end inside it: they go
        // where offsets have left the field, which is where the field itself begins to diverge.
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
        // Seed lines are joined first, then the offsets between them. Each joint is refused where
        // it would cross a line laid before.
        let mut others: Vec<Line> = seeds.iter().chain(&offsets).cloned().collect();
        for (rank, lines) in [(0, &seeds), (1, &offsets)] {
            let neighbours = Neighbours::new(&others, &border, 1.5 * context.spacing_mm());
            let paths =
                ended(lines.iter().map(bead).collect(), &infill_region, &neighbours, &border, context);
            others.extend(paths.iter().map(|b| Line { points: b.points.clone(), closed: b.closed }));
            // Skins and bridges keep their role: the speed and the fan depend on it.
            let role = match context.role {
                Role::SolidFill | Role::SparseFill if rank == 0 => Role::SeedLine,
                role => role,
            };
            out.extend(paths.into_iter().map(|bead| {
                let path = Toolpath::new(bead.points, context.bead_width_mm, role, bead.closed);
                Toolpath { rank, ..path }
            }));
        }
    }
}

/// What is still open while lines are laid.
struct FreeArea<'a> {
    /// Where centrelines may lie at all.
    infill_region: &'a Region,
    /// Where further centrelines may lie: at least [`KEPT_FREE`] of the spacing from every line that is laid.
    free: Region,
    /// Distance of neighbouring lines, mm.
    step: f64,
    /// The field's axis at a point.
    axis: &'a dyn Fn(DVec2) -> DVec2,
}

impl FreeArea<'_> {
    /// Streamlines far apart, the first one through the middle of the widest place; with `whole` only
    /// those that run from border to border.
    fn seeds(&mut self, whole: bool) -> Vec<Line> {
        let spacing = SEED_SPACING.value();
        // A seed line may run on until it is one bead away from another one.
        let lines = self.traced(&[widest_place(&self.free, self.step)], spacing, 1.0 / spacing, whole);
        lines.iter().for_each(|line| self.take(line));
        lines
    }

    /// Streamlines one bead apart in all that is left.
    fn streamlines(&mut self) -> Vec<Line> {
        // Along the borders of what is left: there a line lies beside its neighbour.
        let inwards = 0.02 * self.step;
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
            whole,
        };
        let settings = LineSettings {
            tolerance_mm: TOLERANCE_MM,
            step_mm: self.step,
            // A field without an end could circle for ever: twenty times the sum of both sides is
            // far more than any line of the region.
            longest_mm: 20.0 * bounds.size().element_sum(),
        };
        let line = |l: TracedLine| Line { points: l.points, closed: l.closed };
        evenly_spaced(starts, bounds, &axis, &seeding, &settings).into_iter().map(line).collect()
    }

    /// Offsets of lines, a bead each round, until no round finds room for another.
    fn grown_from(&mut self, lines: &[Line]) -> Vec<Line> {
        let mut out = Vec::new();
        let mut front = lines.to_vec();
        while !front.is_empty() {
            let mut next = Vec::new();
            // One line at a time, in the order of the seeds: what grows towards each other meets in the middle,
            // and the result does not depend on the number of threads.
            for line in &front {
                let offsets = self.offsets(line);
                // The next line of the round has to keep clear of these.
                offsets.iter().for_each(|line| self.take(line));
                next.extend(offsets);
            }
            out.extend(next.iter().cloned());
            front = next;
        }
        out
    }

    /// What is free of the offset of a line by one bead, to both sides, as far as it follows the field.
    fn offsets(&self, line: &Line) -> Vec<Line> {
        let around = Region::around_line(&self.drawn_out(line), line.closed, self.step);
        let clipper = LineClipper::new(&self.free);
        // The line before this one blocks its own side, so a front only grows onwards. Round caps at the ends of
        // a line run across the field and are cut off below.
        let mut pieces = Vec::new();
        for contour in around.contours() {
            push_inside(&clipper, contour.clone(), true, self.step, &mut pieces);
        }
        let shortest_mm = SHORTEST.value() * self.step;
        let along = |piece| stretches_along(piece, self.axis, FARTHEST_RAD, shortest_mm);
        pieces.into_iter().flat_map(along).collect()
    }

    /// The points of a line, drawn out straight where it ends on the border of the infill region.
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
            // A hair that is longer than the rounding of clipping and tracing.
            if !self.infill_region.contains(points[n - 1] + 0.05 * self.step * along) {
                points.push(points[n - 1] + DRAWN_OUT * self.step * along);
            }
            points.reverse();
        }
        points
    }

    /// Keeps further centrelines a bead away from a line.
    fn take(&mut self, line: &Line) {
        // Drawn out as for the offset, or a sliver would stay free where a line meets the border aslant.
        let points = self.drawn_out(line);
        let taken = Region::around_line(&points, line.closed, KEPT_FREE.value() * self.step);
        self.free = self.free.difference(&taken);
    }
}

/// The middle of the widest place of a region: of what is left when the region is shrunk until, to a
/// tenth of a step, nothing is. It turns with the region.
fn widest_place(region: &Region, step: f64) -> DVec2 {
    let Some(bounds) = region.bounds() else { return DVec2::ZERO };
    let (mut low, mut high) = (0.0, 0.5 * bounds.size().min_element());
    let mut left = region.clone();
    while high - low > 0.1 * step {
        let middle = 0.5 * (low + high);
        let shrunk = region.offset(-middle, Join::Round);
        if shrunk.is_empty() {
            high = middle;
        } else {
            (low, left) = (middle, shrunk);
        }
    }
    let Some(largest) = left.polygons.iter().max_by(|a, b| a.area_mm2().total_cmp(&b.area_mm2())) else {
        return bounds.centre();
    };
    // What is left of a bar is a thin strip along its middle, whose centroid is the middle of the bar; of a ring
    // it is a ring, whose centroid lies outside of it.
    let middle = centroid(&largest.outer);
    if largest.contains(middle) {
        return middle;
    }
    let nearest = |a: &DVec2, b: &DVec2| a.distance_squared(middle).total_cmp(&b.distance_squared(middle));
    largest.outer.iter().copied().min_by(nearest).unwrap_or(middle)
}
