//! Finds which side of a photographed rectangle is its width.
//!
//! Four corners in a photograph give the position of a board, but several rotations are possible. If the
//! ratio of its sides is known beforehand, it decides between them. The ratio follows from the four
//! corners for a pinhole camera with square pixels (Zhang and He 2007, *Whiteboard scanning and image
//! enhancement*, section 3.2), once its focal length and the place of its axis in the picture are known.
//!
//! The corners alone do not tell both. The sides of a rectangle are perpendicular, which is one equation
//! for three unknowns; with the axis in the middle of the picture it gives the focal length, unless one
//! pair of sides is parallel in the picture. A cropped picture has its axis elsewhere. So the ratio is
//! taken for every credible camera that makes the sides perpendicular within the error of the corners,
//! and the least and the greatest ratio are compared with the given size. A turn of the board that lies
//! outside of them is ruled out. Where both turns are possible, the less unusual camera decides and the
//! turn counts as a guess. Where no camera fits either turn, the size is wrong or another object was
//! found, and the photograph is refused. A half turn goes unnoticed; of the two possible first corners,
//! the one nearer to the picture's upper left is taken.
//!
//! Cost is constant: some thousand cameras, or about a millisecond.
//!
//! ```text
//!        a--------b           portrait photograph of a landscape board:
//!       /          \            corners as found   a b c d, width/height 0.4
//!      d------------c           size_mm = [100, 40] -> corners turned: d a b c
//! ```

use grainpath_core::math::{cross, exp, ln};
use grainpath_core::{DVec2, DVec3};

use super::corners::CornersNotFound;

/// Focal length of a usual camera, as a share of the picture's diagonal. Source: 26 to 28 mm in 35 mm film terms (43.3 mm
/// diagonal), the main camera of current telephones.
const USUAL_FOCAL: f64 = 0.62;
/// Range of credible focal lengths, as a share of the diagonal of the whole picture, before it was cropped.
/// Source: 13 mm (the widest camera of a telephone) to 200 mm as 35 mm equivalent.
const FOCAL_RANGE: [f64; 2] = [0.3, 4.6];
/// Factor between the focal lengths that are tried. Source: chosen; ratios of neighbours differ by at most this
/// factor, which is small beside `RATIO_TOLERANCE`.
const FOCAL_STEP: f64 = 1.08;
/// Distances of the camera's axis from the middle of the picture that are tried, as shares of the picture's width and
/// height: number of steps to each side, and step.
type Axes = (i32, f64);
/// Axes of pictures of which two thirds of the width and height are left. Source: derived; a picture cropped from one
/// edge to the share s has its axis up to (1 / s - 1) / 2 of its size away.
const NEAR: Axes = (2, 0.125);
/// Axes of pictures of which half of the width and height is left. Source: as for `NEAR`.
const FAR: Axes = (4, 0.125);
/// Cosine of the greatest credible angle between the normal of the board and the line of sight, 67 degrees. Source:
/// chosen; it leaves room around the 60 degrees of docs/woodgrain.md.
const LEAST_COS_TILT: f64 = 0.39;
/// Error of a corner, px. Measured: `a_board_on_a_cloth_is_found_to_a_pixel` (grainpath-parts).
const CORNER_ERROR_PX: f64 = 1.0;
/// Deviation of the corner of a real board from a right angle, radians. Source: derived; half a millimetre on 50 mm.
const OUT_OF_SQUARE: f64 = 0.01;
/// Factor by which the ratio of sides found may differ from the given one, besides what the camera leaves open.
/// Measured: `no_credible_view_of_a_board_takes_the_wrong_side` finds no view that is refused. It leaves room for
/// the thickness of a board, which a tilted view adds to one side.
const RATIO_TOLERANCE: f64 = 1.35;
/// Up to this factor a ratio counts as that of the given size. Source: derived. A picture stretched by f turns
/// directions by up to asin((f - 1) / (f + 1)), which is 2.7 degrees.
pub const FITS: f64 = 1.1;
/// Below this ratio of the sides, it is uncertain which side is the longer one: the error of the ratio would decide.
/// Source: chosen; sides of 50 and 57 mm are told apart, if both are measured to a tenth.
const NEARLY_SQUARE: f64 = 1.15;

/// How sure the turn of a board is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turn {
    /// Only this turn fits the outline.
    Certain,
    /// The board is nearly square, so the corners stay as they were found.
    NearlySquare,
    /// Both turns fit about as well, each with another lens or crop; the less unusual one was taken.
    ByLens,
}

/// The corners of a board, ordered by its known size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oriented {
    /// Upper left, upper right, lower right, lower left of the board, px; a half turn is not resolved.
    pub corners: [DVec2; 4],
    /// Whether the rotation is a guess, and why.
    pub turn: Turn,
}

/// How much wider or narrower for its height than `size_mm` a rectangle is whose corners appear at `corners` (clockwise as
/// seen, rows downwards) in a picture of `size_px`: a factor of 1 or more. It is that of the camera that fits the size best,
/// so 1 says that some credible camera sees a rectangle of this size there.
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
    let asked = ln(size_mm.x / size_mm.y);
    let off = |r: &Ratios| r.off(asked);
    exp(off(&fitting(corners, size_px, &off)))
}

/// Rotates the list of corners so that the first two are the ends of a side of `size_mm.x`. It is given clockwise as
/// seen, with the corner nearest to the picture's upper left first.
///
/// # Errors
/// [`CornersNotFound::Ratio`] when the ratio of the sides fits neither turn.
pub fn oriented(corners: [DVec2; 4], size_mm: DVec2, size_px: DVec2) -> Result<Oriented, CornersNotFound> {
    // Ratios are compared by their logarithms, so that 2 : 1 and 1 : 2 are equally far from 1 : 1.
    let asked = ln(size_mm.x / size_mm.y);
    let off = |r: &Ratios| r.off(asked).min(r.off(-asked));
    let found = fitting(corners, size_px, &off);
    let (as_found, turned) = (found.off(asked), found.off(-asked));
    // A size that no credible camera explains is a mistake in the job, or the corners are not those of the board.
    if as_found.min(turned) > ln(RATIO_TOLERANCE) {
        return Err(CornersNotFound::Ratio { found: exp(found.likely.abs()), asked: exp(asked.abs()) });
    }
    // Twice the error of a ratio separates the turns: each of them may be off by one.
    let turn = if asked.abs() < ln(NEARLY_SQUARE) {
        Turn::NearlySquare
    } else if (as_found - turned).abs() < 2.0 * ln(NEARLY_SQUARE) {
        Turn::ByLens
    } else {
        Turn::Certain
    };
    let other = match turn {
        Turn::Certain => turned < as_found,
        Turn::NearlySquare => false,
        // Of two turns that both fit, the one of the less unusual camera.
        Turn::ByLens if as_found.max(turned) <= ln(FITS) => found.likely * asked < 0.0,
        Turn::ByLens => turned < as_found,
    };
    let mut corners = corners;
    if other {
        // Of the two possible quarter turns, this takes the one whose first corner is nearer to the
        // upper left of the picture.
        let distance = |c: DVec2| c.x + c.y;
        let quarter = if distance(corners[1]) < distance(corners[3]) { 1 } else { 3 };
        corners.rotate_left(quarter);
    }
    debug_assert!(cross(corners[2] - corners[0], corners[3] - corners[1]) >= 0.0);
    Ok(Oriented { corners, turn })
}

/// Logarithms of the ratio of width to height that credible cameras give.
#[derive(Debug, Clone, Copy)]
struct Ratios {
    least: f64,
    most: f64,
    /// The ratio of the least unusual camera.
    likely: f64,
}

impl Ratios {
    /// Distance of a ratio's logarithm from the range; 0 inside it.
    fn off(&self, ratio: f64) -> f64 {
        (self.least - ratio).max(ratio - self.most).max(0.0)
    }
}

/// The ratios of cameras with their axis near the middle of the picture; those of cameras with their axis far from it
/// if these alone fit, where `off` is the distance from what is looked for.
fn fitting(corners: [DVec2; 4], size_px: DVec2, off: &dyn Fn(&Ratios) -> f64) -> Ratios {
    let fits = |r: &Ratios| off(r) <= ln(FITS);
    let near = ratios(corners, size_px, NEAR);
    if fits(&near) {
        return near;
    }
    let far = ratios(corners, size_px, FAR);
    if fits(&far) { far } else { near }
}

/// The ratios of the cameras with these axes that make the sides perpendicular.
fn ratios(corners: [DVec2; 4], size_px: DVec2, (n_steps, step): Axes) -> Ratios {
    // Lengths are shares of the diagonal, so that the same cameras are tried for pictures of all sizes.
    let diagonal = size_px.length();
    let sides = Sides::of(corners, size_px);
    // Each corner moved by its error in x and in y, from which the error of the angle between the sides follows.
    let moved: [Sides; 8] = std::array::from_fn(|k| {
        let mut corners = corners;
        corners[k / 2] += if k % 2 == 0 { DVec2::X } else { DVec2::Y } * CORNER_ERROR_PX;
        Sides::of(corners, size_px)
    });
    let mut found = Ratios { least: f64::INFINITY, most: f64::NEG_INFINITY, likely: f64::INFINITY };
    let mut least_cost = (true, f64::INFINITY);
    for camera in cameras(size_px / diagonal, n_steps, step) {
        let view = sides.seen_by(&camera);
        let credible = view.cos_tilt >= LEAST_COS_TILT;
        // Variance of the cosine between the sides: the errors of the corners, and half a step to the next camera.
        let off = |other: View| (other.cos_sides - view.cos_sides).powi(2);
        let to_next = [
            Camera { focal: camera.focal * FOCAL_STEP.sqrt(), ..camera },
            Camera { axis: camera.axis + DVec2::new(0.5 * step * size_px.x / diagonal, 0.0), ..camera },
            Camera { axis: camera.axis + DVec2::new(0.0, 0.5 * step * size_px.y / diagonal), ..camera },
        ];
        let variance = OUT_OF_SQUARE.powi(2)
            + moved.iter().map(|s| off(s.seen_by(&camera))).sum::<f64>()
            + to_next.iter().map(|c| off(sides.seen_by(c))).sum::<f64>();
        let off_square = view.cos_sides.powi(2) / variance;
        // Two standard deviations.
        if credible && off_square < 4.0 {
            found.least = found.least.min(view.ratio);
            found.most = found.most.max(view.ratio);
        }
        // A board seen too steeply comes last, but an answer is better than none.
        let cost = (!credible, off_square + camera.unusual());
        if cost < least_cost {
            (least_cost, found.likely) = (cost, view.ratio);
        }
    }
    if found.least > found.most {
        // No camera makes the sides perpendicular: the best one counts alone.
        (found.least, found.most) = (found.likely, found.likely);
    }
    found
}

/// A pinhole camera. Lengths are shares of the picture's diagonal.
#[derive(Debug, Clone, Copy)]
struct Camera {
    focal: f64,
    /// Where its axis meets the picture, from the middle of it.
    axis: DVec2,
}

impl Camera {
    /// How unusual this camera is: squared distances from the usual one, in standard deviations.
    fn unusual(&self) -> f64 {
        // Source: chosen; the lenses of telephones lie within a factor of 2 of the usual one, and most pictures are
        // not cropped. It only decides where the user is warned.
        (ln(self.focal / USUAL_FOCAL) / ln(2.0)).powi(2) + self.axis.length_squared() / 0.2f64.powi(2)
    }
}

/// The cameras that are tried for a picture of this size (shares of its diagonal).
fn cameras(size: DVec2, n_steps: i32, step: f64) -> impl Iterator<Item = Camera> {
    let places = move || (-n_steps..=n_steps).map(move |k| step * f64::from(k));
    let axes = places().flat_map(move |x| places().map(move |y| DVec2::new(x, y)));
    axes.flat_map(move |share| {
        // The smallest picture around this one that has the axis in its middle: the lens has to cover it.
        let whole = 1.0 + 2.0 * share.abs().max_element();
        let focals = std::iter::successors(Some(FOCAL_RANGE[0]), |f| Some(f * FOCAL_STEP));
        focals
            .take_while(|f| *f < FOCAL_RANGE[1])
            .map(move |focal| Camera { focal: focal * whole, axis: share * size })
    })
}

/// The sides of a rectangle in a picture: section 3.2 of `ZhangHe2007`, for a camera of focal length 1 with its axis in the
/// middle.
struct Sides {
    right: DVec3,
    down: DVec3,
    /// Where the diagonals meet.
    middle: DVec3,
}

/// A rectangle as a camera sees it.
struct View {
    /// Logarithm of width over height.
    ratio: f64,
    /// Cosine of the angle between the sides; 0 for a rectangle.
    cos_sides: f64,
    /// Cosine of the angle between normal and line of sight.
    cos_tilt: f64,
}

impl Sides {
    fn of(corners: [DVec2; 4], size_px: DVec2) -> Self {
        // Coordinates from the middle of the picture, in units of its diagonal.
        let point = |k: usize| ((corners[k] - 0.5 * size_px) / size_px.length()).extend(1.0);
        let [upper_left, upper_right, lower_right, lower_left] = [point(0), point(1), point(2), point(3)];
        // Scale factors of two corners, then the directions of the sides in camera coordinates.
        let across = upper_left.cross(lower_right);
        let k_right = across.dot(lower_left) / upper_right.cross(lower_right).dot(lower_left);
        let k_down = across.dot(upper_right) / lower_left.cross(lower_right).dot(upper_right);
        let middle = across.cross(upper_right.cross(lower_left));
        Self {
            right: k_right * upper_right - upper_left,
            down: k_down * lower_left - upper_left,
            middle: middle / middle.z,
        }
    }

    fn seen_by(&self, camera: &Camera) -> View {
        let ray = |v: DVec3| ((v.truncate() - v.z * camera.axis) / camera.focal).extend(v.z);
        let [right, down, sight] = [ray(self.right), ray(self.down), ray(self.middle)];
        let (wide, high) = (right.length(), down.length());
        let normal = right.cross(down);
        View {
            ratio: ln(wide / high),
            cos_sides: right.dot(down) / (wide * high),
            cos_tilt: normal.dot(sight).abs() / (normal.length() * sight.length()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainpath_core::math::{direction, rotated, sin_cos};

    const PICTURE: DVec2 = DVec2::new(1200.0, 900.0);

    /// A view of a board: turned in its plane, tilted about an axis in the picture (degrees), seen by a camera of this
    /// focal length in diagonals, that has the board's middle this far from its axis (shares of the picture).
    #[derive(Debug, Clone, Copy)]
    struct Scene {
        turn: f64,
        tilt: f64,
        axis: f64,
        focal: f64,
        away: DVec2,
    }

    /// Corners in the board's own order.
    fn seen(size: DVec2, view: Scene) -> [DVec2; 4] {
        let (s, c) = sin_cos(view.tilt.to_radians());
        let axis = direction(view.axis.to_radians());
        let across = DVec2::new(-axis.y, axis.x);
        let focal_px = view.focal * PICTURE.length();
        let distance = focal_px * size.length() / 500.0;
        let away = view.away * PICTURE * distance / focal_px;
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| {
            let p = rotated(0.5 * size * DVec2::new(x, y), direction(view.turn.to_radians()));
            let (along, off) = (p.dot(axis), p.dot(across));
            0.5 * PICTURE + focal_px * (along * axis + c * off * across + away) / (distance + s * off)
        })
    }

    /// The picture cut to the board and 25 pixels around it.
    fn cropped(corners: [DVec2; 4]) -> ([DVec2; 4], DVec2) {
        let low = corners.into_iter().reduce(DVec2::min).expect("four corners") - 25.0;
        let high = corners.into_iter().reduce(DVec2::max).expect("four corners") + 25.0;
        (corners.map(|c| c - low), high - low)
    }

    fn scenes(away: DVec2) -> impl Iterator<Item = Scene> {
        let angles = [0.0, 20.0, 90.0]
            .into_iter()
            .flat_map(|turn| [0.0, 30.0, 90.0].map(|axis| (turn, axis)))
            .flat_map(|(turn, axis)| {
                [0.0, 25.0, 35.0, 45.0, 50.0, 55.0, 60.0].map(|tilt| (turn, axis, tilt))
            });
        angles.flat_map(move |(turn, axis, tilt)| {
            // 27, 39, 56 and 78 mm as 35 mm equivalent.
            [0.62, 0.9, 1.3, 1.8].map(|focal| Scene { turn, tilt, axis, focal, away })
        })
    }

    /// Whether these are the board's corners, from the first one or after a half turn.
    fn are(found: [DVec2; 4], truth: [DVec2; 4]) -> bool {
        found == truth || found == [truth[2], truth[3], truth[0], truth[1]]
    }

    #[test]
    fn no_credible_view_of_a_board_takes_the_wrong_side() {
        let crops = [
            ("whole", DVec2::ZERO),
            ("cropped", DVec2::ZERO),
            ("cropped", DVec2::new(0.15, 0.0)),
            ("cropped", DVec2::new(-0.1, 0.13)),
        ];
        for (size, most_guessed) in [
            ((60.0, 50.0), 0.9),
            ((65.0, 50.0), 0.7),
            ((70.0, 50.0), 0.4),
            ((90.0, 50.0), 0.05),
            ((50.0, 120.0), 0.0),
            ((100.0, 30.0), 0.0),
        ] {
            let size = DVec2::from(size);
            for (cut, away) in crops {
                let (mut n, mut n_guessed, mut worst) = (0, 0, 1.0f64);
                for scene in scenes(away) {
                    // Corners are found with an error of half a pixel.
                    let error = [(0.5, -0.3), (-0.4, 0.5), (0.2, 0.5), (-0.5, -0.5)].map(DVec2::from);
                    let truth: [DVec2; 4] = std::array::from_fn(|k| seen(size, scene)[k] + error[k]);
                    let (truth, picture) = if cut == "whole" { (truth, PICTURE) } else { cropped(truth) };
                    let what = format!("{size} {cut} {scene:?}");
                    let as_found = [truth[1], truth[2], truth[3], truth[0]];
                    worst = worst.max(stretched(truth, size, picture));
                    let found = oriented(as_found, size, picture).unwrap_or_else(|e| panic!("{what}: {e}"));
                    n += 1;
                    n_guessed += usize::from(found.turn != Turn::Certain);
                    assert!(found.turn != Turn::Certain || are(found.corners, truth), "{what}");
                    assert!(found.turn == Turn::Certain || scene.tilt > 0.0, "{what}");
                }
                let share = n_guessed as f64 / n as f64;
                println!(
                    "{size} {cut} {away}: {share:.2} of {n} views guessed, proportions off by up to {worst:.3}"
                );
                assert!(
                    share <= most_guessed && worst < 1.15,
                    "{size} {cut} {away}: {share} guessed, {worst}"
                );
            }
        }
    }

    #[test]
    fn the_width_is_the_width_however_the_board_lies() {
        for size in [(100.0, 50.0), (100.0, 30.0), (30.0, 100.0)].map(DVec2::from) {
            for scene in scenes(DVec2::ZERO) {
                let truth = seen(size, scene);
                for first in 0..4 {
                    let as_found = std::array::from_fn(|k| truth[(k + first) % 4]);
                    let found = oriented(as_found, size, PICTURE).expect("a board of this size");
                    assert!(are(found.corners, truth) && found.turn == Turn::Certain, "{size} {scene:?}");
                }
            }
        }
    }

    #[test]
    fn another_board_is_refused_and_a_square_one_is_a_guess() {
        let scene = Scene { turn: 30.0, tilt: 45.0, axis: 20.0, focal: 0.62, away: DVec2::ZERO };
        let level = Scene { tilt: 0.0, ..scene };
        for (scene, height) in [(level, 50.0), (scene, 80.0)] {
            let corners = seen(DVec2::new(100.0, 30.0), scene);
            let error = oriented(corners, DVec2::new(100.0, height), PICTURE);
            assert!(matches!(error, Err(CornersNotFound::Ratio { .. })), "{error:?}");
        }
        // Seen more steeply than is credible, a board still has a ratio.
        let size = DVec2::new(100.0, 30.0);
        let off = stretched(seen(size, Scene { tilt: 80.0, ..scene }), size, PICTURE);
        assert!(off.is_finite(), "{off}");
        let corners = seen(DVec2::new(50.0, 50.0), Scene { turn: 10.0, tilt: 20.0, ..scene });
        let square = oriented(corners, DVec2::new(50.0, 48.0), PICTURE).expect("nearly square");
        assert!(square.turn == Turn::NearlySquare && square.corners == corners);
    }

    #[test]
    fn swapped_sides_are_told_from_every_side() {
        for size in [(90.0, 30.0), (120.0, 50.0)].map(DVec2::from) {
            let off = |scene| stretched(seen(size, scene), DVec2::new(size.y, size.x), PICTURE);
            let least = scenes(DVec2::ZERO)
                .map(|s| (off(s), s))
                .fold((f64::INFINITY, None), |a, (o, s)| if o < a.0 { (o, Some(s)) } else { a });
            println!("{size}: {least:?}");
            assert!(least.0 > RATIO_TOLERANCE, "{size}: {least:?}");
        }
    }
}
