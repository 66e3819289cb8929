//! Short straight beads in the voids that lines and single beads leave open.
//!
//! Where lines meet the border at a slant, where they part before a hole, and in corners of the region, voids are triangles.
//! The chords of a triangle's medial axis are short at its tips and longer than any bead at its widest place, so a single bead
//! along it is too short to be worth a start. A straight bead along the chords of another direction still fills most of it:
//!
//! ```text
//!    -----------------------------  border
//!     \ void |/       /
//!      \    /  bead  /
//!       \  /        /
//! ```
//!
//! Candidates begin and end on chords of the void, are there as wide as these, and have their middle inside the void, so they
//! cross no other bead. The one is laid that closes the most after what it lays outside of the void is taken off. Directions
//! are counted from the longest side of the void, so a void that is turned gets the same bead, turned.
//!
//! Lengths are in mm. Cost: [`N_WAYS`] times half the square of [`N_CHORDS`] candidates a void, about 800, each clipped from it in
//! four steps.

use std::f64::consts::PI;

use grainpath_core::math::{cross, direction, rotated};
use grainpath_core::poly::{Join, LineClipper, centroid, edges, signed_area_mm2};
use grainpath_core::units::{bead_spacing_mm, bead_width_mm};
use grainpath_core::{BeadWidth, DVec2, Polygon, Region, Toolpath};

use super::axis_of;
use crate::fill::FillContext;

/// Directions that are tried, over half a turn. Source: derived. No direction is more than 7.5 degrees from one of them, which
/// moves the corners of a bead as long as it is wide by a fifteenth of its width.
const N_WAYS: usize = 12;
/// Places along a direction at which a bead may begin and end. Source: derived. A void that gets a short bead is one to two beads
/// long, so its ends are placed to a sixth of a bead.
const N_CHORDS: usize = 12;
/// A bead across the field counts this share less than one along it. Source: measured on ten fields (`cargo xtask bench jobs
/// fields`, joined ends): with 0, 0.5 and 0.75 the beads of two charges lie 3.38, 3.35 and 3.35 degrees off, and 0.27, 0.27 and 0.32
/// squares of a bead stay open on the turned bar.
const ACROSS: f64 = 0.5;

/// Corners of voids stay sharp where slits are taken off. Source: as for rings in gaps ([`stripes`](super::stripes)).
const MITER: Join = Join::Miter(2.0);
/// Slits narrower than this tie voids together and get no bead, in spacings. Source: derived; less than a fifth of the strip of the
/// narrowest bead, which would lie twice over four fifths of itself.
const SLIT: f64 = 0.1;
/// A void gets a short straight bead from this size on, in squares as wide as a strip. Source: measured
/// on ten fields (`cargo xtask bench jobs fields`). It is half a square, less what the outside measure of a plan finds more; with
/// 0.4 no void is smaller, two charges get 8 such beads instead of 6, and a straight field 3 instead of 1.
const SHORT_VOID: f64 = 0.48;
/// A short straight bead closes at least this much more of a void than it lays outside of it, in squares as wide as a strip.
/// Source: measured on ten fields; with 0.2, a void of 0.56 squares stays open on the spiral, where 0.35 do with 0.1.
const LEAST_GAIN: f64 = 0.1;

/// A straight bead whose strip changes evenly from end to end.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ShortBead {
    ends: [DVec2; 2],
    /// Widths of the strip at both ends.
    strips_mm: [f64; 2],
    /// What the bead closes, less what it lays outside of the void.
    gain_mm2: f64,
}

/// Short straight beads in what stays open beside ends of lines and where single beads along a medial axis are too short.
///
/// Beads are from `narrowest_mm` to `widest_mm` wide, and no narrower than the job allows.
pub(super) fn short_beads(
    open: &Region,
    narrowest_mm: f64,
    widest_mm: f64,
    context: &FillContext<'_>,
) -> Vec<Toolpath> {
    let (nominal, h) = (context.bead_width_mm, context.height_mm);
    let strips_mm = [narrowest_mm.max(context.min_bead_width_mm), widest_mm].map(|mm| bead_spacing_mm(mm, h));
    if strips_mm[0] > strips_mm[1] {
        return Vec::new();
    }
    let square_mm2 = context.spacing_mm() * context.spacing_mm();
    let half_slit_mm = 0.5 * SLIT * context.spacing_mm();
    let mut out = Vec::new();
    for void in &open.polygons {
        let mut open_mm2 = void.area_mm2();
        if open_mm2 < SHORT_VOID * square_mm2 {
            continue;
        }
        let mut pieces =
            Region::from(void.clone()).offset(-half_slit_mm, MITER).offset(half_slit_mm, MITER).polygons;
        pieces.sort_by(|a, b| b.area_mm2().total_cmp(&a.area_mm2()));
        for piece in pieces {
            if open_mm2 < SHORT_VOID * square_mm2 {
                break;
            }
            let axis =
                context.field.map_or(DVec2::ZERO, |field| axis_of(field, context, centroid(&piece.outer)));
            let Some(bead) =
                best_bead(&piece, axis, strips_mm).filter(|b| b.gain_mm2 > LEAST_GAIN * square_mm2)
            else {
                continue;
            };
            open_mm2 -= bead.gain_mm2;
            let widths = bead.strips_mm.map(|mm| bead_width_mm(mm, h)).to_vec();
            out.push(Toolpath {
                width: BeadWidth::PerVertex(widths),
                ..Toolpath::new(bead.ends.to_vec(), nominal, context.role, false)
            });
        }
    }
    out
}

/// The bead that closes most of a void, with a strip from `least_mm` to `most_mm` wide, and at least as long as `least_mm`.
/// `axis` is that of the field.
fn best_bead(void: &Polygon, axis: DVec2, [least_mm, most_mm]: [f64; 2]) -> Option<ShortBead> {
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
                if way.length_squared() < least_mm * least_mm {
                    continue;
                }
                let strips_mm = [start, end].map(|[p, q]| p.distance(*q).clamp(least_mm, most_mm));
                let strip = strip(ends, strips_mm);
                let gain_mm2 = 2.0 * common_mm2(void, &strip) - signed_area_mm2(&strip);
                let sine = cross(axis, way.normalize_or_zero());
                let score = gain_mm2 * (1.0 - ACROSS * sine * sine);
                if score > best.0 && inside.segment_inside(ends[0], ends[1]) {
                    best = (score, Some(ShortBead { ends, strips_mm, gain_mm2 }));
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

/// The four corners of a straight bead's strip, counter-clockwise.
fn strip([a, b]: [DVec2; 2], [at_a, at_b]: [f64; 2]) -> [DVec2; 4] {
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
        let clipped = Region::from(void.clone()).intersection(&Region::from_contours(
            &[square.to_vec()],
            grainpath_core::poly::FillRule::NonZero,
        ));
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
                let bead = best_bead(&void, axis, [0.26, 0.72]).expect("a bead");
                let strip = strip(bead.ends, bead.strips_mm);
                let [closed, laid] = [common_mm2(&void, &strip), signed_area_mm2(&strip)];
                println!("turned by {by_rad}: {closed:.3} of {:.3} mm2 for {laid:.3}", void.area_mm2());
                assert!((closed - (laid - closed) - bead.gain_mm2).abs() < 1e-12);
                // Measured: from 0.59 on; beads along the axis count more.
                assert!(closed > 0.5 * void.area_mm2() && laid - closed < 0.2 * void.area_mm2());
                assert!(bead.strips_mm.iter().all(|mm| (0.26..=0.72).contains(mm)));
            }
        }
    }

    #[test]
    fn voids_too_small_for_a_bead_get_none() {
        let sliver = polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 0.05]], 0.0);
        let short = polygon(&[[0.0, 0.0], [0.2, 0.0], [0.0, 0.2]], 0.0);
        let flat = polygon(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], 0.0);
        for void in [sliver, short, flat, Polygon { outer: Vec::new(), holes: Vec::new() }] {
            assert_eq!(best_bead(&void, DVec2::X, [0.26, 0.72]), None);
        }
    }
}
