//! Dense fill from seed lines and their offsets: the principal stress line method as published.
//!
//! Method: the S2 paper in docs/references.bib (`PrincipalStressLines`). Some streamlines of the
//! field are chosen that come nowhere nearer to each other than a bead. They part the infill
//! region; each part is filled with offsets of the seed line at its lower left, one bead apart,
//! until it is full.
//!
//! ```text
//!    seed 2  ___________________
//!            - - - - - - - - - -     offsets of seed 1, a bead apart
//!            - - - - - - - - - -
//!    seed 1  ___________________
//! ```
//!
//! Bead width is constant, so wherever neighbouring seeds diverge a wedge stays open, and offsets
//! drift from the field the farther they lie from their seed. [`Stripes`](super::Stripes) have
//! neither fault; this fill is kept so that the paper can be reproduced. Cost: an offset is a
//! polygon offset of its part, so it grows with the number of offsets times their length.

use grainpath_core::poly::{Join, LineClipper, simplify_line};
use grainpath_core::{DVec2, Polygon, Region, Toolpath};

use super::axis_of;
use super::stripes::{WideBead, ended};
use super::widths::{Line, Neighbours};
use crate::fill::{FillContext, Infill};
use grainpath_core::streamlines::{LineSettings, Seeding, TracedLine, evenly_spaced};
use grainpath_core::tuned::Tuned;

/// Seed lines and offsets.
pub struct SeedLines;

/// Distance between seed lines where the planner places them, in beads.
/// Measured: row `fill.field.seed_lines.SEED_SPACING` of `cargo xtask bench constants`.
static SEED_SPACING: Tuned<f64> = Tuned::new("fill.field.seed_lines.SEED_SPACING", 8.0);
/// Pieces shorter than this are dropped, in beads.
/// Measured: row `fill.field.seed_lines.SHORTEST` of `cargo xtask bench constants`.
static SHORTEST: Tuned<f64> = Tuned::new("fill.field.seed_lines.SHORTEST", 2.0);
/// Largest number of offsets of a seed line.
/// Measured: row `fill.field.seed_lines.MAX_OFFSETS` of `cargo xtask bench constants`.
static MAX_OFFSETS: Tuned<usize> = Tuned::new("fill.field.seed_lines.MAX_OFFSETS", 2000);

impl Infill for SeedLines {
    fn fill(&self, context: &FillContext<'_>, infill_region: &Polygon, out: &mut Vec<Toolpath>) {
        let (Some(field), Some(bounds)) = (context.field, infill_region.bounds()) else { return };
        let step = context.spacing_mm() / context.density.fraction();
        let infill_region = Region::from(infill_region.clone());
        let inside = LineClipper::new(&infill_region);
        let axis = |p: DVec2| inside.contains(p).then(|| axis_of(field, context, p));
        let separation = |_: DVec2| SEED_SPACING.value() * step;
        let seeding = Seeding {
            separation_mm: &separation,
            // A seed line may run on until it is one bead away from another one.
            end_share: 1.0 / SEED_SPACING.value(),
            shortest_mm: SHORTEST.value() * step,
            whole: true,
        };
        let settings = LineSettings {
            tolerance_mm: 0.005,
            step_mm: step,
            // A field without an end could circle for ever: twenty times the sum of both sides is
            // far more than any line of the region.
            longest_mm: 20.0 * bounds.size().element_sum(),
        };
        let seeds = evenly_spaced(&[bounds.centre()], bounds, &axis, &seeding, &settings);
        let border = infill_region.offset(context.border_mm, Join::Miter(2.0));
        let mut offsets = Vec::new();
        for region in parted(&infill_region, &seeds, step).polygons {
            offsets.extend(fill_region(&Region::from(region), &seeds, step));
        }
        let bead = |l: &TracedLine| {
            let points = simplify_line(&l.points, 0.005);
            WideBead { widths: vec![context.bead_width_mm; points.len()], points, closed: l.closed }
        };
        let line = |l: &TracedLine| Line { points: l.points.clone(), closed: l.closed };
        // Seed lines are joined first, then the offsets between them. Each joint is refused where
        // it would cross a line laid before.
        let mut others: Vec<Line> = seeds.iter().chain(&offsets).map(line).collect();
        for (rank, lines) in [(0, &seeds), (1, &offsets)] {
            let neighbours = Neighbours::new(&others, &border, 1.5 * context.spacing_mm());
            let paths =
                ended(lines.iter().map(bead).collect(), &infill_region, &neighbours, &border, context);
            others.extend(paths.iter().map(|b| Line { points: b.points.clone(), closed: b.closed }));
            out.extend(paths.into_iter().map(|bead| {
                let path = Toolpath::new(bead.points, context.bead_width_mm, context.role, bead.closed);
                Toolpath { rank, ..path }
            }));
        }
    }
}

/// The area within `r_mm` of a line.
fn around(line: &TracedLine, r_mm: f64) -> Region {
    Region::around_line(&simplify_line(&line.points, 0.005), line.closed, r_mm)
}

/// The area for the centrelines of offsets: the infill region less one bead around each seed line.
fn parted(infill_region: &Region, seeds: &[TracedLine], step: f64) -> Region {
    // The band is a little narrower than a bead, so that the first offset, one bead away, lies
    // inside the part and not on its border.
    let taken = seeds.iter().fold(Region::default(), |sum, l| sum.union(&around(l, 0.98 * step)));
    infill_region.difference(&taken)
}

/// Offsets in one region, from the seed line that borders it lowest and leftmost, until it is full.
fn fill_region(region: &Region, seeds: &[TracedLine], step: f64) -> Vec<TracedLine> {
    // A little wider than the band that was cut away, so that a seed touches the parts beside it.
    let touching = |l: &&TracedLine| !around(l, 1.02 * step).intersection(region).is_empty();
    let place = |l: &TracedLine| {
        let least = |a: DVec2, b: DVec2| if (a.y + a.x) <= (b.y + b.x) { a } else { b };
        l.points.iter().copied().reduce(least).unwrap_or(DVec2::ZERO)
    };
    let first = seeds.iter().filter(touching).min_by(|a, b| {
        let (a, b) = (place(a), place(b));
        (a.y + a.x).total_cmp(&(b.y + b.x))
    });
    let clipper = LineClipper::new(region);
    let mut out = Vec::new();
    let Some(seed) = first else {
        return out;
    };
    let mut rest = region.clone();
    for k in 1..=MAX_OFFSETS.value() {
        let distance = k as f64 * step;
        let band = around(seed, distance);
        for contour in band.contours() {
            // A contour is a ring, a clipped line is open: the first point is repeated so that the
            // last edge is clipped too.
            let mut ring = contour.clone();
            ring.extend(contour.first().copied());
            for piece in clipper.clip(&ring) {
                let length: f64 = piece.points.windows(2).map(|w| w[0].distance(w[1])).sum();
                if length > SHORTEST.value() * step {
                    out.push(TracedLine { points: piece.points, closed: false });
                }
            }
        }
        // What is filled grows by half a bead beyond the offset's centreline, the other half of its
        // strip.
        rest = rest.difference(&around(seed, distance + 0.5 * step));
        if rest.is_empty() {
            break;
        }
    }
    out
}
