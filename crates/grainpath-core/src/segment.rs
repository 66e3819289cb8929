//! Straight segments in the plane: the closest point, the distance, and whether two of them cross.
//!
//! Lengths are mm. The signs of areas are exact ([`robust::orient2d`], Shewchuk 1997,
//! `shewchuk1997` in docs/references.bib). So even three nearly collinear points turn the same way
//! in every comparison. A segment of no length is a point; every function accepts it.

use glam::DVec2;

use crate::Bounds2;

/// The position on the segment that is nearest to `p`, as a share of the way from `a` to `b` (0 to 1).
#[inline]
pub fn closest_share(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let d = b - a;
    let length2 = d.length_squared();
    if length2 > 0.0 { ((p - a).dot(d) / length2).clamp(0.0, 1.0) } else { 0.0 }
}

/// The point of the segment from `a` to `b` that is nearest to `p`.
///
/// ```
/// use grainpath_core::{DVec2, segment};
///
/// let (a, b) = (DVec2::ZERO, DVec2::new(10.0, 0.0));
/// assert_eq!(segment::closest_point(DVec2::new(4.0, 3.0), a, b), DVec2::new(4.0, 0.0));
/// assert_eq!(segment::closest_point(DVec2::new(-4.0, 3.0), a, b), a);
/// ```
pub fn closest_point(p: DVec2, a: DVec2, b: DVec2) -> DVec2 {
    a + closest_share(p, a, b) * (b - a)
}

/// Squared distance of `p` from the segment from `a` to `b`, mm².
pub fn distance_squared_mm2(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    p.distance_squared(closest_point(p, a, b))
}

/// The direction in which the corner `a`, `b`, `c` turns: positive to the left, negative to the
/// right, zero for three points on one line. The sign is exact; the value is about twice the area
/// of the triangle, mm².
pub fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| robust::Coord { x: p.x, y: p.y };
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// How two segments meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meeting {
    /// They have no point in common.
    Apart,
    /// They have a point in common, and at least one of them ends there or they overlap on one line.
    Touch,
    /// They have one point in common, which is inside both.
    Cross,
}

/// How the segment from `a` to `b` meets the one from `c` to `d`; exact.
///
/// ```
/// use grainpath_core::{DVec2, segment::{Meeting, meeting}};
///
/// let p = |x, y| DVec2::new(x, y);
/// assert_eq!(meeting([p(0., 0.), p(2., 2.)], [p(0., 2.), p(2., 0.)]), Meeting::Cross);
/// assert_eq!(meeting([p(0., 0.), p(2., 0.)], [p(1., 0.), p(1., 3.)]), Meeting::Touch);
/// assert_eq!(meeting([p(0., 0.), p(1., 0.)], [p(2., 0.), p(3., 0.)]), Meeting::Apart);
/// ```
pub fn meeting([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> Meeting {
    let bounds = |p: DVec2, q: DVec2| Bounds2 { min: p.min(q), max: p.max(q) };
    // Comparing boxes is exact and cheaper than computing turns. For two segments on one line it
    // already gives the answer.
    if !bounds(a, b).meets(bounds(c, d)) {
        return Meeting::Apart;
    }
    let opposite = |s: f64, t: f64| (s > 0.0 && t < 0.0) || (s < 0.0 && t > 0.0);
    let same = |s: f64, t: f64| (s > 0.0 && t > 0.0) || (s < 0.0 && t < 0.0);
    let (of_c, of_d) = (turn(a, b, c), turn(a, b, d));
    // If both ends lie on the same side, there is no common point. A turn of zero (an end on the
    // line) is decided below.
    if same(of_c, of_d) {
        return Meeting::Apart;
    }
    let (of_a, of_b) = (turn(c, d, a), turn(c, d, b));
    if same(of_a, of_b) {
        Meeting::Apart
    } else if opposite(of_c, of_d) && opposite(of_a, of_b) {
        Meeting::Cross
    } else {
        Meeting::Touch
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// On a small grid of whole numbers the answer is that of exact rational arithmetic.
        #[test]
        fn meetings_are_those_of_whole_numbers(n in prop::array::uniform8(0i64..5)) {
            let [ax, ay, bx, by, cx, cy, dx, dy] = n;
            let p = |x: i64, y: i64| DVec2::new(x as f64 * 0.1, y as f64 * 0.1);
            let found = meeting([p(ax, ay), p(bx, by)], [p(cx, cy), p(dx, dy)]);
            // Points in common at shares s = k / n and t with n the least common multiple of small
            // denominators: a + s (b - a) lies on c-d exactly when the whole numbers below say so.
            let side = |(ox, oy): (i64, i64), (ex, ey): (i64, i64), (px, py): (i64, i64)| {
                ((ex - ox) * (py - oy) - (ey - oy) * (px - ox)).signum()
            };
            let (a, b, c, d) = ((ax, ay), (bx, by), (cx, cy), (dx, dy));
            let on = |p: (i64, i64), q: (i64, i64), r: (i64, i64)| {
                side(p, q, r) == 0
                    && (p.0.min(q.0)..=p.0.max(q.0)).contains(&r.0)
                    && (p.1.min(q.1)..=p.1.max(q.1)).contains(&r.1)
            };
            let crosses = side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
            let touches = on(a, b, c) || on(a, b, d) || on(c, d, a) || on(c, d, b);
            // 0.1 n is not exact, so only answers that do not hang on a rounded zero can be compared.
            let clear = [side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b)].iter().all(|s| *s != 0);
            if clear {
                prop_assert_eq!(found == Meeting::Cross, crosses);
            }
            let whole = |(x, y): (i64, i64)| DVec2::new(x as f64, y as f64);
            let wanted = match (crosses, touches) {
                (true, _) => Meeting::Cross,
                (_, true) => Meeting::Touch,
                _ => Meeting::Apart,
            };
            prop_assert_eq!(meeting([whole(a), whole(b)], [whole(c), whole(d)]), wanted);
        }

        /// No point of the segment is nearer than the closest one.
        #[test]
        fn the_closest_point_is_the_closest(v in prop::array::uniform6(-5.0f64..5.0), share in 0.0f64..=1.0) {
            let (p, a, b) = (DVec2::new(v[0], v[1]), DVec2::new(v[2], v[3]), DVec2::new(v[4], v[5]));
            let nearest = distance_squared_mm2(p, a, b);
            prop_assert!(nearest <= p.distance_squared(a.lerp(b, share)) + 1e-12);
            prop_assert!(distance_squared_mm2(p, a, a) == p.distance_squared(a));
        }
    }
}
