//! Finds which side of a photographed rectangle is its width.
//!
//! Four corners in a photograph give the position of a board, but several rotations are possible. If the
//! ratio of its sides is known beforehand, it decides between them. The ratio follows from the four
//! corners for a pinhole camera with square pixels and its axis through the middle of the picture (Zhang
//! and He 2007, *Whiteboard scanning and image enhancement*, section 3.2). Of the two rotations, the one
//! whose ratio fits the given size is taken. Where neither fits, the size is wrong or another object was
//! found, and the photograph is refused. A half turn goes unnoticed; of the two possible first corners,
//! the one nearer to the picture's upper left is taken.
//!
//! Cost is constant. If one pair of sides is parallel in the picture, the focal length is undetermined. It is then
//! taken as `USUAL_FOCAL`; the error is small, because such a view has little perspective.
//!
//! ```text
//!        a--------b           portrait photograph of a landscape board:
//!       /          \            corners as found   a b c d, width/height 0.4
//!      d------------c           size_mm = [100, 40] -> corners turned: d a b c
//! ```

use grainpath_core::math::{cross, ln};
use grainpath_core::{DVec2, DVec3};

use super::corners::CornersNotFound;

/// Focal length of a usual camera, as a share of the picture's diagonal. Source: 26 to 28 mm in 35 mm film terms (43.3 mm
/// diagonal), the main camera of current telephones.
const USUAL_FOCAL: f64 = 0.62;
/// Range of credible focal lengths, in the same share. A value outside it comes from noise or from a cropped picture.
/// Source: 13 mm (the widest camera of a telephone) to 200 mm as 35 mm equivalent.
const FOCAL_RANGE: [f64; 2] = [0.3, 4.6];
/// Factor by which the ratio of sides found may differ from the given one. Measured:
/// `the_ratio_of_a_board_comes_out_from_every_side` looks at boards of 2:1 to 4:1 from 108 camera positions tilted by
/// up to 45 degrees. With the usual focal length ratios come out within 1.03; with twice that focal length they are off
/// by up to 1.26, in views where one pair of sides is parallel in the picture and the focal length cannot be found.
pub const RATIO_TOLERANCE: f64 = 1.35;
/// Below this ratio of the sides, it is uncertain which side is the longer one: the error of the
/// ratio (see `RATIO_TOLERANCE`) would decide.
const NEARLY_SQUARE: f64 = 1.15;

/// The corners of a board, ordered by its known size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oriented {
    /// Upper left, upper right, lower right, lower left of the board, px; a half turn is not resolved.
    pub corners: [DVec2; 4],
    /// Whether the rotation is a guess, because the board is nearly square.
    pub is_guess: bool,
}

/// How much wider or narrower for its height than `size_mm` a rectangle is whose corners appear at `corners` (clockwise as
/// seen, rows downwards) in a picture of `size_px`: a factor of 1 or more.
///
/// ```
/// use grainpath_core::DVec2;
/// use grainpath_imaging::photo::width_side::stretched;
///
/// let corners = [(0.0, 0.0), (900.0, 0.0), (900.0, 300.0), (0.0, 300.0)].map(DVec2::from);
/// let off = stretched(corners, DVec2::new(30.0, 100.0), DVec2::new(900.0, 300.0));
/// assert!((off - 10.0).abs() < 1e-6);
/// ```
pub fn stretched(corners: [DVec2; 4], size_mm: DVec2, size_px: DVec2) -> f64 {
    let factor = side_ratio(corners, size_px) / (size_mm.x / size_mm.y);
    factor.max(factor.recip())
}

/// Ratio of width to height of the rectangle whose corners appear at `corners` (clockwise as seen, rows
/// downwards) in a picture of `size_px`.
pub(crate) fn side_ratio(corners: [DVec2; 4], size_px: DVec2) -> f64 {
    let diagonal = size_px.length();
    // Coordinates from the centre of the picture, in units of its diagonal.
    let point = |k: usize| ((corners[k] - 0.5 * size_px) / diagonal).extend(1.0);
    let [upper_left, upper_right, lower_right, lower_left] = [point(0), point(1), point(2), point(3)];
    // Section 3.2 of `ZhangHe2007`: scale factors of two corners, then the directions of the sides in
    // camera coordinates.
    let across = upper_left.cross(lower_right);
    let k_right = across.dot(lower_left) / upper_right.cross(lower_right).dot(lower_left);
    let k_down = across.dot(upper_right) / lower_left.cross(lower_right).dot(upper_right);
    let right = k_right * upper_right - upper_left;
    let down = k_down * lower_left - upper_left;
    // If one pair of sides is parallel in the picture, the product of the two depths is zero and the
    // focal length cancels.
    let vanishing = right.z * down.z;
    let focal = if vanishing.abs() > 1e-4 {
        // The sides of a rectangle are perpendicular, which fixes the focal length.
        let squared = -(right.x * down.x + right.y * down.y) / vanishing;
        squared.max(0.0).sqrt().clamp(FOCAL_RANGE[0], FOCAL_RANGE[1])
    } else {
        USUAL_FOCAL
    };
    let length = |v: DVec3| ((v.x * v.x + v.y * v.y) / (focal * focal) + v.z * v.z).sqrt();
    length(right) / length(down)
}

/// Rotates the list of corners so that the first two are the ends of a side of `size_mm.x`. It is given clockwise as
/// seen, with the corner nearest to the picture's upper left first.
///
/// # Errors
/// [`CornersNotFound::Ratio`] when the ratio of the sides fits neither turn.
pub fn oriented(corners: [DVec2; 4], size_mm: DVec2, size_px: DVec2) -> Result<Oriented, CornersNotFound> {
    let found = side_ratio(corners, size_px);
    let asked = size_mm.x / size_mm.y;
    // Ratios are compared by their logarithms, so that 2 : 1 and 1 : 2 are equally far from 1 : 1.
    let off = |ratio: f64| ln(ratio / asked).abs();
    let (as_found, turned) = (off(found), off(1.0 / found));
    if as_found.min(turned) > ln(RATIO_TOLERANCE) {
        return Err(CornersNotFound::Ratio { found: found.max(1.0 / found), asked: asked.max(1.0 / asked) });
    }
    let is_guess = ln(asked).abs() < ln(NEARLY_SQUARE);
    let mut corners = corners;
    if turned < as_found && !is_guess {
        // Of the two possible quarter turns, this takes the one whose first corner is nearer to the
        // upper left of the picture.
        let distance = |c: DVec2| c.x + c.y;
        let quarter = if distance(corners[1]) < distance(corners[3]) { 1 } else { 3 };
        corners.rotate_left(quarter);
    }
    debug_assert!(cross(corners[2] - corners[0], corners[3] - corners[1]) >= 0.0);
    Ok(Oriented { corners, is_guess })
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::math::{direction, rotated, sin_cos};

    const PICTURE: DVec2 = DVec2::new(1200.0, 900.0);

    /// Corners of a board of this size (mm), turned in its plane, tilted about an axis in the picture, seen by a camera of
    /// this focal length in diagonals: in the board's own order.
    fn seen(size: DVec2, turn: f64, tilt: f64, axis: f64, focal: f64) -> [DVec2; 4] {
        let (s, c) = sin_cos(tilt.to_radians());
        let axis = direction(axis.to_radians());
        let across = DVec2::new(-axis.y, axis.x);
        let focal_px = focal * PICTURE.length();
        let distance = focal_px * size.length() / 700.0;
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| {
            let p = rotated(0.5 * size * DVec2::new(x, y), direction(turn.to_radians()));
            let (along, off) = (p.dot(axis), p.dot(across));
            0.5 * PICTURE + focal_px * (along * axis + c * off * across) / (distance + s * off)
        })
    }

    fn views() -> impl Iterator<Item = (f64, f64, f64)> {
        let turns = (0..12).map(|k| 30.0 * f64::from(k));
        turns.flat_map(|t| {
            [0.0, 25.0, 45.0].into_iter().flat_map(move |tilt| [0.0, 30.0, 77.0].map(|a| (t, tilt, a)))
        })
    }

    #[test]
    fn the_ratio_of_a_board_comes_out_from_every_side() {
        for (focal, limit) in [(USUAL_FOCAL, 1.03), (2.0 * USUAL_FOCAL, 1.28)] {
            let mut worst = 1.0f64;
            for size in [(100.0, 50.0), (100.0, 30.0), (40.0, 160.0)].map(DVec2::from) {
                for (turn, tilt, axis) in views() {
                    let ratio = side_ratio(seen(size, turn, tilt, axis, focal), PICTURE) / (size.x / size.y);
                    worst = worst.max(ratio).max(1.0 / ratio);
                }
            }
            assert!(worst < limit, "focal length {focal} diagonals: {worst}");
        }
    }

    #[test]
    fn the_width_is_the_width_however_the_board_lies() {
        for size in [(100.0, 50.0), (100.0, 30.0), (30.0, 100.0)].map(DVec2::from) {
            for (turn, tilt, axis) in views() {
                let truth = seen(size, turn, tilt, axis, 0.62);
                for first in 0..4 {
                    let as_found = std::array::from_fn(|k| truth[(k + first) % 4]);
                    let found = oriented(as_found, size, PICTURE).expect("a board of this size");
                    // A half turn is left open.
                    let half_turned = [truth[2], truth[3], truth[0], truth[1]];
                    assert!(
                        found.corners == truth || found.corners == half_turned,
                        "{size} {turn} {tilt} {axis}"
                    );
                    assert!(!found.is_guess);
                }
            }
        }
    }

    #[test]
    fn another_board_is_refused_and_a_square_one_is_a_guess() {
        let corners = seen(DVec2::new(100.0, 30.0), 30.0, 45.0, 20.0, 0.62);
        let error = oriented(corners, DVec2::new(100.0, 60.0), PICTURE);
        assert!(matches!(error, Err(CornersNotFound::Ratio { .. })), "{error:?}");
        let corners = seen(DVec2::new(50.0, 50.0), 10.0, 20.0, 20.0, 0.62);
        let square = oriented(corners, DVec2::new(50.0, 48.0), PICTURE).expect("nearly square");
        assert!(square.is_guess && square.corners == corners);
    }
}
