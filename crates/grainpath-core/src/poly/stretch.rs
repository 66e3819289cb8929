//! Stretches pieces of parallel lines until they end on something.
//!
//! Method: each piece grows at both ends up to the first line that crosses it or to the border of a region, whichever comes
//! first; pieces of one line that then overlap become one. Lengths are in mm. Cost: pieces times crossing lines.
//!
//! ```text
//!      |          |          |
//!      |   ----   |    -->   |----------|
//!      |          |          |          |
//! ```

use super::LineClipper;
use crate::DVec2;
use crate::math::{direction, rotated};

/// Points this near to each other are the same, mm. Source: derived. Ten times the grid of the booleans, and far below the
/// distance of two lines.
const SAME_MM: f64 = 1e-3;

/// Farther than any border that a line may have to reach, mm. Source: chosen; ten times the bed of a large printer.
const FAR_MM: f64 = 1e4;

/// Stretches pieces of lines in the direction `angle_rad` up to the lines that cross them, or to the border of the region
/// where no line crosses before it. An end on the border stays where it is. Without crossing lines nothing changes.
///
/// ```
/// use grainpath_core::poly::{LineClipper, stretched_to};
/// use grainpath_core::{DVec2, Region};
/// let at = DVec2::new;
/// let region = LineClipper::new(&Region::rectangle(at(0.0, 0.0), at(10.0, 4.0)));
/// let upright = |x: f64| [at(x, 0.0), at(x, 4.0)];
/// let found = stretched_to(&[[at(4.0, 2.0), at(5.0, 2.0)]], 0.0, &[upright(2.0), upright(7.0)], &region);
/// assert_eq!(found, [[at(2.0, 2.0), at(7.0, 2.0)]]);
/// ```
pub fn stretched_to(
    pieces: &[[DVec2; 2]],
    angle_rad: f64,
    crossing: &[[DVec2; 2]],
    region: &LineClipper,
) -> Vec<[DVec2; 2]> {
    if crossing.is_empty() {
        return pieces.to_vec();
    }
    // In the frame of the lines: their height, and where they begin and end.
    let back = direction(-angle_rad);
    let turned = |[a, b]: [DVec2; 2]| [rotated(a, back), rotated(b, back)];
    let crossing: Vec<[DVec2; 2]> = crossing.iter().map(|&line| turned(line)).collect();
    let stretched = |&piece: &[DVec2; 2]| {
        let [a, b] = turned(piece);
        let (y, [low, high]) = (a.y, [a.x.min(b.x), a.x.max(b.x)]);
        let (mut least, mut most) = (f64::NEG_INFINITY, f64::INFINITY);
        let crosses = |[p, q]: &&[DVec2; 2]| (p.y - y) * (q.y - y) <= 0.0 && p.y != q.y;
        for [p, q] in crossing.iter().filter(crosses) {
            let x = p.x + (y - p.y) / (q.y - p.y) * (q.x - p.x);
            if x <= low {
                least = least.max(x);
            }
            if x >= high {
                most = most.min(x);
            }
        }
        let to = |from: f64, to: f64| {
            let place = |x: f64| rotated(DVec2::new(x, y), direction(angle_rad));
            // An end on the border of the region stays there.
            if !region.contains(place(from + SAME_MM * (to - from).signum())) {
                return from;
            }
            let far = if to.is_finite() { to } else { from + FAR_MM.copysign(to) };
            let crossings = region.crossings(place(from), place(far));
            let border =
                crossings.iter().map(|c| from + c.t * (far - from)).find(|x| (x - from).abs() > SAME_MM);
            border.unwrap_or(if to.is_finite() { to } else { from })
        };
        [y, to(low, least), to(high, most)]
    };
    let mut rows: Vec<[f64; 3]> = pieces.iter().map(stretched).collect();
    // Pieces of one line get one height; those of two lines differ by far more than the rounding of a turn.
    rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
    for k in 1..rows.len() {
        if rows[k][0] - rows[k - 1][0] < SAME_MM {
            rows[k][0] = rows[k - 1][0];
        }
    }
    rows.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut joined: Vec<[f64; 3]> = Vec::new();
    for row in rows {
        match joined.last_mut().filter(|last| last[0] == row[0] && row[1] <= last[2]) {
            Some(last) => last[2] = last[2].max(row[2]),
            None => joined.push(row),
        }
    }
    let ahead = direction(angle_rad);
    joined.iter().map(|[y, a, b]| [*a, *b].map(|x| rotated(DVec2::new(x, *y), ahead))).collect()
}
