//! Pairs the points of two contours.
//!
//! There are two methods, both for closed contours of the same winding:
//! - [`dynamic`]: the cheapest cyclic pairing over the distance of points and the angle between the contours' directions, by
//!   dynamic programming (`fuchs1977` in docs/references.bib). Every point has a partner and the order is kept; a point may
//!   have several partners. Time and memory grow with the product of the numbers of points, so contours of more than 700
//!   points are thinned first.
//! - [`by_features`]: feature points (corners by signed curvature) are paired first and the points between two of them by
//!   number, point `i` with point `[i n / m]`, as published (`tan2020`). Linear time, but a corner that appears on one side
//!   only pulls its neighbours along.

use grainpath_core::math::{atan2, cross};
use grainpath_core::poly::{edges, perimeter_mm, simplify_contour};
use grainpath_core::{Contour, DVec2};

use super::trace::simplified_in_place;

/// Two contours with the same number of points; points of equal index belong together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pairing {
    /// Points of the lower contour; some occur twice.
    pub from: Contour,
    /// Points of the upper contour; some occur twice.
    pub to: Contour,
}

impl Pairing {
    /// The contour interpolated between the lower one (`t` = 0) and the upper one (`t` = 1).
    pub(super) fn at(&self, t: f64) -> Contour {
        self.from.iter().zip(&self.to).map(|(p, q)| p.lerp(*q, t)).collect()
    }
}

/// Limit on the points of a contour that are matched. Source: derived. The table of steps has one byte for each
/// pair of points, 0.5 MB at the limit. Longer contours are thinned, so their details below perimeter / 700 are
/// lost.
const MAX_POINTS: f64 = 700.0;

/// The contour resampled with points at most `step_mm` apart; its corners are kept.
fn dense(contour: &Contour, step_mm: f64) -> Contour {
    let step = step_mm.max(perimeter_mm(contour) / MAX_POINTS);
    // Details below a twentieth of the step are grid rounding; they cost time and add no shape.
    let simple = simplified_in_place(contour, 0.05 * step);
    let simple = if simple.len() > 2 { &simple } else { contour };
    let mut out = Contour::new();
    for (a, b) in edges(simple) {
        let n = (a.distance(b) / step).ceil().max(1.0) as usize;
        out.extend((0..n).map(|k| a.lerp(b, k as f64 / n as f64)));
    }
    out
}

/// The closest pair of points at which both contours run the same way.
fn anchor(p: &[DVec2], q: &[DVec2], shift: DVec2) -> (usize, usize) {
    let way =
        |c: &[DVec2], i: usize| (c[(i + 1) % c.len()] - c[(i + c.len() - 1) % c.len()]).normalize_or_zero();
    let mut best = (f64::INFINITY, 0, 0);
    // A sample of 64 points finds a close pair, if not the closest; dynamic programming corrects the rest.
    let stride = (p.len() / 64).max(1);
    for i in (0..p.len()).step_by(stride) {
        let along = way(p, i);
        for (j, b) in q.iter().enumerate() {
            let d = (p[i] + shift).distance_squared(*b);
            if d < best.0 {
                // A pair that runs the opposite way counts twice its squared distance; otherwise the two
                // sides of a thin wall would be paired.
                let cost = d * (1.5 - 0.5 * along.dot(way(q, j))) + 1e-12;
                if cost < best.0 {
                    best = (cost, i, j);
                }
            }
        }
    }
    (best.1, best.2)
}

/// Pairs two contours of the same winding by dynamic programming (`fuchs1977`): the path through all
/// pairs, forward on both contours, with the least sum of squared distances and of differences in
/// direction. Points lie at most `step_mm` apart. Where the contours do not overlap, `shift` moves the
/// first over the second.
pub(super) fn dynamic(lower: &Contour, upper: &Contour, step_mm: f64, shift: DVec2) -> Pairing {
    let (p, q) = (dense(lower, step_mm), dense(upper, step_mm));
    let (i0, j0) = anchor(&p, &q, shift);
    let (n, m) = (p.len(), q.len());
    let turned =
        |c: &[DVec2], k: usize| -> Vec<DVec2> { (0..=c.len()).map(|i| c[(i + k) % c.len()]).collect() };
    // The cyclic pairing is cut open at the anchor, so both contours begin and end at their anchor point.
    let (p, q) = (turned(&p, i0), turned(&q, j0));
    let ways = |c: &[DVec2]| -> Vec<DVec2> {
        let n = c.len() - 1;
        (0..=n).map(|i| (c[(i + 1) % n] - c[(i + n - 1) % n]).normalize_or_zero()).collect()
    };
    let (along_p, along_q) = (ways(&p), ways(&q));
    // A right angle between directions costs as much as a distance of two steps.
    let weight = 4.0 * step_mm * step_mm;
    let cost = |i: usize, j: usize| {
        (p[i] + shift).distance_squared(q[j]) + weight * (1.0 - along_p[i].dot(along_q[j]))
    };
    // Steps: 1 forward on p, 2 forward on q, 3 forward on both.
    let mut steps = vec![0u8; (n + 1) * (m + 1)];
    // One row of costs suffices, because a pair depends only on the row before. The steps of all rows are stored, because
    // the path is traced back through them.
    let mut row = vec![0.0; m + 1];
    row[0] = cost(0, 0);
    for j in 1..=m {
        row[j] = row[j - 1] + cost(0, j);
        steps[j] = 2;
    }
    for i in 1..=n {
        let mut diagonal = row[0];
        row[0] += cost(i, 0);
        steps[i * (m + 1)] = 1;
        for j in 1..=m {
            let (up, left) = (row[j], row[j - 1]);
            let c = cost(i, j);
            // A step on both contours replaces two single steps, so its pair counts one and a half times.
            // Counted once, it would always win; counted twice, it would gain nothing.
            let (best, step) = [(diagonal + 1.5 * c, 3), (up + c, 1), (left + c, 2)]
                .into_iter()
                .fold((f64::INFINITY, 0), |best, s| if s.0 < best.0 { s } else { best });
            row[j] = best;
            steps[i * (m + 1) + j] = step;
            diagonal = up;
        }
    }
    // The path is traced back from the end along the stored steps.
    let (mut i, mut j) = (n, m);
    let mut out = Pairing { from: Vec::new(), to: Vec::new() };
    while i > 0 || j > 0 {
        out.from.push(p[i]);
        out.to.push(q[j]);
        let step = steps[i * (m + 1) + j];
        i -= usize::from(step & 1);
        j -= usize::from(step >> 1 & 1);
    }
    out.from.reverse();
    out.to.reverse();
    out
}

/// Conditions for a feature point of a contour, as in the paper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Features {
    /// Least magnitude of the signed curvature, as a multiple of the contour's mean.
    pub curvature: f64,
    /// Least length of the edges on both sides, mm. It keeps a single jagged pixel from counting as a
    /// corner.
    pub min_edge_mm: f64,
}

/// Signed curvature at every point, 1/mm: the turning angle over the length, positive to the left. The
/// sign is that of the cross product of the two edges.
fn curvatures(c: &[DVec2]) -> Vec<f64> {
    let n = c.len();
    (0..n)
        .map(|i| {
            let (a, b) = (c[i] - c[(i + n - 1) % n], c[(i + 1) % n] - c[i]);
            let length = 0.5 * (a.length() + b.length());
            if length > 0.0 { atan2(cross(a, b), a.dot(b)) / length } else { 0.0 }
        })
        .collect()
}

/// Indices and curvatures of the feature points, in order.
pub(super) fn feature_points(contour: &[DVec2], settings: Features) -> Vec<(usize, f64)> {
    let k = curvatures(contour);
    let n = contour.len();
    let mean = k.iter().map(|v| v.abs()).sum::<f64>() / n.max(1) as f64;
    let edge = |i: usize| contour[i].distance(contour[(i + 1) % n]);
    let long = |i: usize| edge(i) >= settings.min_edge_mm && edge((i + n - 1) % n) >= settings.min_edge_mm;
    (0..n).filter(|&i| k[i].abs() > settings.curvature * mean && long(i)).map(|i| (i, k[i])).collect()
}

/// Pairs two contours as the paper does. Feature points are matched by position and signed curvature; the
/// points between two of them are paired by number, `[i n/m]`.
pub(super) fn by_features(
    lower: &Contour,
    upper: &Contour,
    step_mm: f64,
    features: Features,
    shift: DVec2,
) -> Pairing {
    // Feature points need edges longer than a pixel, so they are sought on a coarser contour.
    let coarse = |c: &Contour| {
        let simple = simplify_contour(c, 0.35 * step_mm);
        if simple.len() > 2 { simple } else { c.clone() }
    };
    let (p, q) = (dense(lower, step_mm), dense(upper, step_mm));
    // Every point of the coarse contour is also a point of the fine one, which gives its index there.
    let found = |fine: &Contour| -> Vec<(usize, f64)> {
        let rough = coarse(fine);
        let place = |at: DVec2| fine.iter().position(|p| *p == at);
        let mut all: Vec<(usize, f64)> = feature_points(&rough, features)
            .into_iter()
            .filter_map(|(i, k)| Some((place(rough[i])?, k)))
            .collect();
        all.sort_by_key(|f| f.0);
        all
    };
    let (fp, fq) = (found(&p), found(&q));
    let mut marks = match_features(&p, &fp, &q, &fq, step_mm, shift);
    // Circles have no corners; such contours are cut open at one close pair of points.
    if marks.is_empty() {
        let (i, j) = anchor(&p, &q, shift);
        marks.push((i, j));
    }
    let mut out = Pairing { from: Vec::new(), to: Vec::new() };
    for (k, &(i, j)) in marks.iter().enumerate() {
        let (i_end, j_end) = marks[(k + 1) % marks.len()];
        let a = fragment(&p, i, i_end, step_mm);
        let b = fragment(&q, j, j_end, step_mm);
        let n = a.len().max(b.len());
        for s in 0..n {
            out.from.push(a[s * a.len() / n]);
            out.to.push(b[s * b.len() / n]);
        }
    }
    out
}

/// The points from `i` up to `end`, evenly spaced; the range may wrap around the start of the contour.
fn fragment(c: &[DVec2], i: usize, end: usize, step_mm: f64) -> Vec<DVec2> {
    let n = c.len();
    let count = if end > i { end - i } else { end + n - i };
    let mut out = Vec::new();
    for k in 0..count {
        let (a, b) = (c[(i + k) % n], c[(i + k + 1) % n]);
        let pieces = (a.distance(b) / step_mm).ceil().max(1.0) as usize;
        out.extend((0..pieces).map(|s| a.lerp(b, s as f64 / pieces as f64)));
    }
    out
}

/// Pairs of feature points, in order around both contours.
fn match_features(
    p: &[DVec2],
    fp: &[(usize, f64)],
    q: &[DVec2],
    fq: &[(usize, f64)],
    step_mm: f64,
    shift: DVec2,
) -> Vec<(usize, usize)> {
    // A corner that moved by more than a twelfth of the perimeter counts as another corner.
    let reach = (perimeter_mm(p).min(perimeter_mm(q)) / 12.0).max(3.0 * step_mm);
    let mut all: Vec<(f64, usize, usize)> = Vec::new();
    for (a, &(i, kp)) in fp.iter().enumerate() {
        for (b, &(j, kq)) in fq.iter().enumerate() {
            let d = (p[i] + shift).distance(q[j]);
            // Curvatures of different sign are a convex and a concave corner.
            if d < reach && kp * kq > 0.0 {
                let bend = (kp - kq).abs() / (kp.abs() + kq.abs());
                all.push((d * (1.0 + bend), a, b));
            }
        }
    }
    all.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
    // The best pairs first. A pair that would cross those already taken is left out.
    let mut taken: Vec<(usize, usize)> = Vec::new();
    for (_, a, b) in all.into_iter().take(4000) {
        if taken.iter().any(|t| t.0 == a || t.1 == b) {
            continue;
        }
        let mut with = taken.clone();
        let at = with.partition_point(|t| t.0 < a);
        with.insert(at, (a, b));
        // In cyclic order the partners may decrease once, where the numbering begins again.
        let falls = (0..with.len()).filter(|&k| with[(k + 1) % with.len()].1 < with[k].1).count();
        if falls <= 1 {
            taken = with;
        }
    }
    taken.into_iter().map(|(a, b)| (fp[a].0, fq[b].0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::math::direction;
    use grainpath_core::poly::signed_area_mm2;

    fn circle(centre: DVec2, r: f64, n: usize) -> Contour {
        (0..n).map(|i| centre + r * direction(i as f64 / n as f64 * std::f64::consts::TAU)).collect()
    }

    fn star(scale: f64, turn: f64) -> Contour {
        (0..10)
            .map(|i| {
                let r = if i % 2 == 0 { 10.0 } else { 5.0 };
                scale * r * direction(turn + f64::from(i) / 10.0 * std::f64::consts::TAU)
            })
            .collect()
    }

    #[test]
    fn halfway_between_circles_is_a_circle() {
        for (a, b) in [(40, 170), (170, 40), (100, 100)] {
            let pairing = dynamic(
                &circle(DVec2::ZERO, 10.0, a),
                &circle(DVec2::new(1.0, 0.5), 14.0, b),
                0.4,
                DVec2::ZERO,
            );
            let middle = pairing.at(0.5);
            let area = signed_area_mm2(&middle);
            assert!((area / (std::f64::consts::PI * 144.0) - 1.0).abs() < 8e-3, "{area}");
            let off = |p: &DVec2| (p.distance(DVec2::new(0.5, 0.25)) - 12.0).abs();
            assert!(middle.iter().map(off).fold(0.0, f64::max) < 0.12);
        }
    }

    #[test]
    fn corners_go_to_corners() {
        let features = Features { curvature: 2.0, min_edge_mm: 0.5 };
        let (a, b) = (star(1.0, 0.0), star(1.2, 0.15));
        let truth = signed_area_mm2(&star(1.1, 0.0));
        for pairing in [
            dynamic(&a, &b, 0.4, DVec2::ZERO),
            by_features(&a, &b, 0.4, Features { curvature: 0.5, ..features }, DVec2::ZERO),
        ] {
            assert!((signed_area_mm2(&pairing.at(0.0)) / signed_area_mm2(&a) - 1.0).abs() < 1e-6);
            assert!((signed_area_mm2(&pairing.at(1.0)) / signed_area_mm2(&b) - 1.0).abs() < 1e-6);
            let area = signed_area_mm2(&pairing.at(0.5));
            assert!((area / truth - 1.0).abs() < 0.02, "{area} {truth}");
        }
        assert_eq!(feature_points(&a, Features { curvature: 0.5, min_edge_mm: 0.5 }).len(), 10);
        let signs = feature_points(&a, Features { curvature: 0.5, min_edge_mm: 0.5 });
        assert_eq!(signs.iter().filter(|s| s.1 < 0.0).count(), 5, "inner corners turn right");
    }
}
