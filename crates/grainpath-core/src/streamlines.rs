//! Streamlines of a field: one at a time, and evenly spaced.
//!
//! Lines are traced with the embedded Runge-Kutta pair of `dormand1980`, fifth order with a
//! fourth-order error estimate, so steps are long where the field is smooth. An axis has no sign,
//! so at every stage the sign is chosen that continues the heading. Even spacing follows
//! `Jobard1997`. Lengths are in mm. Cost: seven samples of the field a step; spacing looks up the
//! points in a few cells.

use std::collections::VecDeque;
use std::iter::Sum;
use std::ops::{Add, Mul, Neg, Sub};

use crate::buckets::PointGrid2;
use crate::math::pow;
use crate::{Bounds2, DVec2, DVec3};

/// A place in the plane or in space, in which lines are traced.
pub trait Place:
    Copy + Add<Output = Self> + Sub<Output = Self> + Neg<Output = Self> + Mul<f64, Output = Self> + Sum
{
    /// The scalar product.
    fn dot(self, other: Self) -> f64;
}

impl Place for DVec2 {
    fn dot(self, other: Self) -> f64 {
        Self::dot(self, other)
    }
}

impl Place for DVec3 {
    fn dot(self, other: Self) -> f64 {
        Self::dot(self, other)
    }
}

/// Distance of two places, mm.
fn distance<P: Place>(a: P, b: P) -> f64 {
    (a - b).dot(a - b).sqrt()
}

/// Accuracy and length of a traced line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineSettings {
    /// Largest error of a step, mm.
    pub tolerance_mm: f64,
    /// Longest step, mm.
    pub step_mm: f64,
    /// Longest line, mm; lines end there.
    pub longest_mm: f64,
}

/// A traced line.
#[derive(Debug, Clone, PartialEq)]
pub struct TracedLine<P = DVec2> {
    /// Its points, mm.
    pub points: Vec<P>,
    /// Whether the line returned to its beginning. The first point is then not repeated.
    pub closed: bool,
}

impl<P: Place> TracedLine<P> {
    /// Length, mm.
    pub fn length_mm(&self) -> f64 {
        let open: f64 = self.points.windows(2).map(|w| distance(w[0], w[1])).sum();
        let ends = [self.points.first(), self.points.last()];
        open + if let (true, [Some(a), Some(b)]) = (self.closed, ends) { distance(*a, *b) } else { 0.0 }
    }
}

/// Coefficients of the stages. Source: `dormand1980`, the pair RK5(4)7M; the last row is the
/// fifth-order result.
const A: [[f64; 6]; 6] = [
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// Weights of the error estimate: the fifth-order result less the fourth-order one. Source:
/// `dormand1980`.
const ERROR: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];

/// Traces the line through `seed` in both directions. `axis` gives the field's axis as a unit
/// vector of either sign, or `None` where the line has to end. `stop` gets each new point and the
/// length so far; the line also ends where it returns `true`.
pub fn trace_line<P: Place>(
    seed: P,
    axis: &dyn Fn(P) -> Option<P>,
    stop: &dyn Fn(P, f64) -> bool,
    settings: &LineSettings,
) -> TracedLine<P> {
    let Some(first) = axis(seed) else { return TracedLine { points: vec![seed], closed: false } };
    let (forwards, closed) = half(seed, first, axis, stop, settings);
    if closed {
        return TracedLine { points: forwards, closed };
    }
    let (mut points, _) = half(seed, -first, axis, stop, settings);
    points.reverse();
    points.extend(&forwards[1..]);
    TracedLine { points, closed: false }
}

/// One half of a line, and whether it returned to its beginning.
fn half<P: Place>(
    seed: P,
    heading: P,
    axis: &dyn Fn(P) -> Option<P>,
    stop: &dyn Fn(P, f64) -> bool,
    settings: &LineSettings,
) -> (Vec<P>, bool) {
    let mut points = vec![seed];
    let (mut at, mut heading) = (seed, heading);
    let first = heading;
    // The first step is short; the error estimate then adjusts its length.
    let mut step = 0.25 * settings.step_mm;
    let mut length = 0.0;
    // A line that could only take steps shorter than a thousandth of the longest one has practically reached the border.
    let least = 1e-3 * settings.step_mm;
    let along = |p: P, heading: P| -> Option<P> {
        let a = axis(p)?;
        // An axis nearly at right angles to the heading occurs at a degenerate point, where either
        // sign would be arbitrary; the line ends.
        let c = a.dot(heading);
        (c.abs() > 0.2).then_some(if c < 0.0 { -a } else { a })
    };
    while length < settings.longest_mm {
        let Some(next) = attempt(at, heading, step, &along) else {
            // A stage fell outside the field. Halving the step leads up to its edge.
            step *= 0.5;
            if step < least {
                break;
            }
            continue;
        };
        let (to, onward, error) = next;
        let ratio = settings.tolerance_mm / error.max(1e-12);
        // Usual step control for a method of fifth order: the safety factor of 0.9 avoids rejected
        // steps, the bounds avoid oscillation.
        let factor = (0.9 * fifth_root(ratio)).clamp(0.3, 2.0);
        // A step of the least size is accepted whatever its error; otherwise the loop might never end.
        if ratio < 1.0 && step > least {
            step *= factor;
            continue;
        }
        length += distance(at, to);
        // The line closes if it passes its beginning in the same direction.
        if length > 4.0 * settings.step_mm && onward.dot(first) > 0.8 {
            let d = to - at;
            let t = ((seed - at).dot(d) / d.dot(d).max(1e-300)).clamp(0.0, 1.0);
            if distance(seed, at + d * t) < 0.1 * settings.step_mm {
                // A last point close to the first would leave a very short last segment.
                if distance(seed, points[points.len() - 1]) < 0.2 * settings.step_mm {
                    points.pop();
                }
                return (points, true);
            }
        }
        if stop(to, length) {
            break;
        }
        points.push(to);
        (at, heading) = (to, onward);
        step = (step * factor).min(settings.step_mm);
    }
    (points, false)
}

/// The fifth root, the same bits everywhere.
fn fifth_root(x: f64) -> f64 {
    pow(x, 0.2)
}

/// One Runge-Kutta step: its end, the heading there, and the estimated error; `None` where a stage
/// leaves the field.
fn attempt<P: Place>(at: P, heading: P, step: f64, along: &dyn Fn(P, P) -> Option<P>) -> Option<(P, P, f64)> {
    let mut k = [along(at, heading)?; 7];
    for stage in 0..6 {
        let p = at + (0..=stage).map(|j| k[j] * A[stage][j]).sum::<P>() * step;
        // Every stage is aligned with the first one, so that all derivatives of the step have the
        // same sign.
        k[stage + 1] = along(p, k[0])?;
    }
    let to = at + (0..6).map(|j| k[j] * A[5][j]).sum::<P>() * step;
    let error = (0..7).map(|j| k[j] * ERROR[j]).sum::<P>() * step;
    Some((to, k[6], error.dot(error).sqrt()))
}

/// Spacing of evenly spaced lines.
pub struct Seeding<'a> {
    /// Distance wanted between lines at a point, mm.
    pub separation_mm: &'a dyn Fn(DVec2) -> f64,
    /// A line ends where it comes nearer to another than this share of the separation. From 0 to 1.
    pub end_share: f64,
    /// Lines shorter than this are not kept where they end beside another line, mm.
    pub shortest_mm: f64,
    /// Lines shorter than this are not kept where both their ends lie on the border of the field, mm.
    pub shortest_across_mm: f64,
    /// A seed that the caller names is taken if no line is nearer than this share of the separation. From 0 to 1.
    pub seed_share: f64,
    /// Whether a line that comes too near to another is dropped as a whole instead of cut.
    pub whole: bool,
    /// Whether a place lies on something below. A line that starts on it ends where it no longer does.
    pub is_held: &'a dyn Fn(DVec2) -> bool,
}

/// A seed found here is taken if no line is nearer than this share of the separation. Source: derived. Such seeds lie
/// exactly one separation away from their line; two per cent less allow for rounding.
pub const FOUND_SHARE: f64 = 0.98;

/// Evenly spaced lines everywhere in `bounds` where the field exists (`Jobard1997`). Each line
/// yields further seeds on both its sides. `seeds` are tried first; points of a grid are tried
/// last, so that no area is left out. Lines begin at seeds that are at least
/// [`Seeding::seed_share`] of the separation from others, or nearly the whole of it for seeds found here.
pub fn evenly_spaced(
    seeds: &[DVec2],
    bounds: Bounds2,
    axis: &dyn Fn(DVec2) -> Option<DVec2>,
    seeding: &Seeding<'_>,
    settings: &LineSettings,
) -> Vec<TracedLine> {
    let middle = (seeding.separation_mm)(bounds.centre());
    let mut near = PointGrid2::new(bounds, middle);
    let mut lines: Vec<TracedLine> = Vec::new();
    let mut queue: VecDeque<DVec2> = seeds.iter().copied().collect();
    let mut named = seeds.len();
    let size = bounds.size();
    let pitch = middle.max(size.max_element() / 1000.0);
    let (nx, ny) = ((size.x / pitch) as usize + 1, (size.y / pitch) as usize + 1);
    let mut grid = (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j)));
    loop {
        let seed = match queue.pop_front() {
            Some(seed) => seed,
            None => match grid.next() {
                Some((i, j)) => bounds.min + pitch * (DVec2::new(i as f64, j as f64) + 0.5),
                None => return lines,
            },
        };
        let share = if named > 0 { seeding.seed_share } else { FOUND_SHARE };
        named = named.saturating_sub(1);
        if axis(seed).is_none() {
            continue;
        }
        let separation = (seeding.separation_mm)(seed);
        // Between two places that ask for different separations, their mean counts.
        let is_near = |p: DVec2, share: f64| {
            // Lines further away than the separation here are too far, whatever separation they ask for.
            let own = (seeding.separation_mm)(p);
            let close = |q: DVec2| p.distance(q) < 0.5 * share * (own + (seeding.separation_mm)(q));
            near.within(p, share * own).any(|(q, ())| close(q))
        };
        if is_near(seed, share) {
            continue;
        }
        // `stop` and `held_axis` are shared closures, so the result leaves them through a cell.
        let met = std::cell::Cell::new(false);
        let stop = |p: DVec2, _: f64| {
            let hit = is_near(p, seeding.end_share);
            met.set(met.get() || hit);
            hit
        };
        // The field of a line that is held ends with what holds it, so steps become shorter up to that place.
        let is_held = (seeding.is_held)(seed);
        let held_axis = |p: DVec2| {
            let axis = axis(p)?;
            let goes_on = !is_held || (seeding.is_held)(p);
            met.set(met.get() || !goes_on);
            goes_on.then_some(axis)
        };
        let line = trace_line(seed, &held_axis, &stop, settings);
        let line = cut_at_itself(line, separation * seeding.end_share);
        // A line that met no other ends on the border at both ends, where walls hold it.
        let shortest_mm = if met.get() { seeding.shortest_mm } else { seeding.shortest_across_mm };
        if line.length_mm() < shortest_mm || (seeding.whole && met.get()) {
            continue;
        }
        let n = line.points.len();
        let segments = if line.closed { n } else { n - 1 };
        for k in 0..segments {
            let (a, b) = (line.points[k], line.points[(k + 1) % n]);
            let length = a.distance(b);
            // Where the separation is smaller than at the seed, points are closer together, so that
            // later lines find this one there too.
            let separation = separation.min((seeding.separation_mm)(a));
            // Points at a quarter of the separation: the distance to the nearest one is then nearly
            // the distance to the line.
            let steps = (length / (0.25 * separation)).ceil().max(1.0) as usize;
            for s in 0..steps {
                near.insert(a.lerp(b, s as f64 / steps as f64), ());
            }
        }
        for (at, along) in stations(&line, seed, seeding.separation_mm) {
            let across = DVec2::new(-along.y, along.x);
            queue.extend([across, -across].map(|way| next_seed(at, way, seeding.separation_mm)));
        }
        near.insert(line.points[n - 1], ());
        lines.push(line);
    }
}

/// Places along a line, one separation apart, and the unit vector along the line at each. They are counted from the seed
/// from which the line was traced. Its ends lie where a step of the tracing leaves the field, and are less certain.
fn stations(line: &TracedLine, seed: DVec2, separation_mm: &dyn Fn(DVec2) -> f64) -> Vec<(DVec2, DVec2)> {
    let own = line.points.iter().position(|p| *p == seed).unwrap_or(0);
    let mut backwards: Vec<DVec2> = line.points[..=own].to_vec();
    backwards.reverse();
    let mut forwards = line.points[own..].to_vec();
    if line.closed {
        forwards.extend(&line.points[..=own]);
    }
    let mut before = along_polyline(&backwards, separation_mm);
    before.reverse();
    let mut all: Vec<(DVec2, DVec2)> = before.into_iter().map(|(at, along)| (at, -along)).collect();
    let first = forwards.get(1).or(backwards.get(1)).map(|next| (*next - seed).normalize_or(DVec2::X));
    all.push((seed, first.unwrap_or(DVec2::X)));
    all.extend(along_polyline(&forwards, separation_mm));
    all
}

/// Places along a polyline at multiples of the separation from its beginning, without the beginning, and the unit vector
/// along it at each.
fn along_polyline(points: &[DVec2], separation_mm: &dyn Fn(DVec2) -> f64) -> Vec<(DVec2, DVec2)> {
    let Some(&first) = points.first() else { return Vec::new() };
    let mut out = Vec::new();
    let mut left = separation_mm(first);
    for w in points.windows(2) {
        let (length, mut done) = (w[0].distance(w[1]), 0.0);
        while length - done >= left {
            done += left;
            let at = w[0].lerp(w[1], done / length);
            out.push((at, (w[1] - w[0]) / length));
            left = separation_mm(at);
        }
        left -= length - done;
    }
    out
}

/// The place beside a line whose distance from it is the mean of the separations at both. The separation changes by less
/// than the distance, so a few rounds come close.
fn next_seed(from: DVec2, way: DVec2, separation_mm: &dyn Fn(DVec2) -> f64) -> DVec2 {
    let own = separation_mm(from);
    let nearer = |distance: f64, _: usize| 0.5 * (own + separation_mm(from + way * distance));
    from + way * (0..SEED_ROUNDS).fold(own, nearer)
}

/// Rounds of [`next_seed`]. Source: derived. Where the separation grows by half a mm a mm, each round leaves a quarter of the
/// error, and four a quarter of a per cent.
const SEED_ROUNDS: usize = 4;

/// Cuts a line where it passes itself at less than `d_mm`, as a spiral into a centre
/// does.
fn cut_at_itself(line: TracedLine, d_mm: f64) -> TracedLine {
    if line.closed || line.points.len() < 8 {
        return line;
    }
    let Some(bounds) = Bounds2::around_points(line.points.iter().copied()) else { return line };
    let mut near = PointGrid2::new(bounds, d_mm);
    let mut waiting: VecDeque<(DVec2, f64)> = VecDeque::new();
    let mut length = 0.0;
    for (k, &p) in line.points.iter().enumerate() {
        if k > 0 {
            length += p.distance(line.points[k - 1]);
        }
        // The latest stretch of the line is always near its end. A point therefore counts only once
        // the line is three distances further on.
        while waiting.front().is_some_and(|w| length - w.1 > 3.0 * d_mm) {
            if let Some((q, _)) = waiting.pop_front() {
                near.insert(q, ());
            }
        }
        if near.within(p, d_mm).next().is_some() {
            return TracedLine { points: line.points[..k].to_vec(), closed: false };
        }
        waiting.push_back((p, length));
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{cross, sin};

    const SETTINGS: LineSettings = LineSettings { tolerance_mm: 1e-5, step_mm: 1.0, longest_mm: 1e3 };

    #[test]
    fn a_circle_closes_and_a_saddle_follows_its_hyperbola() {
        let around = |p: DVec2| DVec2::new(-p.y, p.x).try_normalize();
        let line = trace_line(DVec2::new(10.0, 0.0), &around, &|_, _| false, &SETTINGS);
        assert!(line.closed);
        assert!((line.length_mm() - std::f64::consts::TAU * 10.0).abs() < 0.5, "{}", line.length_mm());
        assert!(line.points.iter().all(|p| (p.length() - 10.0).abs() < 1e-3));
        let saddle = |p: DVec2| (p.length() < 20.0).then(|| DVec2::new(p.x, -p.y).normalize_or(DVec2::X));
        let line = trace_line(DVec2::new(2.0, 3.0), &saddle, &|_, _| false, &SETTINGS);
        assert!(line.points.iter().all(|p| (p.x * p.y - 6.0).abs() < 1e-2));
        assert!(line.points[0].length() > 19.9 && line.points[line.points.len() - 1].length() > 19.9);
    }

    /// Lines that are shorter are left out, wherever they end. Nothing below is needed to hold them.
    fn spaced(separation_mm: &dyn Fn(DVec2) -> f64, end_share: f64, shortest_mm: f64) -> Seeding<'_> {
        Seeding {
            separation_mm,
            end_share,
            shortest_mm,
            shortest_across_mm: shortest_mm,
            seed_share: FOUND_SHARE,
            whole: false,
            is_held: &|_| true,
        }
    }

    /// Lines across a strip of this size, sorted by their places along it.
    fn lines_across(length_mm: f64, width_mm: f64, separation_mm: &dyn Fn(DVec2) -> f64) -> Vec<f64> {
        let bounds = Bounds2 { min: DVec2::ZERO, max: DVec2::new(length_mm, width_mm) };
        let axis = |p: DVec2| (p.clamp(bounds.min, bounds.max) == p).then_some(DVec2::Y);
        let seeding = Seeding { shortest_across_mm: 0.45, ..spaced(separation_mm, 0.55, 4.5) };
        let lines = evenly_spaced(&[bounds.centre()], bounds, &axis, &seeding, &SETTINGS);
        let mut at: Vec<f64> = lines.iter().map(|line| line.points[0].x).collect();
        at.sort_by(f64::total_cmp);
        at
    }

    #[test]
    fn a_strip_narrower_than_the_shortest_line_gets_lines_across() {
        let at = lines_across(40.0, 2.0, &|_| 3.0);
        assert!((12..=14).contains(&at.len()), "{at:?}");
    }

    #[test]
    fn distances_follow_a_separation_that_grows_or_shrinks_across_the_lines() {
        for grows in [true, false] {
            let separation = |p: DVec2| 1.0 + if grows { p.x } else { 60.0 - p.x } / 30.0;
            let at = lines_across(60.0, 20.0, &separation);
            assert!(at.len() > 25, "{at:?}");
            for w in at.windows(2) {
                let asked = separation(DVec2::new(0.5 * (w[0] + w[1]), 0.0));
                let ratio = (w[1] - w[0]) / asked;
                assert!((0.9..1.1).contains(&ratio), "{ratio} of {asked} at {}", w[0]);
            }
        }
    }

    #[test]
    fn evenly_spaced_lines_are_neither_near_nor_far() {
        let bounds = Bounds2 { min: DVec2::ZERO, max: DVec2::new(40.0, 30.0) };
        let axis = |p: DVec2| {
            let inside = p.cmpge(bounds.min).all() && p.cmple(bounds.max).all();
            inside.then(|| DVec2::new(1.0, 0.02 * (p.x - 20.0)).normalize())
        };
        let separation = |_| 2.0;
        let seeding = spaced(&separation, 0.6, 3.0);
        let lines = evenly_spaced(&[bounds.centre()], bounds, &axis, &seeding, &SETTINGS);
        assert!((12..=20).contains(&lines.len()), "{}", lines.len());
        for (i, a) in lines.iter().enumerate() {
            for b in &lines[i + 1..] {
                for (p, q) in a.points.iter().flat_map(|p| b.points.iter().map(move |q| (p, q))) {
                    assert!(p.distance(*q) > 1.1, "{p} {q}");
                }
                for w in a.points.windows(2) {
                    for v in b.points.windows(2) {
                        let (d, e) = (w[1] - w[0], v[1] - v[0]);
                        let sides =
                            |o: DVec2, d: DVec2, p: DVec2, q: DVec2| cross(d, p - o) * cross(d, q - o);
                        assert!(sides(w[0], d, v[0], v[1]) > 0.0 || sides(v[0], e, w[0], w[1]) > 0.0);
                    }
                }
            }
        }
    }

    #[test]
    fn lines_that_start_on_something_end_where_they_leave_it() {
        let bounds = Bounds2 { min: DVec2::ZERO, max: DVec2::new(40.0, 12.0) };
        let axis = |p: DVec2| (p.clamp(bounds.min, bounds.max) == p).then_some(DVec2::X);
        // Something lies below the left half of the two lower lines.
        let is_held = |p: DVec2| p.x < 20.0 && p.y < 6.0;
        let seeding = Seeding { is_held: &is_held, ..spaced(&|_| 3.0, 0.5, 3.0) };
        let seeds = [1.5, 4.5, 7.5].map(|y| DVec2::new(5.0, y));
        let lines = evenly_spaced(&seeds, bounds, &axis, &seeding, &SETTINGS);
        for line in &lines[..2] {
            let ends = [line.points[0].x, line.points[line.points.len() - 1].x];
            assert!(ends[0] < 0.1 && (ends[1] - 20.0).abs() < 0.01, "{ends:?}");
        }
        // The others lie on nothing, or start beside what is held, and run on to the border.
        assert!(lines[2].length_mm() > 39.0, "{}", lines[2].length_mm());
        let beside = |line: &TracedLine| line.points.iter().all(|p| p.x > 20.0 && p.y < 6.0);
        assert_eq!(lines.iter().filter(|line| beside(line) && line.length_mm() > 15.0).count(), 2);
    }

    #[test]
    fn lines_do_not_move_with_a_border_that_they_meet_aslant() {
        // A border that moves by 1e-3 mm moves the end of a line that meets it at a small angle by much more.
        for turn in [2.0, 8.0, 21.0, 35.0, 38.0] {
            let lines = |moved_mm: f64| {
                let bounds = Bounds2 { min: DVec2::ZERO, max: DVec2::new(160.0, 20.0) };
                let axis = |p: DVec2| {
                    let inside = p.cmpge(bounds.min).all() && p.cmple(bounds.max).all();
                    let rise = 0.03 * sin(0.05 * p.x + turn) + 0.003 * (p.y - 8.0);
                    let is_below = p.y < 10.0 + 0.06 * p.x + moved_mm;
                    (inside && is_below).then(|| DVec2::new(1.0, rise).normalize())
                };
                let seeding = spaced(&|_| 3.0, 0.125, 1.0);
                let settings = LineSettings { tolerance_mm: 0.005, step_mm: 0.4, longest_mm: 1e3 };
                evenly_spaced(&[DVec2::new(80.0, 10.0)], bounds, &axis, &seeding, &settings)
            };
            let (first, second) = (lines(0.0), lines(1e-3));
            assert!(first.len() > 4 && first.len() == second.len(), "{} {}", first.len(), second.len());
            for (a, b) in first.iter().zip(&second) {
                let middle = a.points[a.points.len() / 2];
                let to_b = |w: &[DVec2]| crate::segment::distance_squared_mm2(middle, w[0], w[1]);
                let apart_mm = b.points.windows(2).map(to_b).fold(f64::INFINITY, f64::min).sqrt();
                assert!(apart_mm < 1e-5, "{turn}, {middle}: {apart_mm}");
            }
        }
    }
}
