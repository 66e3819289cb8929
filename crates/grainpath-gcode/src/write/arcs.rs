//! Finds sequences of points that lie on a circle, to be written as G2 or G3.
//!
//! # Method
//! The circle through the first, the middle and the last point of a sequence is compared with all its points
//! and chords. The sequence is doubled until it no longer fits; bisection then finds the longest sequence that
//! does. Where an arc ends, the search starts again.
//!
//! # Units, cost and limits
//! Lengths in mm, angles in rad. The cost is n log n for n points in one arc. The points and the middles
//! of the chords between them lie within the tolerance of the arc. Points on a line have no circle and
//! stay lines. Arcs have 5 points at least, radii of 0.3 to 1000 mm, and less than a full turn; a chord
//! that turns by more than a radian counts as a corner.

use grainpath_core::DVec2;
use grainpath_core::math::{atan2, cross};

/// An arc that replaces the points from a start to `end`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Arc {
    /// Index of the last point that the arc replaces.
    pub end: usize,
    /// Centre, in the frame of the points.
    pub centre: DVec2,
    /// Whether the arc turns left (G3).
    pub counter_clockwise: bool,
    /// Length, mm.
    pub length_mm: f64,
}

/// Fewest points of an arc. Any three points lie on a circle, and an arc that replaces
/// only a few chords saves no lines. Source: derived from these two reasons: the fourth
/// point is the first to confirm a circle, and the fifth makes a coincidence less
/// likely.
const MIN_POINTS: usize = 5;
// Smallest and largest radius of an arc, mm. Source: derived. An arc of a smaller radius is at most 1.65 mm long
// (`MAX_SWEEP`), which is a few chords. Firmware computes with 24 bits, in which the square of a larger radius
// has steps of more than 0.06 mm2, and the radius itself steps of 0.00003 mm.
const RADIUS_MM: std::ops::RangeInclusive<f64> = 0.3..=1000.0;
/// Largest sweep of an arc, rad (315 degrees). Source: derived. Firmware confuses an almost complete circle with an almost
/// empty arc through rounding.
const MAX_SWEEP: f64 = 5.5;

/// The longest arc from point `start` that stays within `tolerance_mm` of the points and the chords.
///
/// The length of a sequence is doubled while it fits; then bisection finds the limit between the last that
/// fits and the first that does not. That takes n log n distance tests for n points instead of n squared.
pub(super) fn arc_from(points: &[DVec2], start: usize, tolerance_mm: f64) -> Option<Arc> {
    let points = &points[start..];
    let try_run = |n: usize| {
        let (centre, counter_clockwise, length_mm) = fit(points.get(..n)?, tolerance_mm)?;
        Some(Arc { end: start + n - 1, centre, counter_clockwise, length_mm })
    };
    let mut fits = MIN_POINTS;
    let mut best = try_run(fits)?;
    let mut fails = points.len() + 1;
    while fits + 1 < fails {
        // Doubling stops at the midpoint to the first failure; from then on the search is a bisection.
        let n = (2 * fits).min(fits.midpoint(fails)).max(fits + 1);
        match try_run(n) {
            Some(arc) => (fits, best) = (n, arc),
            None => fails = n,
        }
    }
    Some(best)
}

fn fit(points: &[DVec2], tolerance: f64) -> Option<(DVec2, bool, f64)> {
    // The circle is taken through the first, the middle and the last point, which makes it least sensitive to noise.
    let (a, m, b) = (points[0], points[points.len() / 2], points[points.len() - 1]);
    let centre = centre(a, m, b)?;
    let r = centre.distance(a);
    if !RADIUS_MM.contains(&r) || points.iter().any(|p| (p.distance(centre) - r).abs() > tolerance) {
        return None;
    }
    let left = cross(m - a, b - m) > 0.0;
    let mut sweep = 0.0;
    // At this point all points lie near the circle. The chords between them must be near it as well,
    // and must all turn the same way.
    for w in points.windows(2) {
        let (u, v) = (w[0] - centre, w[1] - centre);
        let turn = atan2(cross(u, v), u.dot(v)) * if left { 1.0 } else { -1.0 };
        // Distance between the arc and the chord at its middle.
        let bulge = r - (0.5 * (w[0] + w[1])).distance(centre);
        // A chord that turns by more than a radian is a corner of the path.
        if turn <= 0.0 || turn > 1.0 || bulge > tolerance {
            return None;
        }
        sweep += turn;
    }
    (sweep <= MAX_SWEEP).then_some((centre, left, sweep * r))
}

/// The centre of the circle through three points; `None` where they lie on a line.
fn centre(a: DVec2, b: DVec2, c: DVec2) -> Option<DVec2> {
    let (u, v) = (b - a, c - a);
    let d = 2.0 * cross(u, v);
    if d.abs() < 1e-9 {
        return None;
    }
    let (uu, vv) = (u.length_squared(), v.length_squared());
    Some(a + DVec2::new(v.y * uu - u.y * vv, u.x * vv - v.x * uu) / d)
}
