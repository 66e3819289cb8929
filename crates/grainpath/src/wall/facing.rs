//! Two sides of a wall that face each other share the space between them.
//!
//! A part 1.8 mm thick has room for four strips of 0.41 mm and 0.13 mm more: too little for a bead of its own. Both
//! sides of the inner wall take half of it each. They become wider, or narrower where they were laid too close, and
//! their centrelines move by half as much, so that their outer edges stay where they are:
//!
//! ```text
//!    before                     after
//!   |  wall  |  wall  |        |  wall  |   wall   |
//!            gap              the edges towards the part's border stay, the others meet
//!   |  wall  |  wall  |        |  wall  |   wall   |
//! ```
//!
//! Where the space begins or ends at once, the bead moves inwards before it widens and narrows before it moves back: a
//! piece whose width and place change together would leave the part at its narrow end.
//!
//! Method: points at most [`STEP_MM`] apart along each loop look across its inner side for the nearest side of a
//! loop of the same depth. Lengths are in mm. Cost: a search in a grid for each point. Degenerate cases: at a tip, where the
//! other side lies beside a point and not across, the bead stays as it is.

use grainpath_core::poly::edges;
use grainpath_core::polyline::simplified_with;
use grainpath_core::segments::Segments;
use grainpath_core::units::bead_width_mm;
use grainpath_core::{BeadWidth, DVec2, Toolpath};

/// Longest piece of a loop without a point that looks across, mm. Source: derived: about a bead's width, so that a bead
/// ends to widen within a bead's width of the place where the space ends.
const STEP_MM: f64 = 0.4;
/// A point lies on a piece that is nearer than this, mm; the other side never is. Source: derived; coordinates of 1000 mm are
/// rounded by 1e-13 mm, and polygons lie on a grid of 1e-4 mm.
const ON_MM: f64 = 1e-6;
/// Cosine of the largest angle between the way across and the normal of a loop. Source: derived: 26 degrees. Where two
/// sides meet at a larger angle, they face each other for less than a bead's width.
const ACROSS: f64 = 0.9;
/// What a simplified loop may differ from the points that looked across, in place and in width, mm. Source: derived: the
/// fifth part of the least difference in width that the eye sees in a print, about 0.01 mm.
const TOLERANCE_MM: f64 = 0.002;

/// Where a bead that widens steadily would reach farther outwards than this, it moves inwards first, mm. Source: derived:
/// half of the least difference in width that the eye sees in a print, about 0.01 mm.
const JOG_MM: f64 = 0.005;
/// Length of each of the two pieces in which a bead moves inwards and widens, mm. Source: derived: the eighth part of
/// [`STEP_MM`], so that the bead has the width of one of the two sides on three quarters of a piece.
const JOG_LENGTH_MM: f64 = 0.05;

/// Widens or narrows loops, each with its depth, where two sides of the same depth face each other with a space between
/// their strips of `s_mm` that lies in `range_mm`; the space is negative where the strips overlap.
pub(super) fn share_the_space(
    loops: &mut [(usize, &mut Toolpath)],
    s_mm: f64,
    height_mm: f64,
    range_mm: (f64, f64),
) {
    let (s, h) = (s_mm, height_mm);
    // Loops of different depths face each other everywhere, so each depth has a grid of its own.
    let mut of_depths: Vec<Vec<[DVec2; 2]>> = Vec::new();
    for (depth, path) in loops.iter() {
        of_depths.resize(of_depths.len().max(depth + 1), Vec::new());
        of_depths[*depth].extend(edges(&path.points).map(<[DVec2; 2]>::from));
    }
    let of_depths: Vec<Segments> = of_depths.into_iter().map(|all| Segments::new(all, 2.0 * s)).collect();
    for (depth, path) in loops.iter_mut() {
        let pieces = &of_depths[*depth];
        let across = |p: DVec2, normal: DVec2| {
            let near = pieces.within(p, s + range_mm.1);
            let ways = near.map(|(i, share)| pieces.ends(i)[0].lerp(pieces.ends(i)[1], share) - p);
            let ways = ways.filter(|way| way.length() > ON_MM && way.dot(normal) > ACROSS * way.length());
            // The diameter of the circle that touches the loop here and passes through the other point: the distance of
            // parallel sides, and in a round place the same for every point across.
            let across_mm = ways.map(|way| way.length_squared() / way.dot(normal)).min_by(f64::total_cmp)?;
            let space_mm = across_mm - s;
            (space_mm > range_mm.0 && space_mm < range_mm.1).then_some(space_mm)
        };
        // Each point of the loop, the way inwards, and the space that it has across.
        let mut all: Vec<(DVec2, DVec2, f64)> = Vec::new();
        let mut before = path.points.last().copied().unwrap_or_default();
        let mut any = false;
        for (a, b) in edges(&path.points) {
            let n = (a.distance(b) / STEP_MM).ceil().max(1.0);
            let normal = (b - a).normalize_or_zero().perp();
            let corner = ((a - before).normalize_or_zero().perp() + normal).normalize_or_zero();
            before = a;
            for k in 0..n as usize {
                let p = a.lerp(b, k as f64 / n);
                let normal = if k == 0 { corner } else { normal };
                let found = across(p, normal);
                any |= found.is_some();
                all.push((p, normal, found.unwrap_or_default()));
            }
        }
        let (mut points, mut widths) = (Vec::new(), Vec::new());
        let mut lay = |p: DVec2, inwards_mm: DVec2, space_mm: f64| {
            points.push(p + inwards_mm);
            widths.push(bead_width_mm(s + 0.5 * space_mm, h));
        };
        for (i, &(p, normal, space_mm)) in all.iter().enumerate() {
            let (next, _, next_mm) = all[(i + 1) % all.len()];
            lay(p, 0.25 * space_mm * normal, space_mm);
            // The mean width of a piece reaches half of the difference in place of its ends beyond the narrow one, and each
            // side moves by a quarter of the space.
            if 0.125 * (next_mm - space_mm).abs() > JOG_MM {
                let normal = (next - p).normalize_or_zero().perp();
                let half = (JOG_LENGTH_MM / p.distance(next)).min(0.25);
                let (narrow_mm, deep_mm) = (space_mm.min(next_mm), space_mm.max(next_mm));
                lay(p.lerp(next, 0.5 - half), 0.25 * space_mm * normal, space_mm);
                lay(p.lerp(next, 0.5), 0.25 * deep_mm * normal, narrow_mm);
                lay(p.lerp(next, 0.5 + half), 0.25 * next_mm * normal, next_mm);
            }
        }
        if any {
            let (points, widths) = simplified_with(&points, &widths, true, TOLERANCE_MM, TOLERANCE_MM);
            path.points = points;
            path.width = BeadWidth::PerVertex(widths);
        }
    }
}
