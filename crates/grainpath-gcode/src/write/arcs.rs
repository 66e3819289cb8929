//! Runs of points that lie on a circle.

use grainpath_core::DVec2;
use grainpath_core::math::{atan2, cross};

/// An arc that stands for the points from one to a later one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc {
    /// Index of the last point it reaches.
    pub end: usize,
    /// Its centre.
    pub centre: DVec2,
    /// Whether it turns left (G3).
    pub counter_clockwise: bool,
    /// Its length, mm.
    pub length_mm: f64,
}

/// Fewer points than this are not worth an arc.
const MIN_POINTS: usize = 5;
const RADIUS_MM: std::ops::RangeInclusive<f64> = 0.3..=1000.0;
/// Firmware loses its way on arcs that are almost whole circles.
const MAX_SWEEP: f64 = 5.5;

/// The longest arc from point `start` within `tolerance_mm` of the points and of the chords between them.
///
/// Longer and longer runs are tried, each twice the one before, then halfway between the last that fits and the
/// first that does not: n log n looks at n points instead of n squared.
pub fn arc_from(points: &[DVec2], start: usize, tolerance_mm: f64) -> Option<Arc> {
    let points = &points[start..];
    let try_run = |n: usize| {
        let (centre, counter_clockwise, length_mm) = fit(points.get(..n)?, tolerance_mm)?;
        Some(Arc { end: start + n - 1, centre, counter_clockwise, length_mm })
    };
    let mut fits = MIN_POINTS;
    let mut best = try_run(fits)?;
    let mut fails = points.len() + 1;
    while fits + 1 < fails {
        let n = (2 * fits).min(fits.midpoint(fails)).max(fits + 1);
        match try_run(n) {
            Some(arc) => (fits, best) = (n, arc),
            None => fails = n,
        }
    }
    Some(best)
}

fn fit(points: &[DVec2], tolerance: f64) -> Option<(DVec2, bool, f64)> {
    let (a, m, b) = (points[0], points[points.len() / 2], points[points.len() - 1]);
    let centre = centre(a, m, b)?;
    let r = centre.distance(a);
    if !RADIUS_MM.contains(&r) || points.iter().any(|p| (p.distance(centre) - r).abs() > tolerance) {
        return None;
    }
    let left = cross(m - a, b - m) > 0.0;
    let mut sweep = 0.0;
    for w in points.windows(2) {
        let (u, v) = (w[0] - centre, w[1] - centre);
        let turn = atan2(cross(u, v), u.dot(v)) * if left { 1.0 } else { -1.0 };
        // How far the arc bulges over the chord.
        let bulge = r - (0.5 * (w[0] + w[1])).distance(centre);
        if turn <= 0.0 || turn > 1.0 || bulge > tolerance {
            return None;
        }
        sweep += turn;
    }
    (sweep <= MAX_SWEEP).then_some((centre, left, sweep * r))
}

/// The centre of the circle through three points.
fn centre(a: DVec2, b: DVec2, c: DVec2) -> Option<DVec2> {
    let (u, v) = (b - a, c - a);
    let d = 2.0 * cross(u, v);
    if d.abs() < 1e-9 {
        return None;
    }
    let (uu, vv) = (u.length_squared(), v.length_squared());
    Some(a + DVec2::new(v.y * uu - u.y * vv, u.x * vv - v.x * uu) / d)
}
