//! Names of faces, such as `f:9c1e`.
//!
//! A name is a coarse description of its face in hexadecimal digits. It can be decoded without the mesh
//! that it came from. In another export of the part, the face nearest to the description is looked up, so
//! that the name finds it even if a value lies at the edge of an interval and is rounded the other way.
//!
//! A description has eight numbers: the centroid in the part's bounding box, measured from its middle
//! in units of its diagonal; the mean normal, which is zero for a whole cylinder or sphere; the
//! logarithm of the area over the squared diagonal; and the bulge, which is the mean of the normal
//! times the position about the centroid: the radius of a cylinder over the diagonal, negative for a hole. None of
//! them depends on the origin, the unit, the order of triangles or the kind of primitive that was
//! fitted, and chord errors change them little. Names do depend on how the part is turned in its file.
//!
//! Each digit stands for four halvings of the intervals in which the numbers lie. Each time, the interval
//! that is widest in units of its tolerance is halved. A name is thus a box of eight intervals. The
//! distance of a face from the box is zero inside; outside it is measured in tolerances. A name means the
//! one face within a distance of 1, provided that the next face is at least 0.5 further away. Names are
//! printed with the fewest digits (at least four) that keep all other faces at least 1.5 away. If two
//! faces are equal, no name finds either.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;

use crate::math::ln;

/// The eight numbers that describe a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Description([f64; N]);

/// Length of a description. Source: the list of numbers in the module's text.
const N: usize = 8;

/// Lower end, upper end and tolerance of each number.
///
/// Source: derived from a chord error of 0.2 mm on parts of 20 mm and more: centroids and radii move
/// by less than 0.01 of the diagonal, areas of holes with eight facets shrink by 10 %. Normals of
/// coarse half cylinders change by less than 0.15. The smallest area is that of a square of 0.03 %
/// of the diagonal. Most ranges are 1.5 times as long as necessary, so that the values 0 and the true
/// upper end, which are frequent in symmetric parts, lie at one and two thirds of the range. However often
/// a range is halved, thirds stay far from the edges of intervals, so rounding seldom changes a name.
const RANGES: [(f64, f64, f64); N] = [
    (-0.5, 1.0, 0.01),
    (-0.5, 1.0, 0.01),
    (-0.5, 1.0, 0.01),
    (-1.0, 2.0, 0.15),
    (-1.0, 2.0, 0.15),
    (-1.0, 2.0, 0.15),
    (-16.0, 4.0, 0.3),
    (-0.5, 1.0, 0.01),
];

/// Fewest and most digits of a name. Source: derived: with 15 digits every interval is narrower than
/// half of its tolerance.
pub(super) const DIGITS: (usize, usize) = (4, 15);
/// Greatest distance at which a name still means a face. Source: derived: one tolerance.
pub(super) const MAX_DISTANCE: f64 = 1.0;
/// The second nearest face has to be further away than the nearest by at least this. Source: derived: half a tolerance.
pub(super) const MIN_MARGIN: f64 = 0.5;

impl Description {
    pub(super) fn new(
        centroid: DVec3,
        normal: DVec3,
        area: f64,
        bulge: f64,
        (low, high): (DVec3, DVec3),
    ) -> Self {
        let diagonal = (high - low).length();
        let place = (centroid - 0.5 * (low + high)) / diagonal;
        let area = ln(area / (diagonal * diagonal));
        Self([place.x, place.y, place.z, normal.x, normal.y, normal.z, area, bulge / diagonal])
    }

    /// The name with this many digits.
    pub(super) fn name(&self, digits: usize) -> FaceName {
        let mut intervals = RANGES.map(|(low, high, _)| (low, high));
        let mut text = String::with_capacity(digits);
        for _ in 0..digits {
            let mut digit = 0;
            for _ in 0..4 {
                let axis = widest(&intervals);
                let (low, high) = intervals[axis];
                let middle = 0.5 * (low + high);
                let upper = self.0[axis] >= middle;
                intervals[axis] = if upper { (middle, high) } else { (low, middle) };
                digit = 2 * digit + u8::from(upper);
            }
            // `from_digit` gives a character for every digit below 16.
            text.extend(char::from_digit(u32::from(digit), 16));
        }
        FaceName { digits: text, intervals }
    }
}

/// The interval that is widest in units of its tolerance; of equal ones the first.
fn widest(intervals: &[(f64, f64); N]) -> usize {
    let width = |i: usize| (intervals[i].1 - intervals[i].0) / RANGES[i].2;
    (1..N).fold(0, |best, i| if width(i) > width(best) { i } else { best })
}

/// A name as typed: `f:` and 4 to 15 hexadecimal digits.
///
/// ```
/// use grainpath_core::faces::FaceName;
///
/// let name: FaceName = "f:9c1e".parse().unwrap();
/// assert_eq!(name.to_string(), "f:9c1e");
/// assert!("f:9c1".parse::<FaceName>().is_err());
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FaceName {
    digits: String,
    /// The intervals in which the eight numbers lie.
    intervals: [(f64, f64); N],
}

impl FaceName {
    /// Distance of a face from the name, in tolerances.
    pub(super) fn distance(&self, face: &Description) -> f64 {
        let off = |i: usize| {
            let (low, high) = self.intervals[i];
            ((low - face.0[i]).max(face.0[i] - high) / RANGES[i].2).max(0.0)
        };
        (0..N).map(|i| off(i).powi(2)).sum::<f64>().sqrt()
    }
}

impl fmt::Display for FaceName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "f:{}", self.digits)
    }
}

/// Text that does not have the form of a name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "{0:?} is not the name of a face; a name is f: and 4 to 15 hexadecimal digits, and `grainpath inspect FILE --faces` lists them"
)]
pub struct InvalidName(String);

impl FromStr for FaceName {
    type Err = InvalidName;

    fn from_str(text: &str) -> Result<Self, InvalidName> {
        let digits = text.strip_prefix("f:").filter(|d| (DIGITS.0..=DIGITS.1).contains(&d.len()));
        let digits = digits.ok_or_else(|| InvalidName(text.to_owned()))?.to_ascii_lowercase();
        let mut intervals = RANGES.map(|(low, high, _)| (low, high));
        for c in digits.chars() {
            let digit = c.to_digit(16).ok_or_else(|| InvalidName(text.to_owned()))?;
            for bit in (0..4).rev() {
                let axis = widest(&intervals);
                let (low, high) = intervals[axis];
                let middle = 0.5 * (low + high);
                intervals[axis] = if digit >> bit & 1 == 1 { (middle, high) } else { (low, middle) };
            }
        }
        Ok(Self { digits, intervals })
    }
}

/// A name that means no face, or more than one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FaceError {
    /// The text does not have the form of a name.
    #[error(transparent)]
    InvalidName(#[from] InvalidName),
    /// Every face is too far from the name.
    #[error(
        "{name} is no face of the part; nearest are {candidates}; `grainpath inspect FILE --faces` lists all"
    )]
    NotFound {
        /// The name.
        name: String,
        /// Descriptions of the nearest faces.
        candidates: String,
    },
    /// Two or more faces are about equally near.
    #[error(
        "{name} is doubtful, for several faces are alike: {candidates}; name one of these, or in a job a box, a plane or a cylinder"
    )]
    Doubtful {
        /// The name.
        name: String,
        /// Descriptions of these faces.
        candidates: String,
    },
}
