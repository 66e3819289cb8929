//! Single lines along the field in places that evenly spaced lines leave empty.
//!
//! Sparse lines lie up to 4 mm apart. Beside a border, beyond which the next line would lie, and between lines that end, a
//! window of [`WINDOW_MM`] may hold none, and no width of its neighbours makes up for that. Lines stand on each other in all
//! layers of a plate, so other layers leave the same window empty. Each such window gets a line along the field, as long as it
//! lies in windows that lack material. Widths are fitted afterwards.
//!
//! ```text
//!    ############################ border
//!            ------------            a line in a gap
//!
//!    ----------------------------    evenly spaced lines
//! ```
//!
//! Lengths are in mm. Cost: linear in the area and in the beads; for each line also the windows that lack material.

use grainpath_core::buckets::PointGrid2;
use grainpath_core::math::direction;
use grainpath_core::poly::{LineClipper, simplify_line};
use grainpath_core::streamlines::{LineSettings, trace_line};
use grainpath_core::units::bead_spacing_mm;
use grainpath_core::{Bounds2, DVec2, Polygon, Region, Toolpath};

use super::density_windows::{Sums, WINDOW_MM, Windows, pieces};
use super::field::seed_lines::{LONGEST_SIDES, TOLERANCE_MM};
use super::field::stripes::WIDEST;
use super::{FillContext, LinesBelow};

/// Lines shorter than this, in beads, are left out. Source: derived. Twice the shortest piece of `stripes`:
/// lines of sparse infill have no support between their ends.
pub(super) const SHORTEST: f64 = 4.0;
/// A window gets a line where it would stay short by more than this share of full with the widest beads. Source: measured
/// on the bracket of docs/gallery, 8 mm thick, at eight masses from 7 to 16.7 g: without such lines the worst cell is off by
/// 10.1 % of full, with them by 9.2 %, for 2 % more paths. With usual beads in the place of the widest it is 8.5 % for 6 %
/// more paths, and with a share of 0.05 and usual beads 7.0 % for 14 % more.
const SHORT: f64 = 0.08;
/// A line in a gap ends where another is nearer than this share of the wanted distance. Source: measured. At 8.2 g a cell of
/// the bracket has no room for a line with 0.55, the share of other lines, and stays off by 10.3 %; with 0.4 the worst cell
/// is off by 5.4 %.
const NEAREST: f64 = 0.4;

/// Adds lines to those from `first` on wherever a window would stay short by more than [`SHORT`] with the widest beads.
pub(super) fn lines_in_gaps(
    context: &FillContext<'_>,
    windows: &Windows<'_>,
    infill_region: &Polygon,
    first: usize,
    out: &mut Vec<Toolpath>,
) {
    let Some(field) = context.field else { return };
    let piece_mm = 0.5 * windows.grid.cell_mm();
    let strip_mm = context.spacing_mm();
    // What each bead can hold.
    let most_mm = bead_spacing_mm(WIDEST * context.bead_width_mm, context.height_mm);
    let mut laid = vec![0.0; windows.n_cells()];
    for path in &out[first..] {
        pieces_of(path, piece_mm).for_each(|(p, mm)| laid[windows.cell_of(p)] += most_mm * mm);
    }
    let laid = Sums::new(windows.grid.size(), &laid);
    let area = windows.sums(|k| if windows.is_in_area(k) { windows.cell_mm2() } else { 0.0 });
    // What each window lacks, by the cell in its middle, mm2; windows that hold less than half of their area do not count.
    let lacks = |k: usize| {
        let around = windows.around(windows.middle_mm(k));
        let mm2 = area.of(around);
        let counts = windows.is_in_area(k) && mm2 >= 0.5 * WINDOW_MM * WINDOW_MM;
        if counts { windows.asked.of(around) - laid.of(around) - SHORT * mm2 } else { 0.0 }
    };
    let mut lacks: Vec<f64> = (0..windows.n_cells()).map(lacks).collect();
    let mut gaps: Vec<usize> = (0..windows.n_cells()).filter(|k| lacks[*k] > 0.0).collect();
    let Some(bounds) = Bounds2::around_points(gaps.iter().map(|k| windows.middle_mm(*k))) else { return };
    // Distance of lines wanted at a point, mm.
    let apart_mm = |p: DVec2| strip_mm / windows.density(p);
    let mut lines = PointGrid2::new(bounds, apart_mm(bounds.centre()));
    let reach = bounds.grown(2.0 * WINDOW_MM);
    for (p, _) in out[first..].iter().flat_map(|path| pieces_of(path, piece_mm)) {
        if p.clamp(reach.min, reach.max) == p {
            lines.insert(p, ());
        }
    }
    let inside = LineClipper::new(&Region::from(infill_region.clone()));
    let axis =
        |p: DVec2| inside.contains(p).then(|| direction(field.sample(p.extend(context.z_mid_mm)).axis_rad));
    let settings = LineSettings {
        tolerance_mm: TOLERANCE_MM,
        step_mm: piece_mm,
        longest_mm: LONGEST_SIDES * reach.size().element_sum(),
    };
    // A line of the layer below goes on first, so that it carries the one above.
    let mut below = context.below.into_iter().flat_map(LinesBelow::places).copied();
    loop {
        let named = below.next();
        let worst = if named.is_some() {
            None
        } else {
            gaps.iter().copied().max_by(|a, b| lacks[*a].total_cmp(&lacks[*b]).then(b.cmp(a)))
        };
        let is_free = |p: DVec2| {
            let mm = (NEAREST * apart_mm(p)).max(strip_mm);
            lines.within(p, mm).next().is_none()
        };
        let seed = match (named, worst) {
            (Some(seed), _) => Some(seed),
            (None, Some(k)) => {
                // The free place nearest to the middle of the area in the window.
                let there: Vec<DVec2> = windows
                    .cells_in(k)
                    .filter(|k| windows.is_in_area(*k))
                    .map(|k| windows.middle_mm(k))
                    .collect();
                let middle = there.iter().sum::<DVec2>() / there.len().max(1) as f64;
                let free = there.into_iter().filter(|p| inside.contains(*p) && is_free(*p));
                free.min_by(|a, b| a.distance_squared(middle).total_cmp(&b.distance_squared(middle)))
            }
            (None, None) => break,
        };
        let in_gap = |p: DVec2| windows.cells_in(windows.cell_of(p)).any(|k| lacks[k] > 0.0);
        let is_held = seed.is_some_and(|seed| context.is_held(seed));
        let stop = |p: DVec2, _: f64| !is_free(p) || !in_gap(p) || is_held && !context.is_held(p);
        let line = seed.filter(|p| !stop(*p, 0.0)).map(|p| trace_line(p, &axis, &stop, &settings));
        let long = line.filter(|line| line.length_mm() > SHORTEST * context.bead_width_mm);
        if let Some(line) = long {
            let points = simplify_line(&line.points, TOLERANCE_MM);
            let path = Toolpath::new(points, context.bead_width_mm, context.role, line.closed);
            for (p, mm) in pieces_of(&path, piece_mm) {
                lines.insert(p, ());
                windows.cells_in(windows.cell_of(p)).for_each(|k| lacks[k] -= most_mm * mm);
            }
            out.push(path);
        } else if let Some(k) = worst {
            // No line fits.
            lacks[k] = 0.0;
        }
        gaps.retain(|k| lacks[*k] > 0.0);
    }
}

/// The middles of pieces of a path that are at most `piece_mm` long, and their lengths, mm.
fn pieces_of(path: &Toolpath, piece_mm: f64) -> impl Iterator<Item = (DVec2, f64)> + '_ {
    (0..path.n_segments()).map(|k| path.segment(k)).flat_map(move |(a, b, _)| {
        let (length_mm, middles) = pieces(a, b, piece_mm);
        middles.map(move |p| (p, length_mm))
    })
}
