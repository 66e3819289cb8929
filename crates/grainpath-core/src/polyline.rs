//! Polylines in the plane: length, equal steps, cutting out small loops, and dropping vertices that do not matter.
//!
//! A polyline is a slice of points in mm. `closed` says that the last point is joined to the first,
//! which is not repeated. Cost: [`length_mm`] and [`resampled`] are linear; [`simplified_with`]
//! (Douglas and Peucker 1973, `douglas1973` in docs/references.bib) is O(n log n) for usual lines
//! and O(n²) at worst, O(n) with pieces of limited length. Degenerate lines: without a point the
//! result is empty; a line of no length keeps its points.

use glam::DVec2;

use crate::math::cross;
use crate::segment::{Meeting, closest_share, meeting};

/// Length of a polyline, mm.
///
/// ```
/// use grainpath_core::{DVec2, polyline::length_mm};
///
/// let corner = [DVec2::ZERO, DVec2::new(3.0, 0.0), DVec2::new(3.0, 4.0)];
/// assert_eq!(length_mm(&corner, false), 7.0);
/// assert_eq!(length_mm(&corner, true), 12.0);
/// ```
pub fn length_mm(line: &[DVec2], closed: bool) -> f64 {
    let open: f64 = line.windows(2).map(|w| w[0].distance(w[1])).sum();
    match (closed, line) {
        (true, [first, .., last]) => open + last.distance(*first),
        _ => open,
    }
}

/// Replaces each loop of up to `longest_mm` in which a line crosses itself by the point where it does, with a value of `values`
/// between those of the segment that is crossed. Cost: each segment is compared with those within `longest_mm` behind it.
///
/// ```
/// use grainpath_core::{DVec2, polyline::cut_small_loops};
///
/// let mut line = [[0., 0.], [4., 0.], [4., 2.], [3., 2.], [3., 1.], [9., 1.]].map(DVec2::from).to_vec();
/// let mut widths = vec![0.4, 0.4, 0.5, 0.5, 0.5, 0.4];
/// cut_small_loops(&mut line, &mut widths, false, 5.0);
/// assert_eq!(line, [[0., 0.], [4., 0.], [4., 1.], [9., 1.]].map(DVec2::from));
/// assert_eq!(widths, [0.4, 0.4, 0.45, 0.4]);
/// ```
///
/// # Panics
///
/// If there is not one value for each point.
pub fn cut_small_loops(points: &mut Vec<DVec2>, values: &mut Vec<f64>, closed: bool, longest_mm: f64) {
    assert_eq!(points.len(), values.len(), "one value for each point");
    cut_loops_between_ends(points, values, longest_mm);
    if closed {
        // A loop across the place where a ring begins lies within the ring that begins half way around.
        let half = points.len() / 2;
        points.rotate_left(half);
        values.rotate_left(half);
        cut_loops_between_ends(points, values, longest_mm);
        let back = half.min(points.len());
        points.rotate_right(back);
        values.rotate_right(back);
    }
}

/// [`cut_small_loops`] of the line from the first to the last point.
fn cut_loops_between_ends(points: &mut Vec<DVec2>, values: &mut Vec<f64>, longest_mm: f64) {
    let mut i = 0;
    while i + 3 < points.len() {
        let [a, b] = [points[i], points[i + 1]];
        let (mut from_b_mm, mut last) = (0.0, None);
        for j in i + 2..points.len() - 1 {
            let [c, d] = [points[j], points[j + 1]];
            from_b_mm += points[j - 1].distance(c);
            if from_b_mm > longest_mm {
                break;
            }
            if meeting([a, b], [c, d]) == Meeting::Cross {
                let share = cross(c - a, d - c) / cross(b - a, d - c);
                let at = a.lerp(b, share);
                if at.distance(b) + from_b_mm + c.distance(at) <= longest_mm {
                    last = Some((j, share, at));
                }
            }
        }
        if let Some((j, share, at)) = last {
            let value = values[i] + share * (values[i + 1] - values[i]);
            points.splice(i + 1..=j, [at]);
            values.splice(i + 1..=j, [value]);
        }
        i += 1;
    }
}

/// Removes the length `by_mm` from the beginning of an open line. A line that is no longer than that keeps its last point.
///
/// ```
/// use grainpath_core::{DVec2, polyline::shorten_start};
///
/// let mut line = vec![DVec2::ZERO, DVec2::new(1.0, 0.0), DVec2::new(4.0, 0.0)];
/// shorten_start(&mut line, 1.5);
/// assert_eq!(line, [DVec2::new(1.5, 0.0), DVec2::new(4.0, 0.0)]);
/// ```
pub fn shorten_start(points: &mut Vec<DVec2>, mut by_mm: f64) {
    while points.len() > 1 {
        let l = points[0].distance(points[1]);
        if l > by_mm {
            points[0] = points[0].lerp(points[1], by_mm / l);
            return;
        }
        by_mm -= l;
        points.remove(0);
    }
}

/// The polyline with points at equal steps of about `step_mm`. An open line keeps both ends; a
/// closed one its first point.
///
/// Corners between two steps are cut off. At most 10⁶ points are made.
///
/// ```
/// use grainpath_core::{DVec2, polyline::resampled};
///
/// let line = [DVec2::ZERO, DVec2::new(1.0, 0.0), DVec2::new(4.0, 0.0)];
/// let xs: Vec<f64> = resampled(&line, false, 0.9).iter().map(|p| p.x).collect();
/// assert_eq!(xs, [0.0, 1.0, 2.0, 3.0, 4.0]);
/// ```
pub fn resampled(line: &[DVec2], closed: bool, step_mm: f64) -> Vec<DVec2> {
    let length = length_mm(line, closed);
    if line.len() < 2 || length <= 0.0 {
        return line.to_vec();
    }
    // The upper bound limits the memory that a tiny step takes.
    let n = (length / step_mm).round().clamp(1.0, 1e6) as usize;
    let step = length / n as f64;
    let ends = line.windows(2).map(|w| (w[0], w[1]));
    let closing = (line[line.len() - 1], line[0]);
    let mut out = Vec::with_capacity(n + 1);
    let (mut walked, mut next) = (0.0, 0.0);
    for (a, b) in ends.chain(closed.then_some(closing)) {
        let d = a.distance(b);
        while next < walked + d && out.len() < n {
            out.push(a + (next - walked) / d * (b - a));
            next += step;
        }
        walked += d;
    }
    if !closed {
        out.push(line[line.len() - 1]);
    }
    out
}

/// The vertices of an open polyline that Douglas and Peucker's method keeps. It keeps the ends. Between
/// two kept vertices it keeps the one with the largest `off`, and repeats this until no `off` is above 1.
///
/// `off(i, a, b)` is the distance of vertex `i` from the line between vertices `a` and `b`, as a
/// share of the tolerance; it may include differences of other data of the vertices. The line is
/// first cut into pieces of at most `max_piece` segments, so that the time grows no faster than the
/// number of vertices.
///
/// ```
/// use grainpath_core::polyline::kept_vertices;
///
/// // Heights along x = 0, 1, 2, 3: the third is 0.5 above the line through its neighbours.
/// let y = [0.0f64, 0.01, 0.5, 0.0];
/// let off = |i: usize, a: usize, b: usize| {
///     let share = (i - a) as f64 / (b - a) as f64;
///     (y[i] - (y[a] + share * (y[b] - y[a]))).abs() / 0.3
/// };
/// assert_eq!(kept_vertices(4, usize::MAX, off), [true, false, true, true]);
/// ```
pub fn kept_vertices(n: usize, max_piece: usize, off: impl Fn(usize, usize, usize) -> f64) -> Vec<bool> {
    let mut keep = vec![false; n];
    if n == 0 {
        return keep;
    }
    keep[n - 1] = true;
    let mut stack = Vec::new();
    for a in (0..n - 1).step_by(max_piece.max(1)) {
        keep[a] = true;
        stack.push((a, a.saturating_add(max_piece.max(1)).min(n - 1)));
    }
    keep[0] = true;
    while let Some((a, b)) = stack.pop() {
        let worst =
            (a + 1..b).map(|i| (off(i, a, b), i)).fold((1.0, 0), |m, o| if o.0 > m.0 { o } else { m });
        if worst.0 > 1.0 {
            keep[worst.1] = true;
            stack.extend([(a, worst.1), (worst.1, b)]);
        }
    }
    keep
}

/// The longest piece of a line that is simplified as a whole, in segments. Source: derived. The time
/// for a piece grows with the square of its length, and is below a millisecond for 256 segments; the
/// price is one vertex that is kept every 256 segments although the line is straight there.
const MAX_PIECE: usize = 256;

/// Simplifies a polyline with a value at each vertex. It drops a vertex that lies within
/// `tolerance_mm` of the simplified line, if its value lies within `value_tolerance` of the value
/// interpolated there.
///
/// A closed line is cut into at least two pieces, so that it never collapses to a point.
///
/// ```
/// use grainpath_core::{DVec2, polyline::simplified_with};
///
/// let line: Vec<DVec2> = (0..5).map(|i| DVec2::new(f64::from(i), 0.0)).collect();
/// let widths = [0.4, 0.4, 0.5, 0.4, 0.4];
/// let (points, kept) = simplified_with(&line, &widths, false, 0.005, 0.01);
/// assert_eq!(kept, [0.4, 0.4, 0.5, 0.4, 0.4], "the straight line keeps the wide place");
/// let (points, _) = simplified_with(&line, &[0.4; 5], false, 0.005, 0.01);
/// assert_eq!(points.len(), 2);
/// ```
pub fn simplified_with(
    line: &[DVec2],
    values: &[f64],
    closed: bool,
    tolerance_mm: f64,
    value_tolerance: f64,
) -> (Vec<DVec2>, Vec<f64>) {
    let off = |i: usize, a: usize, b: usize| {
        let share = closest_share(line[i], line[a], line[b]);
        let value = values[a] + share * (values[b] - values[a]);
        let distance = line[i].distance(line[a] + share * (line[b] - line[a]));
        (distance / tolerance_mm).max((values[i] - value).abs() / value_tolerance)
    };
    // A ring's first and last points are neighbours, so distances cannot be measured from the line between them.
    let max_piece = if closed { MAX_PIECE.min(line.len() / 2).max(1) } else { MAX_PIECE };
    let keep = kept_vertices(line.len(), max_piece, off);
    let kept = || (0..line.len()).filter(|&i| keep[i]);
    (kept().map(|i| line[i]).collect(), kept().map(|i| values[i]).collect())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::segment::distance_squared_mm2;

    fn lines() -> impl Strategy<Value = Vec<DVec2>> {
        prop::collection::vec((-5.0f64..5.0, -5.0f64..5.0), 2..40)
            .prop_map(|v| v.into_iter().map(|(x, y)| DVec2::new(x, y)).collect())
    }

    proptest! {
        /// Steps are equal along the line, so no chord is longer than a step, and every new point
        /// is on the old line.
        #[test]
        fn steps_are_equal_and_on_the_line(line in lines(), closed in any::<bool>(), step in 0.05f64..2.0) {
            let out = resampled(&line, closed, step);
            let length = length_mm(&line, closed);
            let n = out.len() - usize::from(!closed);
            let longest = length / n as f64;
            prop_assert!(out.windows(2).all(|w| w[0].distance(w[1]) <= longest * (1.0 + 1e-9)));
            prop_assert_eq!(out[0], line[0]);
            if !closed {
                prop_assert_eq!(out[out.len() - 1], line[line.len() - 1]);
            }
            let mut all = line.clone();
            all.extend(closed.then_some(line[0]));
            let near = |p: &DVec2| all.windows(2).any(|w| distance_squared_mm2(*p, w[0], w[1]) < 1e-18);
            prop_assert!(out.iter().all(near));
        }

        /// Every vertex dropped lies within the tolerances of the line that remains.
        #[test]
        fn what_is_dropped_is_within_the_tolerances(line in lines(), wave in 0.0f64..3.0) {
            let values: Vec<f64> = (0..line.len()).map(|i| 0.4 + 0.1 * crate::math::sin(wave * i as f64)).collect();
            let (points, kept) = simplified_with(&line, &values, false, 0.5, 0.05);
            prop_assert_eq!(points.len(), kept.len());
            let fits = |(p, v): (&DVec2, &f64)| {
                points.windows(2).zip(kept.windows(2)).any(|(w, k)| {
                    let share = closest_share(*p, w[0], w[1]);
                    p.distance(w[0].lerp(w[1], share)) <= 0.5 + 1e-9
                        && (v - (k[0] + share * (k[1] - k[0]))).abs() <= 0.05 + 1e-9
                })
            };
            prop_assert!(line.iter().zip(&values).all(fits));
        }
    }

    #[test]
    fn degenerate_lines_come_back() {
        let p = DVec2::new(1.0, 2.0);
        assert_eq!(resampled(&[], true, 1.0), []);
        assert_eq!(resampled(&[p], false, 1.0), [p]);
        assert_eq!(resampled(&[p, p], true, 1.0), [p, p]);
        assert_eq!(simplified_with(&[p], &[0.4], true, 0.1, 0.1), (vec![p], vec![0.4]));
        assert_eq!(simplified_with(&[], &[], false, 0.1, 0.1), (vec![], vec![]));
        assert_eq!(length_mm(&[p], true), 0.0);
    }

    #[test]
    fn small_loops_are_cut_out_wherever_a_ring_begins() {
        let ring = [[0., 0.], [9., 0.], [9., 9.], [1., 9.], [1., 1.], [2., 1.], [2., 2.], [0., 2.]];
        for start in 0..ring.len() {
            let mut points = ring.map(DVec2::from).to_vec();
            points.rotate_left(start);
            let mut values = vec![1.0; points.len()];
            cut_small_loops(&mut points, &mut values, true, 5.0);
            assert_eq!((points.len(), values.len()), (6, 6), "from {start}");
            assert!(points.contains(&DVec2::new(1.0, 2.0)), "from {start}: {points:?}");
        }
        // The loop is 4 mm long; a ring without a loop begins where it did.
        for (n_points, longest_mm) in [(8, 3.9), (4, 5.0)] {
            let whole = ring[..n_points].iter().map(|p| DVec2::from(*p)).collect::<Vec<_>>();
            let mut points = whole.clone();
            cut_small_loops(&mut points, &mut vec![1.0; n_points], true, longest_mm);
            assert_eq!(points, whole);
        }
    }
}
