//! The straight strip that closes most of a void between beads.
//!
//! Candidates begin and end on chords of the void, are there as wide as these, and have their middle inside the void, so that a
//! bead in their place crosses no other. Directions are counted from the longest side of the void, so a void that is turned gets
//! the same strip, turned.
//!
//! Lengths are in mm. Cost: [`N_WAYS`] times half the square of [`N_CHORDS`] candidates, about 800, each clipped from the void in
//! four steps.

use std::f64::consts::PI;

use glam::DVec2;

use super::{LineClipper, Polygon, Region, edges, signed_area_mm2};
use crate::math::{cross, direction, rotated};

/// Directions that are tried, over half a turn. Source: derived. No direction is more than 7.5 degrees from one of them, which
/// moves the corners of a bead as long as it is wide by a fifteenth of its width.
const N_WAYS: usize = 12;
/// Places along a direction at which a bead may begin and end. Source: derived. A void that gets a short bead is one to two beads
/// long, so its ends are placed to a sixth of a bead.
const N_CHORDS: usize = 12;
/// A strip across the axis counts this share less than one along it. Source: measured on ten fields (`cargo xtask bench jobs
/// fields`, joined ends): with 0, 0.5 and 0.75 the beads of two charges lie 3.38, 3.35 and 3.35 degrees off, and 0.27, 0.27 and 0.32
/// squares of a bead stay open on the turned bar.
const ACROSS: f64 = 0.5;

/// A straight strip whose width changes evenly from end to end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StraightStrip {
    /// The ends of its middle line, mm.
    pub ends: [DVec2; 2],
    /// Its widths at both ends, mm.
    pub widths_mm: [f64; 2],
    /// What it closes of the void, less what it covers outside of it.
    pub gain_mm2: f64,
}

/// The straight strip that closes most of a void: the area that both have in common, less what the strip covers outside of the
/// void, counts; across `axis` it counts half. The strip is from `least_mm` to `most_mm` wide and at least `least_mm` long, and
/// its middle lies inside the void. `None` where no strip closes more than it covers outside.
///
/// ```
/// use grainpath_core::poly::straight_strip;
/// use grainpath_core::{DVec2, Polygon};
///
/// let outer = [(0.0, 0.0), (0.8, 0.0), (0.4, 0.4)].map(DVec2::from).to_vec();
/// let strip = straight_strip(&Polygon { outer, holes: Vec::new() }, DVec2::X, [0.2, 0.7]).unwrap();
/// assert!((0.08..0.16).contains(&strip.gain_mm2), "most of 0.16 mm2: {}", strip.gain_mm2);
/// ```
pub fn straight_strip(void: &Polygon, axis: DVec2, [least_mm, most_mm]: [f64; 2]) -> Option<StraightStrip> {
    let sides = void.contours().flat_map(|c| edges(c));
    let longest = sides.max_by(|a, b| a.0.distance_squared(a.1).total_cmp(&b.0.distance_squared(b.1)));
    let first = longest.and_then(|(a, b)| (b - a).try_normalize())?;
    let inside = LineClipper::new(&Region::from(void.clone()));
    let mut best = (0.0, None);
    for k in 0..N_WAYS {
        let along = rotated(first, direction(PI * k as f64 / N_WAYS as f64));
        let chords = chords(void, along);
        for (i, start) in chords.iter().enumerate() {
            for end in &chords[i + 1..] {
                let ends = [start, end].map(|[p, q]| 0.5 * (*p + *q));
                let way = ends[1] - ends[0];
                // A strip shorter than it is wide lies across the direction that is tried.
                if way.length_squared() < least_mm * least_mm {
                    continue;
                }
                let widths_mm = [start, end].map(|[p, q]| p.distance(*q).clamp(least_mm, most_mm));
                let strip = corners(ends, widths_mm);
                let gain_mm2 = 2.0 * common_mm2(void, &strip) - signed_area_mm2(&strip);
                let sine = cross(axis, way.normalize_or_zero());
                let score = gain_mm2 * (1.0 - ACROSS * sine * sine);
                if score > best.0 && inside.segment_inside(ends[0], ends[1]) {
                    best = (score, Some(StraightStrip { ends, widths_mm, gain_mm2 }));
                }
            }
        }
    }
    best.1
}

/// The longest chords of a void across a direction, at even steps along it.
fn chords(void: &Polygon, along: DVec2) -> Vec<[DVec2; 2]> {
    let across = along.perp();
    let ahead = || void.outer.iter().map(|p| p.dot(along));
    let (low, high) = (ahead().fold(f64::INFINITY, f64::min), ahead().fold(f64::NEG_INFINITY, f64::max));
    let chord = |k: usize| {
        let at = low + (high - low) * (k as f64 + 0.5) / N_CHORDS as f64;
        let mut crossed: Vec<f64> = Vec::new();
        for (a, b) in void.contours().flat_map(|c| edges(c)) {
            let (from, to) = (a.dot(along), b.dot(along));
            if (from < at) != (to < at) {
                crossed.push(a.lerp(b, (at - from) / (to - from)).dot(across));
            }
        }
        crossed.sort_by(f64::total_cmp);
        let longest = crossed.chunks_exact(2).max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))?;
        Some([longest[0], longest[1]].map(|side| at * along + side * across))
    };
    (0..N_CHORDS).filter_map(chord).collect()
}

/// The four corners of a strip, counter-clockwise.
fn corners([a, b]: [DVec2; 2], [at_a, at_b]: [f64; 2]) -> [DVec2; 4] {
    let left = (b - a).normalize_or(DVec2::X).perp();
    let (p, q) = (0.5 * at_a * left, 0.5 * at_b * left);
    [a - p, b - q, b + q, a + p]
}

/// The area that a polygon and a convex contour have in common. The contour runs counter-clockwise.
fn common_mm2(polygon: &Polygon, convex: &[DVec2]) -> f64 {
    // Each contour is cut at one side of the convex one after the other. What then lies on a cut encloses no area.
    let common = |contour: &[DVec2]| {
        let mut left = contour.to_vec();
        for (a, b) in edges(convex) {
            let inside = |p: DVec2| cross(b - a, p - a);
            let mut cut = Vec::with_capacity(left.len() + 2);
            for (p, q) in edges(&left) {
                let (at_p, at_q) = (inside(p), inside(q));
                if at_p >= 0.0 {
                    cut.push(p);
                }
                if (at_p >= 0.0) != (at_q >= 0.0) {
                    cut.push(p.lerp(q, at_p / (at_p - at_q)));
                }
            }
            left = cut;
        }
        signed_area_mm2(&left)
    };
    polygon.contours().map(|c| common(c)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(outer: &[[f64; 2]], by_rad: f64) -> Polygon {
        let turned = |&p: &[f64; 2]| rotated(DVec2::from(p), direction(by_rad));
        Polygon { outer: outer.iter().map(turned).collect(), holes: Vec::new() }
    }

    #[test]
    fn common_area_is_that_of_clipping_also_where_a_polygon_is_not_convex() {
        let u =
            [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [2.0, 2.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let square = [DVec2::new(0.5, 0.5), DVec2::new(2.5, 0.5), DVec2::new(2.5, 1.5), DVec2::new(0.5, 1.5)];
        let void = polygon(&u, 0.0);
        let clipped = Region::from(void.clone())
            .intersection(&Region::from_contours(&[square.to_vec()], crate::poly::FillRule::NonZero));
        assert!((common_mm2(&void, &square) - clipped.area_mm2()).abs() < 1e-6);
        let far = square.map(|p| p + DVec2::splat(5.0));
        assert_eq!(common_mm2(&void, &far), 0.0);
    }

    /// Between the flat ends of slanting lines and the border, with sides of 0.53 mm at the border's angle of 40 degrees.
    #[test]
    fn half_of_a_triangle_is_closed_whichever_way_it_is_turned() {
        for triangle in [[[0.0, 0.0], [0.83, 0.0], [0.35, 0.41]], [[0.0, 0.0], [0.6, 0.0], [0.0, 0.6]]] {
            for by_rad in [0.0, 0.3, 1.1, 2.0, 3.0] {
                let void = polygon(&triangle, by_rad);
                let axis = direction(by_rad + 0.7);
                let bead = straight_strip(&void, axis, [0.26, 0.72]).expect("a bead");
                let strip = corners(bead.ends, bead.widths_mm);
                let [closed, laid] = [common_mm2(&void, &strip), signed_area_mm2(&strip)];
                println!("turned by {by_rad}: {closed:.3} of {:.3} mm2 for {laid:.3}", void.area_mm2());
                assert!((closed - (laid - closed) - bead.gain_mm2).abs() < 1e-12);
                // Measured: from 0.59 on; beads along the axis count more.
                assert!(closed > 0.5 * void.area_mm2() && laid - closed < 0.2 * void.area_mm2());
                assert!(bead.widths_mm.iter().all(|mm| (0.26..=0.72).contains(mm)));
            }
        }
    }

    #[test]
    fn voids_too_small_for_a_bead_get_none() {
        let sliver = polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 0.05]], 0.0);
        let short = polygon(&[[0.0, 0.0], [0.2, 0.0], [0.0, 0.2]], 0.0);
        let flat = polygon(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], 0.0);
        for void in [sliver, short, flat, Polygon { outer: Vec::new(), holes: Vec::new() }] {
            assert_eq!(straight_strip(&void, DVec2::X, [0.26, 0.72]), None);
        }
    }
}
