//! What all steps share: where pieces lie, which way a line goes on, and what it would cross.

use crate::math::{atan2, cross, direction, rotated};
use crate::poly::LineClipper;
use crate::segments::Segments;
use crate::{DVec2, Region};

/// The direction of a piece at its end is that of the stretch between these two distances from the end, in spacings.
/// Source: derived; a hairpin between two beads is over after one spacing and a half.
pub(super) const STRETCH: [f64; 2] = [2.0, 4.0];
/// A segment within the first of [`STRETCH`] belongs to a hairpin if it deviates from the direction of the piece by more
/// than this, and a change of lanes is one if it deviates less; the cosine of 25 degrees. Source: derived from [`STEEPEST_RAD`],
/// with ten degrees for the curve of a line.
pub(super) const HAIRPIN_COS: f64 = 0.906;
/// Steepest slope by which two ends that face each other are joined: 15 degrees. Source: chosen; the angle within which a
/// path counts as along the load in the report.
pub(super) const STEEPEST_RAD: f64 = 0.2618;
/// A turn is rounded with this much of its lines, in radii. Source: derived; an arc by 150 degrees, the most at
/// [`LEAST_SINE`] plus a curve of 30, reaches 3.9 radii back.
pub(super) const STRAIGHT: f64 = 4.0;

/// What a cut is worth when groups are chosen, in spacings of fibre. Source: measured on one layer of `plate-wide`, as `TURNS_PER_LINE`; with 1, 10 and
/// 20 the plate has 5.11, 5.11 and 5.08 m of fibre in 45, 45 and 43 pieces a layer. With 0 lines that are long enough alone would
/// not turn.
pub(super) const CUT_SPACINGS: f64 = 10.0;

/// Where pieces lie.
pub struct Place<'a> {
    /// The area for their centrelines.
    pub region: &'a Region,
    /// The same area, searchable.
    pub clipper: &'a LineClipper,
    /// Distance between beads side by side, mm.
    pub spacing_mm: f64,
    /// Least radius of a turn, mm.
    pub least_mm: f64,
    /// Groups of lines begin this much farther along the border, mm, so that the cuts of layers lie apart.
    pub onward_mm: f64,
    /// Least length of a path, mm; what is shorter stays a piece that is laid otherwise.
    pub needed_mm: f64,
}

/// The points of a line, and whether it is closed.
pub(super) type Path = (Vec<DVec2>, bool);

/// All points of a path; those of a closed one end where they begin.
pub(super) fn whole((points, closed): &Path) -> Vec<DVec2> {
    if *closed { [&points[..], &points[..1]].concat() } else { points.clone() }
}

/// Unit vector in which a line goes on beyond its first point; `None` if the line is too short to tell.
pub(super) fn onward(line: &[DVec2], spacing_mm: f64) -> Option<DVec2> {
    direction_of(line, STRETCH.map(|beads| beads * spacing_mm))
}

/// As [`onward`], turned by the curve of the line: at the end of an arc of 12 mm radius the stretch of [`STRETCH`] deviates by
/// 11 degrees from the arc, so that two ends of it would not face each other.
pub(super) fn onward_curved(line: &[DVec2], place: &Place<'_>) -> Option<DVec2> {
    let near = onward(line, place.spacing_mm)?;
    let Some(far) = direction_of(line, STRETCH.map(|beads| 2.0 * beads * place.spacing_mm)) else {
        return Some(near);
    };
    // The middles of both stretches are three spacings apart, and the nearer is three from the end.
    let turn_rad = atan2(cross(far, near), far.dot(near));
    let most_rad = 3.0 * place.spacing_mm / place.least_mm;
    Some(rotated(near, direction(turn_rad.clamp(-most_rad, most_rad))))
}

/// Unit vector from one place on a line to another nearer to its first point, told by their distances along it.
fn direction_of(line: &[DVec2], mut left_mm: [f64; 2]) -> Option<DVec2> {
    let mut at = [None; 2];
    for w in line.windows(2) {
        let length_mm = w[0].distance(w[1]);
        for (left_mm, at) in left_mm.iter_mut().zip(&mut at).filter(|(_, at)| at.is_none()) {
            if *left_mm <= length_mm && length_mm > 0.0 {
                *at = Some(w[0].lerp(w[1], *left_mm / length_mm));
            }
            *left_mm -= length_mm;
        }
    }
    (at[0]? - at[1]?).try_normalize()
}

/// The segments of lines, searchable.
pub(super) struct Obstacles {
    pub(super) segments: Segments,
    /// The line of each segment.
    pub(super) line_of: Vec<usize>,
}

impl Obstacles {
    pub(super) fn new(lines: impl Iterator<Item = Vec<DVec2>>, cell_mm: f64) -> Self {
        let (mut segments, mut line_of) = (Vec::new(), Vec::new());
        for (l, line) in lines.enumerate() {
            segments.extend(line.windows(2).map(|w| [w[0], w[1]]));
            line_of.resize(segments.len(), l);
        }
        Self { segments: Segments::new(segments, cell_mm), line_of }
    }

    /// Whether a line other than those that `skips` names crosses or touches the way from `a` to `b`.
    pub(super) fn between(&self, a: DVec2, b: DVec2, skips: impl Fn(usize) -> bool) -> bool {
        self.segments.meets(a, b, |i| !skips(self.line_of[i]))
    }
}
